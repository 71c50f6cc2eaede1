// Curves of the last seconds: rates, latencies, velocities.

import { shortened } from "./name";

/** The time span that is shown, and the interval at which it is drawn. */
const SPAN_MS = 20000;
const PERIOD_MS = 200;
/** The colours of the curves of a plot. */
const COLOURS = ["#ffb454", "#5aa9ff", "#7fd38a", "#ff7b72", "#c792ea", "#4dd0c4", "#e6db74", "#f78fb3"];

interface Curve {
  colour: string;
  /** Times in ms, as from `performance.now()`, and values. */
  points: [number, number][];
}

/** Returns the smallest number of 1, 2, 5, 10, 20 … that is not smaller than a value. */
export function roundUp(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  const share = value / power;
  return power * (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10);
}

/** Removes values that are too old. */
function trim({ points }: Curve, now: number) {
  const kept = points.findIndex(([time]) => time > now - SPAN_MS);
  points.splice(0, kept < 0 ? points.length : kept);
}

class Plot {
  readonly element = document.createElement("figure");
  private readonly canvas = document.createElement("canvas");
  private readonly legend = document.createElement("ul");
  private readonly curves = new Map<string, Curve>();

  constructor(
    title: string,
    unit: string,
  ) {
    const caption = document.createElement("figcaption");
    caption.textContent = `${title}, ${unit}`;
    this.element.append(caption, this.canvas, this.legend);
  }

  /** Adds a value, and removes values that are too old, even while the plot is hidden. */
  add(name: string, value: number) {
    const now = performance.now();
    const curve = this.curves.get(name) ?? { colour: COLOURS[this.curves.size % COLOURS.length] ?? "", points: [] };
    curve.points.push([now, value]);
    trim(curve, now);
    this.curves.set(name, curve);
  }

  /** Returns the last value of each curve. */
  values(): Record<string, number> {
    return Object.fromEntries([...this.curves].map(([name, { points }]) => [name, points.at(-1)?.[1] ?? NaN]));
  }

  /** Returns the number of stored values. */
  get size(): number {
    return [...this.curves.values()].reduce((sum, { points }) => sum + points.length, 0);
  }

  draw(now: number) {
    for (const [name, curve] of this.curves) {
      trim(curve, now);
      if (curve.points.length === 0) this.curves.delete(name);
    }
    const curves = [...this.curves.values()];
    const values = curves.flatMap(({ points }) => points.map(([, value]) => value));
    const [most, least] = [Math.max(0, ...values), Math.min(0, ...values)];
    const [top, bottom] = [most > 0 ? roundUp(most) : least < 0 ? 0 : 1, least < 0 ? -roundUp(-least) : 0];
    const ratio = window.devicePixelRatio;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    [this.canvas.width, this.canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const context = this.canvas.getContext("2d");
    if (context === null) return;
    context.scale(ratio, ratio);
    const x = (time: number) => width * (1 - (now - time) / SPAN_MS);
    const y = (value: number) => 2 + (height - 4) * ((top - value) / (top - bottom));
    context.strokeStyle = "#2a3340";
    context.fillStyle = "#8b98a8";
    context.font = "10px system-ui, sans-serif";
    for (const [value, baseline] of [[top, "top"], [0, "bottom"], [bottom, "bottom"]] as const) {
      context.beginPath();
      context.moveTo(0, y(value));
      context.lineTo(width, y(value));
      context.stroke();
      context.textBaseline = baseline;
      context.fillText(String(value), 2, y(value));
    }
    for (const { colour, points } of curves) {
      context.strokeStyle = colour;
      context.beginPath();
      for (const [time, value] of points) context.lineTo(x(time), y(value));
      context.stroke();
    }
    this.legend.replaceChildren(
      ...[...this.curves].map(([name, { colour, points }]) => {
        const item = document.createElement("li");
        item.style.color = colour;
        item.append(shortened(name), `\u00a0 ${(points.at(-1)?.[1] ?? NaN).toFixed(2)}`);
        return item;
      }),
    );
  }
}

/** The plots. They are drawn only while they are shown. */
export class Plots {
  readonly rates = new Plot("frames a second", "Hz");
  readonly latencies = new Plot("from sent to shown", "ms");
  readonly velocities = new Plot("velocity by odometry", "m/s, rad/s");

  constructor(private readonly place: HTMLElement) {
    place.append(this.rates.element, this.latencies.element, this.velocities.element);
    setInterval(() => {
      if (this.isShown && !document.hidden) this.draw();
    }, PERIOD_MS);
  }

  get isShown(): boolean {
    return !this.place.hidden;
  }

  show(shown: boolean) {
    this.place.hidden = !shown;
    if (shown) this.draw();
  }

  private draw() {
    for (const plot of [this.rates, this.latencies, this.velocities]) plot.draw(performance.now());
  }

  values() {
    return {
      rates: this.rates.values(),
      latencies: this.latencies.values(),
      velocities: this.velocities.values(),
      size: this.rates.size + this.latencies.size + this.velocities.size,
    };
  }
}
