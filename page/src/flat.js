// The muscle from the side, drawn flat: for browsers without WebGL.

import { svg } from "./dom.js";
import { drums } from "./geometry.js";
import { css } from "./theme.js";

const FIBRES = 24;

export class Flat {
  constructor(place) {
    this.root = svg("svg", { class: "flat", preserveAspectRatio: "xMidYMid meet", "aria-hidden": "true" });
    place.append(this.root);
  }

  show(shape, tint, wide, high) {
    const middle = 0.5 * (shape.z[0] + shape.z.at(-1));
    const tall = 1.15 * high;
    this.root.setAttribute("viewBox", [middle - 0.55 * wide, -0.5 * tall, 1.1 * wide, tall].join(" "));
    const points = (side) => shape.r.map((r, k) => `${shape.z[k]},${side * r}`);
    const outline = svg("polygon", { points: [...points(1), ...points(-1).reverse()].join(" "), class: "wall" });
    const ends = drums(shape).map(({ radius, long, middle: z }) =>
      svg("rect", { x: z - long / 2, y: -radius, width: long, height: 2 * radius, class: "drum" }));
    const drawn = Math.min(shape.fibres / 2, FIBRES);
    const strands = [1, -1].flatMap((hand) => Array.from({ length: drawn }, (_, k) =>
      this.strand(shape, hand, (2 * Math.PI * k) / drawn, tint)).flat());
    this.root.replaceChildren(outline, ...strands, ...ends);
  }

  // The pieces of a fibre that are on the near side, each in its colour.
  strand(shape, hand, start, tint) {
    const pieces = [];
    for (let k = 0; k + 1 < shape.r.length; k++) {
      const [a, b] = [k, k + 1].map((j) => start + hand * shape.turn[j]);
      if (Math.cos(0.5 * (a + b)) < 0) continue;
      pieces.push(svg("line", {
        x1: shape.z[k], y1: shape.r[k] * Math.sin(a), x2: shape.z[k + 1], y2: shape.r[k + 1] * Math.sin(b),
        stroke: css(tint(k + 0.5)), "stroke-width": shape.diameter,
      }));
    }
    return pieces;
  }
}
