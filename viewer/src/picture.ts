// A panel with a camera's picture.

import { rgba } from "./colour";
import type { Frame } from "./frame";

export class Picture {
  readonly element = document.createElement("figure");
  private readonly canvas = document.createElement("canvas");
  private readonly caption = document.createElement("figcaption");
  private readonly size = document.createElement("span");

  constructor(topic: string) {
    const name = document.createElement("span");
    name.textContent = `/${topic}`;
    this.caption.append(name, this.size);
    this.element.append(this.canvas, this.caption);
    this.element.dataset.topic = topic;
  }

  show(frame: Frame) {
    const { width, height, encoding } = frame.header;
    if (width === 0 || height === 0) return;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const pixels = rgba(frame);
    this.size.textContent = pixels === null ? `${encoding} cannot be shown` : `${width}×${height} ${encoding}`;
    if (pixels !== null) this.canvas.getContext("2d")?.putImageData(new ImageData(pixels, width, height), 0, 0);
  }
}
