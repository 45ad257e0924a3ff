// @ts-check
// The figures of an asset, and sorting by them.

/**
 * An asset, as documented in `mod.rs`.
 * @typedef {{
 *   id: string, title?: string, state: string, error?: string, unmet?: string[], warnings?: string[],
 *   thumbnail?: string, turntable?: string, viewer?: string, report?: string, model?: string,
 *   photographs?: number, sigma?: number, p95_sigma?: number, triangles_in?: number, triangles?: number, bytes_in?: number, bytes_out?: number, mean_angle?: number,
 *   p95_angle?: number, max_angle?: number, mean_color?: number, hausdorff?: number, missed?: number,
 *   seconds?: number, peak_bytes?: number
 * }} Asset
 * @typedef {{ name: string, key: string, of: (asset: Asset) => number | undefined, text: (value: number) => string }} Figure
 */

const percent = (/** @type {number} */ value) => written(value * 100, 3) + "\u202f%";
/** Three decimals for angles that two would show as zero. */
const degrees = (/** @type {number} */ value) => written(value, Math.abs(value) < 0.01 ? 3 : 2) + "°";

/**
 * @param {number} value
 */
function bytes(value) {
  if (value >= 1e9) return written(value / 1e9, 2) + "\u202fGB";
  if (value >= 1e6) return written(value / 1e6, 1) + "\u202fMB";
  return written(value / 1e3, 0) + "\u202fkB";
}

/**
 * @param {number} value
 */
function time(value) {
  if (value >= 5400) return written(value / 3600, 1) + "\u202fh";
  if (value >= 90) return written(value / 60, 1) + "\u202fmin";
  return written(value, 1) + "\u202fs";
}

/** @type {Figure[]} */
const FIGURES = [
  { name: "normal error, overview, mean", key: "mean", of: (asset) => asset.mean_angle, text: degrees },
  { name: "normal error, overview, 95\u202f%", key: "p95", of: (asset) => asset.p95_angle, text: degrees },
  { name: "normal error, overview, largest sampled", key: "max", of: (asset) => asset.max_angle, text: degrees },
  { name: "uncertainty of normals, median", key: "sigma", of: (asset) => asset.sigma, text: degrees },
  { name: "uncertainty of normals, 95\u202f%", key: "sigma95", of: (asset) => asset.p95_sigma, text: degrees },
  { name: "colour error, overview, mean", key: "color", of: (asset) => asset.mean_color, text: (value) => written(value, 2) + "\u202fΔE" },
  { name: "largest distance (Hausdorff), bound", key: "shape", of: (asset) => asset.hausdorff, text: percent },
  { name: "missed, close-up", key: "missed", of: (asset) => asset.missed, text: percent },
  { name: "size of the asset", key: "bytes", of: (asset) => asset.bytes_out, text: bytes },
  { name: "size of the scan or photographs", key: "scan", of: (asset) => asset.bytes_in, text: bytes },
  { name: "triangles of the scan", key: "triangles", of: (asset) => asset.triangles_in, text: (value) => written(value, 0) },
  { name: "photographs", key: "photographs", of: (asset) => asset.photographs, text: (value) => written(value, 0) },
  { name: "time", key: "time", of: (asset) => asset.seconds, text: time },
  { name: "memory", key: "memory", of: (asset) => asset.peak_bytes, text: bytes },
];

/** The states, worst first, with their labels and tones. */
const STATES = [
  { name: "failed", text: "failed", tone: "bad" },
  { name: "refused", text: "refused", tone: "bad" },
  { name: "required-not-met", text: "requirement not met", tone: "changed" },
  { name: "waiting", text: "not done yet", tone: "changed" },
  { name: "done", text: "done", tone: "good" },
];

/**
 * @param {Asset} asset
 */
function badness(asset) {
  const at = STATES.findIndex((state) => state.name === asset.state);
  return at < 0 ? STATES.length : at;
}

/**
 * Sorts assets: worst first, by name, or by a figure. Assets without the figure come last.
 * @param {Asset[]} assets
 * @param {string} key
 * @param {boolean} down
 */
function ordered(assets, key, down) {
  const byName = (/** @type {Asset} */ a, /** @type {Asset} */ b) => (a.id < b.id ? -1 : a.id > b.id ? 1 : 0);
  const sign = down ? -1 : 1;
  if (key === "name") return [...assets].sort((a, b) => sign * byName(a, b));
  const figure = FIGURES.find((figure) => figure.key === key);
  // An error for scans, an uncertainty for photographs.
  const angle = (/** @type {Asset} */ asset) => asset.mean_angle ?? asset.sigma ?? -1;
  const worst = (/** @type {Asset} */ a, /** @type {Asset} */ b) =>
    badness(a) - badness(b) || angle(b) - angle(a) || byName(a, b);
  if (!figure) return [...assets].sort((a, b) => (down ? worst(a, b) : worst(b, a)));
  return [...assets].sort((a, b) => {
    const [first, second] = [figure.of(a), figure.of(b)];
    if (first === undefined || second === undefined) return Number(first === undefined) - Number(second === undefined) || byName(a, b);
    return sign * (first - second) || byName(a, b);
  });
}
