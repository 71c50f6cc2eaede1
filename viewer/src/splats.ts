// A depth image as points in space without a graphics card: this code draws the points with their depths into an image,
// and WebGL draws only that image. Software renderers of OpenGL take about 0.5 µs per point, 25 times as long.

import * as THREE from "three";
import { rgba, shade } from "./colour";
import type { Frame, Intrinsics } from "./frame";
import { place } from "./points";

const VERTEX = `
void main() {
  // A triangle that covers all.
  gl_Position = vec4(4.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}`;

const FRAGMENT = `
uniform sampler2D colours;
uniform highp sampler2D depths;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depths, at, 0).r;
  if (depth == 1.0) discard;
  gl_FragDepth = depth;
  gl_FragColor = texelFetch(colours, at, 0);
}`;

/** Shades from near to far. */
const SHADES = Uint32Array.from({ length: 256 }, (_, index) => shade(index / 255));

interface Depths {
  texels: Uint16Array;
  width: number;
  height: number;
  lens: Intrinsics;
}

interface Colours {
  pixels: Uint32Array;
  width: number;
  height: number;
  lens: Intrinsics;
}

/** Returns the column (x) or row (y) of the colour image that corresponds to one of the depths. */
function seenAt(index: number, axis: "x" | "y", lens: Intrinsics, seen: Colours | undefined): number {
  if (seen === undefined) return 0;
  const ray = (index - lens[`c${axis}`]) / lens[`f${axis}`];
  const at = Math.floor(ray * seen.lens[`f${axis}`] + seen.lens[`c${axis}`] + 0.5);
  return Math.min((axis === "x" ? seen.width : seen.height) - 1, Math.max(0, at));
}

export class SplattedCloud {
  readonly object: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  /** Where the camera is. */
  private readonly sensor = new THREE.Object3D();
  private depths: Depths | undefined;
  private seen: Colours | undefined;
  private readonly size = new THREE.Vector2();
  private colourTexture = new THREE.DataTexture(new Uint8Array(4), 1, 1);
  private depthTexture = new THREE.DataTexture(new Float32Array(1), 1, 1, THREE.RedFormat, THREE.FloatType);

  constructor() {
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { colours: { value: null }, depths: { value: null } },
    });
    this.object = new THREE.Mesh(new THREE.BufferGeometry(), material);
    this.object.geometry.setDrawRange(0, 3);
    this.object.frustumCulled = false;
    this.object.visible = false;
    // Rays never hit the points.
    this.object.raycast = () => undefined;
    this.object.onBeforeRender = (renderer, _, camera) => {
      renderer.getDrawingBufferSize(this.size);
      this.splat(this.size.x, this.size.y, camera);
    };
  }

  /** Sets the newest depths, 16-bit millimetres. */
  show({ header, payload }: Frame) {
    const { width, height, intrinsics } = header;
    if (intrinsics === undefined || header.encoding !== "16uc1") return;
    const texels = new Uint16Array(payload.buffer, payload.byteOffset, width * height);
    this.depths = { texels, width, height, lens: intrinsics };
    place(this.sensor, header.position, header.orientation, true);
    this.sensor.updateMatrixWorld();
    this.object.visible = true;
  }

  /** Sets the newest image of the colour camera that belongs to the depth camera. */
  colour(frame: Frame) {
    const { width, height, intrinsics } = frame.header;
    if (intrinsics === undefined || width === 0) return;
    const pixels = rgba(frame);
    this.seen = pixels === null ? undefined : { pixels: new Uint32Array(pixels.buffer), width, height, lens: intrinsics };
  }

  /** Creates textures of the view's size. */
  private reserve(width: number, height: number) {
    if (this.depthTexture.image.width === width && this.depthTexture.image.height === height) return;
    this.colourTexture.dispose();
    this.depthTexture.dispose();
    const [bytes, numbers] = [new Uint8Array(4 * width * height), new Float32Array(width * height)];
    this.colourTexture = new THREE.DataTexture(bytes, width, height);
    this.depthTexture = new THREE.DataTexture(numbers, width, height, THREE.RedFormat, THREE.FloatType);
    const { uniforms } = this.object.material;
    (uniforms.colours as { value: THREE.Texture }).value = this.colourTexture;
    (uniforms.depths as { value: THREE.Texture }).value = this.depthTexture;
  }

  /** Draws each point as a square of 2 × 2 pixels; the nearest point wins. */
  private splat(width: number, height: number, camera: THREE.Camera) {
    if (this.depths === undefined) return;
    this.reserve(width, height);
    const colours = new Uint32Array((this.colourTexture.image.data as Uint8Array).buffer);
    const nearest = this.depthTexture.image.data as Float32Array;
    nearest.fill(1);
    const { texels, lens } = this.depths;
    const [columns, rows] = [this.depths.width, this.depths.height];
    // A pixel's position in the view is depth × (across · column + base of its row) + origin, all in the homogeneous
    // coordinates of pixels.
    const view = new THREE.Matrix4()
      .makeTranslation(width / 2, height / 2, 0.5)
      .multiply(new THREE.Matrix4().makeScale(width / 2, height / 2, 0.5))
      .multiply(camera.projectionMatrix)
      .multiply(camera.matrixWorldInverse)
      .multiply(this.sensor.matrixWorld);
    const [ax, ay, az, aw, dx, dy, dz, dw, ex, ey, ez, ew, ox, oy, oz, ow] = view.elements;
    const [sx, sy, sz, sw] = [ax / lens.fx, ay / lens.fx, az / lens.fx, aw / lens.fx];
    const { seen } = this;
    const across = Int32Array.from({ length: columns }, (_, column) => seenAt(column, "x", lens, seen));
    const shades = SHADES.length / (Math.min(lens.far ?? 10, 10) - lens.near);
    for (let row = 0, index = 0; row < rows; row++) {
      const [right, down] = [-lens.cx / lens.fx, (row - lens.cy) / lens.fy];
      let [x, y, z, w] = [
        ax * right + dx * down + ex,
        ay * right + dy * down + ey,
        az * right + dz * down + ez,
        aw * right + dw * down + ew,
      ];
      const line = seenAt(row, "y", lens, seen) * (seen?.width ?? 0);
      for (let column = 0; column < columns; column++, index++, x += sx, y += sy, z += sz, w += sw) {
        const millimetres = texels[index] as number;
        if (millimetres === 0 || millimetres === 65535) continue;
        const depth = 0.001 * millimetres;
        const share = 1 / (depth * w + ow);
        const [u, v] = [(depth * x + ox) * share - 0.5, (depth * y + oy) * share - 0.5];
        const away = (depth * z + oz) * share;
        // Behind the eye, or outside the view.
        if (!(share > 0 && away > 0 && u >= 0 && v >= 0 && u < width - 1 && v < height - 1)) continue;
        const shade = Math.min(SHADES.length - 1, Math.max(0, Math.floor((depth - lens.near) * shades)));
        const colour = (seen === undefined ? SHADES[shade] : seen.pixels[line + (across[column] as number)]) as number;
        const at = Math.floor(v) * width + Math.floor(u);
        if (away < (nearest[at] as number)) {
          nearest[at] = away;
          colours[at] = colour;
        }
        if (away < (nearest[at + 1] as number)) {
          nearest[at + 1] = away;
          colours[at + 1] = colour;
        }
        if (away < (nearest[at + width] as number)) {
          nearest[at + width] = away;
          colours[at + width] = colour;
        }
        if (away < (nearest[at + width + 1] as number)) {
          nearest[at + width + 1] = away;
          colours[at + width + 1] = colour;
        }
      }
    }
    this.colourTexture.needsUpdate = true;
    this.depthTexture.needsUpdate = true;
  }

  dispose() {
    this.colourTexture.dispose();
    this.depthTexture.dispose();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
