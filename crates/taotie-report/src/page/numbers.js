// @ts-check
// Number formatting, and the round numbers of axis ticks.

const MISSING = "\u2013";

/**
 * Formats a number with a fixed number of decimals and a thin space between thousands.
 * @param {number | null} value
 * @param {number} digits
 */
function written(value, digits) {
  if (value === null) return MISSING;
  const [whole, fraction] = Math.abs(value).toFixed(digits).split(".");
  const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole;
  const sign = value < 0 && Number(value.toFixed(digits)) !== 0 ? "\u2212" : "";
  return sign + grouped + (fraction ? "." + fraction : "");
}

/**
 * Formats a number as briefly as possible, for axis ticks.
 * @param {number} value
 */
function short(value) {
  const size = Math.abs(value);
  if (size >= 1e6) return Number((value / 1e6).toPrecision(3)) + "M";
  if (size >= 1e4) return Number((value / 1e3).toPrecision(3)) + "k";
  return String(Number(value.toPrecision(4)));
}

/**
 * Round numbers from 0 to `top`, about `wanted` of them.
 * @param {number} top
 * @param {number} wanted
 * @returns {number[]}
 */
function ticks(top, wanted) {
  if (!(top > 0)) return [0];
  const raw = top / wanted;
  const ten = 10 ** Math.floor(Math.log10(raw));
  const step = ten * ([1, 2, 5, 10].find((factor) => factor * ten >= raw * 0.999) ?? 10);
  const count = Math.floor(top / step + 1e-9);
  return Array.from({ length: count + 1 }, (_, i) => i * step);
}
