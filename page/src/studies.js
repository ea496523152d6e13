// Studies of the muscle: the size of effects, a fit to measured data, a design, which has a file of its own.

import { el, table } from "./dom.js";
import { design } from "./design.js";
import { digits, said } from "./format.js";
import { begin, Free } from "./free.js";
import { job, notes, taking } from "./jobs.js";
import { menu } from "./menu.js";
import { dialog } from "./notices.js";

const percent = (value) => (value === null || Math.abs(value) > 1e3 ? "–" : `${digits(value, 2)} %`);

function effects(line, store) {
  job(line, "Size of effects", "effects", store.asked(), (found) => [
    table(found.title, ["Effect", "Force", "", "Volume", "Fibre tension"], found.rows.map((row) => [
      `${row.effect}${row.assumed ? " (assumed size)" : ""}`, said(row.newtons, "N", 3), percent(row.force), percent(row.volume),
      percent(row.peak_fibre_tension)])),
    ...notes([
      ...found.rows.filter((row) => row.reason).map((row) => `${row.effect}: ${row.reason}`),
      "To have an effect in your muscle, switch it on among the effects, or write into a case file what stands here:",
      ...found.rows.map((row) => `${row.effect}: ${row.switch}`)]),
  ]);
}

function fit(line, store, measured) {
  const head = "Fit to measured data";
  if (!measured.data)
    return void dialog(head, el("p", { text: "There are no measured data yet: drop a CSV or XLSX file on the plot, or choose one below it." }));
  const free = new Free(store);
  begin(head, `Numbers are sought with which the forces differ least from those of ${measured.data.name}.`, free, [], (form) =>
    job(line, head, "fit", { ...store.asked(), data: measured.data.data, free: free.said() }, (found) => [
      table("What was found", ["Number", "value", "error", "interval", "searched"], found.rows),
      el("p", { text: `Forces are off by ${said(found.rms, "N", 3)} (rms).` }), ...notes(found.notes),
      taking(() => store.open(found.opened, store.now))], form));
}

export function studies(line, store, measured) {
  menu("studies", [
    ["Size of effects", () => effects(line, store), "effects"],
    ["Fit to measured data", () => fit(line, store, measured), "fit"],
    ["Design", () => design(line, store), "design"],
  ]);
}
