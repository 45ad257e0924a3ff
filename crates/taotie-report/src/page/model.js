// @ts-check
// The asset, if the page contains it: the element <taotie-viewer>, which is defined by another script.

/**
 * The view of the asset; none if the page contains only pictures.
 * @param {string} own
 * @returns {View[]}
 */
function modelViews(own) {
  if (!document.getElementById("taotie-data")) return [];
  const note = own || "The asset as written. Drag to rotate it or move the light; \u201cShow\u201d has its normal error.";
  return [{ name: "model", note, pictures: [], legend: null, isModel: true }];
}

/**
 * @param {View} view
 * @param {Hand} hand
 * @returns {Panel}
 */
function modelPanelOf(view, hand) {
  const viewer = el("taotie-viewer", { class: "inline" });
  // The page reads a new address first, then notifies the element.
  const listen = (/** @type {() => void} */ heard) => addEventListener("hashchange", heard);
  Object.assign(viewer, { address: { read: hand.model, write: hand.setModel, listen } });
  const element = el("div", { class: "view", role: "tabpanel", "aria-label": view.name }, ...note("note", view.note), viewer);
  return { element, labels: [], choose: () => {}, wipeTo: () => {} };
}
