// @ts-check
// Assets as table rows.

/**
 * @param {string} key The figure by which rows are sorted.
 * @param {boolean} down
 * @param {(key: string) => void} sort
 */
function rowsHead(key, down, sort) {
  const columns = [{ name: "name", key: "name", numeric: false }, { name: "state", key: "worst", numeric: false }];
  const figures = FIGURES.map((figure) => ({ name: figure.name, key: figure.key, numeric: true }));
  const heads = [...columns, ...figures].map((column) => {
    const label = el("button", { type: "button", title: "Sort" }, column.name);
    label.addEventListener("click", () => sort(column.key));
    const order = column.key === key ? (down ? "descending" : "ascending") : "none";
    return el("th", { scope: "col", "aria-sort": order, ...(column.numeric ? { class: "numeric" } : {}) }, label);
  });
  return el("tr", {}, ...heads, el("th", { scope: "col" }, el("span", {}, "problems")));
}

/**
 * @param {Asset} asset
 */
function rowOf(asset) {
  const to = asset.viewer ?? asset.report ?? asset.model;
  const name = to ? el("a", { href: to }, asset.title ?? asset.id) : asset.title ?? asset.id;
  const figures = FIGURES.map((figure) => {
    const value = figure.of(asset);
    return el("td", { class: "numeric" }, value === undefined ? MISSING : figure.text(value));
  });
  const complaints = complaintsOf(asset).join("; ");
  return el("tr", {}, el("td", {}, name), el("td", {}, markOfState(asset)), ...figures, el("td", { class: "why" }, complaints, ...warningsOf(asset)));
}
