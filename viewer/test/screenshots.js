// Tests the page in Chromium by comparing screenshots. The argument is the program belvedere.
import assert from "node:assert/strict";
import pixelmatch from "pixelmatch";
import { chromium } from "playwright-core";
import { PNG } from "pngjs";
import { WebSocket } from "ws";
import { end, killAll, sleep, start, until } from "./simulator.js";

const PICTURE = "camera/rgb/image_raw";
const DEPTHS = "camera/depth/image_raw";
const SIZE = { width: 1280, height: 720 };
/** Largest distance in pixels between a point of a scan and its range: half of a point of four pixels, and rounding. */
const POINT_PX = 3;
/** Least number of pixels that differ after the robot was driven; the actual number is about ten times as large. */
const MANY = 2000;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});

/** Takes a screenshot of a part of the page. */
const shoot = async (page, part) => PNG.sync.read(await page.locator(part).screenshot());

/** Compares the pixels of two screenshots; by default as perceived, because Chromium may draw corners differently. */
function compare(one, other, threshold = 0.1) {
  assert.deepEqual([one.width, one.height], [other.width, other.height]);
  const mask = new PNG({ width: one.width, height: one.height });
  const options = { threshold, includeAA: true, diffMask: true };
  const count = pixelmatch(one.data, other.data, mask.data, one.width, one.height, options);
  const pixels = [];
  for (let at = 0; at < mask.width * mask.height; at++) {
    if (mask.data[4 * at + 3] > 0) pixels.push([at % mask.width, Math.floor(at / mask.width)]);
  }
  return { count, pixels };
}

/** Waits until a part of the page has not changed for a second and a half. Returns its screenshot. */
async function settled(page, part) {
  // Without a graphics card, the view has full resolution only while nothing moves; on a busy machine a frame may be
  // late.
  let [before, same] = [await shoot(page, part), 0];
  return until(`${part} stays as it looks`, async () => {
    await sleep(500);
    const now = await shoot(page, part);
    same = compare(before, now).count === 0 ? same + 1 : 0;
    before = now;
    return same === 3 && now;
  });
}

async function setTime(page, wanted) {
  await page.click("#pause");
  await until(wanted, () => page.evaluate((wanted) => window.viewer().state === wanted, wanted));
}

/** Subscribes to a stream as a separate client. Returns an object with the newest frame. */
function follow(url, topic) {
  const socket = new WebSocket(url.replace("http:", "ws:"));
  const ask = () => socket.send(JSON.stringify({ op: "next", topic }));
  let newest = null;
  socket.on("open", ask);
  socket.on("message", (data, isBinary) => {
    if (!isBinary) return;
    newest = data;
    ask();
  });
  return { newest: () => newest, end: () => socket.close() };
}

/** Returns the points of a scan of an upright scanner, by code that does not come from the page. */
function pointsOf(frame) {
  const length = frame.readUInt32LE(0);
  const { position, orientation, width, elemStride, scan } = JSON.parse(frame.toString("utf8", 4, 4 + length));
  const heading = 2 * Math.atan2(orientation[2], orientation[3]);
  const points = [];
  for (let ray = 0; ray < width; ray++) {
    const range = frame.readFloatLE(4 + length + ray * elemStride);
    if (!(range >= scan.rangeMin && range <= scan.rangeMax)) continue;
    const angle = heading + scan.angleMin + ray * scan.angleIncrement;
    points.push([position[0] + range * Math.cos(angle), position[1] + range * Math.sin(angle), position[2]]);
  }
  return points;
}

/** Projects the points of a depth frame with the page's camera to pixels of the view, each once. */
function pixelsOf(page, frame) {
  const length = frame.readUInt32LE(0);
  const header = JSON.parse(frame.toString("utf8", 4, 4 + length));
  const [texels, base] = [[], 4 + length];
  for (let at = base; at < frame.length; at += 2) texels.push(frame.readUInt16LE(at));
  return page.evaluate(
    ({ header, texels }) => {
      const { fx, fy, cx, cy } = header.intrinsics;
      const [x, y, z, w] = header.orientation;
      const { left, top } = window.space.canvas.getBoundingClientRect();
      const found = new Set();
      texels.forEach((millimetres, index) => {
        if (millimetres === 0 || millimetres === 65535) return;
        // Forwards, left and up, rotated by the orientation of the sensor: v + 2 w (q × v) + 2 q × (q × v).
        const depth = millimetres / 1000;
        const [column, row] = [index % header.width, Math.floor(index / header.width)];
        const v = [depth, (-depth * (column - cx)) / fx, (-depth * (row - cy)) / fy];
        const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];
        const [once, q] = [cross([x, y, z], v), [x, y, z]];
        const twice = cross(q, once);
        const point = v.map((value, axis) => header.position[axis] + value + 2 * w * once[axis] + 2 * twice[axis]);
        const [seenX, seenY] = window.space.pixelOf(point);
        found.add(`${Math.floor(seenX - left)} ${Math.floor(seenY - top)}`);
      });
      return [...found].map((place) => place.split(" ").map(Number));
    },
    { header, texels },
  );
}

try {
  const domain = `screenshots-${process.pid}`;
  const driven = await start(domain, 0, ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "still"]);
  const page = await browser.newPage({ viewport: SIZE });
  await page.goto(driven.url);
  await page.uncheck("#follow");
  await until("the robot", () => page.evaluate(() => window.viewer().robot));
  const panel = `figure[data-topic="${PICTURE}"] > canvas`;
  await until("pictures", () => page.evaluate((topic) => window.viewer().frames[topic] > 2, PICTURE));

  const depths = follow(driven.url, DEPTHS);
  await until("that both follow it", depths.newest);

  // While time is paused, no pixel of the page changes.
  await setTime(page, "paused");
  const rates = () => page.locator(".rate").allTextContents();
  await until("that no frames come", async () => (await rates()).join("") === "");
  const stood = { page: await settled(page, "body"), space: await shoot(page, "#space"), picture: await shoot(page, panel) };
  await sleep(1000);
  assert.equal(compare(stood.page, await shoot(page, "body")).count, 0);

  // The cloud is at the positions given by the depths.
  const cloud = await pixelsOf(page, depths.newest());
  depths.end();
  const near = new Set(cloud.flatMap(([x, y]) => [-1, 0, 1].flatMap((u) => [-1, 0, 1].map((v) => `${x + u} ${y + v}`))));
  await page.uncheck(`[data-key="${DEPTHS}#space"]`);
  // Its colours are about those of the surfaces on which it lies.
  const ofCloud = compare(stood.space, await settled(page, "#space"), 0.02).pixels;
  const outside = ofCloud.filter(([x, y]) => !near.has(`${x} ${y}`));
  assert.deepEqual(outside, []);
  assert.ok(ofCloud.length > MANY, `${ofCloud.length} pixels of the cloud`);
  console.log(`the cloud: all ${ofCloud.length} pixels of it are within 1 of where its depths say`);
  await page.check(`[data-key="${DEPTHS}#space"]`);

  // The robot is driven: the 3D view and the camera image change, and then stay the same again.
  await setTime(page, "running");
  const from = await page.evaluate(() => window.viewer().robot);
  await page.keyboard.down("ArrowUp");
  await page.keyboard.down("ArrowLeft");
  await until("driven", async () => {
    const now = await page.evaluate(() => window.viewer().robot);
    return Math.hypot(now[0] - from[0], now[1] - from[1]) > 0.3;
  });
  const moving = await shoot(page, panel);
  const change = await until("that the picture moves", async () => compare(moving, await shoot(page, panel)).count);
  await page.keyboard.up("ArrowLeft");
  await page.keyboard.up("ArrowUp");
  await setTime(page, "paused");
  await settled(page, "body");
  const moved = {
    space: compare(stood.space, await shoot(page, "#space")),
    picture: compare(stood.picture, await shoot(page, panel)),
  };
  assert.ok(moved.space.count > MANY && moved.picture.count > MANY, JSON.stringify(moved));
  console.log("while time is paused, no pixel of the page changes");
  console.log(
    `driven, ${change} pixels of the picture change from one look to the next; when it stands again, ` +
      `${moved.picture.count} of the picture and ${moved.space.count} of the 3D view have`,
  );
  await page.close();
  await end(driven);

  // Seen from above, the pixels that the scan adds to the view are at the positions given by its ranges, on objects.
  const scanning = await start(domain, 0, ["--robot", "kobuki_nostack_rplidar", "--world", "playground", "--drive", "still"]);
  const plan = await browser.newPage({ viewport: SIZE });
  await plan.goto(scanning.url);
  await until("the robot", () => plan.evaluate(() => window.viewer().robot));
  await until("a scan", () => plan.evaluate(() => window.viewer().frames.scan > 2));
  await plan.evaluate(() => window.space.look([-0.02, 0, 9]));
  const follower = follow(scanning.url, "scan");
  await until("that both follow it", follower.newest);
  await setTime(plan, "paused");
  const shown = await settled(plan, "#space");
  const points = await plan.evaluate((points) => {
    const { left, top } = window.space.canvas.getBoundingClientRect();
    return points.map((point) => window.space.pixelOf(point)).map(([x, y]) => [x - left, y - top]);
  }, pointsOf(follower.newest()));
  follower.end();
  await plan.uncheck('[data-key="scan"]');
  const added = compare(shown, await settled(plan, "#space"));
  const distance = ([x, y], [atX, atY]) => Math.max(Math.abs(x + 0.5 - atX), Math.abs(y + 0.5 - atY));
  const strays = added.pixels.filter((pixel) => points.every((point) => distance(pixel, point) > POINT_PX));
  assert.deepEqual(strays, []);
  const inView = points.filter(([x, y]) => x > POINT_PX && y > POINT_PX && x < shown.width - POINT_PX && y < shown.height - POINT_PX);
  const seen = inView.filter((point) => added.pixels.some((pixel) => distance(pixel, point) <= POINT_PX));
  // Because of noise, every other range ends behind the surface that it hit.
  assert.ok(inView.length > 100 && seen.length > inView.length / 3, `${seen.length} of ${inView.length}`);
  const modelsAt = (places) =>
    plan.evaluate((places) => {
      const { left, top } = window.space.canvas.getBoundingClientRect();
      return places.map(([x, y]) => window.space.pick(window.space.placeOf([x + left, y + top]))?.model);
    }, places);
  const robot = await plan.evaluate(() => {
    const { left, top } = window.space.canvas.getBoundingClientRect();
    const [x, y] = window.space.pixelOf(window.space.robotPosition());
    return [x - left, y - top];
  });
  const [itself, ...hit] = await modelsAt([robot, ...seen]);
  assert.equal(itself, "turtlebot");
  const onThings = hit.filter((model) => model !== undefined && model !== "ground_plane");
  // At a corner, or if noise makes it nearer, a point may have the floor behind it.
  assert.ok(onThings.length > 0.8 * hit.length && new Set(onThings).size >= 4, hit.join(" "));
  console.log(
    `the robot stands in its scan: all ${added.count} pixels of it are within ${POINT_PX} of where its ranges say, ` +
      `${onThings.length} of ${hit.length} points on ${[...new Set(onThings)].join(", ")}`,
  );
  await plan.close();
  await end(scanning);
} finally {
  killAll();
  await browser.close();
}
