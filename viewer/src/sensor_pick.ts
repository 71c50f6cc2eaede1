// Clicks on sensors in 3D.

import type { Space } from "./space";

/** Largest movement of the mouse during a click, in pixels. */
const STEADY = 4;
/** Largest distance of a click from a sensor, in pixels, and on its robot, in metres. */
const NEAR = 16;
const BESIDE = 0.08;

/** Returns the topic of the sensor at a position on the page, among those whose poses are known; otherwise null. */
export function sensorAt(
  space: Space,
  [x, y]: [number, number],
  sensors: Map<string, [number, number, number]>,
): string | null {
  const nearest = (distance: (at: [number, number, number]) => number, most: number) => {
    const found = [...sensors].map(([topic, at]) => ({ topic, far: distance(at) }));
    return found.filter(({ far }) => far <= most).sort((one, other) => one.far - other.far)[0]?.topic ?? null;
  };
  const seen = nearest((at) => {
    const [left, top] = space.pixelOf(at);
    return Math.hypot(left - x, top - y);
  }, NEAR);
  if (seen !== null) return seen;
  const met = space.pick(space.placeOf([x, y]))?.at;
  if (met === undefined) return null;
  return nearest((at) => Math.hypot(at[0] - met.x, at[1] - met.y, at[2] - met.z), BESIDE);
}

/** Reports clicks that rotate, shift and move nothing. */
export function onClick(canvas: HTMLElement, clicked: (place: [number, number]) => void) {
  let from: [number, number] | null = null;
  canvas.addEventListener("pointerdown", ({ clientX, clientY, button, shiftKey }) => {
    from = button === 0 && !shiftKey ? [clientX, clientY] : null;
  });
  canvas.addEventListener("pointerup", ({ clientX, clientY }) => {
    if (from !== null && Math.hypot(clientX - from[0], clientY - from[1]) <= STEADY) clicked([clientX, clientY]);
    from = null;
  });
}
