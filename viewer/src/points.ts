// Scans and clouds of lidars as points.

import * as THREE from "three";
import { shade } from "./colour";
import type { Frame } from "./frame";

/** Points of one stream, in the sensor's own axes or in its optical axes. */
export class Points {
  readonly object: THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial>;
  private capacity = 0;
  private places = new Float32Array();
  private colours = new Uint8Array();
  /** Colour of points without a colour of their own. */
  private readonly plain: number;

  constructor(topic: string, size: number) {
    const material = new THREE.PointsMaterial({ size, sizeAttenuation: false, vertexColors: true });
    this.object = new THREE.Points(new THREE.BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.name = topic;
    this.plain = 0xff4d5aff;
  }

  private reserve(count: number) {
    if (count <= this.capacity) return;
    this.capacity = Math.ceil(count * 1.2);
    this.places = new Float32Array(3 * this.capacity);
    this.colours = new Uint8Array(4 * this.capacity);
    const geometry = this.object.geometry;
    geometry.dispose();
    geometry.setAttribute("position", new THREE.BufferAttribute(this.places, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(this.colours, 4, true));
  }

  private finish({ header }: Frame, count: number) {
    const geometry = this.object.geometry;
    geometry.setDrawRange(0, count);
    for (const attribute of Object.values(geometry.attributes)) attribute.needsUpdate = true;
    place(this.object, header.position, header.orientation, header.intrinsics !== undefined);
  }

  private put(index: number, x: number, y: number, z: number, colour: number) {
    this.places.set([x, y, z], 3 * index);
    this.colours[4 * index] = colour & 255;
    this.colours[4 * index + 1] = (colour >> 8) & 255;
    this.colours[4 * index + 2] = (colour >> 16) & 255;
    this.colours[4 * index + 3] = 255;
  }

  /** Returns the number of points. */
  get count(): number {
    return this.object.geometry.drawRange.count;
  }

  showScan(frame: Frame) {
    const { header, payload } = frame;
    if (header.scan === undefined) return;
    const { angleMin, angleIncrement, rangeMin, rangeMax, verticalAngleMin, verticalAngleIncrement } = header.scan;
    this.reserve(header.width * header.height);
    let count = 0;
    for (let layer = 0; layer < header.height; layer++) {
      const elevation = verticalAngleMin + layer * verticalAngleIncrement;
      const [flat, up] = [Math.cos(elevation), Math.sin(elevation)];
      for (let ray = 0; ray < header.width; ray++) {
        const range = payload.getFloat32(layer * header.rowStride + ray * header.elemStride, true);
        if (!(range >= rangeMin && range <= (rangeMax ?? Infinity))) continue;
        const angle = angleMin + ray * angleIncrement;
        const colour = header.height > 1 ? shade(1 - layer / header.height) : this.plain;
        this.put(count++, range * flat * Math.cos(angle), range * flat * Math.sin(angle), range * up, colour);
      }
    }
    this.finish(frame, count);
  }

  showCloud(frame: Frame) {
    const { header, payload } = frame;
    const count = header.points ?? 0;
    this.reserve(count);
    // The strongest return is the end of the scale.
    let most = 1e-6;
    if (header.colour === "intensity") {
      for (let at = 12; at < 16 * count; at += 16) most = Math.max(most, payload.getFloat32(at, true));
    }
    for (let index = 0, at = 0; index < count; index++, at += 16) {
      const number = (offset: number) => payload.getFloat32(at + offset, true);
      const colour =
        header.colour === "rgb" ? payload.getUint32(at + 12, true) : shade(1 - number(12) / most);
      this.put(index, number(0), number(4), number(8), colour);
    }
    this.finish(frame, count);
  }

  dispose() {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

/** Rotation from optical axes (x right, y down, z forward) to body axes (x forward, y left, z up). */
export const BODY_FROM_OPTICAL = new THREE.Quaternion(-0.5, 0.5, -0.5, 0.5);

/** Places an object at the pose of a sensor. */
export function place(
  object: THREE.Object3D,
  position: [number, number, number],
  orientation: [number, number, number, number],
  isOptical: boolean,
) {
  object.position.set(...position);
  object.quaternion.set(...orientation);
  if (isOptical) object.quaternion.multiply(BODY_FROM_OPTICAL);
}
