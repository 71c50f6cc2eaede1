// Writes the documentation's images of the viewer. Arguments: the program belvedere, and the output folder.
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { animate } from "./animation.js";
import { end, killAll, sleep, start, until } from "./simulator.js";

const ROBOT = ["--robot", "kobuki_hexagons_vlp16_d435"];
const SHOWN = ["velodyne_points", "camera/depth/color/points", "camera/color/image_raw", "image_raw", "rear/image_raw"];
const FRAMES = 40;
const ROBOTS = [
  "kobuki_nostack_camera",
  "kobuki_nostack_rplidar",
  "kobuki_hexagons_camera",
  "kobuki_hexagons_rplidar",
  "kobuki_hexagons_kinect",
  "kobuki_hexagons_asus_xtion_pro",
  "kobuki_hexagons_KinectHokuyo",
  "kobuki_hexagons_vlp16_d435",
  "create_circles_kinect",
];
/** Each world with the position of the camera relative to the robot. */
const WORLDS = [
  { world: "tag_ceiling", from: [-3.6, -2.4, 3.2] },
  { world: "playground", from: [-6, -5, 5] },
  { world: "corridor", from: [-0.5, -3, 9], more: ["--pose", "0,1"] },
  { world: "empty", from: [-2, -1.5, 1.2] },
];
const pictures = process.argv[3];
const domain = `pictures-${process.pid}`;
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});

const viewer = (page) => page.evaluate(() => window.viewer());

/** Opens the page and shows exactly the streams of SHOWN. */
async function open(url, size) {
  const page = await browser.newPage({ viewport: size });
  await page.goto(url);
  await until("the robot", async () => (await viewer(page)).robot);
  for (const box of await page.locator("#streams [data-key]").all()) {
    await box.setChecked(SHOWN.includes((await box.getAttribute("data-key")).replace(/^\//, "")));
  }
  return page;
}

/** Waits until the requested view has been drawn. */
async function drawn(page) {
  await until("that it stands", async () => (await viewer(page)).state === "paused");
  await sleep(900);
}

/** Saves the 3D view of a robot or a world from a position relative to the robot. */
async function portray(args, from, path) {
  const simulator = await start(domain, 0, [...args, "--drive", "still"]);
  const page = await browser.newPage({ viewport: { width: 800, height: 520 } });
  await page.goto(simulator.url);
  await until("the robot", async () => (await viewer(page)).robot);
  for (const box of await page.locator("#streams [data-key]").all()) await box.setChecked(false);
  await page.click("#pause");
  await page.evaluate((from) => window.space.look(from), from);
  await drawn(page);
  const { x, y, width, height } = await page.locator("#space canvas").boundingBox();
  const side = Math.min(width, (height * 4) / 3);
  const clip = { x: x + (width - side) / 2, y: y + (height - (side * 3) / 4) / 2, width: side, height: (side * 3) / 4 };
  await page.screenshot({ path, clip, type: "jpeg", quality: 80 });
  await page.close();
  await end(simulator);
}

try {
  const simulator = await start(domain, 0, [...ROBOT, "--drive", "loop"]);
  const page = await open(simulator.url, { width: 1600, height: 900 });
  await until("that it drives", async () => (await viewer(page)).stamp > 6e9, 240000);
  await page.click("#pause");
  await page.evaluate(() => window.space.look([-2.2, -2.4, 2.2]));
  await drawn(page);
  await page.screenshot({ path: join(pictures, "viewer.png") });

  // A step is a tenth of a second.
  await page.setViewportSize({ width: 1280, height: 640 });
  await page.evaluate(() => window.space.look([-1.7, -1.9, 1.8]));
  const shots = [];
  for (let frame = 0; frame < FRAMES; frame++) {
    const { stamp } = await viewer(page);
    await page.click("#step");
    await until("a step", async () => (await viewer(page)).stamp > stamp);
    await drawn(page);
    shots.push(await page.screenshot());
  }
  const moving = await animate(page, shots, { width: 880, height: 440, periodMs: 100 });
  writeFileSync(join(pictures, "viewer.webp"), moving);
  console.log(`an animation of ${(moving.length / 1e6).toFixed(2)} MB`);
  assert.ok(moving.length < 2e6);
  await end(simulator);

  const gallery = join(pictures, "gallery");
  mkdirSync(gallery, { recursive: true });
  for (const robot of ROBOTS) await portray(["--robot", robot], [0.72, -0.5, 0.45], join(gallery, `${robot}.jpg`));
  for (const { world, from, more } of WORLDS) {
    await portray(["--world", world, ...(more ?? [])], from, join(gallery, `${world}.jpg`));
  }
} finally {
  killAll();
  await browser.close();
}
