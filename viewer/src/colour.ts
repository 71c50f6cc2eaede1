// Colours of numbers, and pixels of images.

import type { Frame, FrameHeader } from "./frame";

/** Start of the colour map. Before it, colours of far depths are nearly as black as missing depths. */
const FARTHEST = 0.08;

/** Google's colour map Turbo, by its published polynomial: near is red, far is blue. */
function turbo(share: number): [number, number, number] {
  const x = 1 - (1 - FARTHEST) * Math.min(1, Math.max(0, share));
  const at = (a: number, b: number, c: number, d: number, e: number, f: number) =>
    255 * Math.min(1, Math.max(0, a + x * (b + x * (c + x * (d + x * (e + x * f))))));
  return [
    at(0.13572138, 4.6153926, -42.66032258, 132.13108234, -152.94239396, 59.28637943),
    at(0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604),
    at(0.1066733, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973),
  ];
}

const SHADES = Array.from({ length: 256 }, (_, index) => {
  const [red, green, blue] = turbo(index / 255);
  return (255 << 24) | (Math.round(blue) << 16) | (Math.round(green) << 8) | Math.round(red);
});

/** The same map for a shader, for a fraction from 0 (near) to 1 (far). */
export const SHADE_GLSL = `
vec3 shade(float share) {
  float x = 1.0 - ${1 - FARTHEST} * clamp(share, 0.0, 1.0);
  vec4 low = vec4(1.0, x, x * x, x * x * x);
  vec2 high = low.zw * low.z;
  return clamp(vec3(
    dot(low, vec4(0.13572138, 4.6153926, -42.66032258, 132.13108234)) + dot(high, vec2(-152.94239396, 59.28637943)),
    dot(low, vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333)) + dot(high, vec2(4.27729857, 2.82956604)),
    dot(low, vec4(0.1066733, 12.64194608, -60.58204836, 110.36276771)) + dot(high, vec2(-89.90310912, 27.34824973))
  ), 0.0, 1.0);
}`;

/** The depths in metres at the ends of the scale of a depth image. */
export function depthRange({ intrinsics }: FrameHeader): [near: number, far: number] {
  return [intrinsics?.near ?? 0, Math.min(intrinsics?.far ?? 10, 10)];
}

/** Returns the colour 0xAABBGGRR of a fraction from 0 (near) to 1 (far). */
export function shade(share: number): number {
  return SHADES[Math.round(255 * Math.min(1, Math.max(0, share)))] ?? 0;
}

const BLACK = 255 << 24;

function grey(value: number): number {
  return BLACK | (value << 16) | (value << 8) | value;
}

/** Returns a colour for the number of an object; consecutive numbers have different colours. */
function label(number: number): number {
  if (number < 0) return BLACK;
  const mixed = Math.imul(number + 1, 0x9e3779b1);
  return BLACK | ((mixed >>> 8) & 0xffffff) | 0x404040;
}

/** Positions of red, green (the first) and blue in a square of a Bayer mosaic. */
const MOSAICS: Record<string, [number, number, number]> = {
  rggb: [0, 1, 3],
  bggr: [3, 1, 0],
  gbrg: [2, 0, 1],
  grbg: [1, 0, 2],
};

const drawn = new WeakMap<Frame, Uint8ClampedArray<ArrayBuffer> | null>();

/** Returns the image as RGBA bytes, converted once for all panels that show it; null for an unknown kind. */
export function rgba(frame: Frame): Uint8ClampedArray<ArrayBuffer> | null {
  const before = drawn.get(frame);
  if (before !== undefined) return before;
  const pixels = new Uint32Array(frame.header.width * frame.header.height);
  const bytes = draw(frame, pixels) ? new Uint8ClampedArray(pixels.buffer) : null;
  drawn.set(frame, bytes);
  return bytes;
}

/** Converts an image to 32-bit pixels 0xAABBGGRR. Returns false for an unknown kind of pixels. */
function draw({ header, payload }: Frame, pixels: Uint32Array): boolean {
  const { width, height, rowStride, encoding } = header;
  const bytes = new Uint8Array(payload.buffer, payload.byteOffset, payload.byteLength);
  const each = (colour: (at: number) => number, stride: number) => {
    for (let y = 0, to = 0; y < height; y++) {
      for (let x = 0, at = y * rowStride; x < width; x++, at += stride) pixels[to++] = colour(at);
    }
    return true;
  };
  const byte = (at: number) => bytes[at] ?? 0;
  const [near, far] = depthRange(header);
  const depth = (metres: number) => shade((metres - near) / (far - near));
  switch (encoding) {
    case "rgb8":
      // Most images have this encoding, so it is converted without a call for each pixel.
      for (let y = 0, to = 0; y < height; y++) {
        for (let end = to + width, at = y * rowStride; to < end; at += 3) {
          pixels[to++] =
            BLACK | ((bytes[at + 2] as number) << 16) | ((bytes[at + 1] as number) << 8) | (bytes[at] as number);
        }
      }
      return true;
    case "bgr8":
      return each((at) => BLACK | (byte(at) << 16) | (byte(at + 1) << 8) | byte(at + 2), 3);
    case "rgba8":
      return each((at) => BLACK | (byte(at + 2) << 16) | (byte(at + 1) << 8) | byte(at), 4);
    case "mono8":
      return each((at) => grey(byte(at)), 1);
    case "mono16":
      return each((at) => grey(byte(at + 1)), 2);
    case "16uc1":
      return each((at) => {
        const millimetres = payload.getUint16(at, true);
        return millimetres === 0 || millimetres === 65535 ? BLACK : depth(millimetres / 1000);
      }, 2);
    case "32fc1":
      return each((at) => {
        const metres = payload.getFloat32(at, true);
        return Number.isFinite(metres) ? depth(metres) : BLACK;
      }, 4);
    case "32fc2":
      return each((at) => {
        const [right, down] = [payload.getFloat32(at, true), payload.getFloat32(at + 4, true)];
        const length = Math.hypot(right, down);
        return Number.isFinite(length) ? shade(length / 20) : BLACK;
      }, 8);
    case "32fc3":
      return each((at) => {
        const part = (axis: number) => Math.round(127.5 + 127.5 * payload.getFloat32(at + 4 * axis, true));
        return BLACK | (part(2) << 16) | (part(1) << 8) | part(0);
      }, 12);
    case "32sc1":
      return each((at) => label(payload.getInt32(at, true)), 4);
  }
  const mosaic = /^bayer_([rgb]{4})(8|16)$/.exec(encoding);
  const places = MOSAICS[mosaic?.[1] ?? ""];
  if (places === undefined) return false;
  const size = mosaic?.[2] === "16" ? 2 : 1;
  // One colour for each square of four pixels, which is enough for a preview.
  for (let y = 0, to = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const corner = (y & ~1) * rowStride + (x & ~1) * size + (size - 1);
      const [red, green, blue] = places.map((place) => byte(corner + (place >> 1) * rowStride + (place & 1) * size));
      pixels[to++] = BLACK | ((blue ?? 0) << 16) | ((green ?? 0) << 8) | (red ?? 0);
    }
  }
  return true;
}
