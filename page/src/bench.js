// The bench: pressure, and what is held beside it, a load or a contraction.

import { at, el } from "./dom.js";
import { shown } from "./format.js";
import { Slider } from "./slider.js";
import { niceAbove } from "./theme.js";

const HELD = {
  force: { label: "Load", unit: "N", si: "N", words: "a load" },
  contraction: { label: "Contraction", unit: "%", si: "contraction", words: "a contraction" },
};
const USUAL = { force: [0, 100], contraction: [-10, 30] };

export class Bench {
  constructor(store) {
    this.store = store;
    this.ends = { ...USUAL };
    this.moving = false;
    this.pressure = new Slider({ label: "Pressure", unit: "bar", least: 0, most: 1, step: 0.01, hint: "" },
      (value, settled) => this.store.change({ pressure: Number((value * 1e5).toPrecision(12)) }, settled));
    this.value = new Slider({ label: "Load", unit: "N", least: 0, most: 100, step: 0.1, hint: "" },
      (value, settled) => {
        this.moving = !settled;
        this.store.change({ value: this.si(value) }, settled);
      });
    const radios = Object.entries(HELD).map(([hold, { words }]) => el("label", { class: "radio" },
      el("input", { type: "radio", name: "hold", value: hold, on: { change: () => this.hold(hold) } }), words));
    this.radios = radios.map((label) => label.querySelector("input"));
    at("bench").append(this.pressure.root, this.value.root,
      el("fieldset", { class: "held" }, el("legend", { text: "Held beside the pressure" }), ...radios));
    at("bench").addEventListener("submit", (event) => event.preventDefault());
  }

  si(value) {
    return this.store.now.hold === "contraction" ? Number((value / 100).toPrecision(12)) : value;
  }

  // The other quantity is held from now on, at what it is now.
  hold(hold) {
    const value = this.point?.[hold];
    this.store.change({ hold, value: value === null || value === undefined ? 0 : Number(value.toPrecision(4)) }, true);
  }

  show() {
    const { told, pressure, hold, value } = this.store.now;
    const { label, unit, si } = HELD[hold];
    const most = shown(told.most, "Pa");
    this.pressure.about.step = 10 ** Math.floor(Math.log10(most / 100));
    this.pressure.limits(0, Number(most.toPrecision(6)));
    this.pressure.set(Number(shown(pressure, "Pa").toPrecision(12)));
    this.value.rename(label, unit);
    this.span();
    this.value.set(Number(shown(value, si).toPrecision(12)));
    for (const radio of this.radios) radio.checked = radio.value === hold;
  }

  span() {
    const [least, most] = this.ends[this.store.now.hold];
    this.value.about.step = 10 ** Math.floor(Math.log10((most - least) / 100));
    this.value.limits(least, most);
  }

  // How far load and contraction go, from the curves; a slider that is held stays as it is.
  reach(levels) {
    const all = (name) => levels.flatMap((level) => level[name].filter((value, k) => level.good[k] && value !== null));
    const forces = all("force");
    const contractions = all("contraction").map((value) => 100 * value);
    if (!forces.length || this.moving) return;
    this.ends.force = [0, niceAbove(1.1 * Math.max(...forces, 1e-3))];
    const low = Math.min(0, ...contractions);
    const high = Math.max(1, ...contractions);
    this.ends.contraction = [Math.floor(low - 0.05 * (high - low)), Math.ceil(high + 0.25 * (high - low))];
    const { hold, value } = this.store.now;
    this.span();
    this.value.set(Number(shown(value, HELD[hold].si).toPrecision(12)));
  }
}
