// A design: what is wanted, one goal or two against each other, within limits.

import { el, table } from "./dom.js";
import { plain, shown } from "./format.js";
import { begin, Free } from "./free.js";
import { Front } from "./front.js";
import { job, notes, taking } from "./jobs.js";
import { notice } from "./notices.js";

function field(label, unit, value = "") {
  const input = el("input", { type: "text", inputmode: "decimal", size: 7, value, "aria-label": unit ? `${label}, in ${unit}` : label });
  return { input, root: el("p", { class: "wish" }, el("span", { text: label }), input, el("span", { class: "unit", text: unit })) };
}

// What can be wanted at a pressure, and there at a contraction.
const GOALS = {
  "largest force there": (place, there) => ({ maximise: "force", ...there }),
  "largest free contraction": (place) => ({ maximise: "stroke", ...place }),
  "smallest diameter": (place) => ({ minimise: "diameter", ...place }),
  "least air there": (place, there) => ({ minimise: "air-volume", ...there }),
  "smallest mass": () => ({ minimise: "mass" }),
};
const ALONE = "nothing else";
const TRIED = { one: "300", front: "1000" };

function choice(label, words) {
  const select = el("select", { "aria-label": label }, ...words.map((text) => el("option", { text })));
  return { select, root: el("p", { class: "wish" }, el("span", { text: label }), select) };
}

export function design(line, store) {
  const head = "Design";
  const free = new Free(store);
  const pressure = field("At a pressure of", "bar", plain(shown(store.now.told.top, "Pa")));
  const contraction = field("and a contraction of", "%", "5");
  const goal = choice("Wanted", Object.keys(GOALS));
  const other = choice("and against it", [ALONE, ...Object.keys(GOALS)]);
  const limits = { force: field("Force there at least", "N"), stroke: field("Free contraction at least", "%"), diameter: field("Largest diameter at most", "mm") };
  const count = field("Designs that are tried", "", TRIED.one);
  other.select.addEventListener("change", () => {
    const [before, now] = other.select.selectedIndex ? [TRIED.one, TRIED.front] : [TRIED.front, TRIED.one];
    if (count.input.value === before) count.input.value = now;
  });
  begin(head, "The muscle is sought that does best what is wanted, within limits; empty ones do not count. " +
    "Of two goals against each other all best compromises are found.", free,
    [pressure.root, contraction.root, goal.root, other.root, ...Object.values(limits).map(({ root }) => root), count.root], (form) => {
      const place = { pressure: `${pressure.input.value} bar` };
      const there = { ...place, contraction: `${contraction.input.value} %` };
      const words = new Set([goal.select.value, other.select.value].filter((word) => word !== ALONE));
      const wanted = [...words].map((word) => GOALS[word](place, there));
      const wished = [
        [limits.force, { measure: "force", ...there, at_least: `${limits.force.input.value} N` }],
        [limits.stroke, { measure: "stroke", ...place, at_least: `${limits.stroke.input.value} %` }],
        [limits.diameter, { measure: "diameter", ...place, at_most: `${limits.diameter.input.value} mm` }],
      ].filter(([{ input }]) => input.value.trim()).map(([, limit]) => limit);
      const wish = { ...store.asked(), free: free.said(), objective: wanted.length > 1 ? wanted : wanted[0], subject_to: wished, designs: Number(count.input.value) };
      job(line, head, "design", wish, (found) => (found.front ? front(line, store, found) : best(store, found)), form);
    });
}

function best(store, found) {
  return [
    el("p", { text: found.feasible ? `The best of ${found.tried} designs.` : "No design meets all limits together; this one misses least." }),
    table("What was found", ["Number", "value", "searched"], found.rows),
    found.limits.length ? table("Limits", ["Limit", "value", "room"], found.limits) : null,
    ...notes(found.notes), taking(() => store.open(found.opened, store.now))].filter(Boolean);
}

function front(line, store, found) {
  const shown = new Front(found.front);
  return [
    el("p", { text: `The ${found.front.muscles.length} best compromises of ${found.tried} designs: none of them is better in both goals than another.` }),
    shown.root, ...notes(found.notes),
    taking(() => line.ask("open", shown.muscle()).then((told) => store.open(told, store.now),
      (error) => notice(`The muscle was not opened: ${error.message}`, "wrong")))];
}
