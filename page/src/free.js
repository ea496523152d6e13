// What may be free: a row for each number of the muscle, with the range in which it is sought.

import { el } from "./dom.js";
import { plain } from "./format.js";
import { dialog } from "./notices.js";

const USUAL = ["braid.angle", ...["c1", "mu", "mu[0]", "E", "shore", "axial_stiffness"].map((name) => `chamber.law.${name}`)];

export class Free {
  constructor(store) {
    this.rows = store.now.told.sliders.map((one) => this.row(one, store.shown(one)));
    this.root = el("table", { class: "free" },
      el("thead", {}, el("tr", {}, ...["Free", "from", "to", ""].map((text) => el("th", { scope: "col", text })))),
      el("tbody", {}, ...this.rows.map(({ root }) => root)));
  }

  row(one, value) {
    const narrow = one.name === "braid.angle" ? [value - 5, value + 5]
      : value > 0 ? [value / (one.log ? 3 : 1.25), value * (one.log ? 3 : 1.25)] : [one.least, one.most];
    const [from, to] = narrow.map((end) => plain(one.whole ? 2 * Math.round(end / 2) : Number(end.toPrecision(3))));
    const label = one.label.startsWith(one.group) ? one.label : `${one.group}: ${one.label}`;
    const check = el("input", { type: "checkbox", "aria-label": label });
    check.checked = USUAL.includes(one.name);
    const field = (text, words) => el("input", { type: "text", inputmode: "decimal", size: 7, value: text, "aria-label": `${label}, ${words}` });
    const ends = [field(from, "from"), field(to, "to")];
    const root = el("tr", {}, el("th", { scope: "row" }, el("label", {}, check, ` ${label}`)),
      ...ends.map((end) => el("td", {}, end)), el("td", { class: "unit", text: one.unit }));
    return { one, check, ends, root };
  }

  // As fit and design take it.
  said() {
    const chosen = this.rows.filter(({ check }) => check.checked);
    return Object.fromEntries(chosen.map(({ one, ends }) => {
      const [from, to] = ends.map((end) => `${end.value.trim()} ${one.unit}`.trim());
      return [one.name, `${from} to ${to}`];
    }));
  }
}

// The dialog in which a study is begun; `does(form)` is given the form, to come back to.
export function begin(head, words, free, more, does) {
  const form = el("form", { autocomplete: "off" }, el("p", { text: words }), free.root, ...more,
    el("button", { type: "submit", class: "main", text: "Begin" }));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    does(form);
  });
  dialog(head, form);
}
