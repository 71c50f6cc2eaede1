// Keys: those that drive send a velocity ten times a second while they are held, and then a stop; others do one action.

const SPEED = 0.3;
const TURN = 1;
const PERIOD_MS = 100;

const DRIVING: Record<string, [number, number]> = {
  ArrowUp: [1, 0],
  KeyW: [1, 0],
  ArrowDown: [-1, 0],
  KeyS: [-1, 0],
  ArrowLeft: [0, 1],
  KeyA: [0, 1],
  ArrowRight: [0, -1],
  KeyD: [0, -1],
};

/** Returns true if an element uses letters or arrows itself. */
function takesKeys(target: EventTarget | null): boolean {
  if (target instanceof HTMLSelectElement) return true;
  return target instanceof HTMLInputElement && target.type !== "checkbox";
}

/** Returns true if an element uses space: a text field, or a control that was focused with the keyboard. */
function takesSpace(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement && target.type === "range") return false;
  if (takesKeys(target)) return true;
  return target instanceof HTMLElement && target.matches("button:focus-visible, input:focus-visible");
}

/** Installs the handlers of keys. `others` has actions by the names of keys, such as `KeyH`. */
export function useKeys(drive: (forward: number, turn: number) => void, onSpace: () => void, others: Record<string, () => void>) {
  const held = new Set<string>();
  let timer: ReturnType<typeof setInterval> | undefined;
  const send = () => {
    let [forward, turn] = [0, 0];
    for (const key of held) {
      forward += DRIVING[key]?.[0] ?? 0;
      turn += DRIVING[key]?.[1] ?? 0;
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
  // Runs before the 3D view's own keys, which would move the camera.
  window.addEventListener(
    "keydown",
    (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.code === "Space" && !takesSpace(event.target)) {
        event.preventDefault();
        if (!event.repeat) onSpace();
      }
      if (takesKeys(event.target)) return;
      const other = others[event.code];
      if (other !== undefined && !event.repeat) other();
      if (!(event.code in DRIVING)) return;
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
  // A clicked element loses the focus; otherwise space would press a clicked button again.
  window.addEventListener("click", () => {
    const { activeElement } = document;
    // An element that was focused with the keyboard keeps it.
    if (activeElement?.matches("button, input[type=checkbox], input[type=range]") !== true) return;
    if (activeElement instanceof HTMLElement && !activeElement.matches(":focus-visible")) activeElement.blur();
  });
  window.addEventListener("change", ({ target }) => {
    if (target instanceof HTMLSelectElement) target.blur();
  });
}
