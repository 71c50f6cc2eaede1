// The field of view of a camera, as the edges of a pyramid.

import * as THREE from "three";
import type { Frame } from "./frame";
import { place } from "./points";

/** Length along the optical axis, metres. */
const LENGTH = 0.3;

export class Frustum {
  readonly object = new THREE.LineSegments(
    new THREE.BufferGeometry(),
    new THREE.LineBasicMaterial({ color: 0xffb454 }),
  );

  constructor() {
    this.object.frustumCulled = false;
  }

  show({ header }: Frame) {
    const { width, height, intrinsics } = header;
    if (intrinsics === undefined || (intrinsics.model ?? "plumb_bob") !== "plumb_bob") {
      this.object.visible = false;
      return;
    }
    const { fx, fy, cx, cy } = intrinsics;
    const corner = (u: number, v: number) =>
      new THREE.Vector3(((u - cx) / fx) * LENGTH, ((v - cy) / fy) * LENGTH, LENGTH);
    const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
    const apex = new THREE.Vector3();
    const edges = corners.flatMap((from, index) => [apex, from, from, corners[(index + 1) % 4] ?? from]);
    this.object.geometry.setFromPoints(edges);
    place(this.object, header.position, header.orientation, true);
  }

  dispose() {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
