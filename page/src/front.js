// A front: two goals against each other, one design of it chosen by a slider, on the picture or in the table.

import { axis, Chart, ring } from "./chart.js";
import { el, table } from "./dom.js";
import { digits } from "./format.js";
import { colour } from "./theme.js";

const COLUMNS = 8;

export class Front {
  constructor(front) {
    this.front = front;
    const count = front.muscles.length;
    this.slider = el("input", { type: "range", min: 1, max: count, step: 1, id: "front-design", on: { input: () => this.choose(this.slider.value - 1) } });
    this.picture = el("div", { class: "plot", role: "img", "aria-label": this.told() });
    this.chosen = el("div", { role: "status" });
    const better = this.front.goals.map(({ short, better }) => `${short.replace(/ \[.*/, "")}: ${better}`).join("; ");
    this.root = el("div", {}, this.picture, el("p", { class: "quiet", text: `${better}.` }),
      el("p", { class: "along" }, el("label", { for: "front-design", text: "Design along the front" }), this.slider),
      this.chosen, el("details", { class: "table" }, el("summary", { text: "As a table" }), el("div", { class: "wide" }, this.all())));
    this.chart = new Chart(this.picture, 260, () => this.options());
    this.choose(front.middle);
  }

  heads(how) {
    return [...this.front.goals.map((goal) => goal[how]), ...this.front.numbers];
  }

  row(k) {
    return [...this.front.goals.map(({ values }) => digits(values[k])), ...this.front.said[k]];
  }

  all() {
    return table("All designs of the front", ["Design", ...this.heads("short")].slice(0, COLUMNS),
      this.front.muscles.map((_, k) => [`${k + 1}`, ...this.row(k)].slice(0, COLUMNS)));
  }

  told() {
    const ends = this.front.goals.map(({ label, values }) => `${label} from ${digits(Math.min(...values))} to ${digits(Math.max(...values))}`);
    return `The front of ${this.front.muscles.length} designs: ${ends.join(", ")}.`;
  }

  options() {
    const [x, y] = this.front.goals;
    return {
      series: [{ label: x.label }, { label: "front", stroke: colour("accent"), width: 0, paths: () => null,
        points: { show: true, size: 7, fill: colour("accent") } }, ring("chosen")],
      scales: { x: { time: false, range: (_, low, high) => wider(low, high) }, y: { range: (_, low, high) => wider(low, high) } },
      axes: [axis(x.short, 28), axis(y.short, 50)],
      legend: { show: false },
      cursor: { x: false, y: false, drag: { x: false, y: false }, points: { show: false } },
      hooks: { ready: [(plot) => plot.over.addEventListener("click", (event) => this.nearest(plot, event))] },
    };
  }

  nearest(plot, event) {
    const { left, top } = plot.over.getBoundingClientRect();
    const [x, y] = this.front.goals.map(({ values }) => values);
    const far = x.map((value, k) => Math.hypot(plot.valToPos(value, "x") - event.clientX + left, plot.valToPos(y[k], "y") - event.clientY + top));
    this.choose(far.indexOf(Math.min(...far)));
  }

  choose(k) {
    this.k = k;
    this.slider.value = k + 1;
    this.slider.setAttribute("aria-valuetext", `${k + 1} of ${this.front.muscles.length}: ${this.row(k).join(", ")}`);
    const [x, y] = this.front.goals.map(({ values }) => values);
    this.chart.show([x, y, x.map((_, one) => (one === k ? y[k] : null))], "front");
    this.chosen.replaceChildren(table(`Design ${k + 1} of ${x.length}`, ["Number", "value"], this.heads("label").map((name, j) => [name, this.row(k)[j]])));
  }

  muscle() {
    return this.front.muscles[this.k];
  }
}

function wider(low, high) {
  const more = 0.06 * (high - low) || 0.06 * Math.abs(high) || 1;
  return [low - more, high + more];
}
