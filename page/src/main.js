// The page put together: what changes is looked at, and what is seen follows.

import "uplot/dist/uPlot.min.css";
import "./page.css";
import { Bench } from "./bench.js";
import { at, el } from "./dom.js";
import { downloads, uploads } from "./files.js";
import { Form } from "./form.js";
import { Measured } from "./measured.js";
import { clear, notice } from "./notices.js";
import { ForcePlot } from "./plot.js";
import { RangePlot } from "./range.js";
import { Second } from "./second.js";
import { held, keep, sharing } from "./share.js";
import { Line, Newest } from "./socket.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";
import { studies } from "./studies.js";
import { cautions, energies, numbers, verdict } from "./verdict.js";

const line = new Line();
const store = new Store();
const stage = new Stage();
const bench = new Bench(store);
const form = new Form(store, choose);
const force = new ForcePlot((contraction, settled) => store.change({ hold: "contraction", value: contraction }, settled));
const range = new RangePlot(line, store);
const looks = new Newest(look);
const over = { measured: [], second: [] };
const measured = new Measured(line, store, (extras) => lay("measured", extras));
const second = new Second(line, store, (extras) => lay("second", extras), (rows) => {
  others = rows;
  numbers(own, others);
});
let levels = null;
let point = null;
let own = [];
let others = null;
let rested = 0;
let last = "";

// What lies over the curves beside their own point.
function lay(name, extras) {
  over[name] = extras;
  force.add([...over.measured, ...over.second]);
}

// Once the browser has painted, the time from the input is a measure that benchmarks read.
function painted(name, since) {
  requestAnimationFrame(() => setTimeout(() => performance.measure(name, { start: since })));
}

async function look({ asked, since }) {
  document.body.dataset.busy = true;
  const slow = setTimeout(() => working("the state is sought"), 400);
  try {
    const told = await line.ask("look", asked, (part, data) => {
      clearTimeout(slow);
      if (part === "state") seen(data, since);
      if (part === "preparing")
        working("this kind of muscle is new here, and is prepared once; that takes up to a minute");
    });
    levels = told.levels;
    bench.reach(levels);
    force.show(levels, point);
    painted("input to picture", since);
  } catch (error) {
    last = "";
    if (error.kind === "error") impossible(error.message);
    else if (error.kind === "busy") working(error.message);
    if (error.kind === "busy") setTimeout(() => looks.wanted ?? looks.ask({ asked: store.asked(), since }), 1000);
  } finally {
    clearTimeout(slow);
    document.body.dataset.busy = looks.wanted !== null;
  }
}

// What is shown is not what is asked for until the answer comes.
function working(words) {
  document.body.dataset.stale = true;
  verdict("working", words);
}

function seen(state, since) {
  document.body.dataset.stale = false;
  point = state.good ? state.point : state.last;
  bench.point = point;
  verdict(state.verdict, state.said, state.drawn);
  own = state.numbers;
  numbers(own, others);
  energies(state.energy);
  cautions(state.cautions);
  form.stiffness(state.law);
  stage.show(state.shape, state.good ? "" : state.last ? "Last good state" : "As made");
  range.move(point);
  painted("input to shape", since);
}

function impossible(message) {
  document.body.dataset.stale = true;
  verdict("impossible", message);
  at("stage").classList.add("old");
}

store.addEventListener("change", ({ detail: { settled, opened } }) => {
  const since = performance.now();
  if (opened) {
    form.build();
    stage.fit();
    pick();
  }
  form.show();
  bench.show();
  const asked = store.asked();
  const key = JSON.stringify(asked);
  if (key !== last) looks.ask({ asked, since }); // letting go of a slider changes nothing
  last = key;
  range.follow();
  second.follow();
  clearTimeout(rested);
  rested = setTimeout(() => measured.follow(), settled ? 0 : 300);
  at("undo").disabled = !store.past.length;
  at("redo").disabled = !store.future.length;
  if (settled) keep(store);
});

function pick() {
  const name = store.now.told.from.preset ?? "";
  at("preset").value = name;
  if (at("preset").value !== name || !name) at("preset").value = "";
}

async function open(muscle, bench) {
  try {
    store.open(await line.ask("open", muscle), bench);
  } catch (error) {
    notice(`The muscle was not opened: ${error.message}`, "wrong");
    return false;
  }
  return true;
}

// Another choice makes another kind of muscle, with other numbers: it is opened anew, pressure and load stay.
async function choose(name, value) {
  const { pressure, hold, value: amount } = store.now;
  const done = await open({ ...store.muscle(), choose: { [name]: value } }, { pressure, hold, value: amount });
  if (!done) form.show();
}

async function begin() {
  const { presets, start } = await (await fetch("start")).json();
  at("preset").append(el("option", { value: "", text: "another" }),
    ...presets.map(({ name, about }) => el("option", { value: name, text: name, title: about })));
  at("preset").addEventListener("change", () => at("preset").value && open({ from: { preset: at("preset").value } }));
  if (!(await fromLink())) await open(start);
}

// The muscle of the address line; false where it holds none, or one that cannot be.
async function fromLink() {
  try {
    const asked = held();
    return asked ? await open(asked.muscle, asked) : false;
  } catch (error) {
    notice(error.message, "wrong");
    return false;
  }
}

downloads(store);
studies(line, store, measured);
sharing(store);
uploads((told) => store.open(told));
at("undo").addEventListener("click", () => store.undo());
at("redo").addEventListener("click", () => store.redo());
addEventListener("hashchange", fromLink);
addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.target.matches("input[type=text]")) return;
  const back = event.key === "z" && !event.shiftKey;
  const again = event.key === "y" || (event.key.toLowerCase() === "z" && event.shiftKey);
  if (back) store.undo();
  if (again) store.redo();
  if (back || again) event.preventDefault();
});
line.addEventListener("open", () => {
  clear("lost");
  if (store.now) looks.ask({ asked: store.asked(), since: performance.now() });
  else begin();
});
line.addEventListener("lost", () => notice("The connection to mckibben serve was lost; it is tried again.", "lost"));
line.addEventListener("refused", ({ detail }) => notice(detail, "wrong"));
