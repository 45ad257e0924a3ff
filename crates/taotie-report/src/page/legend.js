// @ts-check
// The colour legend of a view.

/**
 * @param {Legend} legend
 * @returns {HTMLElement}
 */
function legendOf({ title, unit, top, stops }) {
  const bar = el("div", { class: "bar", role: "img", "aria-label": `colours from 0 to ${short(top)} ${unit}` });
  const colors = stops.map((rgb) => `rgb(${rgb.join(" ")})`);
  bar.style.background = colors.length > 1 ? `linear-gradient(to right, ${colors.join(", ")})` : colors[0] ?? "";
  const scale = el("div", { class: "scale" });
  for (const value of ticks(top, 4)) {
    const mark = el("span", {}, short(value));
    mark.style.left = `${top > 0 ? (100 * value) / top : 0}%`;
    scale.append(mark);
  }
  const caption = el("div", { class: "what" }, title, ...(unit ? [el("span", { class: "unit" }, unit)] : []));
  return el("div", { class: "legend" }, caption, el("div", { class: "ramp" }, bar, scale));
}
