// Measured points: dropped on the plot or chosen, drawn over the curves, with the differences.

import { at, el, table } from "./dom.js";
import { answered } from "./files.js";
import { said } from "./format.js";
import { dialog, notice } from "./notices.js";
import { Newest } from "./socket.js";

const MOST = 1e7;
const HUES = ["m1", "m2", "m3", "m4"];

export class Measured {
  // `draw(extras)` is called with what is to be drawn.
  constructor(line, store, draw) {
    Object.assign(this, { line, store, draw, data: null });
    this.newest = new Newest(() => this.compare());
    const panel = at("force-panel");
    at("add-data").addEventListener("click", () => at("data-file").click());
    at("data-file").addEventListener("change", () => {
      const [file] = at("data-file").files;
      at("data-file").value = "";
      if (file) this.take(file);
    });
    panel.addEventListener("dragover", (event) => {
      event.preventDefault();
      panel.classList.add("over");
    });
    panel.addEventListener("dragleave", () => panel.classList.remove("over"));
    panel.addEventListener("drop", (event) => {
      event.preventDefault();
      panel.classList.remove("over");
      if (event.dataTransfer.files[0]) this.take(event.dataTransfer.files[0]);
    });
    for (const kind of ["dragover", "drop"]) addEventListener(kind, (event) => event.preventDefault());
  }

  // Of a workbook with several sheets, one is asked for.
  async take(file, sheet = "") {
    try {
      if (file.size > MOST) throw new Error(`the file is too large: measured data have at most ${MOST / 1e6} MB`);
      const called = new URLSearchParams({ name: file.name, sheet });
      const response = await fetch(`data?${called}`, { method: "POST", body: file });
      const told = await (await answered(response)).json();
      if (told.sheets) return void this.choose(file, told.sheets);
      this.data = told;
      this.newest.ask(true);
    } catch (error) {
      notice(`${file.name} was not read: ${error.message}`, "wrong");
    }
  }

  choose(file, sheets) {
    const take = (name) => {
      at("dialog").close();
      this.take(file, name);
    };
    const buttons = sheets.map((name) => el("li", {}, el("button", { type: "button", text: name, on: { click: () => take(name) } })));
    dialog("Which sheet?", el("p", { text: `${file.name} has several sheets. Take the one that holds the measured points.` }),
      el("ul", { class: "sheets" }, ...buttons));
  }

  // The muscle has changed: the differences are found anew.
  follow() {
    if (this.data) this.newest.ask(true);
  }

  drop() {
    this.data = null;
    at("measured").replaceChildren();
    this.draw([]);
  }

  async compare() {
    if (!this.data) return;
    try {
      const found = await this.line.ask("measured", { ...this.store.asked(), data: this.data.data });
      if (this.data) this.show(found);
    } catch (error) {
      at("measured").replaceChildren(el("p", { class: "quiet", text: `No comparison: ${error.message}` }), this.remove());
    }
  }

  remove() {
    return el("button", { type: "button", text: "Remove the measured data", on: { click: () => this.drop() } });
  }

  show(found) {
    const extras = found.compared.flatMap((one, k) => {
      const hue = HUES[k % HUES.length];
      const dots = { name: `measured ${one.test}`, hue, dots: true, x: one.contraction, y: one.force };
      const curve = one.curve && { name: `model ${one.test}`, hue, dash: [4, 3], x: one.curve.contraction, y: one.curve.force };
      return curve ? [dots, curve] : [dots];
    });
    this.draw(extras);
    const rows = found.compared.map((one) => [one.test, said(one.rms ?? null, "N", 3), said(one.largest ?? null, "N", 3)]);
    const made = table(`${found.name}: ${found.points} points; model (dashed) less measured (dots)`, ["Test", "rms", "largest difference"], rows);
    [...made.tBodies[0].rows].forEach((row, k) => {
      row.title = found.compared[k].said;
      row.cells[0].prepend(el("span", { class: `dot ${HUES[k % HUES.length]}` }));
    });
    const lines = [...found.compared.filter((one) => !one.curve).map((one) => `${one.test}: ${one.said}.`), ...found.assumptions];
    at("measured").replaceChildren(...[made, el("ul", { class: "quiet notes" }, ...lines.map((text) => el("li", { text }))),
      found.left ? el("p", { class: "quiet", text: `${found.left} more tests are not compared.` }) : null,
      this.remove()].filter(Boolean));
  }
}
