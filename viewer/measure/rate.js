// Measures the frame rate of a 640 × 480 image and its depths, and the server's processor time: for a client that only
// receives frames, and for the page in Chromium.
import { readdirSync, readFileSync } from "node:fs";
import { chromium } from "playwright-core";
import { WebSocket } from "ws";
import { end, killAll, sleep, start, until } from "../test/simulator.js";

const TOPICS = ["camera/rgb/image_raw", "camera/depth/image_raw"];
const SECONDS = 10;
const TICK = 0.01;

/** Returns the processor time of the server's threads in seconds. */
function taken(pid) {
  return readdirSync(`/proc/${pid}/task`)
    .map((thread) => readFileSync(`/proc/${pid}/task/${thread}/stat`, "utf8"))
    .filter((stat) => /\((view[^)]*)\)/.test(stat))
    .map((stat) => stat.slice(stat.lastIndexOf(")") + 2).split(" "))
    .reduce((sum, fields) => sum + (Number(fields[11]) + Number(fields[12])) * TICK, 0);
}

async function measure(pid, what, count, drawn = () => 0) {
  await sleep(2000);
  const [before, frames, first] = [taken(pid), await count(), await drawn()];
  await sleep(1000 * SECONDS);
  const [after, more, last] = [taken(pid), await count(), await drawn()];
  const rates = TOPICS.map((topic) => ((more[topic] - frames[topic]) / SECONDS).toFixed(1));
  const share = (100 * (after - before)) / SECONDS;
  const draws = last > 0 ? `, drawn in 3D ${((last - first) / SECONDS).toFixed(1)} times` : "";
  console.log(`${what}: ${rates.join(" and ")} frames per second${draws}; the server uses ${share.toFixed(1)} % of a core`);
}

try {
  const simulator = await start(`rate-${process.pid}`, 0, [
    "--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "spin",
  ]);
  const pid = simulator.child.pid;
  const client = new WebSocket(simulator.url.replace("http:", "ws:"));
  const counts = Object.fromEntries(TOPICS.map((topic) => [topic, 0]));
  // The Kinect of the TurtleBot's file has a lower rate.
  const rate = { op: "control", operation: "configure", name: TOPICS[0], text: "update_rate=30" };
  client.on("open", () => client.send(JSON.stringify(rate)));
  client.on("open", () => TOPICS.forEach((topic) => client.send(JSON.stringify({ op: "next", topic }))));
  client.on("message", (data, isBinary) => {
    if (!isBinary) return;
    const { topic } = JSON.parse(data.toString("utf8", 4, 4 + data.readUInt32LE(0)));
    counts[topic] += 1;
    client.send(JSON.stringify({ op: "next", topic }));
  });
  await measure(pid, "a client that only takes them", () => ({ ...counts }));
  client.close();

  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox"],
  });
  const page = await browser.newPage({ viewport: { width: 900, height: 400 } });
  await page.goto(simulator.url);
  const frames = async () => (await page.evaluate(() => window.viewer())).frames;
  await until("frames", async () => {
    const known = await frames();
    return TOPICS.every((topic) => known[topic] > 0);
  });
  const drawn = () => page.evaluate(() => window.space.drawn);
  await measure(pid, "the page in Chromium without a graphics card", frames, drawn);
  await browser.close();
  await end(simulator);
} finally {
  killAll();
}
