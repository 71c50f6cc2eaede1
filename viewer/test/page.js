// Tests the page in Chromium with a live simulator. The argument is the program belvedere.
import assert from "node:assert/strict";
import { chromium } from "playwright-core";
import { end, killAll, sleep, start, until } from "./simulator.js";

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
/** Returns a checksum of the pixels of a camera's panel. */
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
  console.log(`the first image appears ${first.toFixed(0)} ms after the page began to load`);

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
  console.log("pause pauses, and a step is ten steps of physics");

  // Space pauses and resumes, regardless of what was clicked before.
  await page.click("#reset");
  await until("reset", async () => (await viewer(page)).stamp < stood[0]);
  const reset = (await viewer(page)).stamp;
  await page.keyboard.press("Space");
  await until("paused by space", async () => (await viewer(page)).state === "paused");
  assert.ok((await viewer(page)).stamp >= reset, "space has reset it again");
  assert.equal(await page.textContent("#state"), "paused");
  const standing = (await viewer(page)).stamp;
  await page.click("#step");
  await until("a step", async () => (await viewer(page)).stamp > standing);
  // While the timestamp changes, the page shows that time runs, and space would pause.
  await sleep(1000);
  await until("paused after the step", async () => (await viewer(page)).state === "paused");
  await page.check("#frames");
  await page.uncheck("#frames");
  await page.keyboard.press("Space");
  await until("running by space", async () => (await viewer(page)).state === "running");
  assert.equal(await page.isChecked("#frames"), false);
  console.log("space pauses and resumes after clicks on buttons");

  // The camera stays above the floor and near the world, and can return to the initial view.
  const home = (await viewer(page)).eye;
  const view = await page.locator("#space canvas").boundingBox();
  const middle = [view.x + view.width / 2, view.y + view.height / 2];
  await page.mouse.move(...middle);
  await page.mouse.down();
  await page.mouse.move(middle[0], view.y + 5, { steps: 5 });
  await page.mouse.up();
  await page.mouse.down({ button: "right" });
  await page.mouse.move(middle[0], view.y - 300, { steps: 5 });
  await page.mouse.up({ button: "right" });
  assert.ok((await viewer(page)).eye[2] > 0, `the camera is at ${(await viewer(page)).eye}`);
  for (let turn = 0; turn < 60; turn++) await page.mouse.wheel(0, 1000);
  await sleep(300);
  const away = Math.hypot(...(await viewer(page)).eye);
  assert.ok(away < 300, `the camera is ${away} m away`);
  await page.keyboard.press("t");
  const top = (await viewer(page)).eye;
  assert.ok(top[2] > 5 && Math.hypot(top[0] - home[0], top[1] - home[1]) < 4, `from above: ${top}`);
  await page.click("#home");
  const back = (await viewer(page)).eye;
  assert.ok(Math.hypot(...back.map((axis, index) => axis - home[index])) < 0.3, `${back} instead of ${home}`);
  console.log("the camera stays above the floor; home and top");

  // A depth image shows the scale of its colours and the type of its stream.
  const DEPTH = "camera/depth/image_raw";
  await page.check(`[data-key="${DEPTH}"]`);
  const panel = page.locator(`figure[data-topic="${DEPTH}"]`);
  await until("its encoding", async () => (await panel.innerText()).includes("32fc1"));
  assert.match(await panel.locator(".scale").innerText(), /^0\.\d+ m\s+\d+ m$/);
  await page.uncheck(`[data-key="${DEPTH}"]`);
  const named = await page.locator("#streams li").allInnerTexts();
  assert.equal(new Set(named.map((text) => text.replace(/[\d.]+$/, ""))).size >= 4, true, named.join(", "));
  assert.ok(named.some((text) => text.includes("3D")), named.join(", "));
  console.log("depths have a scale and the stream's own encoding");

  const [before, seen] = [(await viewer(page)).robot, await pixels(page, PICTURE)];
  await page.keyboard.down("ArrowUp");
  await until("driven", async () => {
    const now = (await viewer(page)).robot;
    return Math.hypot(now[0] - before[0], now[1] - before[1]) > 0.2;
  });
  await page.keyboard.up("ArrowUp");
  assert.notEqual(await pixels(page, PICTURE), seen);
  console.log("keys drive the robot, and the camera image changes");

  await page.click(`li:has([data-key="${PICTURE}"]) .gear`);
  const setting = page.locator('[data-setting="update_rate"]');
  await setting.fill("5");
  await setting.press("Enter");
  await until("another rate", async () => (await setting.inputValue()) === "5");
  await until("that the simulator takes it", () =>
    page.evaluate(() => window.viewer().settings.some((sensor) => sensor.settings.some(({ name, value }) => name === "update_rate" && value === 5))),
  );
  console.log("the rate of a sensor can be changed");

  // A click on the camera in 3D opens its settings; a click beside it does not.
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
  // The rate was set to 5 Hz. Of the frames that were held back while a click was handled, the curve first shows a higher
  // one.
  const [rate, latency] = await until("curves of all plots", async () => {
    const { rates, latencies, velocities } = (await viewer(page)).plots;
    const forwards = Object.entries(velocities).find(([name]) => name.endsWith("forwards"))?.[1] ?? 0;
    const [rate, latency] = [rates[`/${PICTURE}`] ?? 0, latencies[`/${PICTURE}`] ?? 0];
    return forwards > 0.2 && rate > 0 && rate < 8 && latency > 0 && [rate, latency];
  });
  await page.keyboard.up("ArrowUp");
  assert.ok(latency < 3000, `${latency} ms`);
  const drawn = await page.evaluate(() =>
    [...document.querySelectorAll("#plots canvas")].map((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return new Set(new Uint32Array(data.buffer)).size;
    }),
  );
  assert.ok(drawn.length === 3 && drawn.every((colours) => colours > 3), `${drawn} colours`);
  await page.uncheck("#plotted");
  console.log(`plots: ${rate.toFixed(1)} images per second, latency ${latency.toFixed(0)} ms`);

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
  console.log("the mouse moves a model");

  await page.click("#reset");
  await until("reset", async () => (await viewer(page)).stamp < stood[0]);

  await end(simulator, "SIGKILL");
  await until("gone", async () => (await viewer(page)).state === "gone");
  // The browser reports the refused connection, as expected.
  problems = problems.filter((text) => !text.includes("ERR_CONNECTION_REFUSED"));
  simulator = await start(domain, port, KINECT);
  const frames = (await viewer(page)).frames[PICTURE];
  await until("pictures again", async () => (await viewer(page)).frames[PICTURE] > frames + 3);
  problems = problems.filter((text) => !text.includes("ERR_CONNECTION_REFUSED"));
  console.log("the page continues after the simulator was killed and restarted");
  // Old values of plots are removed even while the plots are hidden.
  const kept = await until("some values", async () => ((await viewer(page)).plots.size > 12 ? (await viewer(page)).plots.size : 0));
  await page.evaluate(() => {
    const now = performance.now.bind(performance);
    performance.now = () => now() + 60000;
  });
  await until("fewer values", async () => (await viewer(page)).plots.size < kept);
  await page.close();

  // On a phone and in half a window, everything fits the width, and the world is visible.
  for (const size of [{ width: 480, height: 800 }, { width: 800, height: 600 }]) {
    const small = await open(simulator.url, size);
    await until("a picture", async () => (await viewer(small)).firstPictureMs);
    const [wide, canvas] = await small.evaluate(() => {
      const { clientWidth, clientHeight } = document.querySelector("#space canvas");
      return [document.documentElement.scrollWidth, [clientWidth, clientHeight]];
    });
    assert.ok(wide <= size.width && canvas[0] >= 400 && canvas[1] >= 250, `${wide}, ${canvas}`);
    assert.ok(await small.locator("#pause").isVisible());
    await small.close();
  }
  console.log("small windows show everything");
  await end(simulator);

  // Seen from above, the points of the scan lie on the walls and objects of the world.
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
