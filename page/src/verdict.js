// The verdict in words, the numbers of the state, its energies, its cautions.

import { at, el, svg, table } from "./dom.js";
import { digits, said } from "./format.js";

const MARKS = {
  stable: ["✓", "good"], unstable: ["!", "doubt"], inadmissible: ["✕", "bad"], "no equilibrium": ["✕", "bad"],
  "not converged": ["?", "bad"], impossible: ["✕", "bad"], working: ["…", "wait"],
};
const WORDS = {
  stable: "It holds", unstable: "It gives way", inadmissible: "It would fold into itself",
  "no equilibrium": "It cannot be held there", "not converged": "No state was found",
  impossible: "Such a muscle cannot be", working: "One moment",
};
const HUES = ["e1", "e2", "e3", "e4", "e5", "e6", "e7"];

export function verdict(word, sentence, more = "") {
  const [mark, kind] = MARKS[word];
  at("verdict").className = kind;
  at("verdict").replaceChildren(
    el("span", { class: "badge", "aria-hidden": "true", text: mark }),
    el("div", {}, el("p", {}, el("strong", { text: `${WORDS[word]}. ` }), sentenced(sentence)),
      more ? el("p", { class: "more", text: more }) : null));
}

// With a capital at its beginning and a full stop at its end; names of fields stay as they are.
function sentenced(text) {
  const head = /^\w+\.\w/.test(text) ? text.charAt(0) : text.charAt(0).toUpperCase();
  return head + text.slice(1) + (/[.!?]$/.test(text) ? "" : ".");
}

// The numbers of the state, beside them those of a second muscle where there is one.
export function numbers(rows, others = null) {
  if (!rows.length) return void at("numbers").replaceChildren(el("p", { class: "quiet", text: "No numbers: there is no such state." }));
  const text = (row) => (row ? `${row[1].replace("-", "−")} ${row[2]}`.trim() : "–");
  if (!others) return void at("numbers").replaceChildren(el("dl", {}, ...rows.flatMap((row) => [
    el("dt", { text: row[0] }), el("dd", { text: text(row) })])));
  const second = new Map(others.map((row) => [row[0], row]));
  at("numbers").replaceChildren(table("", ["", "this muscle", "second"], rows.map((row) => [row[0], text(row), text(second.get(row[0]))])));
}

export function cautions(lines) {
  at("cautions").replaceChildren(...lines.map((line) => el("li", { text: line })));
  at("cautions").hidden = !lines.length;
}

// Parts of the stored energy as one bar, and a legend with numbers.
export function energies(parts) {
  if (!parts.length) return void at("energy").replaceChildren(el("p", { class: "quiet", text: "Not known." }));
  const total = parts.reduce((sum, part) => sum + part.value, 0);
  const share = (value) => (total > 0 ? Math.max(value, 0) / total : 0);
  let from = 0;
  const bar = svg("svg", { viewBox: "0 0 100 6", preserveAspectRatio: "none", "aria-hidden": "true", class: "bar" });
  const rows = parts.map((part, k) => {
    bar.append(svg("rect", { x: 100 * from, width: 100 * share(part.value), height: 6, class: HUES[k] }));
    from += share(part.value);
    return el("tr", {}, el("th", { scope: "row", title: part.meaning }, el("span", { class: `dot ${HUES[k]}` }), part.name),
      el("td", { text: said(part.value, "J", 3) }), el("td", { text: `${digits(100 * share(part.value), 3)} %` }));
  });
  rows.push(el("tr", { class: "sum" }, el("th", { scope: "row", text: "together" }), el("td", { text: said(total, "J", 4) }), el("td")));
  at("energy").replaceChildren(bar, el("table", { class: "legend" }, el("tbody", {}, ...rows)));
}
