// A depth image as points in space, which the graphics card unprojects.

import * as THREE from "three";
import { depthRange, rgba, SHADE_GLSL } from "./colour";
import type { Frame } from "./frame";
import { place } from "./points";

const VERTEX = `
precision highp usampler2D;
uniform usampler2D depths;
uniform sampler2D colours;
uniform vec4 lens; // fx, fy, cx, cy
uniform vec2 range;
uniform float size;
uniform bool coloured;
uniform vec4 colourLens;
uniform vec2 colourSize;
varying vec3 colour;

${SHADE_GLSL}

void main() {
  ivec2 extent = textureSize(depths, 0);
  ivec2 pixel = ivec2(gl_VertexID % extent.x, gl_VertexID / extent.x);
  uint millimetres = texelFetch(depths, pixel, 0).r;
  float depth = float(millimetres) * 0.001;
  vec2 ray = (vec2(pixel) - lens.zw) / lens.xy;
  gl_PointSize = size;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(ray * depth, depth, 1.0);
  // Nothing there: outside of what is drawn.
  if (millimetres == 0u || millimetres == 65535u) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  vec2 seen = (ray * colourLens.xy + colourLens.zw + 0.5) / colourSize;
  colour = coloured ? texture(colours, seen).rgb : shade((depth - range.x) / (range.y - range.x));
}`;

const FRAGMENT = `
varying vec3 colour;
void main() {
  gl_FragColor = vec4(colour, 1.0);
}`;

export class DepthCloud {
  readonly object: THREE.Points<THREE.BufferGeometry, THREE.ShaderMaterial>;
  private depths: THREE.DataTexture | undefined;
  private colours: THREE.DataTexture | undefined;

  constructor() {
    const material = new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: {
        depths: { value: null },
        colours: { value: null },
        lens: { value: new THREE.Vector4(1, 1, 0, 0) },
        range: { value: new THREE.Vector2(0, 5) },
        size: { value: 2 },
        coloured: { value: false },
        colourLens: { value: new THREE.Vector4(1, 1, 0, 0) },
        colourSize: { value: new THREE.Vector2(1, 1) },
      },
    });
    this.object = new THREE.Points(new THREE.BufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  private uniform<T>(name: string): { value: T } {
    return this.object.material.uniforms[name] as { value: T };
  }

  /** Sets the newest depths, 16-bit millimetres. */
  show({ header, payload }: Frame) {
    const { width, height, intrinsics } = header;
    if (intrinsics === undefined || header.encoding !== "16uc1") return;
    const texels = new Uint16Array(payload.buffer, payload.byteOffset, width * height);
    if (this.depths?.image.width !== width || this.depths.image.height !== height) {
      this.depths?.dispose();
      this.depths = new THREE.DataTexture(texels, width, height, THREE.RedIntegerFormat, THREE.UnsignedShortType);
      this.depths.internalFormat = "R16UI";
      this.depths.unpackAlignment = 2;
      this.uniform("depths").value = this.depths;
      this.object.geometry.setDrawRange(0, width * height);
    } else {
      this.depths.image.data = texels;
    }
    this.depths.needsUpdate = true;
    this.uniform<THREE.Vector4>("lens").value.set(intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy);
    this.uniform<THREE.Vector2>("range").value.set(...depthRange(header));
    place(this.object, header.position, header.orientation, true);
  }

  /** Sets the newest image of the colour camera that belongs to the depth camera. */
  colour(frame: Frame) {
    const { width, height, intrinsics } = frame.header;
    if (intrinsics === undefined || width === 0) return;
    const pixels = rgba(frame);
    this.uniform<boolean>("coloured").value = pixels !== null;
    if (pixels === null) return;
    if (this.colours?.image.width !== width || this.colours.image.height !== height) {
      this.colours?.dispose();
      this.colours = new THREE.DataTexture(pixels, width, height);
      this.uniform("colours").value = this.colours;
    }
    this.colours.image.data = pixels;
    this.colours.needsUpdate = true;
    this.uniform<THREE.Vector4>("colourLens").value.set(intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy);
    this.uniform<THREE.Vector2>("colourSize").value.set(width, height);
  }

  dispose() {
    this.depths?.dispose();
    this.colours?.dispose();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
