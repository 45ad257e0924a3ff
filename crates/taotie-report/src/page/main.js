// @ts-check
// Builds the page from its data.

/**
 * The data, as documented in `data.rs`. Missing numbers are null.
 * @typedef {{ label: string, note: string, uri: string, width: number, height: number }} Picture
 * @typedef {{ title: string, unit: string, top: number, stops: [number, number, number][] }} Legend
 * @typedef {{ name: string, note: string, pictures: Picture[], legend: Legend | null, isModel?: boolean }} View
 * @typedef {{ name: string, unit: string, numeric: boolean }} Column
 * @typedef {{ text: string, tone: "good" | "bad" | "changed", why: string }} Mark
 * @typedef {{ text: string } | { code: string } | { number: { value: number | null, digits: number } } | { mark: Mark }} Cell
 * @typedef {{ title: string, note: string, columns: Column[], rows: Cell[][] }} Table
 * @typedef {{ label: string, counts: number[] }} Series
 * @typedef {{
 *   title: string, note: string, unit: string, bin_width: number, last_is_open: boolean, series: Series[]
 * }} Histogram
 * @typedef {{ at: [number, number], text: string, is_chosen: boolean, is_filled: boolean }} PlotPoint
 * @typedef {{ name: string, unit: string }} Axis
 * @typedef {{
 *   title: string, note: string, x: Axis, y: Axis, series: { label: string, points: PlotPoint[] }[],
 *   frontier: [number, number][]
 * }} Plot
 * @typedef {{ title: string, paragraphs: string[] }} Prose
 * @typedef {{ title: string, note: string, code: string }} Code
 * @typedef {{ title: string, note: string, notices: Notice[] }} Notices
 * @typedef {{ text: Prose } | { code: Code } | { table: Table } | { histogram: Histogram } | { plot: Plot } |
 *   { notices: Notices }} Section
 * @typedef {{ title: string, note: string, columns: Column[], rows: Cell[][] }} PlainTable
 * @typedef {{
 *   title: string, verdict: Notice, facts: { name: string, value: string }[], tables: PlainTable[], command_note: string,
 *   command: string
 * }} Statement
 * @typedef {{ text: string, tone: "good" | "bad" | "changed" }} Notice
 * @typedef {{
 *   title: string, subtitle: string, notices: Notice[], facts: { name: string, value: string }[],
 *   statement: Statement | null, features: View[], views: View[], model_note: string, sections: Section[],
 *   footer: string
 * }} Page
 */

/**
 * @param {Page} page
 * @returns {HTMLElement[]}
 */
function contentOf({ title, subtitle, notices, facts, statement, features, views, model_note, sections, footer }) {
  const list = facts.flatMap(({ name, value }) => el("div", {}, el("dt", {}, name), el("dd", {}, value)));
  const head = el("header", { class: "head" }, el("h1", {}, title), ...note("subtitle", subtitle));
  if (notices.length) head.append(el("ul", { class: "notices" }, ...notices.map(noticeOf)));
  if (list.length) head.append(el("dl", {}, ...list));
  const all = [...modelViews(model_note), ...views];
  return [
    head,
    ...(statement ? [statementOf(statement)] : []),
    ...features.map(featureOf),
    ...(all.length ? [viewerOf(all)] : []),
    ...sections.map(sectionOf),
    ...(footer ? [el("footer", {}, footer)] : []),
  ];
}

/**
 * @param {Notice} notice
 * @returns {HTMLElement}
 */
function noticeOf({ text, tone }) {
  return el("li", { class: tone }, text);
}

/**
 * @param {Section} section
 * @returns {HTMLElement}
 */
function sectionOf(section) {
  if ("table" in section) return tableOf(section.table);
  if ("histogram" in section) return histogramOf(section.histogram);
  if ("plot" in section) return plotOf(section.plot);
  if ("code" in section) {
    const { title, note: about, code } = section.code;
    const text = el("pre", { class: "command", tabindex: "0" }, el("code", {}, code));
    return el("section", { class: "code" }, el("h2", {}, title), ...note("note", about), text);
  }
  if ("notices" in section) {
    const { title, note: about, notices } = section.notices;
    const list = el("ul", { class: "notices" }, ...notices.map(noticeOf));
    return el("section", {}, el("h2", {}, title), ...note("note", about), list);
  }
  const { title, paragraphs } = section.text;
  return el("section", { class: "text" }, el("h2", {}, title), ...paragraphs.map((text) => el("p", {}, text)));
}

function main() {
  const data = document.getElementById("data")?.textContent ?? "";
  document.getElementById("report")?.replaceChildren(...contentOf(JSON.parse(data)));
  // Only now do frames have a size.
  dispatchEvent(new Event("resize"));
}

main();
