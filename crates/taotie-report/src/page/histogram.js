// @ts-check
// Histograms: one panel per series on common axes, with linear or logarithmic counts in all of them.

const PANEL = { width: 360, height: 150, left: 46, right: 10, top: 8, bottom: 26 };

/**
 * @param {Histogram} given
 * @returns {HTMLElement}
 */
function histogramOf(given) {
  const histogram = { ...given, bin_width: given.bin_width > 0 ? given.bin_width : 1 };
  const panels = el("div", { class: "panels" });
  const draw = (/** @type {boolean} */ logarithmic) =>
    panels.replaceChildren(...histogram.series.map((series) => seriesOf(series, histogram, logarithmic)));
  const box = /** @type {HTMLInputElement} */ (el("input", { type: "checkbox" }));
  box.addEventListener("change", () => draw(box.checked));
  listenToBins(panels, histogram);
  draw(false);
  const control = el("label", { class: "quiet" }, box, "logarithmic counts");
  return el(
    "section",
    { class: "histogram" },
    el("header", {}, el("h2", {}, histogram.title), control),
    ...note("note", histogram.note),
    panels,
  );
}

/**
 * Maps numbers to pixels for all panels of a histogram.
 * @param {Histogram} histogram
 * @param {boolean} logarithmic
 */
function axesOf({ series, bin_width }, logarithmic) {
  const bins = Math.max(1, ...series.map(({ counts }) => counts.length));
  const most = Math.max(1, ...series.flatMap(({ counts }) => counts));
  const [across, down] = [PANEL.width - PANEL.left - PANEL.right, PANEL.height - PANEL.top - PANEL.bottom];
  // A count of one is visibly above zero.
  const share = (/** @type {number} */ count) =>
    logarithmic ? (count > 0 ? (Math.log10(count) + 0.3) / (Math.log10(most) + 0.3) : 0) : count / most;
  return {
    bins,
    most,
    end: bins * bin_width,
    x: (/** @type {number} */ bin) => PANEL.left + (across * bin) / bins,
    y: (/** @type {number} */ count) => PANEL.top + down * (1 - share(count)),
  };
}

/** @typedef {ReturnType<typeof axesOf>} Axes */

/**
 * @param {Series} series
 * @param {Histogram} histogram
 * @param {boolean} logarithmic
 */
function seriesOf({ label, counts }, histogram, logarithmic) {
  const axes = axesOf(histogram, logarithmic);
  const picture = svg("svg", { viewBox: `0 0 ${PANEL.width} ${PANEL.height}`, role: "img", "aria-label": label });
  picture.append(...countMarks(axes, logarithmic), ...valueMarks(axes, histogram));
  picture.append(svg("path", { class: "counts", d: outline(counts, axes) }));
  picture.append(svg("rect", { class: "bin", y: PANEL.top, height: axes.y(0) - PANEL.top, visibility: "hidden" }));
  const readout = el("span", { class: "readout" });
  return el("figure", {}, el("figcaption", {}, el("span", { class: "label" }, label), readout), picture);
}

/**
 * @param {number[]} counts
 * @param {Axes} axes
 */
function outline(counts, { x, y }) {
  const steps = counts.map((count, bin) => `V${y(count).toFixed(2)}H${x(bin + 1).toFixed(2)}`);
  return `M${x(0)} ${y(0)}${steps.join("")}V${y(0)}Z`;
}

/**
 * @param {Axes} axes
 * @param {boolean} logarithmic
 */
function countMarks({ most, y }, logarithmic) {
  const powers = Array.from({ length: Math.floor(Math.log10(most)) + 1 }, (_, i) => 10 ** i);
  const every = Math.ceil(powers.length / 5);
  const values = logarithmic ? [0, ...powers.filter((_, i) => i % every === 0)] : ticks(most, 4);
  return values.flatMap((value) => [
    svg("line", { x1: PANEL.left, x2: PANEL.width - PANEL.right, y1: y(value), y2: y(value) }),
    svg("text", { x: PANEL.left - 6, y: y(value) + 3.5, "text-anchor": "end" }, short(value)),
  ]);
}

/**
 * @param {Axes} axes
 * @param {Histogram} histogram
 */
function valueMarks({ x, y, end, bins }, { bin_width, unit, last_is_open }) {
  const open = end - bin_width;
  const values = ticks(end, 5).filter((value) => !last_is_open || value < end * 0.85);
  if (last_is_open) values.push(open);
  const mark = (/** @type {number} */ value) => {
    const last = value === values[values.length - 1];
    const text = (last && last_is_open ? "\u2265 " : "") + short(value) + (last && unit ? " " + unit : "");
    const near = value / bin_width > bins * 0.85;
    const at = { x: near ? PANEL.width - PANEL.right : x(value / bin_width), y: PANEL.height - 8 };
    return svg("text", { ...at, "text-anchor": near ? "end" : "middle" }, text);
  };
  const tick = (/** @type {number} */ value) => {
    const at = x(value / bin_width);
    return svg("line", { class: "tick", x1: at, x2: at, y1: y(0), y2: y(0) + 4 });
  };
  return values.flatMap((value) => [tick(value), mark(value)]);
}

/**
 * A pointer over one panel reads the same bin in all panels.
 * @param {HTMLElement} panels
 * @param {Histogram} histogram
 */
function listenToBins(panels, histogram) {
  const axes = axesOf(histogram, false);
  panels.addEventListener("pointermove", (event) => {
    const picture = event.target instanceof Element ? event.target.closest("svg") : null;
    if (!picture) return readBin(panels, histogram, -1);
    const box = picture.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * PANEL.width;
    readBin(panels, histogram, Math.floor(((at - axes.x(0)) / (axes.x(axes.bins) - axes.x(0))) * axes.bins));
  });
  panels.addEventListener("pointerleave", () => readBin(panels, histogram, -1));
}

/**
 * @param {HTMLElement} panels
 * @param {Histogram} histogram
 * @param {number} bin
 */
function readBin(panels, histogram, bin) {
  const axes = axesOf(histogram, false);
  for (const [i, { counts }] of histogram.series.entries()) {
    const figure = panels.children[i];
    const [mark, readout] = [figure.querySelector(".bin"), figure.querySelector(".readout")];
    const inside = bin >= 0 && bin < axes.bins;
    mark?.setAttribute("visibility", inside ? "visible" : "hidden");
    mark?.setAttribute("x", String(axes.x(bin)));
    mark?.setAttribute("width", String(axes.x(1) - axes.x(0)));
    if (readout) readout.textContent = inside ? binText(counts, bin, histogram) : "";
  }
}

/**
 * @param {number[]} counts
 * @param {number} bin
 * @param {Histogram} histogram
 */
function binText(counts, bin, { bin_width, unit, last_is_open }) {
  const total = counts.reduce((sum, count) => sum + count, 0);
  const count = counts[bin] ?? 0;
  const from = short(bin * bin_width);
  const open = last_is_open && bin === counts.length - 1;
  const range = open ? `\u2265 ${from}` : `${from}\u2013${short((bin + 1) * bin_width)}`;
  const share = total > 0 ? `, ${((100 * count) / total).toFixed(2)} %` : "";
  return `${range} ${unit}: ${written(count, 0)}${share}`;
}
