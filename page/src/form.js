// The muscle's own controls: a slider for each number in its group, a choice for each effect.

import { at, el } from "./dom.js";
import { Slider } from "./slider.js";

let made = 0;

export class Form {
  // `choose(name, value)` is called for a choice, which makes the muscle one of another kind.
  constructor(store, choose) {
    this.store = store;
    this.choose = choose;
    this.root = at("form");
    this.root.addEventListener("submit", (event) => event.preventDefault());
  }

  build() {
    const { told } = this.store.now;
    this.sliders = new Map();
    this.selects = new Map();
    const groups = new Map();
    for (const one of told.sliders) {
      const slider = new Slider({ ...one, hint: one.meaning, mark: one.assumed ? "assumed" : "" },
        (value, settled) => this.store.changeField(one.name, value, settled));
      slider.root.title = one.source || one.meaning;
      this.sliders.set(one.name, slider);
      if (!groups.has(one.group)) groups.set(one.group, []);
      groups.get(one.group).push(slider.root);
    }
    if (told.choices.length) groups.set("Effects", told.choices.map((one) => this.choice(one)));
    this.root.replaceChildren(...[...groups].map(([name, controls]) =>
      el("fieldset", {}, el("legend", { text: name }), ...controls)));
    at("about").replaceChildren(el("strong", { text: told.name }), told.about ? `: ${told.about}. ` : ". ", told.remark);
    const assumed = told.assumed.map((one) => el("li", {}, el("code", { text: one.name }), ` ${one.meaning}`));
    at("assumed").hidden = !assumed.length;
    at("assumed").querySelector("ul").replaceChildren(...assumed);
    at("assumed").querySelector("summary").textContent = `${assumed.length} values are assumed, not measured`;
    this.show();
  }

  choice(one) {
    const id = `choice-${++made}`;
    const select = el("select", { id, on: { change: () => this.choose(one.name, one.options[select.selectedIndex][0]) } },
      ...one.options.map(([, word]) => el("option", { text: word })));
    this.selects.set(one.name, { select, one });
    return el("div", { class: "choice", title: one.meaning },
      el("span", { class: "name" }, el("label", { for: id, text: one.label }),
        one.assumed ? el("span", { class: "mark", text: "assumed" }) : null), select);
  }

  show() {
    for (const one of this.store.now.told.sliders) {
      const slider = this.sliders.get(one.name);
      slider.set(this.store.shown(one));
      slider.root.classList.toggle("changed", one.name in this.store.now.changes);
    }
    for (const { select, one } of this.selects.values()) {
      const value = this.store.now.changes[one.name] ?? one.value;
      select.selectedIndex = one.options.findIndex(([option]) => option === value);
    }
  }
}
