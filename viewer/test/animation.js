// Combines screenshots into an animated WebP. Chromium encodes the frames.
import { Buffer } from "node:buffer";

/** Encodes a PNG with the browser. Returns the chunks of a still WebP that contain the image. */
async function encode(page, png, width, height) {
  const base64 = await page.evaluate(
    async ({ png, width, height }) => {
      const image = new window.Image();
      image.src = `data:image/png;base64,${png}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [width, height];
      const context = canvas.getContext("2d", { alpha: false });
      context.imageSmoothingQuality = "high";
      context.drawImage(image, 0, 0, width, height);
      return canvas.toDataURL("image/webp", 0.6).split(",")[1];
    },
    { png: png.toString("base64"), width, height },
  );
  const webp = Buffer.from(base64, "base64");
  const parts = [];
  for (let at = 12; at < webp.length; ) {
    const [name, size] = [webp.toString("latin1", at, at + 4), webp.readUInt32LE(at + 4)];
    const end = at + 8 + size + (size % 2);
    if (["VP8 ", "VP8L", "ALPH"].includes(name)) parts.push(webp.subarray(at, end));
    at = end;
  }
  return Buffer.concat(parts);
}

function chunk(name, data) {
  const head = Buffer.alloc(8);
  head.write(name, "latin1");
  head.writeUInt32LE(data.length, 4);
  return Buffer.concat([head, data, Buffer.alloc(data.length % 2)]);
}

/** Returns a size as in the format: three bytes, little-endian. */
function threeBytes(value) {
  return Buffer.from([value & 255, (value >> 8) & 255, value >> 16]);
}

/** Creates a looping WebP from PNGs, each with its duration. `page` is any page of a browser. */
export async function animate(page, pngs, { width, height, periodMs }) {
  const size = Buffer.concat([threeBytes(width - 1), threeBytes(height - 1)]);
  // The only feature flag: animation.
  const parts = [chunk("VP8X", Buffer.concat([Buffer.from([2, 0, 0, 0]), size])), chunk("ANIM", Buffer.alloc(6))];
  for (const png of pngs) {
    const frame = await encode(page, png, width, height);
    const place = Buffer.alloc(6);
    // Each frame replaces the previous one, without blending.
    parts.push(chunk("ANMF", Buffer.concat([place, size, threeBytes(periodMs), Buffer.from([2]), frame])));
  }
  return chunk("RIFF", Buffer.concat([Buffer.from("WEBP", "latin1"), ...parts]));
}
