// From the numbers of a shape to triangles: one fibre of each hand, which is then turned around; the chamber; fittings.
// Nothing of the mechanics is here: radius, height and how far a fibre has gone round come from the server.

const lerp = (values, place) => {
  const k = Math.min(Math.floor(place), values.length - 2);
  return values[k] + (place - k) * (values[k + 1] - values[k]);
};

// The meridian at a share of its length: r, z, the unit normal (outward, along), and how far round a fibre is.
function meridian(shape, share) {
  const place = share * (shape.r.length - 1);
  const k = Math.min(Math.max(Math.floor(place), 1), shape.r.length - 3);
  const dr = shape.r[k + 1] - shape.r[k - 1];
  const dz = shape.z[k + 1] - shape.z[k - 1];
  const size = Math.hypot(dr, dz) || 1;
  const at = (name) => lerp(shape[name], place);
  return { r: at("r"), z: at("z"), nr: dz / size, nz: -dr / size, turn: at("turn"), place };
}

// Centre line of a fibre: over the others at every second crossing, under them between; where that is too fine to be
// drawn, those of one hand lie over the others.
function centre(shape, hand, share, weave) {
  const { r, z, nr, nz, turn, place } = meridian(shape, share);
  const out = 0.5 * hand * shape.diameter * (weave ? Math.cos(0.5 * shape.fibres * turn) : 0.5);
  const angle = hand * turn;
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const radius = r + out * nr;
  return { point: [radius * c, radius * s, z + out * nz], normal: [nr * c, nr * s, nz], place };
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => a.map((value, k) => value - b[k]);
const unit = (a) => {
  const size = Math.hypot(...a) || 1;
  return a.map((value) => value / size);
};

// A fibre as a round bar. `tint(place)` is its colour at a place of the meridian.
export function fibre(shape, hand, samples, sides, weave, tint) {
  const line = Array.from({ length: samples }, (_, k) => centre(shape, hand, k / (samples - 1), weave));
  const count = samples * sides;
  const [position, normal, colour] = [0, 1, 2].map(() => new Float32Array(3 * count));
  line.forEach(({ point, normal: up, place }, k) => {
    const along = unit(minus(line[Math.min(k + 1, samples - 1)].point, line[Math.max(k - 1, 0)].point));
    const side = unit(cross(along, up));
    const top = cross(side, along);
    const rgb = tint(place);
    for (let j = 0; j < sides; j++) {
      const angle = (2 * Math.PI * j) / sides;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      for (let i = 0; i < 3; i++) {
        const n = c * top[i] + s * side[i];
        const at = 3 * (k * sides + j) + i;
        normal[at] = n;
        position[at] = point[i] + 0.5 * shape.diameter * n;
        colour[at] = rgb[i];
      }
    }
  });
  return { position, normal, colour, index: grid(samples, sides) };
}

// The outer face of the chamber, just inside the fibres.
export function chamber(shape, around) {
  const along = shape.r.length;
  const [position, normal] = [0, 1].map(() => new Float32Array(3 * along * around));
  for (let k = 0; k < along; k++) {
    const { r, z, nr, nz } = meridian(shape, k / (along - 1));
    const under = 1.2 * shape.diameter;
    const radius = Math.max(r - under * nr, 0);
    for (let j = 0; j < around; j++) {
      const angle = (2 * Math.PI * j) / around;
      const at = 3 * (k * around + j);
      position.set([radius * Math.cos(angle), radius * Math.sin(angle), z - under * nz], at);
      normal.set([nr * Math.cos(angle), nr * Math.sin(angle), nz], at);
    }
  }
  return { position, normal, index: grid(along, around) };
}

// Triangles of a grid that is closed around.
function grid(rows, columns) {
  const index = [];
  for (let k = 0; k + 1 < rows; k++)
    for (let j = 0; j < columns; j++) {
      const next = (j + 1) % columns;
      const [a, b, c, d] = [k * columns + j, k * columns + next, (k + 1) * columns + j, (k + 1) * columns + next];
      index.push(a, b, c, b, d, c);
    }
  return index;
}

// Radius, length and middle of the drums at both ends.
export function drums(shape) {
  const long = 0.4 * shape.rest;
  return [0, shape.r.length - 1].map((end) => ({
    radius: shape.r[end] + shape.diameter + 0.04 * shape.rest, long,
    middle: shape.z[end] + (end ? 1 : -1) * (0.5 * long - shape.diameter),
  }));
}
