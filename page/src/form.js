// The muscle's own controls: a slider for each number in its group, a choice for each effect.

import { at, el } from "./dom.js";
import { Slider } from "./slider.js";

const PASSING = 500;
let made = 0;

export class Form {
  // `choose(name, value)` is called for a choice, which makes the muscle one of another kind.
  constructor(store, choose) {
    this.store = store;
    this.choose = choose;
    this.root = at("form");
    this.root.addEventListener("submit", (event) => event.preventDefault());
  }

  // A control that had the focus has it afterwards, or somebody without a mouse would begin anew.
  build() {
    const { told } = this.store.now;
    const focused = this.root.contains(document.activeElement) ? document.activeElement.dataset : {};
    this.sliders = new Map();
    this.selects = new Map();
    const groups = new Map(told.groups.map((name) => [name, []]));
    for (const one of told.sliders) {
      const slider = new Slider({ ...one, hint: one.meaning, mark: one.assumed ? "assumed" : "" },
        (value, settled) => this.store.changeField(one.name, value, settled));
      slider.root.title = one.source || one.meaning;
      Object.assign(slider.field.dataset, { of: one.name, as: "field" });
      Object.assign(slider.range.dataset, { of: one.name, as: "range" });
      this.sliders.set(one.name, slider);
      groups.get(one.group).push(slider.root);
    }
    for (const one of [...told.choices].reverse()) {
      groups.get(one.group).unshift(this.choice(one));
    }
    this.left = null;
    this.law = el("p", { class: "quiet" });
    if (groups.get("Rubber").length) groups.get("Rubber").push(this.law);
    this.root.replaceChildren(...[...groups].filter(([, controls]) => controls.length).map(([name, controls]) =>
      el("fieldset", {}, el("legend", { text: name }), ...controls)));
    at("about").replaceChildren(el("strong", { text: told.name }), told.about ? `: ${told.about}. ` : ". ", told.remark);
    const again = focused.of && this.root.querySelector(`[data-of="${CSS.escape(focused.of)}"][data-as="${focused.as}"]`);
    if (again) again.focus();
    this.show();
  }

  assumed(left) {
    const key = left.map(({ name }) => name).join();
    if (this.left === key) return; // most of the time a slider only moves on
    this.left = key;
    const box = at("assumed");
    box.hidden = !left.length;
    box.querySelector("ul").replaceChildren(...left.map((one) => el("li", {}, el("code", { text: one.name }), ` ${one.meaning}`)));
    box.querySelector("summary").textContent = `${left.length} values are assumed, not measured`;
  }

  choice(one) {
    const id = `choice-${++made}`;
    let [keys, soon] = [false, 0]; // by keyboard the words in between are passed, not meant
    const taken = () => this.choose(one.name, one.options[select.selectedIndex][0]);
    const change = () => (clearTimeout(soon), (soon = setTimeout(taken, keys ? PASSING : 0)));
    const select = el("select", { id, on: { change, keydown: () => (keys = true), pointerdown: () => (keys = false) } },
      ...one.options.map(([, word]) => el("option", { text: word })));
    Object.assign(select.dataset, { of: one.name, as: "choice" });
    this.selects.set(one.name, { select, one });
    return el("div", { class: "choice", title: one.meaning },
      el("span", { class: "name" }, el("label", { for: id, text: one.label }),
        one.assumed ? el("span", { class: "mark", text: "assumed" }) : null), select);
  }

  // How stiff the rubber is, as the state that is seen has it.
  stiffness(words) {
    this.law.textContent = words && `${words[0].toUpperCase()}${words.slice(1)}.`;
  }

  show() {
    const { told, changes } = this.store.now;
    const given = new Set(Object.keys(changes).map(field)); // what was given is assumed no longer
    for (const one of told.sliders) {
      const slider = this.sliders.get(one.name);
      slider.set(this.store.shown(one));
      slider.root.classList.toggle("changed", one.name in changes);
      slider.root.querySelector(".mark")?.toggleAttribute("hidden", given.has(field(one.name)));
    }
    this.assumed(told.assumed.filter(({ name }) => !given.has(name)));
    for (const { select, one } of this.selects.values()) {
      select.selectedIndex = one.options.findIndex(([option]) => option === one.value);
    }
  }
}

// The field that a number is of: of one of a list that of the list.
function field(name) {
  return name.split("[")[0];
}
