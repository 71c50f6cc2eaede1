// Names of topics where there is little room: what tells one from another stands at their end.

/** An element with a name that gives up its middle first, and has the whole of it as its tooltip. */
export function shortened(name: string): HTMLElement {
  const [whole, head, tail] = [document.createElement("span"), document.createElement("span"), document.createElement("span")];
  const cut = name.lastIndexOf("/") + 1;
  whole.className = "name";
  whole.title = name;
  head.textContent = name.slice(0, cut);
  tail.textContent = name.slice(cut);
  // The style sheet reserves room for an ellipsis, which so short a beginning does not need.
  if (cut <= 2) head.style.minWidth = "max-content";
  whole.append(head, tail);
  return whole;
}

/** What a topic's name has before its last part, and that part. */
export function parts(topic: string): [folder: string, last: string] {
  const cut = topic.lastIndexOf("/");
  return [topic.slice(0, Math.max(0, cut)), topic.slice(cut + 1)];
}
