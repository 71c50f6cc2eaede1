// Settings of sensors that can be changed at run time: bridge/WIRE.md, SensorSettings.

import type { Frame } from "./frame";

export interface Setting {
  name: string;
  value: number;
  min: number;
  max: number;
}

export interface Sensor {
  name: string;
  topics: string[];
  settings: Setting[];
}

const text = new TextDecoder();
const OFFSETS = { update_rate: 1600, noise_mean: 1624, noise_stddev: 1648, exposure: 1672 };
const UNITS: Record<string, string> = { update_rate: "Hz" };

/** Returns the sensors of `simulation/sensor_settings`, each with its settings. */
export function sensors({ header, payload }: Frame): Sensor[] {
  return Array.from({ length: header.height }, (_, index) => {
    const at = index * header.rowStride;
    const word = (offset: number, length: number) => {
      const bytes = new Uint8Array(payload.buffer, payload.byteOffset + at + offset, length);
      const end = bytes.indexOf(0);
      return text.decode(bytes.subarray(0, end < 0 ? length : end));
    };
    const number = (offset: number) => payload.getFloat64(at + offset, true);
    const settings = Object.entries(OFFSETS).map(([name, offset]) => ({
      name,
      value: number(offset),
      min: number(offset + 8),
      max: number(offset + 16),
    }));
    return {
      name: word(0, 64),
      topics: Array.from({ length: 6 }, (_, place) => word(64 + 256 * place, 256)).filter((topic) => topic !== ""),
      settings: settings.filter(({ value }) => !Number.isNaN(value)),
    };
  });
}

/** A panel with the settings of a sensor. It reports changes as `name=value`. */
export function settingsPanel(sensor: Sensor, change: (words: string) => void): HTMLElement {
  const panel = document.createElement("div");
  panel.className = "settings";
  panel.append(sensor.name);
  for (const { name, value, min, max } of sensor.settings) {
    const [label, input] = [document.createElement("label"), document.createElement("input")];
    input.type = "number";
    input.step = "any";
    input.value = String(Number(value.toPrecision(6)));
    input.title = `${min} to ${max} ${UNITS[name] ?? ""}`;
    input.dataset.setting = name;
    input.addEventListener("change", () => {
      change(`${name}=${input.value}`);
    });
    label.append(`${name.replace("_", " ")} `, input);
    panel.append(label);
  }
  return panel;
}
