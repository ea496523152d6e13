// Colours: those of the style sheet for what is drawn on canvas, and the map of tensions.

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

const dark = matchMedia("(prefers-color-scheme: dark)");
export const onTheme = (does) => dark.addEventListener("change", does);
export const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

// viridis: even steps to the eye, also to those who do not see red and green apart.
const VIRIDIS = [
  [68, 1, 84], [72, 26, 108], [71, 47, 125], [65, 68, 135], [57, 86, 140], [49, 104, 142], [42, 120, 142],
  [35, 136, 142], [31, 152, 139], [34, 168, 132], [53, 183, 121], [84, 197, 104], [122, 209, 81], [165, 219, 54],
  [210, 226, 27], [253, 231, 37],
];

// The colour at a share from 0 to 1, as red, green and blue from 0 to 1.
export function mapped(share) {
  const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(place), VIRIDIS.length - 2);
  return VIRIDIS[k].map((from, i) => (from + (place - k) * (VIRIDIS[k + 1][i] - from)) / 255);
}

export const css = (rgb) => `rgb(${rgb.map((part) => Math.round(255 * part)).join(",")})`;

// A round number at or above a value, so that scales do not tremble.
export function niceAbove(value) {
  if (!(value > 0)) return 1;
  const size = 10 ** Math.floor(Math.log10(value));
  return size * [1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((step) => step * size >= value * (1 - 1e-9));
}
