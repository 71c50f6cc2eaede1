// The streams that can be shown, each with its display.

import type { Connection, Stream } from "./connection";
import { DepthCloud } from "./depth";
import type { Frame } from "./frame";
import { Frustum } from "./frustum";
import { Picture } from "./picture";
import { Points } from "./points";
import { IS_SOFTWARE } from "./software";
import type { Space } from "./space";
import { SplattedCloud } from "./splats";

/** Ends the display of a stream. */
type End = () => void;

export interface Tally {
  frames: number;
  stamp: number;
  /** Recent frames per second. */
  rate: number;
  /** Time from sending to showing of the last frame, in ms. */
  latency: number;
  /** The pose of its sensor, if it has one. */
  place: [number, number, number] | null;
}

/** Suffix of the key of depths in 3D. */
const SPATIAL = "#space";
const OF_SENSORS = ["image", "depth_image", "laser_scan", "point_cloud"];

/** A way to show a stream, and the key under which the choice is stored. */
export interface Choice {
  key: string;
  topic: string;
  /** True if depths are shown as points in 3D instead of as an image. */
  isSpatial: boolean;
  /** Shown by default. */
  isDefault: boolean;
}

/** Returns the colour camera whose image colours the points of a depth camera. */
function colourOf(depth: string, streams: Stream[]): string | undefined {
  const folder = depth.replace(/\/depth\/.*$/, "");
  const of = (stream: Stream) => stream.kind === "image" && stream.topic.startsWith(`${folder}/rgb/`);
  return streams.find(of)?.topic;
}

export class Layers {
  private readonly layers = new Map<string, End>();
  private readonly topics = new Map<string, Set<(frame: Frame) => void>>();
  readonly tallies = new Map<string, Tally>();
  streams: Stream[] = [];
  /** Called after an image was drawn. */
  onPicture: () => void = () => undefined;

  constructor(
    private readonly connection: Connection,
    private readonly space: Space,
    private readonly pictures: HTMLElement,
  ) {}

  /** Returns the ways in which these streams can be shown. */
  choices(): Choice[] {
    let pictures = 0;
    return this.streams.flatMap(({ topic, kind }) => {
      const choice = (isDefault: boolean, isSpatial = false) => ({
        key: isSpatial ? `${topic}${SPATIAL}` : topic,
        topic,
        isDefault,
        isSpatial,
      });
      const isTruth = topic.includes("/truth/");
      switch (kind) {
        case "image":
          return [choice(!isTruth && pictures++ < 2)];
        case "depth_image":
          return [choice(false), choice(!isTruth && pictures++ < 2, true)];
        case "laser_scan":
          return [choice(!isTruth)];
        case "point_cloud":
          // The cloud of a depth camera has the same points as its depths, in more bytes.
          return [choice(!topic.includes("depth"))];
        default:
          return [];
      }
    });
  }

  isShown(key: string): boolean {
    return this.layers.has(key);
  }

  /** Shows or hides a stream. */
  toggle({ key, topic, isSpatial }: Choice, shown: boolean) {
    if (shown === this.isShown(key)) return;
    if (!shown) {
      this.layers.get(key)?.();
      this.layers.delete(key);
      return;
    }
    const kind = this.streams.find((stream) => stream.topic === topic)?.kind ?? "";
    const end = isSpatial ? this.depthCloud(topic) : this.layerOf(topic, kind);
    this.layers.set(key, end);
  }

  private layerOf(topic: string, kind: string): End {
    if (kind === "image" || kind === "depth_image") {
      const [picture, frustum] = [new Picture(topic), new Frustum()];
      this.pictures.append(picture.element);
      this.space.add(frustum.object);
      const end = this.follow(topic, (frame) => {
        picture.show(frame);
        this.onPicture();
        frustum.show(frame);
        this.space.touch();
      });
      return () => {
        end();
        picture.element.remove();
        this.space.remove(frustum.object);
        frustum.dispose();
      };
    }
    const points = new Points(topic, kind === "laser_scan" ? 4 : 2);
    this.space.add(points.object);
    const end = this.follow(topic, (frame) => {
      if (frame.header.kind === "laser_scan") points.showScan(frame);
      else points.showCloud(frame);
      this.space.touch();
    });
    return () => {
      end();
      this.space.remove(points.object);
      points.dispose();
    };
  }

  private depthCloud(topic: string): End {
    const cloud = IS_SOFTWARE ? new SplattedCloud() : new DepthCloud();
    this.space.add(cloud.object);
    const ends = [
      this.follow(topic, (frame) => {
        cloud.show(frame);
        this.space.touch();
      }),
    ];
    const colours = colourOf(topic, this.streams);
    if (colours !== undefined) {
      ends.push(
        this.follow(colours, (frame) => {
          cloud.colour(frame);
        }),
      );
    }
    return () => {
      for (const end of ends) end();
      this.space.remove(cloud.object);
      cloud.dispose();
    };
  }

  isFollowed(topic: string): boolean {
    return this.topics.has(topic);
  }

  /** Adds a consumer of the frames of a topic. Returns a function that removes it. */
  follow(topic: string, handler: (frame: Frame) => void): () => void {
    const handlers = this.topics.get(topic) ?? new Set();
    handlers.add(handler);
    this.topics.set(topic, handlers);
    this.connection.follow(topic, (frame) => {
      for (const known of handlers) known(frame);
      this.count(frame);
    });
    return () => {
      handlers.delete(handler);
      if (handlers.size === 0) {
        this.topics.delete(topic);
        this.connection.stop(topic);
      }
    };
  }

  private readonly counted = new Map<string, { since: number; frames: number }>();

  private count({ header }: Frame) {
    const tally = this.tallies.get(header.topic) ?? { frames: 0, stamp: 0, rate: 0, latency: 0, place: null };
    tally.frames += 1;
    tally.stamp = header.stamp;
    tally.latency = performance.timeOrigin + performance.now() - header.sentMs;
    tally.place = OF_SENSORS.includes(header.kind) ? header.position : null;
    this.tallies.set(header.topic, tally);
  }

  /** Updates the rates with the frames since the last call. */
  takeRates() {
    const now = performance.now();
    for (const [topic, tally] of this.tallies) {
      const before = this.counted.get(topic) ?? { since: now, frames: tally.frames };
      const seconds = (now - before.since) / 1000;
      tally.rate = seconds > 0 ? (tally.frames - before.frames) / seconds : 0;
      this.counted.set(topic, { since: now, frames: tally.frames });
    }
  }
}
