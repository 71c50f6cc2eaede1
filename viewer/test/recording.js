// Tests a recording on the page and its time line in Chromium. The argument is the program belvedere.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { end, killAll, play, record, until } from "./simulator.js";

const PICTURE = "camera/rgb/image_raw";
const SECONDS = 6;
const folder = mkdtempSync(join(tmpdir(), "belvedere-"));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});

try {
  const [file, domain] = [join(folder, "run.mcap"), `recording-${process.pid}`];
  record(domain, file, SECONDS, ["--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "loop"]);
  const player = await play(domain, file);
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
  const problems = [];
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(String(error)));
  await page.goto(player.url);
  const viewer = () => page.evaluate(() => window.viewer());
  const head = async () => (await viewer()).timeline;
  const bar = page.locator('#timeline [data-is="bar"]');
  /** Returns a checksum of the pixels of the image. */
  const pixels = () =>
    page.evaluate((topic) => {
      const canvas = document.querySelector(`figure[data-topic="${topic}"] canvas`);
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      return data.reduce((sum, value, index) => (Math.imul(sum, 31) + value * ((index % 7) + 1)) | 0, 7);
    }, PICTURE);
  /** Drags the thumb of the time line to a fraction of its length. Returns the image once it no longer changes. */
  const dragTo = async (share) => {
    const box = await bar.boundingBox();
    const place = ((await head()).position / (await head()).duration) * (box.width - 16) + 8;
    await page.mouse.move(box.x + place, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + 8 + share * (box.width - 16), box.y + box.height / 2, { steps: 4 });
    await page.mouse.up();
    const wanted = Number(await bar.inputValue());
    const began = performance.now();
    // At full speed, streams are recorded with small delays between them.
    const near = async () => Math.abs((await viewer()).stamp / 1e9 - wanted) < 0.4;
    await until(`the states at ${wanted} s`, near);
    const took = performance.now() - began;
    let [before, now] = [0, await pixels()];
    await until("a picture that stays", async () => {
      [before, now] = [now, await pixels()];
      await page.waitForTimeout(200);
      return before === now && now === (await pixels());
    });
    return { wanted, took, robot: (await viewer()).robot, pixels: now };
  };

  await until("a picture", async () => (await viewer()).firstPictureMs);
  await until("the robot", async () => (await viewer()).robot);
  const { duration } = await head();
  assert.ok(Math.abs(duration - SECONDS) < 0.1, `${duration} s`);
  await until("that it plays", async () => (await viewer()).state === "running");
  assert.equal(await page.locator("#reset").isVisible(), false);
  await page.click('#timeline [data-is="play"]');
  await until("that it stands", async () => (await viewer()).state === "paused");

  const late = await dragTo(0.8);
  const early = await dragTo(0.3);
  assert.ok(Math.abs(late.wanted - 0.8 * duration) < 0.1 && Math.abs(early.wanted - 0.3 * duration) < 0.1);
  assert.notDeepEqual(early.robot, late.robot);
  assert.notEqual(early.pixels, late.pixels);
  await bar.evaluate((bar, value) => {
    bar.value = String(value);
    bar.dispatchEvent(new window.Event("input"));
  }, late.wanted);
  await until("the same again", async () => {
    const { robot } = await viewer();
    return (await pixels()) === late.pixels && robot.every((axis, index) => axis === late.robot[index]);
  });
  console.log(`dragging shows the state at that time after ${Math.max(late.took, early.took).toFixed(0)} ms`);

  // A clicked element does not take the space key.
  await dragTo(0.1);
  await page.keyboard.press("Space");
  await until("that it plays by space", async () => !(await head()).paused);
  await page.keyboard.press("Space");
  await until("that it stands by space", async () => (await head()).paused);
  await dragTo(0.1);
  await page.locator('#timeline [data-is="rate"]').selectOption("4");
  const [from, began] = [(await head()).position, performance.now()];
  await page.click('#timeline [data-is="play"]');
  await until("the end", async () => (await head()).position === duration && (await head()).paused);
  const rate = (duration - from) / ((performance.now() - began) / 1000);
  // A busy machine may not keep up with this rate.
  assert.ok(rate < 4.5, `${rate} instead of 4`);
  assert.equal((await head()).rate, 4);
  await page.click('#timeline [data-is="play"]');
  await until("the beginning again", async () => (await head()).position < duration - 0.5);
  console.log(`played at rate 4: ${rate.toFixed(1)}; it stops at the end, and can be started again`);
  assert.deepEqual(problems, []);

  await end(player);
} finally {
  killAll();
  await browser.close();
  rmSync(folder, { recursive: true });
}
