// A plot in its place: axes in the colours of the page, made anew when size or colours change.

import uPlot from "uplot";
import { at } from "./dom.js";
import { colour, onTheme } from "./theme.js";

export function axis(label, size) {
  return {
    label, size, labelSize: 20, labelGap: 0, gap: 4, stroke: colour("quiet"), font: "12px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif", grid: { stroke: colour("grid"), width: 1 }, ticks: { show: false },
    values: (_, splits) => splits.map((value) => (value === null ? "" : String(value).replace("-", "−"))),
  };
}

export class Chart {
  // `place` is an element, or the name of one.
  constructor(place, height, options) {
    Object.assign(this, { place: typeof place === "string" ? at(place) : place, height, options, data: null, plot: null, key: "" });
    new ResizeObserver(() => this.resize()).observe(this.place);
    onTheme(() => this.renew());
  }

  show(data, key) {
    this.data = data;
    if (!this.plot || key !== this.key) this.renew(key);
    else this.plot.setData(data);
  }

  renew(key = this.key) {
    this.key = key;
    this.plot?.destroy();
    if (!this.data) return;
    const width = Math.max(this.place.clientWidth, 200);
    this.plot = new uPlot({ width, height: this.height, ...this.options() }, this.data, this.place);
  }

  resize() {
    const width = Math.max(this.place.clientWidth, 200);
    if (this.plot && width !== this.plot.width) this.plot.setSize({ width, height: this.height });
  }
}

// A working point: a ring in the colour of points.
export const ring = (label) => ({
  label, stroke: colour("point"), width: 0, paths: () => null,
  points: { show: true, size: 12, width: 2, fill: colour("panel"), stroke: colour("point") },
});
