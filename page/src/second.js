// A second muscle beside the first: kept as it is now, at the same pressure and load.

import { at } from "./dom.js";
import { said } from "./format.js";
import { Newest } from "./socket.js";
import { Stage } from "./stage.js";

export class Second {
  // `draw(extras)` takes its curve; `numbers(rows)` the numbers of its state, null where there is none.
  constructor(line, store, draw, numbers) {
    Object.assign(this, { line, store, draw, numbers, kept: null });
    this.newest = new Newest(() => this.look());
    at("second").addEventListener("click", () => (this.kept ? this.drop() : this.keep()));
  }

  keep() {
    this.kept = { muscle: this.store.muscle(), top: this.store.now.told.top, name: this.store.now.told.name };
    at("second").textContent = "Remove the second";
    at("stages").classList.add("two");
    at("second-place").hidden = false;
    this.stage ??= new Stage("2");
    this.stage.fit();
    this.newest.ask(true);
  }

  drop() {
    this.kept = null;
    at("second").textContent = "Keep as second";
    at("stages").classList.remove("two");
    at("second-place").hidden = true;
    this.draw([]);
    this.numbers(null);
  }

  follow() {
    if (this.kept) this.newest.ask(true);
  }

  async look() {
    if (!this.kept) return;
    const { pressure, hold, value } = this.store.now;
    try {
      const asked = { ...this.kept, pressure, hold, value };
      const told = await this.line.ask("beside", asked, (part, data) => part === "state" && this.kept && this.show(data));
      if (!this.kept) return;
      const level = told.levels.find((one) => one.present);
      const y = level.force.map((force, k) => (level.good[k] ? force : null));
      this.draw([{ name: `second, ${said(level.pressure, "Pa", 3)}`, hue: "other", dash: [8, 4], x: level.contraction, y }]);
    } catch (error) {
      at("second-said").textContent = `Second muscle: ${error.message}`;
    }
  }

  show(state) {
    this.stage.show(state.shape, state.good ? "" : state.last ? "Last good state" : "As made");
    at("second-said").textContent = `Second muscle (${this.kept.name}; wide dashes in the plot): ${state.said}.`;
    this.numbers(state.numbers);
  }
}
