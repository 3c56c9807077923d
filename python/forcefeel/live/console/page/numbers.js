// Numbers as people read them.

const MINUS = "\u2212";

// With as many decimals as three digits need.
export function text(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const whole = size < 1 ? 1 : Math.floor(Math.log10(size) + 1e-9) + 1;
  const fixed = value.toFixed(Math.max(digits - whole, 0));
  return (Number(fixed) === 0 ? fixed.replace("-", "") : fixed).replace("-", MINUS);
}

// A mark of an axis whose marks are so far apart, with the decimals of that distance: 2.5 has one more than 2 or 5.
export function tick(value, apart) {
  const [digits, power] = apart.toExponential(6).split("e");
  const fixed = value.toFixed(Math.max(0, digits.replace(/\.?0+$/, "").replace(".", "").length - 1 - Number(power)));
  return (Number(fixed) === 0 ? "0" : fixed).replace("-", MINUS);
}

// A step of 1, 2 or 5 times a power of ten that divides a span into about so many.
export function step(span, parts) {
  const rough = span / parts;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * (rough / power < 1.5 ? 1 : rough / power < 3.5 ? 2 : rough / power < 7.5 ? 5 : 10);
}

// Limits around values that stay as they are while values stay between two steps; at least so far apart.
export function calm(low, high, least) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [-least / 2, least / 2];
  const room = Math.max(high - low, least);
  const by = step(room, 4);
  const middle = (low + high) / 2;
  const from = Math.min(low, middle - least / 2);
  const to = Math.max(high, middle + least / 2);
  return [Math.floor(from / by) * by, Math.ceil(to / by) * by];
}
