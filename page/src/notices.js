// Messages above the page, and the one dialog.

import { at, el } from "./dom.js";

export function notice(text, kind = "notice") {
  const close = el("button", { type: "button", class: "close", "aria-label": "Close this message", text: "✕" });
  const line = el("p", { class: kind }, text, close);
  close.addEventListener("click", () => line.remove());
  for (const old of at("notices").children) if (old.firstChild.textContent === text) old.remove();
  at("notices").append(line);
  while (at("notices").children.length > 3) at("notices").firstChild.remove();
  return line;
}

export function clear(kind) {
  for (const line of at("notices").querySelectorAll(`.${kind}`)) line.remove();
}

// A dialog with a head, its content, and a button that closes it.
export function dialog(head, ...content) {
  const box = at("dialog");
  box.replaceChildren(
    el("h2", { id: "dialog-head", text: head }), ...content,
    el("p", { class: "ends" }, el("button", { type: "button", text: "Close", on: { click: () => box.close() } })));
  if (!box.open) box.showModal();
  return box;
}
