// Where the shape is seen: in three dimensions where the browser can, else flat; with the scale of its colours.

import { at, el } from "./dom.js";
import { Flat } from "./flat.js";
import { digits } from "./format.js";
import { Shape3D } from "./shape3d.js";
import { colour, css, mapped, niceAbove } from "./theme.js";

const KEYS = "Arrow keys turn it, plus and minus bring it nearer or farther, Home puts it back.";

export class Stage {
  constructor(name = "") {
    this.place = at(`stage${name}`);
    this.name = name ? "Second muscle" : "Shape of the muscle";
    const canvas = el("canvas", { tabindex: 0, role: "img", "aria-label": this.name });
    this.place.append(canvas);
    this.canvas = canvas;
    try {
      this.view = new Shape3D(canvas);
    } catch {
      canvas.remove();
      this.place.setAttribute("role", "img");
      this.canvas = this.place;
      this.view = new Flat(this.place);
    }
    this.flat = this.view instanceof Flat;
    const said = this.flat ? "Drawn flat: this browser has no WebGL." : "Drag to turn.";
    this.note = el("p", { class: "quiet note" });
    this.hint = said;
    at(`scale${name}`).append(this.note, this.bar());
  }

  bar() {
    const stops = Array.from({ length: 16 }, (_, k) => css(mapped(k / 15)));
    this.low = el("span", { text: "0" });
    this.high = el("span");
    this.ramp = el("span", { class: "ramp" });
    this.ramp.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    this.words = el("div", { class: "colours" }, el("span", { text: "Fibre tension" }), this.low, this.ramp, this.high);
    return this.words;
  }

  // A new muscle: the view is fitted anew, and stays while its length changes.
  fit() {
    this.wide = 0;
    this.tall = 0;
  }

  show(shape, old) {
    const long = shape.z.at(-1) - shape.z[0] + 0.8 * shape.rest;
    const high = 2.4 * Math.max(...shape.r);
    if (long > this.wide || long < 0.45 * this.wide) this.wide = 1.08 * long;
    if (high > this.tall || high < 0.5 * this.tall) this.tall = 1.05 * high;
    const { tension } = shape;
    this.words.hidden = !tension;
    const low = tension ? Math.min(0, ...tension) : 0;
    const high_ = tension ? niceAbove(Math.max(...tension)) : 1;
    const least = low < -1e-3 * high_ ? -niceAbove(-low) : 0;
    this.low.textContent = digits(least);
    this.high.textContent = `${digits(high_)} N`;
    const plain = rgb(colour("fibre"));
    const tint = tension ? (place) => mapped((between(tension, place) - least) / (high_ - least)) : () => plain;
    this.view.show(shape, tint, this.wide, this.tall);
    const size = `${digits(1e3 * (shape.z.at(-1) - shape.z[0]))} mm long, ${digits(2e3 * Math.max(...shape.r))} mm wide`;
    this.note.textContent = `${old ? `${old}, ` : ""}${size}. ${this.hint}`;
    this.canvas.setAttribute("aria-label", `${this.name}, ${size}.${this.flat ? "" : ` ${KEYS}`}`);
    this.place.classList.toggle("old", old !== "");
  }
}

function between(values, place) {
  const k = Math.min(Math.floor(place), values.length - 2);
  return values[k] + (place - k) * (values[k + 1] - values[k]);
}

function rgb(hex) {
  return [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
}
