// @ts-check
// Tables: sortable by clicking a column, and copied as CSV; notes on cells are numbered and shown below.

/**
 * @param {Table} table
 * @returns {HTMLElement}
 */
function tableOf({ title, note: about, columns, rows }) {
  const reasons = reasonsOf(rows);
  const lines = rows.map((cells) => ({ cells, element: rowOf(cells, columns, reasons) }));
  const body = el("tbody", {}, ...lines.map((line) => line.element));
  const head = el("tr", {});
  let sorted = { column: -1, down: false };
  const sort = (/** @type {number} */ column) => {
    sorted = nextOrder(sorted, column);
    const order = [...lines];
    if (sorted.column >= 0) order.sort((a, b) => compare(a.cells[column], b.cells[column], sorted.down));
    body.replaceChildren(...order.map((line) => line.element));
    for (const [i, th] of [...head.children].entries()) th.setAttribute("aria-sort", orderName(sorted, i));
  };
  head.append(...columns.map((column, i) => headOf(column, () => sort(i))));
  const table = el("table", {}, el("thead", {}, head), body);
  const scroller = el("div", { class: "scroller", role: "region", tabindex: "0", "aria-label": title }, table);
  const notes = reasons.map((reason) => el("li", {}, reason));
  return el(
    "section",
    { class: "table" },
    el("header", {}, el("h2", {}, title), copyButton(() => csvOf(columns, rows))),
    ...note("note", about),
    scroller,
    ...(notes.length ? [el("ol", { class: "reasons" }, ...notes)] : []),
  );
}

/**
 * Cycles through ascending, descending and original order.
 * @param {{ column: number, down: boolean }} order
 * @param {number} column
 */
function nextOrder(order, column) {
  if (order.column !== column) return { column, down: false };
  return order.down ? { column: -1, down: false } : { column, down: true };
}

/**
 * @param {{ column: number, down: boolean }} order
 * @param {number} column
 */
function orderName(order, column) {
  if (order.column !== column) return "none";
  return order.down ? "descending" : "ascending";
}

/**
 * @param {Column} column
 * @param {() => void} sort
 */
function headOf({ name, unit, numeric }, sort) {
  const label = el("button", { type: "button", title: "Sort" }, name);
  if (unit) label.append(" ", el("span", { class: "unit" }, unit));
  label.addEventListener("click", sort);
  return el("th", { scope: "col", "aria-sort": "none", ...(numeric ? { class: "numeric" } : {}) }, label);
}

/**
 * @param {Cell[]} cells
 * @param {Column[]} columns
 * @param {string[]} reasons
 */
function rowOf(cells, columns, reasons) {
  const boxes = cells.map((cell, i) => {
    const box = el("td", columns[i]?.numeric ? { class: "numeric" } : {});
    if ("code" in cell) box.append(el("span", { class: "hash" }, cell.code));
    else box.append(...("mark" in cell ? markOf(cell.mark, reasons) : [textOf(cell)]));
    return box;
  });
  return el("tr", {}, ...boxes);
}

/**
 * @param {Mark} mark
 * @param {string[]} reasons
 * @returns {Node[]}
 */
function markOf({ text, tone, why }, reasons) {
  const mark = el("span", { class: `mark ${tone}`, ...(why ? { title: why } : {}) }, text);
  return why ? [mark, el("sup", {}, String(reasons.indexOf(why) + 1))] : [mark];
}

/**
 * The distinct notes on cells.
 * @param {Cell[][]} rows
 * @returns {string[]}
 */
function reasonsOf(rows) {
  const notes = rows.flat().map((cell) => ("mark" in cell ? cell.mark.why : ""));
  return [...new Set(notes.filter((why) => why !== ""))];
}

/**
 * @param {Cell} cell
 * @returns {string}
 */
function textOf(cell) {
  if ("text" in cell) return cell.text;
  if ("code" in cell) return cell.code;
  return "mark" in cell ? cell.mark.text : written(cell.number.value, cell.number.digits);
}

/**
 * The number in a cell; NaN if it has none.
 * @param {Cell} cell
 */
function valueOf(cell) {
  if ("number" in cell) return cell.number.value ?? NaN;
  return Number.parseFloat(textOf(cell).replace("\u2212", "-"));
}

/**
 * Compares numbers by value and words alphabetically; cells without a number come last in both directions.
 * @param {Cell | undefined} a
 * @param {Cell | undefined} b
 * @param {boolean} down
 */
function compare(a, b, down) {
  if (!a || !b) return 0;
  const [first, second] = [valueOf(a), valueOf(b)];
  if (Number.isNaN(first) !== Number.isNaN(second)) return Number.isNaN(first) ? 1 : -1;
  const words = Number.isNaN(first);
  const order = words ? textOf(a).localeCompare(textOf(b), "en", { numeric: true }) : first - second;
  return down ? -order : order;
}

/**
 * Writes a table as CSV (RFC 4180) with unrounded numbers.
 * @param {Column[]} columns
 * @param {Cell[][]} rows
 * @returns {string}
 */
function csvOf(columns, rows) {
  const quoted = (/** @type {string} */ text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const plain = (/** @type {Cell} */ cell) => ("number" in cell ? String(cell.number.value ?? "") : textOf(cell));
  const head = columns.map(({ name, unit }) => (unit ? `${name} (${unit})` : name));
  return [head, ...rows.map((cells) => cells.map(plain))].map((line) => line.map(quoted).join(",") + "\r\n").join("");
}

/**
 * @param {() => string} text
 */
function copyButton(text) {
  const element = el("button", { type: "button", class: "quiet" }, "Copy as CSV");
  element.addEventListener("click", async () => {
    const copied = await copy(text());
    element.textContent = copied ? "Copied" : "The browser blocked copying";
    setTimeout(() => (element.textContent = "Copy as CSV"), 1500);
  });
  return element;
}

/**
 * @param {string} text
 * @returns {Promise<boolean>}
 */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
