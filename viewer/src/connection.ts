// The WebSocket to the server. It reconnects after it was lost, and requests each frame.

import { parseFrame, type Frame } from "./frame";
import { messages } from "./messages";
import type { Playhead } from "./timeline";

export interface Stream {
  topic: string;
  kind: string | null;
  encoding: string | null;
  frameId: string;
  rateHz: number | null;
  layers: number | null;
  publishers: number;
}

interface Told extends Partial<Playhead> {
  op: "streams" | "scene" | "result" | "status" | "timeline" | "page";
  name?: string;
  streams?: Stream[];
  edition?: number;
  id?: number;
  done?: boolean;
  reason?: string;
  text?: string;
}

export interface Handlers {
  onOpen: () => void;
  onClose: () => void;
  onStreams: (streams: Stream[]) => void;
  onScene: (edition: number) => void;
  onTimeline: (playhead: Playhead) => void;
  onMessage: (text: string) => void;
}

const RETRY_MS = 500;
/** The largest number of requested frames of a stream: one is transferred while another is drawn. */
const AHEAD = 2;

export class Connection {
  private socket: WebSocket | undefined;
  private readonly followed = new Map<string, (frame: Frame) => void>();
  private readonly awaited = new Map<number, (reason: string | null) => void>();
  private nextId = 1;

  constructor(
    private readonly url: string,
    /** Returns the URL from which frames are fetched, by the id of the page. */
    private readonly framesUrl: (page: string) => string,
    private readonly handlers: Handlers,
  ) {
    this.open();
    document.addEventListener("visibilitychange", () => {
      // A hidden page requests nothing, so that nothing is rendered for it.
      if (!document.hidden) this.askForAll();
    });
  }

  private open() {
    const socket = new WebSocket(this.url);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.handlers.onOpen();
      this.askForAll();
    };
    socket.onclose = () => {
      for (const answer of this.awaited.values()) answer("the connection was lost");
      this.awaited.clear();
      this.handlers.onClose();
      setTimeout(() => {
        this.open();
      }, RETRY_MS);
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
      if (typeof event.data === "string") this.hear(JSON.parse(event.data) as Told);
      else this.take(parseFrame(event.data));
    };
  }

  private hear(told: Told) {
    switch (told.op) {
      case "page":
        void this.receive(told.name ?? "");
        break;
      case "streams":
        this.handlers.onStreams(told.streams ?? []);
        break;
      case "scene":
        this.handlers.onScene(told.edition ?? 0);
        break;
      case "timeline":
        this.handlers.onTimeline({ duration: 0, position: 0, rate: 1, paused: false, ...told });
        break;
      case "result":
        this.awaited.get(told.id ?? 0)?.(told.done === true ? null : (told.reason ?? "refused"));
        this.awaited.delete(told.id ?? 0);
        break;
      case "status":
        this.handlers.onMessage(told.text ?? "");
        break;
    }
  }

  /** Receives frames by an HTTP response, which is much faster than the WebSocket, the fallback. */
  private async receive(page: string) {
    const socket = this.socket;
    const answer = await fetch(this.framesUrl(page)).catch(() => null);
    if (answer === null || !answer.ok || answer.body === null) return;
    for await (const message of messages(answer.body)) this.take(parseFrame(message));
    // Frames that were in transfer are lost.
    if (this.socket === socket) this.askForAll();
  }

  private take(frame: Frame) {
    const topic = frame.header.topic;
    const handler = this.followed.get(topic);
    if (handler === undefined) return;
    // Requested before this frame is shown.
    this.ask(topic, 1);
    handler(frame);
  }

  private ask(topic: string, frames: number) {
    if (!document.hidden) this.say({ op: "next", topic, frames });
  }

  private askForAll() {
    for (const topic of this.followed.keys()) this.ask(topic, AHEAD);
  }

  private say(message: object) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Subscribes to the frames of a topic, as many as there is time for. */
  follow(topic: string, handler: (frame: Frame) => void) {
    const isNew = !this.followed.has(topic);
    this.followed.set(topic, handler);
    if (isNew) this.ask(topic, AHEAD);
  }

  stop(topic: string) {
    if (this.followed.delete(topic)) this.say({ op: "stop", topic });
  }

  /** Sends a command to the simulator; rejects with the reason if it was refused. */
  control(operation: string, more: object = {}): Promise<string | null> {
    const id = this.nextId++;
    return new Promise((resolve) => {
      if (this.socket?.readyState !== WebSocket.OPEN) {
        resolve("there is no connection");
        return;
      }
      this.awaited.set(id, resolve);
      this.say({ op: "control", id, operation, ...more });
    });
  }

  /** Continues at a position in the recording, in seconds. */
  seek(position: number) {
    this.say({ op: "seek", position });
  }

  /** Sets the number of recorded seconds that are played per second. */
  setRate(rate: number) {
    this.say({ op: "rate", rate });
  }

  drive(topic: string, forward: number, turn: number) {
    this.say({ op: "drive", topic, linear: [forward, 0, 0], angular: [0, 0, turn] });
  }
}
