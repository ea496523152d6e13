// Force against contraction for a family of pressures, the working point on it. Dragging on it moves the point.

import uPlot from "uplot";
import { axis, Chart, ring } from "./chart.js";
import { at, table } from "./dom.js";
import { digits, said, shown } from "./format.js";
import { colour } from "./theme.js";

const FAMILY = ["family1", "family2", "family3", "family4"];

export class ForcePlot {
  // `moved(contraction, settled)` is called as the point is dragged.
  constructor(moved) {
    this.moved = moved;
    this.levels = [];
    this.extras = [];
    this.chart = new Chart("force", 280, () => this.options());
    at("force").setAttribute("role", "img");
    at("force").setAttribute("aria-label", "Force against contraction, not known yet.");
  }

  options() {
    const lines = this.levels.map((level, k) => ({
      label: said(level.pressure, "Pa", 3), stroke: colour(level.present ? "accent" : FAMILY[k]),
      width: level.present ? 3 : 1.5, points: { show: false },
    }));
    const more = this.extras.map(({ name, hue, dots, dash }) => ({
      label: name, stroke: colour(hue), width: dots ? 0 : 2, dash, paths: dots ? () => null : undefined,
      points: { show: Boolean(dots), size: 5, width: 1.2, fill: "transparent", stroke: colour(hue) },
    }));
    return {
      series: [{ label: "contraction" }, ...lines, ...more, ring("state")],
      scales: { x: { time: false, range: (_, low, high) => [low - 0.34 * (high - low), high + 0.08 * (high - low)] }, y: { range: (_, low, high) => padded(Math.min(low, 0), high) } },
      axes: [axis("Contraction [%]", 28), axis("Force [N]", 50)],
      legend: { show: false },
      cursor: { show: true, x: false, y: false, drag: { x: false, y: false }, points: { show: false } },
      hooks: { ready: [(plot) => this.dragged(plot)], draw: [(plot) => this.label(plot)] },
    };
  }

  dragged(plot) {
    const { over } = plot;
    const move = (event, settled) => {
      const share = (event.clientX - over.getBoundingClientRect().left) / over.clientWidth;
      const { min, max } = plot.scales.x;
      this.moved((min + Math.min(Math.max(share, 0), 1) * (max - min)) / 100, settled);
    };
    over.addEventListener("pointerdown", (event) => {
      over.setPointerCapture(event.pointerId);
      move(event, false);
    });
    over.addEventListener("pointermove", (event) => over.hasPointerCapture(event.pointerId) && move(event, false));
    over.addEventListener("pointerup", (event) => move(event, true));
  }

  // Each line has its pressure where it begins, from the lowest up.
  label(plot) {
    const { ctx } = plot;
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.font = `${12 * ratio}px system-ui, sans-serif`;
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    const taken = [];
    for (const [k, level] of this.levels.entries()) {
      const first = level.force.findIndex((value, j) => level.good[j] && value !== null);
      if (first < 0) continue;
      const text = said(level.pressure, "Pa", 2);
      const x = plot.valToPos(shown(level.contraction[first], "contraction"), "x", true) - 6 * ratio;
      let y = plot.valToPos(level.force[first], "y", true);
      while (taken.some((other) => Math.abs(other - y) < 13 * ratio)) y -= ratio;
      taken.push(y);
      ctx.fillStyle = colour(level.present ? "accent" : FAMILY[k]);
      ctx.lineWidth = 4 * ratio;
      ctx.strokeStyle = colour("panel");
      ctx.strokeText(text, x, y);
      ctx.fillText(text, x, y);
    }
    ctx.restore();
  }

  // Further lines and points: measured ones, those of a second muscle. Each has a name, a hue, x and y in SI.
  add(extras) {
    this.extras = extras;
    if (this.levels.length) this.show(this.levels, this.point);
  }

  show(levels, point) {
    this.levels = levels;
    this.point = point;
    const tables = levels.map((level) => [
      level.contraction.map((value) => (value === null ? null : shown(value, "contraction"))),
      level.force.map((value, k) => (level.good[k] ? value : null)),
    ]).map(risen);
    for (const one of this.extras) tables.push(risen([one.x.map((value) => (value === null ? null : shown(value, "contraction"))), one.y]));
    const known = point && point.contraction !== null && point.force !== null;
    tables.push(known ? [[shown(point.contraction, "contraction")], [point.force]] : [[tables[0][0][0] ?? 0], [null]]);
    const data = uPlot.join(tables, tables.map((one) => one.slice(1).map(() => 1)));
    this.chart.show(data, [...levels.map((level) => `${level.pressure}${level.present}`), ...this.extras.map((one) => one.name)].join());
    at("force").setAttribute("aria-label", this.told(levels.find((level) => level.present), point));
    at("force-table").replaceChildren(table("Blocked force and free contraction", ["Pressure", "Blocked force", "Free contraction"],
      levels.map((level) => [said(level.pressure, "Pa", 3), said(level.blocked.value, "N"), said(level.free.value, "contraction")])));
    at("force-note").textContent = note(levels);
  }

  told(level, point) {
    const where = point && point.force !== null
      ? ` The state is at ${said(point.contraction, "contraction")} and ${said(point.force, "N")}.` : "";
    return `Force against contraction at ${this.levels.length} pressures. At ${said(level.pressure, "Pa", 3)} the blocked force is ` +
      `${said(level.blocked.value, "N")} and the free contraction ${said(level.free.value, "contraction")}.${where}`;
  }
}

function padded(low, high) {
  const span = Math.max(high - low, 1e-3);
  return [low - 0.04 * span, high + 0.1 * span];
}

// By rising contraction, as the plot wants it; states without a contraction are left out.
function risen([x, y]) {
  const order = [...x.keys()].filter((k) => x[k] !== null).sort((a, b) => x[a] - x[b]);
  return [order.map((k) => x[k]), order.map((k) => y[k])];
}

function note(levels) {
  const level = levels.find((one) => one.present);
  const lost = levels.map((one) => [one, one.good.filter((good) => !good).length]).filter(([, count]) => count);
  const left = lost.map(([one, count]) => `${count} states at ${said(one.pressure, "Pa", 3)}`);
  const own = level.blocked.value === null ? level.blocked.reason
    : `At ${said(level.pressure, "Pa", 3)}: ${said(level.blocked.value, "N")} blocked, ` +
      (level.free.value === null ? level.free.reason : `${digits(shown(level.free.value, "contraction"))} % free.`);
  return left.length ? `${own} Left out, because they are not stable: ${left.join(", ")}.` : own;
}
