// Studies of the muscle: the size of effects, a fit to measured data, a design.

import { el, table } from "./dom.js";
import { digits, plain, said, shown } from "./format.js";
import { Free } from "./free.js";
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

function begin(head, words, free, more, does) {
  const form = el("form", { autocomplete: "off" }, el("p", { text: words }), free.root, ...more,
    el("button", { type: "submit", class: "main", text: "Begin" }));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    does();
  });
  dialog(head, form);
}

function fit(line, store, measured) {
  const head = "Fit to measured data";
  if (!measured.data)
    return void dialog(head, el("p", { text: "There are no measured data yet: drop a CSV or XLSX file on the plot, or choose one below it." }));
  const free = new Free(store);
  begin(head, `Numbers are sought with which the forces differ least from those of ${measured.data.name}.`, free, [], () =>
    job(line, head, "fit", { ...store.asked(), data: measured.data.data, free: free.said() }, (found) => [
      table("What was found", ["Number", "value", "error", "interval", "searched"], found.rows),
      el("p", { text: `Forces are off by ${said(found.rms, "N", 3)} (rms).` }), ...notes(found.notes),
      taking(() => store.open(found.opened, store.now))]));
}

function field(label, unit, value = "") {
  const input = el("input", { type: "text", inputmode: "decimal", size: 7, value, "aria-label": `${label}, in ${unit}` });
  return { input, root: el("p", { class: "wish" }, el("span", { text: label }), input, el("span", { class: "unit", text: unit })) };
}

function design(line, store) {
  const head = "Design";
  const free = new Free(store);
  const pressure = field("At a pressure of", "bar", plain(shown(store.now.told.top, "Pa")));
  const contraction = field("and a contraction of", "%", "5");
  const goal = el("select", { "aria-label": "What is wanted" },
    ...["largest force there", "largest free contraction", "smallest diameter"].map((text) => el("option", { text })));
  const limits = { force: field("Force there at least", "N"), stroke: field("Free contraction at least", "%"), diameter: field("Largest diameter at most", "mm") };
  const count = field("Designs that are tried", "", "300");
  begin(head, "The muscle is sought that does best what is wanted, within limits; empty ones do not count.", free,
    [pressure.root, contraction.root, el("p", { class: "wish" }, el("span", { text: "Wanted" }), goal),
      ...Object.values(limits).map(({ root }) => root), count.root], () => {
      const place = { pressure: `${pressure.input.value} bar` };
      const there = { ...place, contraction: `${contraction.input.value} %` };
      const goals = [{ maximise: "force", ...there }, { maximise: "stroke", ...place }, { minimise: "diameter", ...place }];
      const wished = [
        [limits.force, { measure: "force", ...there, at_least: `${limits.force.input.value} N` }],
        [limits.stroke, { measure: "stroke", ...place, at_least: `${limits.stroke.input.value} %` }],
        [limits.diameter, { measure: "diameter", ...place, at_most: `${limits.diameter.input.value} mm` }],
      ].filter(([{ input }]) => input.value.trim()).map(([, limit]) => limit);
      const wish = { ...store.asked(), free: free.said(), objective: goals[goal.selectedIndex], subject_to: wished, designs: Number(count.input.value) };
      job(line, head, "design", wish, (found) => [
        el("p", { text: found.feasible ? `The best of ${found.tried} designs.` : "No design meets all limits together; this one misses least." }),
        table("What was found", ["Number", "value", "searched"], found.rows),
        found.limits.length ? table("Limits", ["Limit", "value", "room"], found.limits) : null,
        ...notes(found.notes), taking(() => store.open(found.opened, store.now))].filter(Boolean));
    });
}

export function studies(line, store, measured) {
  menu("studies", [
    ["Size of effects", () => effects(line, store), "effects"],
    ["Fit to measured data", () => fit(line, store, measured), "fit"],
    ["Design", () => design(line, store), "design"],
  ]);
}
