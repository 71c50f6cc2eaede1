// A panel with the image of a camera, and the scale of its colours if it shows depths.

import { depthRange, rgba, shade } from "./colour";
import type { Frame, FrameHeader } from "./frame";
import { shortened } from "./name";

/** Pixels of the bar from near to far. */
const STEPS = 64;

export class Picture {
  readonly element = document.createElement("figure");
  private readonly canvas = document.createElement("canvas");
  private readonly caption = document.createElement("figcaption");
  private readonly size = document.createElement("span");
  private readonly scale = new Scale();

  constructor(topic: string) {
    this.caption.append(shortened(`/${topic}`), this.size);
    this.element.append(this.canvas, this.caption, this.scale.element);
    this.element.dataset.topic = topic;
    // While time is paused, no frames arrive.
    this.size.textContent = "no frame yet";
  }

  show(frame: Frame) {
    const { width, height, encoding, streamEncoding } = frame.header;
    if (width === 0 || height === 0) return;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const pixels = rgba(frame);
    const named = streamEncoding ?? encoding;
    this.size.textContent = pixels === null ? `${named} cannot be shown` : `${width}×${height} ${named}`;
    if (pixels !== null) this.canvas.getContext("2d")?.putImageData(new ImageData(pixels, width, height), 0, 0);
    this.scale.show(frame.header);
  }
}

/** The scale that shows which depths the colours represent. */
class Scale {
  readonly element = document.createElement("div");
  private readonly ends: [HTMLElement, HTMLElement] = [document.createElement("span"), document.createElement("span")];
  private readonly bar = document.createElement("canvas");

  constructor() {
    this.element.className = "scale";
    this.element.hidden = true;
    this.element.append(this.ends[0], this.bar, this.ends[1]);
    [this.bar.width, this.bar.height] = [STEPS, 1];
    const pixels = Uint32Array.from({ length: STEPS }, (_, step) => shade(step / (STEPS - 1)));
    this.bar.getContext("2d")?.putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), STEPS, 1), 0, 0);
  }

  show(header: FrameHeader) {
    this.element.hidden = header.kind !== "depth_image";
    const range = depthRange(header);
    for (const [index, end] of this.ends.entries()) end.textContent = `${Number((range[index] ?? 0).toPrecision(3))} m`;
  }
}
