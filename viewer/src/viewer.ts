// The page: puts its parts together.

import { Connection, type Stream } from "./connection";
import { dragModels } from "./drag";
import { linkStates, velocity, type LinkState } from "./frame";
import { useKeys } from "./keys";
import { Layers, type Choice } from "./layers";
import { parts, shortened } from "./name";
import { Plots } from "./plots";
import { onClick, sensorAt } from "./sensor_pick";
import { sensors, settingsPanel, type Sensor } from "./settings";
import { Space } from "./space";
import { Timeline } from "./timeline";

const LINK_STATES = "simulation/link_states";
const MODEL_STATES = "simulation/model_states";
const SENSOR_SETTINGS = "simulation/sensor_settings";
/** Longest wait for a frame that is requested once. */
const PATIENCE_MS = 10000;
/** The 3D view starts after this time at the latest, so that the first image is not delayed. */
const HEAD_START_MS = 600;

function element<T extends HTMLElement>(id: string): T {
  return document.getElementById(id) as T;
}

const token = new URLSearchParams(location.search).get("token") ?? "";
const space = new Space(element("space"));
const [state, time, message] = [element("state"), element("time"), element("message")];
const [pause, driven] = [element<HTMLButtonElement>("pause"), element<HTMLSelectElement>("driven")];
const cut = element<HTMLInputElement>("cut");

let stamp = 0;
/** Number of states with the same timestamp; they are repeated while time is paused. */
let repeated = 0;
let isConnected = false;
let scene = 0;
let isCut = false;
let firstPictureMs: number | null = null;

function complain(text: string | null) {
  message.textContent = text ?? "";
}

const query = `token=${encodeURIComponent(token)}`;
const socket = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/?${query}`;
const connection = new Connection(socket, (page) => `/frames?${query}&page=${page}`, {
  onOpen: () => {
    isConnected = true;
    complain(null);
  },
  onClose: () => {
    isConnected = false;
  },
  onStreams: (streams) => {
    layers.streams = streams;
    showStreams(streams);
  },
  onScene: (edition) => {
    if (edition > 0) void loadScene(edition);
  },
  onTimeline: (playhead) => {
    document.body.classList.add("recorded");
    timeline.show(playhead);
    // Both buttons have the same label, and a click on either does what it says.
    showState();
  },
  onMessage: complain,
});
const timeline = new Timeline(element("timeline"), {
  seek: (position) => {
    connection.seek(position);
  },
  setRate: (rate) => {
    connection.setRate(rate);
  },
  togglePause,
});
const layers = new Layers(connection, space, element("pictures"));
const plots = new Plots(element("plots"));
/** Ends the subscription to odometry for its plot. */
let plotted: (() => void)[] = [];

async function loadScene(edition: number) {
  scene = edition;
  const answer = await fetch(`/scene.glb?${query}`);
  if (!answer.ok) {
    complain(`the models cannot be loaded: ${answer.statusText}`);
    return;
  }
  // An older answer may come after a newer one.
  const isNewest = () => scene === edition;
  await space.load(await answer.arrayBuffer(), isNewest);
  if (!isNewest()) return;
  // Rooms have ceilings, which would hide the room from above.
  cut.max = String(Math.max(1, Math.ceil(space.height)));
  // The user's choice stays when models are added or removed.
  if (isCut) return;
  isCut = true;
  setCut(space.height > 1.5 && space.height < 10 ? space.height * 0.75 : Number(cut.max));
}

function setCut(height: number) {
  cut.value = String(height);
  element("cutAt").textContent = `${height.toFixed(1)} m`;
  space.cut(height);
}

/** Stored choices, by key. */
function chosen(): Record<string, boolean> {
  try {
    return JSON.parse(localStorage.getItem("shown") ?? "{}") as Record<string, boolean>;
  } catch {
    return {};
  }
}

function showStreams(streams: Stream[]) {
  const before = chosen();
  const groups = new Map<string, HTMLElement[]>();
  for (const choice of layers.choices()) {
    layers.toggle(choice, before[choice.key] ?? choice.isDefault);
    const [folder] = parts(choice.topic);
    groups.set(folder, [...(groups.get(folder) ?? []), row(choice)]);
  }
  // Topics without a folder have no heading.
  const rows = [...groups].map(([folder, items]) => (folder === "" ? items : [heading(folder), ...items]));
  element("streams").replaceChildren(...rows.flat());
  plotOdometry();
  const robots = streams.filter((stream) => stream.kind === "velocity_command");
  const was = driven.value;
  driven.replaceChildren(...robots.map(({ topic }) => new Option(`/${topic}`, topic, false, topic === was)));
}

/** Subscribes to odometry while its plot is shown. */
function plotOdometry() {
  for (const end of plotted) end();
  const isShown = plots.isShown;
  const topics = layers.streams.filter(({ kind }) => isShown && kind === "odometry").map(({ topic }) => topic);
  plotted = topics.map((topic) =>
    layers.follow(topic, (frame) => {
      const [forwards, turn] = velocity(frame);
      plots.velocities.add(`/${topic} forwards`, forwards);
      plots.velocities.add(`/${topic} turn`, turn);
    }),
  );
}

element<HTMLInputElement>("plotted").addEventListener("change", (event) => {
  plots.show((event.target as HTMLInputElement).checked);
  plotOdometry();
});

/** Returns the common prefix of a sensor's topics. */
function heading(folder: string): HTMLElement {
  const item = document.createElement("li");
  item.className = "folder";
  item.append(shortened(`/${folder}`));
  return item;
}

function row(choice: Choice): HTMLElement {
  const [item, label, box, rate] = [
    document.createElement("li"),
    document.createElement("label"),
    document.createElement("input"),
    document.createElement("span"),
  ];
  box.type = "checkbox";
  box.checked = layers.isShown(choice.key);
  box.dataset.key = choice.key;
  box.addEventListener("change", () => {
    layers.toggle(choice, box.checked);
    localStorage.setItem("shown", JSON.stringify({ ...chosen(), [choice.key]: box.checked }));
  });
  const [folder, last] = parts(choice.topic);
  label.append(box, folder === "" ? `/${last}` : last);
  label.title = `/${choice.topic}`;
  if (choice.isSpatial) {
    const mark = document.createElement("span");
    mark.className = "spatial";
    mark.textContent = "3D";
    mark.title = "as points in 3D";
    label.append(mark);
  }
  label.addEventListener("dblclick", (event) => {
    event.preventDefault();
    showSettings(choice.topic);
  });
  const gear = document.createElement("button");
  gear.className = "gear";
  gear.textContent = "⚙";
  gear.title = "what can be changed of this sensor";
  gear.addEventListener("click", () => {
    showSettings(choice.topic);
  });
  rate.className = "rate";
  rate.dataset.topic = choice.topic;
  item.append(label, rate, gear);
  return item;
}

let known: Sensor[] = [];
let shownSensor: string | null = null;

/** Shows the settings of the sensor that publishes a topic, or hides them. */
function showSettings(topic: string | null) {
  shownSensor = topic === shownSensor ? null : topic;
  refreshSettings();
}

function refreshSettings() {
  const place = element("settings");
  const sensor = known.find(({ topics }) => shownSensor !== null && topics.includes(shownSensor));
  if (sensor === undefined) {
    place.replaceChildren(shownSensor === null ? "" : `nothing of /${shownSensor} can be changed`);
    return;
  }
  place.replaceChildren(
    settingsPanel(sensor, (text) => void control("configure", { name: shownSensor ?? "", text }).then(refreshSettings)),
  );
}

layers.follow(SENSOR_SETTINGS, (frame) => {
  known = sensors(frame);
  refreshSettings();
});

/** Returns the poses of the sensors whose frames are shown. */
function sensorPlaces(): Map<string, [number, number, number]> {
  return new Map(
    [...layers.tallies].flatMap(([topic, { place }]) => (place !== null && layers.isFollowed(topic) ? [[topic, place]] : [])),
  );
}

onClick(space.canvas, (at) => {
  const topic = sensorAt(space, at, sensorPlaces());
  if (topic !== null && topic !== shownSensor) showSettings(topic);
});

dragModels(space.canvas, {
  placeOf: (at) => space.placeOf(at),
  pick: (at) => space.pick(at),
  ray: (at) => space.ray(at),
  poseOf: (model) =>
    new Promise<LinkState | null>((resolve) => {
      const timer = setTimeout(() => {
        finish(null);
      }, PATIENCE_MS);
      const end = layers.follow(MODEL_STATES, (frame) => {
        finish(linkStates(frame).find(({ name }) => name === model) ?? null);
      });
      function finish(state: LinkState | null) {
        clearTimeout(timer);
        end();
        resolve(state);
      }
    }),
  move: (name, position, orientation) => control("set_model_state", { name, position, orientation }),
});

layers.follow(LINK_STATES, (frame) => {
  repeated = frame.header.stamp === stamp ? repeated + 1 : 0;
  stamp = frame.header.stamp;
  space.move(linkStates(frame));
});

function stands(): boolean {
  return timeline.playhead?.paused ?? repeated > 1;
}

async function control(operation: string, more: object = {}) {
  complain(await connection.control(operation, more));
}

function togglePause() {
  // Does what the button says, even if time was just paused or resumed by other means.
  void control(state.dataset.is === "paused" ? "resume" : "pause");
}

pause.addEventListener("click", togglePause);
element("step").addEventListener("click", () => void control("step", { steps: 10 }));
element("reset").addEventListener("click", () => void control("reset_simulation"));
element<HTMLInputElement>("follow").addEventListener("change", (event) => {
  space.followsRobot = (event.target as HTMLInputElement).checked;
});
element<HTMLInputElement>("frames").addEventListener("change", (event) => {
  space.showAxes((event.target as HTMLInputElement).checked);
});
cut.addEventListener("input", () => {
  setCut(Number(cut.value));
});
const views: Record<string, () => void> = {
  KeyH: () => {
    space.home();
  },
  KeyT: () => {
    space.top();
  },
};
element("home").addEventListener("click", () => views.KeyH?.());
element("top").addEventListener("click", () => views.KeyT?.());
useKeys(
  (forward, turn) => {
    if (driven.value !== "") connection.drive(driven.value, forward, turn);
  },
  togglePause,
  views,
);

function showState() {
  const [is, text] = !isConnected
    ? ["gone", "no server; trying again …"]
    : layers.streams.length === 0
      ? ["gone", "waiting for a simulator …"]
      : stands()
        ? ["paused", "paused"]
        : ["running", "running"];
  state.dataset.is = is;
  state.textContent = text;
  time.textContent = `${(stamp / 1e9).toFixed(2)} s`;
  pause.textContent = is === "paused" ? "resume" : "pause";
}

setInterval(showState, 100);
layers.onPicture = () => {
  firstPictureMs ??= performance.now();
  space.start();
};
setTimeout(() => {
  space.start();
}, HEAD_START_MS);
setInterval(() => {
  layers.takeRates();
  for (const [topic, { rate, latency }] of layers.tallies) {
    if (rate === 0) continue;
    plots.rates.add(`/${topic}`, rate);
    plots.latencies.add(`/${topic}`, latency);
  }
  for (const rate of document.querySelectorAll<HTMLElement>(".rate")) {
    const tally = layers.tallies.get(rate.dataset.topic ?? "");
    rate.textContent = tally && tally.rate > 0 ? tally.rate.toFixed(1) : "";
  }
}, 1000);

declare global {
  interface Window {
    /** The current state, for the console and for tests. */
    viewer: () => object;
    space: Space;
  }
}

window.space = space;
window.viewer = () => ({
  state: state.dataset.is,
  stamp,
  scene,
  timeline: timeline.playhead,
  firstPictureMs,
  robot: space.robotPosition(),
  eye: space.eye,
  settings: known,
  shownSensor,
  sensors: Object.fromEntries(sensorPlaces()),
  plots: plots.values(),
  frames: Object.fromEntries([...layers.tallies].map(([topic, tally]) => [topic, tally.frames])),
});
