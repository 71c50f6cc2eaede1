// Starts a simulator or a recording with its page, for tests. The first argument is the program belvedere.
import { execFileSync, spawn } from "node:child_process";
import { createInterface } from "node:readline";

const program = process.argv[2];
const TOKEN = "token-of-the-test";
const children = new Set();

/** Starts a simulator with its page. Returns the process and the page's URL. */
export function start(domain, port, args) {
  return serve(["run", "--view", ...args], domain, port);
}

/** Starts a recording with its page. */
export function play(domain, file) {
  return serve(["view", file], domain, 0);
}

/** Records a run of the given number of seconds. */
export function record(domain, file, seconds, args) {
  const pace = ["--rate", "max", "--duration", String(seconds), "--record", file];
  execFileSync(program, ["run", "--domain", domain, ...pace, ...args], { stdio: "ignore" });
}

async function serve(command, domain, port) {
  const child = spawn(
    program,
    [...command, "--no-browser", "--port", String(port), "--token", TOKEN, "--domain", domain],
    { stdio: ["ignore", "pipe", "ignore"] },
  );
  children.add(child);
  child.once("exit", () => children.delete(child));
  for await (const line of createInterface({ input: child.stdout })) {
    const url = /^page: (http:.*)$/.exec(line)?.[1];
    if (url !== undefined) return { child, url };
  }
  throw new Error("the simulator printed no address");
}

/** Ends a process, and waits for its end. */
export async function end({ child }, signal = "SIGINT") {
  const gone = new Promise((resolve) => child.once("exit", resolve));
  child.kill(signal);
  await gone;
}

/** Ends all processes that still run. */
export function killAll() {
  for (const child of children) child.kill("SIGINT");
}

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until a function returns a truthy value, and returns the value. */
export async function until(what, holds, ms = 30000) {
  const deadline = performance.now() + ms;
  while (performance.now() < deadline) {
    const value = await holds();
    if (value) return value;
    await sleep(20);
  }
  throw new Error(`not within ${ms} ms: ${what}`);
}
