// @ts-check
// The asset itself, where the page holds it: the element <taotie-viewer>, which another script defines.

/**
 * The view of the asset; none where the page holds pictures alone.
 * @returns {View[]}
 */
function modelViews() {
  if (!document.getElementById("taotie-data")) return [];
  const note = "The asset as it was written, to be turned and lit by hand. \u201cShow\u201d has the error of its normals.";
  return [{ name: "model", note, pictures: [], legend: null, isModel: true }];
}

/**
 * @param {View} view
 * @param {Hand} hand
 * @returns {Panel}
 */
function modelPanelOf(view, hand) {
  const viewer = el("taotie-viewer", { class: "inline" });
  // It hears of a new address after the page has read it.
  const listen = (/** @type {() => void} */ heard) => addEventListener("hashchange", heard);
  Object.assign(viewer, { address: { read: hand.model, write: hand.setModel, listen } });
  const element = el("div", { class: "view", role: "tabpanel", "aria-label": view.name }, ...note("note", view.note), viewer);
  return { element, labels: [], choose: () => {}, wipeTo: () => {} };
}
