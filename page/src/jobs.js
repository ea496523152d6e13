// Long jobs in the dialog: how far they are, a button that ends them, and what they found.

import { at, el } from "./dom.js";
import { dialog } from "./notices.js";

// Runs a task; `show(answer)` makes what the dialog holds afterwards. Where nothing came of it one can go back to `form`.
export async function job(line, head, task, said, show, form = null) {
  const bar = el("progress", { "aria-label": "Progress" });
  const far = el("p", { class: "quiet", role: "status", text: "Begun; what is new is compiled first." });
  let answer;
  const cancel = el("button", { type: "button", text: "Cancel", class: "cancel", on: { click: () => line.cancel(answer.id) } });
  const box = dialog(head, bar, far, cancel);
  const begun = performance.now();
  answer = line.ask(task, said, (part, data) => {
    if (part !== "progress") return;
    if (data.of) Object.assign(bar, { max: data.of, value: data.done });
    const seconds = Math.round((performance.now() - begun) / 1000);
    far.textContent = data.of ? `${data.done} of ${data.of} done, ${seconds} s.` : `${data.done} muscles tried, ${seconds} s.`;
  });
  const closed = () => line.cancel(answer.id);
  box.addEventListener("close", closed, { once: true });
  try {
    const found = await answer;
    box.removeEventListener("close", closed);
    dialog(head, ...show(found));
  } catch (error) {
    box.removeEventListener("close", closed);
    const text = error.kind === "cancelled" ? "Cancelled." : `It was not done: ${error.message}`;
    const back = form && el("button", { type: "button", class: "main", text: "Back", on: { click: () => dialog(head, form) } });
    if (box.open) dialog(head, el("p", { role: "status", text }), ...(back ? [back] : []));
  }
}

export const notes = (lines) => (lines.length ? [el("ul", { class: "quiet notes" }, ...lines.map((text) => el("li", { text })))] : []);

// A button that takes the muscle that was found.
export const taking = (does) => el("button", { type: "button", class: "main", text: "Take this muscle", on: { click: () => {
  at("dialog").close();
  does();
} } });
