// The page in Chromium against a live simulator: belvedere's program, then the folder for screenshots.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";
import { end, killAll, sleep, start, until } from "./simulator.js";

const pictures = process.argv[3];
const KINECT = ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "still"];
const PICTURE = "camera/rgb/image_raw";

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});
let problems = [];

async function open(url, size = { width: 1280, height: 720 }) {
  const page = await browser.newPage({ viewport: size });
  page.on("console", (message) => {
    if (message.type() === "error") problems.push(message.text());
  });
  page.on("pageerror", (error) => problems.push(String(error)));
  await page.goto(url);
  return page;
}

const viewer = (page) => page.evaluate(() => window.viewer());
/** The pixels of a camera's panel, as a sum that another picture has not. */
const pixels = (page, topic) =>
  page.evaluate((topic) => {
    const canvas = document.querySelector(`figure[data-topic="${topic}"] canvas`);
    if (canvas === null || canvas.width === 0) return 0;
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.reduce((sum, value, index) => (Math.imul(sum, 31) + value * ((index % 7) + 1)) | 0, 7);
  }, topic);

try {
  const domain = `viewer-${process.pid}`;
  let simulator = await start(domain, 0, KINECT);
  const port = new URL(simulator.url).port;
  const page = await open(simulator.url);

  const first = await until("a picture", async () => (await viewer(page)).firstPictureMs);
  console.log(`first picture ${first.toFixed(0)} ms after the page began to load`);

  await until("the robot", async () => (await viewer(page)).robot);
  await until("running", async () => (await viewer(page)).state === "running");
  await page.click("#pause");
  await until("paused", async () => (await viewer(page)).state === "paused");
  await sleep(500);
  const stood = [(await viewer(page)).stamp, await pixels(page, PICTURE)];
  await sleep(700);
  assert.deepEqual([(await viewer(page)).stamp, await pixels(page, PICTURE)], stood);
  await page.click("#step");
  await until("a step", async () => (await viewer(page)).stamp > stood[0]);
  await sleep(1500);
  const stepped = (await viewer(page)).stamp;
  assert.ok(stepped <= stood[0] + 10 * 10_000_000, `${stood[0]} and then ${stepped}`);
  await until("paused", async () => (await viewer(page)).state === "paused");
  await page.click("#pause");
  await until("running", async () => (await viewer(page)).stamp > stepped);
  console.log("pause stops it, a step is ten steps of physics");

  const [before, seen] = [(await viewer(page)).robot, await pixels(page, PICTURE)];
  await page.keyboard.down("ArrowUp");
  await until("driven", async () => {
    const now = (await viewer(page)).robot;
    return Math.hypot(now[0] - before[0], now[1] - before[1]) > 0.2;
  });
  await page.keyboard.up("ArrowUp");
  assert.notEqual(await pixels(page, PICTURE), seen);
  console.log("keys drive it, and its picture moves");

  await page.click(`li:has([data-key="${PICTURE}"]) .gear`);
  const setting = page.locator('[data-setting="update_rate"]');
  await setting.fill("5");
  await setting.press("Enter");
  await until("another rate", async () => (await setting.inputValue()) === "5");
  await until("that the simulator takes it", () =>
    page.evaluate(() => window.viewer().settings.some((sensor) => sensor.settings.some(({ name, value }) => name === "update_rate" && value === 5))),
  );
  console.log("a sensor's rate is changed");

  // A click on the camera, where it is in 3D, shows what of it can be changed; one beside it does not.
  await page.click(`li:has([data-key="${PICTURE}"]) .gear`);
  assert.equal((await viewer(page)).shownSensor, null);
  await page.click("#pause");
  await until("paused", async () => (await viewer(page)).state === "paused");
  await page.evaluate(() => window.space.look([-0.9, -0.6, 0.5]));
  const clickAt = async (place) => {
    const [x, y] = await page.evaluate((point) => window.space.pixelOf(point), place);
    await page.mouse.click(x, y);
  };
  const camera = (await viewer(page)).sensors[PICTURE];
  await clickAt([camera[0] + 1, camera[1], camera[2]]);
  assert.equal((await viewer(page)).shownSensor, null);
  await clickAt(camera);
  await until("the camera's settings", async () => (await viewer(page)).shownSensor?.startsWith("camera/"));
  assert.ok(await page.locator('[data-setting="update_rate"]').isVisible());
  await page.click("#pause");
  await until("running", async () => (await viewer(page)).state === "running");
  console.log("a click on a sensor in 3D shows its settings");

  await page.check("#plotted");
  await page.keyboard.down("ArrowUp");
  const plots = await until("curves of all plots", async () => {
    const { rates, latencies, velocities } = (await viewer(page)).plots;
    const forwards = Object.entries(velocities).find(([name]) => name.endsWith("forwards"))?.[1] ?? 0;
    return forwards > 0.2 && latencies[`/${PICTURE}`] > 0 && { rates, latencies };
  });
  await page.keyboard.up("ArrowUp");
  // Its rate was set to 5.
  const [rate, latency] = [plots.rates[`/${PICTURE}`], plots.latencies[`/${PICTURE}`]];
  assert.ok(rate > 1 && rate < 8 && latency < 3000, `${rate} Hz, ${latency} ms`);
  const drawn = await page.evaluate(() =>
    [...document.querySelectorAll("#plots canvas")].map((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return new Set(new Uint32Array(data.buffer)).size;
    }),
  );
  assert.ok(drawn.length === 3 && drawn.every((colours) => colours > 3), `${drawn} colours`);
  await page.uncheck("#plotted");
  console.log(`plots: ${rate.toFixed(1)} pictures a second, ${latency.toFixed(0)} ms from sent to shown`);

  // The cube is dragged by its upper face, seen from above.
  await page.evaluate(() => window.space.look([-0.02, 0, 4.2]));
  const cube = () => page.evaluate(() => window.space.linkPosition("cube::link"));
  const from = await cube();
  const [x, y] = await page.evaluate((point) => window.space.pixelOf(point), [from[0], from[1], 0.5]);
  await page.keyboard.down("Shift");
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 60, y, { steps: 5 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  await until("dragged", async () => {
    const now = await cube();
    return Math.hypot(now[0] - from[0], now[1] - from[1]) > 0.05;
  });
  console.log("a model is moved by the mouse");

  await page.click("#reset");
  await until("reset", async () => (await viewer(page)).stamp < stood[0]);

  await end(simulator, "SIGKILL");
  await until("gone", async () => (await viewer(page)).state === "gone");
  // A browser says that nobody listens, as it should.
  problems = problems.filter((text) => !text.includes("ERR_CONNECTION_REFUSED"));
  simulator = await start(domain, port, KINECT);
  const frames = (await viewer(page)).frames[PICTURE];
  await until("pictures again", async () => (await viewer(page)).frames[PICTURE] > frames + 3);
  problems = problems.filter((text) => !text.includes("ERR_CONNECTION_REFUSED"));
  console.log("it goes on after the simulator was killed and started again");
  if (pictures !== undefined) {
    await page.evaluate(() => window.space.look([-1.6, -1.9, 1.7]));
    await sleep(1500);
    await page.screenshot({ path: `${pictures}/viewer.png` });
  }
  await page.close();
  await end(simulator);

  // The robot stands in its scan: seen from above, the scan's points lie on the walls and things of the world.
  simulator = await start(domain, 0, ["--robot", "kobuki_nostack_rplidar", "--world", "playground", "--drive", "still"]);
  const plan = await open(simulator.url);
  const found = await until("a scan", () =>
    plan.evaluate(() => {
      const distances = window.space.scanDistances("scan");
      return distances.length > 50 ? distances : null;
    }),
  );
  found.sort((one, other) => one - other);
  const median = found[found.length >> 1];
  console.log(`${found.length} points of the scan, median ${(median * 1000).toFixed(1)} mm from a surface`);
  assert.ok(median < 0.03, `points are ${median} m from what they hit`);
  await plan.close();
  await end(simulator);
  assert.deepEqual(problems, []);
  console.log("no console error");
} finally {
  killAll();
  await browser.close();
}
