// One number: a range, a field and a unit that go together.

import { el } from "./dom.js";
import { plain } from "./format.js";

const STEPS = 400;
let made = 0;

// about: label, unit, least, most, step, log, whole, hint, mark. `changed(value, settled)` is called as it moves.
export class Slider {
  constructor(about, changed) {
    this.about = about;
    this.changed = changed;
    const id = `slider-${++made}`;
    const hint = about.hint ? `${id}-hint` : undefined;
    this.range = el("input", { type: "range", id: `${id}-range`, "aria-label": this.named(), "aria-describedby": hint });
    this.field = el("input", { type: "text", inputmode: "decimal", id, size: 7, "aria-describedby": hint });
    this.name = el("label", { for: id }, about.label);
    const name = el("span", { class: "name" }, this.name, about.mark ? el("span", { class: "mark", text: about.mark }) : null);
    this.unit = el("span", { class: "unit", text: about.unit.replace("^2", "²") });
    this.root = el("div", { class: "slider" }, name, this.field, this.unit, this.range,
      about.hint ? el("p", { class: "hint", id: hint, text: about.hint }) : null);
    this.limits(about.least, about.most);
    this.range.addEventListener("input", () => this.moved(false));
    this.range.addEventListener("change", () => this.moved(true));
    this.field.addEventListener("input", () => (this.typing = true));
    this.field.addEventListener("change", () => this.typed());
    this.field.addEventListener("blur", () => this.left());
    this.field.addEventListener("keydown", (event) => event.key === "Enter" && (event.preventDefault(), this.typed()));
  }

  named() {
    return this.about.unit ? `${this.about.label}, in ${this.about.unit}` : `${this.about.label}, by slider`;
  }

  rename(label, unit) {
    Object.assign(this.about, { label, unit });
    this.name.firstChild.textContent = label;
    this.unit.textContent = unit;
    this.range.setAttribute("aria-label", this.named());
  }

  limits(least, most) {
    Object.assign(this.about, { least, most });
    const { log, step } = this.about;
    const whole = log ? { min: 0, max: STEPS, step: 1 } : { min: least, max: most, step };
    Object.assign(this.range, whole);
    if (this.value !== undefined) this.set(this.value);
  }

  place(value) {
    const { log, least, most } = this.about;
    return log ? STEPS * Math.log(Math.max(value, least) / least) / Math.log(most / least) : value;
  }

  reading() {
    const at = Number(this.range.value);
    const { log, least, most, whole } = this.about;
    if (!log) return whole ? Math.round(at) : Number(at.toPrecision(12));
    return Number((least * (most / least) ** (at / STEPS)).toPrecision(3));
  }

  set(value) {
    this.value = value;
    this.range.value = this.place(value);
    this.range.setAttribute("aria-valuetext", `${plain(value)} ${this.about.unit}`.trim());
    if (!this.typing) this.field.value = plain(value); // an answer that comes meanwhile takes nothing away
  }

  moved(settled) {
    const value = settled && this.value !== undefined && this.place(this.value) === Number(this.range.value)
      ? this.value : this.reading();
    this.typing = false;
    this.field.classList.remove("wrong");
    this.field.removeAttribute("aria-invalid");
    this.set(value);
    this.changed(value, settled);
  }

  // What is wrong stays to be mended; what is right is shown as it was understood.
  left() {
    if (this.field.classList.contains("wrong")) return;
    this.typing = false;
    this.set(this.value);
  }

  typed() {
    const text = this.field.value.trim().replace("−", "-").replace(",", ".");
    const value = Number(text);
    const wrong = text === "" || !Number.isFinite(value) || (this.about.whole === true && !Number.isInteger(value));
    this.field.classList.toggle("wrong", wrong);
    this.field.toggleAttribute("aria-invalid", wrong);
    this.typing = wrong;
    if (wrong || value === this.value) return;
    this.set(value);
    this.changed(value, true);
  }
}
