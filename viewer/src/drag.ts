// Moves models along the floor with the mouse while shift is held.

import * as THREE from "three";
import type { LinkState } from "./frame";

/** Interval between two commands while a model is dragged. */
const PERIOD_MS = 60;

export interface Grabbed {
  model: string;
  at: THREE.Vector3;
}

export interface Dragging {
  /** Converts a position on the page to one in the view, from -1 to 1. */
  placeOf: (at: [number, number]) => THREE.Vector2;
  /** Returns the model at a position in the view, if there is one. */
  pick: (at: THREE.Vector2) => Grabbed | null;
  /** Returns the ray from the eye through a position in the view. */
  ray: (at: THREE.Vector2) => THREE.Ray;
  /** Resolves to the current poses of models, or to null if they do not arrive. */
  poseOf: (model: string) => Promise<LinkState | null>;
  /** Moves a model; resolves once it was moved. */
  move: (model: string, position: [number, number, number], orientation: [number, number, number, number]) => Promise<void>;
}

export function dragModels(canvas: HTMLElement, { placeOf, pick, ray, poseOf, move }: Dragging) {
  const place = (event: PointerEvent) => placeOf([event.clientX, event.clientY]);
  // Runs before the view's own handlers, which would rotate it.
  canvas.addEventListener(
    "pointerdown",
    (event) => {
      const grabbed = event.shiftKey ? pick(place(event)) : null;
      if (grabbed === null) return;
      event.stopImmediatePropagation();
      event.preventDefault();
      canvas.setPointerCapture(event.pointerId);
      void drag(event.pointerId, grabbed);
    },
    { capture: true },
  );

  async function drag(pointer: number, { model, at }: Grabbed) {
    const level = new THREE.Plane(new THREE.Vector3(0, 0, 1), -at.z);
    let [held, wanted] = [true, at.clone()];
    const onMove = (event: PointerEvent) => {
      const met = ray(place(event)).intersectPlane(level, new THREE.Vector3());
      if (event.pointerId === pointer && met !== null) wanted = met;
    };
    const onUp = (event: PointerEvent) => {
      if (event.pointerId === pointer) held = false;
    };
    canvas.addEventListener("pointermove", onMove);
    canvas.addEventListener("pointerup", onUp);
    canvas.addEventListener("pointercancel", onUp);
    const start = await poseOf(model);
    let sent = at.clone();
    // Only one command is pending at a time; the last one has the position at which the model was released.
    while (start !== null && (held || !sent.equals(wanted))) {
      if (!sent.equals(wanted)) {
        sent = wanted.clone();
        const [x, y, z] = start.position;
        await move(model, [x + sent.x - at.x, y + sent.y - at.y, z], start.orientation);
      }
      await new Promise((resolve) => setTimeout(resolve, PERIOD_MS));
    }
    canvas.removeEventListener("pointermove", onMove);
    canvas.removeEventListener("pointerup", onUp);
    canvas.removeEventListener("pointercancel", onUp);
  }
}
