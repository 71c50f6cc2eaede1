// Names of topics in little space. The end of a name is the part that distinguishes it from others.

/** Creates an element with a name that is shortened in the middle; its tooltip is the full name. */
export function shortened(name: string): HTMLElement {
  const [whole, head, tail] = [document.createElement("span"), document.createElement("span"), document.createElement("span")];
  const cut = name.lastIndexOf("/") + 1;
  whole.className = "name";
  whole.title = name;
  head.textContent = name.slice(0, cut);
  tail.textContent = name.slice(cut);
  // The style sheet reserves space for an ellipsis, which such a short beginning does not need.
  if (cut <= 2) head.style.minWidth = "max-content";
  whole.append(head, tail);
  return whole;
}

/** Returns the part of a topic's name before its last component, and that component. */
export function parts(topic: string): [folder: string, last: string] {
  const cut = topic.lastIndexOf("/");
  return [topic.slice(0, Math.max(0, cut)), topic.slice(cut + 1)];
}
