// The verdict in words, the numbers of the state, its energies, its cautions.

import { at, el, svg } from "./dom.js";
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
  const line = sentence.startsWith(word) ? sentence.slice(word.length).replace(/^[:\s]+/, "") : sentence;
  at("verdict").className = kind;
  at("verdict").replaceChildren(
    el("span", { class: "badge", "aria-hidden": "true", text: mark }),
    el("div", {}, el("p", {}, el("strong", { text: WORDS[word] }), word in { working: 1, impossible: 1 } ? "" : ` (${word})`,
      line ? `: ${line}` : ""), more ? el("p", { class: "more", text: more }) : null));
}

export function numbers(rows) {
  at("numbers").replaceChildren(el("dl", {}, ...rows.flatMap(([name, value, unit]) => [
    el("dt", { text: name }), el("dd", { text: `${value.replace("-", "−")} ${unit}`.trim() }),
  ])));
}

export function cautions(lines) {
  at("cautions").replaceChildren(...lines.map((line) => el("li", { text: line })));
  at("cautions").hidden = !lines.length;
}

// Parts of the stored energy as one bar, and a legend with numbers.
export function energies(parts) {
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
