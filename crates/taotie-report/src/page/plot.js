// @ts-check
// Plots of points on two logarithmic axes.

const PLOT = { width: 720, height: 360, left: 56, right: 16, top: 12, bottom: 40 };

/** The markers of the kinds, as paths around the origin. */
const SHAPES = ["M-4 0A4 4 0 1 0 4 0A4 4 0 1 0 -4 0Z", "M-3.7 -3.7H3.7V3.7H-3.7Z", "M0 -5L4.6 3.4H-4.6Z"];

/**
 * @param {Plot} plot
 * @returns {HTMLElement}
 */
function plotOf(plot) {
  const axes = logAxes(plot);
  const box = `0 0 ${PLOT.width} ${PLOT.height}`;
  const picture = svg("svg", { viewBox: box, role: "img", "aria-label": plot.title });
  picture.append(...axisMarks(plot, axes));
  const line = plot.frontier.map(([x, y], i) => `${i ? "H" + axes.x(x) + "V" : "M" + axes.x(x) + " "}${axes.y(y)}`);
  picture.append(svg("path", { class: "frontier", d: line.join("") }));
  for (const [i, { points }] of plot.series.entries()) picture.append(...points.map((point) => plottedPoint(point, i, axes)));
  const key = plot.series.flatMap(({ label, points }, i) => {
    const mark = svg("svg", { viewBox: "-6 -6 12 12" }, shapeOf(i, true));
    return points.length ? [el("span", { class: "key" }, mark, label)] : [];
  });
  const readout = el("span", { class: "readout" });
  picture.addEventListener("pointermove", (event) => {
    const mark = event.target instanceof Element ? event.target.closest("[data-text]") : null;
    readout.textContent = mark?.getAttribute("data-text") ?? "";
  });
  const caption = el("figcaption", {}, el("span", {}, ...key), readout);
  return el(
    "section",
    { class: "plot" },
    el("h2", {}, plot.title),
    ...note("note", plot.note),
    el("figure", {}, caption, picture),
  );
}

/**
 * Maps numbers to pixels.
 * @param {Plot} plot
 */
function logAxes({ series }) {
  const all = series.flatMap(({ points }) => points.map(({ at }) => at));
  const range = (/** @type {0 | 1} */ axis) => {
    const logs = all.map((at) => Math.log10(at[axis]));
    const [low, high] = [Math.min(...logs), Math.max(...logs)];
    const margin = 0.06 * Math.max(high - low, 0.5);
    return [low - margin, high + margin];
  };
  const [[left, right], [bottom, top]] = [range(0), range(1)];
  const share = (/** @type {number} */ value, /** @type {number} */ low, /** @type {number} */ high) =>
    (Math.log10(value) - low) / (high - low);
  const [across, down] = [PLOT.width - PLOT.left - PLOT.right, PLOT.height - PLOT.top - PLOT.bottom];
  return {
    x: (/** @type {number} */ value) => Number((PLOT.left + across * share(value, left, right)).toFixed(2)),
    y: (/** @type {number} */ value) => Number((PLOT.top + down * (1 - share(value, bottom, top))).toFixed(2)),
    xs: roundLogs(left, right),
    ys: roundLogs(bottom, top),
  };
}

/**
 * Round numbers between two powers of ten: only the powers if there are many, else 1, 2 and 5 times each, or more
 * in a short range.
 * @param {number} low
 * @param {number} high
 */
function roundLogs(low, high) {
  const few = high - low > 0.8 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9];
  const factors = high - low > 2.5 ? [1] : few;
  const powers = Array.from({ length: Math.ceil(high) - Math.floor(low) + 1 }, (_, i) => 10 ** (Math.floor(low) + i));
  const all = powers.flatMap((power) => factors.map((factor) => Number((factor * power).toPrecision(2))));
  return all.filter((value) => value >= 10 ** low && value <= 10 ** high);
}

/**
 * @param {Plot} plot
 * @param {ReturnType<typeof logAxes>} axes
 */
function axisMarks({ x, y }, axes) {
  const [bottom, right] = [PLOT.height - PLOT.bottom, PLOT.width - PLOT.right];
  const middle = { "text-anchor": "middle" };
  return [
    ...axes.xs.flatMap((value) => [
      svg("line", { x1: axes.x(value), x2: axes.x(value), y1: PLOT.top, y2: bottom }),
      svg("text", { x: axes.x(value), y: bottom + 14, ...middle }, short(value)),
    ]),
    ...axes.ys.flatMap((value) => [
      svg("line", { x1: PLOT.left, x2: right, y1: axes.y(value), y2: axes.y(value) }),
      svg("text", { x: PLOT.left - 6, y: axes.y(value) + 3.5, "text-anchor": "end" }, short(value)),
    ]),
    svg("text", { x: (PLOT.left + right) / 2, y: PLOT.height - 6, ...middle }, `${x.name} (${x.unit})`),
    svg("text", { transform: `translate(12 ${(PLOT.top + bottom) / 2}) rotate(-90)`, ...middle }, `${y.name} (${y.unit})`),
  ];
}

/**
 * @param {number} kind
 * @param {boolean} isFilled
 */
function shapeOf(kind, isFilled) {
  return svg("path", { class: `point kind${kind}${isFilled ? " filled" : ""}`, d: SHAPES[kind % SHAPES.length] });
}

/**
 * @param {PlotPoint} point
 * @param {number} kind
 * @param {ReturnType<typeof logAxes>} axes
 */
function plottedPoint({ at: [x, y], text, is_chosen, is_filled }, kind, axes) {
  const place = `translate(${axes.x(x)} ${axes.y(y)})`;
  const mark = svg("g", { transform: place, "data-text": text }, svg("title", {}, text), shapeOf(kind, is_filled));
  if (is_chosen) mark.append(svg("path", { class: "chosen", d: "M-11 0H-6M6 0H11M0 -11V-6M0 6V11" }));
  return mark;
}
