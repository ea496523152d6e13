// The working range: between which lengths the muscle can be held, over the pressure. It is found when all is at rest.

import { axis, Chart, ring } from "./chart.js";
import { at, table } from "./dom.js";
import { said, shown } from "./format.js";
import { colour } from "./theme.js";

const LEVELS = 5;
const REST = 600;

export class RangePlot {
  constructor(line, store) {
    Object.assign(this, { line, store, found: [], point: null, key: "", run: 0 });
    this.chart = new Chart("range", 210, () => this.options());
    at("range").setAttribute("role", "img");
    at("range").setAttribute("aria-label", "Working range over the pressure, not known yet.");
  }

  options() {
    const border = (label) => ({ label, stroke: colour("accent"), width: 2, points: { show: true, size: 5 } });
    return {
      series: [{ label: "pressure" }, border("longest"), border("shortest"),
        { label: "as made", stroke: colour("quiet"), width: 1, dash: [5, 5], points: { show: false } },
        ring("state")],
      bands: [{ series: [1, 2], fill: colour("band") }],
      scales: { x: { time: false, range: (_, low, high) => [low, high === low ? low + 1 : high + 0.05 * (high - low)] },
        y: { range: (_, low, high) => [0, 1.08 * high] } },
      axes: [axis("Pressure [bar]", 28), axis("Length [mm]", 50)],
      legend: { show: false },
      cursor: { show: false },
    };
  }

  // Something changed: the range of a changed muscle is found anew once nothing has moved for a moment.
  follow() {
    const { told } = this.store.now;
    const key = JSON.stringify([this.store.muscle(), told.top]);
    if (key === this.key) return;
    this.key = key;
    this.found = [];
    clearTimeout(this.timer);
    this.run += 1;
    at("range").classList.add("old");
    at("range-note").textContent = "The range follows when nothing moves.";
    this.timer = setTimeout(() => this.find(this.run), REST);
  }

  async find(run) {
    const asked = this.store.asked();
    const { most } = this.store.now.told;
    const found = [];
    for (let k = 0; k < LEVELS; k++) {
      at("range-note").textContent = `Looking for the ends: ${k} of ${LEVELS} pressures.`;
      let answer;
      try {
        answer = await this.line.ask("reach", { ...asked, hold: "force", value: 0, pressure: most * k / (LEVELS - 1) });
      } catch (error) {
        if (run === this.run) at("range-note").textContent = `No range: ${error.message}`;
        if (run === this.run) this.key = "";
        return;
      }
      if (run !== this.run) return;
      found.push(answer);
      this.found = found;
      this.draw();
    }
    const last = found.at(-1);
    at("range").classList.remove("old");
    at("range-note").textContent = last.shortest === null ? `No range at ${said(last.pressure, "Pa", 3)}: ${last.cause}`
      : `At ${said(last.pressure, "Pa", 3)} from ${said(last.shortest, "m")} to ${last.longest === null ? "no end: the fibres stretch" : said(last.longest, "m")}. ` +
        `It ends where ${last.cause.charAt(0).toLowerCase()}${last.cause.slice(1)}.`;
    at("range-table").replaceChildren(table("Lengths between which the muscle can be held", ["Pressure", "Shortest", "Longest"],
      found.map((one) => [said(one.pressure, "Pa", 3), said(one.shortest, "m"), said(one.longest, "m")])));
    at("range").setAttribute("aria-label", `Working range over the pressure. ${at("range-note").textContent}`);
  }

  move(point) {
    this.point = point;
    if (this.found.length) this.draw();
  }

  draw() {
    const mm = (value) => (value === null ? null : shown(value, "m"));
    const levels = this.found.map((one) => [shown(one.pressure, "Pa"), mm(one.longest), mm(one.shortest), mm(one.rest), undefined]);
    const known = this.point && this.point.length !== null && this.point.pressure !== null;
    if (known) levels.push([shown(this.point.pressure, "Pa"), undefined, undefined, undefined, mm(this.point.length)]);
    levels.sort((a, b) => a[0] - b[0]);
    this.chart.show([0, 1, 2, 3, 4].map((k) => levels.map((row) => row[k])), "range");
  }
}
