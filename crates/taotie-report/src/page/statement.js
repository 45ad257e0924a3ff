// @ts-check
// The statement that opens a page; it fills one sheet when printed. Its tables cannot be re-sorted.

/**
 * @param {Statement} statement
 * @returns {HTMLElement}
 */
function statementOf({ title, verdict, facts, tables, command_note: about, command }) {
  const list = facts.flatMap(({ name, value }) => el("div", {}, el("dt", {}, name), el("dd", {}, value)));
  return el(
    "section",
    { class: "statement", "aria-label": title },
    el("h2", {}, title),
    el("p", { class: `verdict ${verdict.tone}` }, verdict.text),
    el("dl", {}, ...list),
    ...tables.map(plainTableOf),
    ...note("note", about),
    ...(command ? [el("pre", { class: "command", tabindex: "0" }, el("code", {}, command))] : []),
  );
}

/**
 * @param {PlainTable} table
 * @returns {HTMLElement}
 */
function plainTableOf({ title, note: about, columns, rows }) {
  const heads = columns.map(({ name, unit, numeric }) =>
    el("th", { scope: "col", ...(numeric ? { class: "numeric" } : {}) }, name, ...(unit ? [el("span", { class: "unit" }, unit)] : [])),
  );
  const lines = rows.map((cells) => rowOf(cells, columns, []));
  const table = el("table", {}, el("thead", {}, el("tr", {}, ...heads)), el("tbody", {}, ...lines));
  const scroller = el("div", { class: "scroller", role: "region", tabindex: "0", "aria-label": title }, table);
  return el("div", { class: "plain" }, el("h3", {}, title), scroller, ...note("note", about));
}

/**
 * Pictures side by side, shown before all others.
 * @param {View} view
 * @returns {HTMLElement}
 */
function featureOf({ name, note: about, pictures, legend }) {
  const figure = (/** @type {Picture} */ picture) =>
    el("figure", {}, imageOf(picture), el("figcaption", {}, picture.label, ...note("note", picture.note)));
  return el(
    "section",
    { class: "feature", "aria-label": name },
    el("h2", {}, name),
    ...note("note", about),
    el("div", { class: "side-by-side" }, ...pictures.map(figure)),
    ...(legend ? [legendOf(legend)] : []),
  );
}
