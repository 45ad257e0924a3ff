// @ts-check
// One view: a wipe of two pictures, and all pictures side by side.

/**
 * A view on the page. `choose` shows the pictures with these labels left and right of the handle.
 * @typedef {{
 *   element: HTMLElement,
 *   labels: string[],
 *   choose: (left: string, right: string) => void,
 *   wipeTo: (percent: number) => void,
 * }} Panel
 */

/**
 * The functions that a view calls on the viewer.
 * @typedef {{
 *   lens: () => Lens,
 *   setLens: (lens: Lens) => void,
 *   wipe: () => number,
 *   setWipe: (percent: number) => void,
 *   setSide: (side: "left" | "right", label: string) => void,
 *   swap: () => void,
 *   model: () => string,
 *   setModel: (link: string) => void,
 * }} Hand
 */

/**
 * @param {View} view
 * @param {Hand} hand
 * @returns {Panel}
 */
function panelOf(view, hand) {
  if (view.isModel) return modelPanelOf(view, hand);
  const labels = view.pictures.map((picture) => picture.label);
  const wipe = view.pictures.length > 1 ? wipeOf(view, hand) : undefined;
  const plates = view.pictures.map((picture) => plateOf(picture, hand, wipe !== undefined));
  const element = el("div", { class: "view", role: "tabpanel", "aria-label": view.name });
  const about = el("div", { class: "about" }, ...note("note", view.note));
  if (view.legend) about.append(legendOf(view.legend));
  if (plates.length === 0) about.append(...note("note", "There are no pictures in this view."));
  element.append(about);
  if (wipe) element.append(wipe.element);
  element.append(el("div", { class: plates.length > 1 ? "plates" : "plates single" }, ...plates.map((p) => p.element)));
  const { width, height } = view.pictures[0] ?? { width: 1, height: 1 };
  element.style.setProperty("--aspect", String(width && height ? width / height : 1));
  const choose = (/** @type {string} */ left, /** @type {string} */ right) => {
    wipe?.choose(left, right);
    for (const plate of plates) plate.choose(left, right);
  };
  return { element, labels, choose, wipeTo: (percent) => wipe?.wipeTo(percent) };
}

/**
 * @param {View} view
 * @param {Hand} hand
 */
function wipeOf({ pictures }, hand) {
  const under = el("div", { class: "layer" });
  const over = el("div", { class: "layer over" });
  const tags = { left: el("span", { class: "tag left" }), right: el("span", { class: "tag right" }) };
  const handle = handleOf(hand.wipe, hand.setWipe);
  const frame = frameOf(under, over, tags.left, tags.right, handle);
  listenToGestures(frame, hand.lens, hand.setLens);
  const left = chooser("Left", pictures, (label) => hand.setSide("left", label));
  const right = chooser("Right", pictures, (label) => hand.setSide("right", label));
  const swap = button("\u21c4", "Swap left and right", hand.swap);
  const element = el("section", { class: "wipe", "aria-label": "Wipe between two pictures" });
  element.append(el("div", { class: "choice" }, left.element, swap, right.element), frame, lensButtons(frame, hand));
  /** @param {string} label */
  const imageFor = (label) => pictures.filter((picture) => picture.label === label).slice(0, 1).map(imageOf);
  return {
    element,
    choose(/** @type {string} */ first, /** @type {string} */ second) {
      left.select.value = first;
      right.select.value = second;
      tags.left.textContent = first;
      tags.right.textContent = second;
      under.replaceChildren(...imageFor(first));
      over.replaceChildren(...imageFor(second));
    },
    wipeTo(/** @type {number} */ percent) {
      const share = Math.round(percent);
      handle.setAttribute("aria-valuenow", String(share));
      const [first, second] = [tags.left.textContent, tags.right.textContent];
      handle.setAttribute("aria-valuetext", `${share} % ${first}, ${100 - share} % ${second}`);
    },
  };
}

/**
 * A list of the pictures' labels.
 * @param {string} side
 * @param {Picture[]} pictures
 * @param {(label: string) => void} set
 */
function chooser(side, pictures, set) {
  const select = /** @type {HTMLSelectElement} */ (el("select", {}));
  select.append(...pictures.map(({ label }) => el("option", { value: label }, label)));
  select.addEventListener("change", () => set(select.value));
  return { select, element: el("label", {}, el("span", {}, side), select) };
}

/**
 * @param {HTMLElement} frame The frame to which 1:1 refers.
 * @param {Hand} hand
 */
function lensButtons(frame, hand) {
  const zoom = (/** @type {number} */ factor) => hand.setLens(zoomed(hand.lens(), factor, 0.5, 0.5));
  const toPixels = () => {
    const width = Number(frame.querySelector("img")?.getAttribute("width") ?? 0);
    zoom(width / (frame.clientWidth * devicePixelRatio) / hand.lens().zoom);
  };
  return el(
    "div",
    { class: "lens" },
    button("\u2212", "Zoom out", () => zoom(1 / 1.5)),
    button("+", "Zoom in", () => zoom(1.5)),
    button("1:1", "1:1, one picture pixel per screen pixel, but at least the whole picture", toPixels),
    button("Whole", "Show whole pictures", () => hand.setLens(WHOLE)),
    el("span", { class: "hint" }, "wheel or pinch to zoom all pictures, drag to move them, double-click to reset"),
  );
}

/**
 * One of the pictures side by side.
 * @param {Picture} picture
 * @param {Hand} hand
 * @param {boolean} selectable
 */
function plateOf(picture, hand, selectable) {
  const frame = frameOf(imageOf(picture));
  listenToGestures(frame, hand.lens, hand.setLens);
  const sides = selectable ? [sideButton("left", picture.label, hand), sideButton("right", picture.label, hand)] : [];
  const name = el("div", { class: "name" }, el("span", { class: "label" }, picture.label), ...sides);
  const element = el("figure", {}, frame, el("figcaption", {}, name, ...note("note", picture.note)));
  const choose = (/** @type {string} */ left, /** @type {string} */ right) => {
    for (const [i, side] of sides.entries())
      side.setAttribute("aria-pressed", String([left, right][i] === picture.label));
  };
  return { element, choose };
}

/**
 * @param {"left" | "right"} side
 * @param {string} label
 * @param {Hand} hand
 */
function sideButton(side, label, hand) {
  return button(side === "left" ? "\u25e7" : "\u25e8", `Show ${label} on the ${side}`, () => hand.setSide(side, label));
}
