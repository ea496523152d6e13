// Numbers for people: SI in, mm, N, bar, mJ and per cent out.

const UNITS = {
  m: ["mm", 1e3], N: ["N", 1], Pa: ["bar", 1e-5], J: ["mJ", 1e3], contraction: ["%", 1e2],
};

export const shown = (value, unit) => value * UNITS[unit][1];
export const unitOf = (unit) => UNITS[unit][0];

export function digits(value, count = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (Math.abs(value) < 1e-9) return "0";
  const text = value.toPrecision(count);
  return String(Number(text)).replace("-", "−");
}

export const said = (value, unit, count = 4) =>
  value === null ? "–" : `${digits(shown(value, unit), count)} ${unitOf(unit)}`;

// A number as a field holds it: few digits, no minus sign of typography.
export const plain = (value) => String(Number(value.toPrecision(6)));
