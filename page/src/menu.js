// A menu that opens below its name, and closes by itself.

import { at, el } from "./dom.js";

// items: [words, does, mark]
export function menu(id, items) {
  const box = at(id);
  const close = () => {
    box.open = false;
    box.querySelector("summary").focus();
  };
  box.querySelector("ul").append(...items.map(([words, does, mark]) => el("li", {},
    el("button", { type: "button", text: words, "data-kind": mark, on: { click: () => (close(), does()) } }))));
  box.addEventListener("keydown", (event) => event.key === "Escape" && close());
  document.addEventListener("click", (event) => box.contains(event.target) || (box.open = false));
}
