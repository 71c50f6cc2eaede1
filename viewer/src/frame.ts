// The frames that the server sends: see src/view/payload.rs.

export interface Intrinsics {
  fx: number;
  fy: number;
  cx: number;
  cy: number;
  near: number;
  far: number | null;
  model: string | null;
}

export interface ScanGeometry {
  angleMin: number;
  angleIncrement: number;
  rangeMin: number;
  rangeMax: number | null;
  verticalAngleMin: number;
  verticalAngleIncrement: number;
}

export interface FrameHeader {
  topic: string;
  kind: string;
  encoding: string;
  /** The encoding of the stream, if the server has converted it for the page. */
  streamEncoding?: string;
  /** Simulated time in nanoseconds. */
  stamp: number;
  /** The time of sending: milliseconds since 1970 by the server's clock. */
  sentMs: number;
  width: number;
  height: number;
  rowStride: number;
  elemStride: number;
  /** Position in the world in metres; the axes are the sensor's own (x forward, z up). */
  position: [number, number, number];
  /** x, y, z, w. */
  orientation: [number, number, number, number];
  intrinsics?: Intrinsics;
  scan?: ScanGeometry;
  /** For a cloud: the meaning of the last four bytes of a point. */
  colour?: "rgb" | "intensity";
  points?: number;
  restarted?: boolean;
}

export interface Frame {
  header: FrameHeader;
  payload: DataView<ArrayBuffer>;
}

const text = new TextDecoder();

/** Parses a binary message. */
export function parseFrame(message: ArrayBuffer): Frame {
  const length = new DataView(message).getUint32(0, true);
  const header = JSON.parse(text.decode(new Uint8Array(message, 4, length))) as FrameHeader;
  return { header, payload: new DataView(message, 4 + length) };
}

export interface LinkState {
  name: string;
  position: [number, number, number];
  orientation: [number, number, number, number];
}

/** The elements of `simulation/link_states`: bridge/WIRE.md, ModelState. */
export function linkStates({ header, payload }: Frame): LinkState[] {
  const states: LinkState[] = [];
  for (let index = 0; index < header.height; index++) {
    const at = index * header.rowStride;
    const bytes = new Uint8Array(payload.buffer, payload.byteOffset + at, 128);
    const end = bytes.indexOf(0);
    const number = (offset: number) => payload.getFloat64(at + offset, true);
    states.push({
      name: text.decode(bytes.subarray(0, end < 0 ? 128 : end)),
      position: [number(128), number(136), number(144)],
      orientation: [number(152), number(160), number(168), number(176)],
    });
  }
  return states;
}

/** Returns the velocities of odometry, forwards in m/s and to the left in rad/s: bridge/WIRE.md, Odometry. */
export function velocity({ payload }: Frame): [number, number] {
  return [payload.getFloat64(120, true), payload.getFloat64(160, true)];
}
