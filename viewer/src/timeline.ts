// The time line of a recording: its current and its requested position.

export interface Playhead {
  /** Seconds from the first message to the last. */
  duration: number;
  /** Seconds after the first message. */
  position: number;
  /** Recorded seconds per second. */
  rate: number;
  paused: boolean;
}

interface Wishes {
  seek: (position: number) => void;
  setRate: (rate: number) => void;
  togglePause: () => void;
}

const RATES = [0.1, 0.25, 0.5, 1, 2, 4, 10];
/** For this time after a drag, reports of the old position are ignored. */
const SETTLING_MS = 300;

function clock(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(1).padStart(4, "0")}`;
}

export class Timeline {
  private head: Playhead | undefined;
  private draggedAt = -Infinity;
  private readonly bar: HTMLInputElement;
  private readonly rate: HTMLSelectElement;
  private readonly play: HTMLButtonElement;
  private readonly text: HTMLElement;

  constructor(
    private readonly place: HTMLElement,
    wishes: Wishes,
  ) {
    const find = <T extends HTMLElement>(name: string) => place.querySelector<T>(`[data-is="${name}"]`) as T;
    [this.bar, this.rate, this.play, this.text] = [find("bar"), find("rate"), find("play"), find("text")];
    this.rate.append(...RATES.map((rate) => new Option(`${rate} ×`, String(rate), rate === 1, rate === 1)));
    this.bar.addEventListener("input", () => {
      this.draggedAt = performance.now();
      this.showPosition(Number(this.bar.value));
      wishes.seek(Number(this.bar.value));
    });
    this.rate.addEventListener("change", () => {
      wishes.setRate(Number(this.rate.value));
    });
    this.play.addEventListener("click", wishes.togglePause);
  }

  /** The state of the replay; undefined for a simulation. */
  get playhead(): Playhead | undefined {
    return this.head;
  }

  show(head: Playhead) {
    this.head = head;
    this.place.hidden = false;
    this.bar.max = String(head.duration);
    // The thumb stays under the pointer.
    if (performance.now() - this.draggedAt > SETTLING_MS) {
      this.bar.value = String(head.position);
      this.showPosition(head.position);
    }
    const rate = String(head.rate);
    // Another page may have set a rate that is not in the list.
    if (![...this.rate.options].some(({ value }) => value === rate)) this.rate.append(new Option(`${rate} ×`, rate));
    this.rate.value = rate;
    this.play.textContent = head.paused ? "▶" : "⏸";
    this.play.title = head.paused ? "play" : "pause";
  }

  private showPosition(position: number) {
    this.text.textContent = `${clock(position)} / ${clock(this.head?.duration ?? 0)}`;
  }
}
