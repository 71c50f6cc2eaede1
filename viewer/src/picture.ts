// A panel with a camera's picture.

import { draw } from "./colour";
import type { Frame } from "./frame";

export class Picture {
  readonly element = document.createElement("figure");
  private readonly canvas = document.createElement("canvas");
  private readonly caption = document.createElement("figcaption");
  private readonly size = document.createElement("span");
  private image: ImageData | undefined;

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
    if (this.image?.width !== width || this.image.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.image = new ImageData(width, height);
    }
    const known = draw(frame, new Uint32Array(this.image.data.buffer));
    this.size.textContent = known ? `${width}×${height} ${encoding}` : `${encoding} cannot be shown`;
    this.canvas.getContext("2d")?.putImageData(this.image, 0, 0);
  }
}
