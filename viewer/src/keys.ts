// Driving by keys: a velocity ten times a second while one is held, and a stop after.

const SPEED = 0.3;
const TURN = 1;
const PERIOD_MS = 100;

const KEYS: Record<string, [number, number]> = {
  ArrowUp: [1, 0],
  KeyW: [1, 0],
  ArrowDown: [-1, 0],
  KeyS: [-1, 0],
  ArrowLeft: [0, 1],
  KeyA: [0, 1],
  ArrowRight: [0, -1],
  KeyD: [0, -1],
};

export function driveByKeys(drive: (forward: number, turn: number) => void, onSpace: () => void) {
  const held = new Set<string>();
  let timer: ReturnType<typeof setInterval> | undefined;
  const send = () => {
    let [forward, turn] = [0, 0];
    for (const key of held) {
      forward += KEYS[key]?.[0] ?? 0;
      turn += KEYS[key]?.[1] ?? 0;
    }
    drive(SPEED * Math.sign(forward), TURN * Math.sign(turn));
  };
  const end = () => {
    if (timer === undefined) return;
    clearInterval(timer);
    timer = undefined;
    held.clear();
    drive(0, 0);
  };
  const isBox = (target: EventTarget | null) => target instanceof HTMLInputElement && target.type === "checkbox";
  const isText = (target: EventTarget | null) =>
    (target instanceof HTMLInputElement && !isBox(target)) || target instanceof HTMLSelectElement;
  // Before the 3D view's own keys, which would move the camera.
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || isText(event.target)) return;
      if (event.code === "Space" && !(event.target instanceof HTMLButtonElement || isBox(event.target))) {
        event.preventDefault();
        if (!event.repeat) onSpace();
      }
      if (!(event.code in KEYS)) return;
      event.preventDefault();
      if (held.has(event.code)) return;
      held.add(event.code);
      send();
      timer ??= setInterval(send, PERIOD_MS);
    },
    { capture: true },
  );
  window.addEventListener("keyup", (event) => {
    if (!held.delete(event.code)) return;
    if (held.size === 0) end();
    else send();
  });
  window.addEventListener("blur", end);
}
