// @ts-check
// All views behind tabs. Selections persist across views and are kept in the address.

/** @typedef {{ view: string, left: string, right: string, wipe: number, lens: Lens, model: string }} Choice */

/**
 * @param {View[]} views
 * @returns {HTMLElement}
 */
function viewerOf(views) {
  const place = el("section", { class: "viewer", "aria-label": "Pictures" });
  const choice = choiceFrom(location.hash, views);
  /** @type {Map<View, Panel>} */
  const panels = new Map();
  const current = () => views.find((view) => view.name === choice.view) ?? views[0];
  /** @type {(change: Partial<Choice>) => void} */
  const change = (changed) => {
    Object.assign(choice, changed);
    show();
  };
  /** @type {Hand} */
  const hand = {
    lens: () => choice.lens,
    setLens: (lens) => change({ lens }),
    wipe: () => choice.wipe,
    setWipe: (percent) => change({ wipe: clamp(percent, 0, 100) }),
    setSide: (side, label) => change({ [side]: label }),
    model: () => choice.model,
    setModel: (link) => change({ model: link }),
    swap: () => change({ left: choice.right, right: choice.left }),
  };
  const tabs = tabsOf(views, (view) => change({ view: view.name }));
  const room = el("div", {});
  place.append(...(views.length > 1 ? [tabs.element] : []), room);

  const panelFor = (/** @type {View} */ view) => {
    const panel = panels.get(view) ?? panelOf(view, hand);
    if (!panels.has(view)) room.append(panel.element);
    panels.set(view, panel);
    return panel;
  };
  let shown = "";
  const show = () => {
    const view = current();
    const panel = panelFor(view);
    const [left, right] = sides(panel.labels, choice);
    const now = JSON.stringify([view.name, left, right]);
    if (now !== shown) {
      for (const [other, { element }] of panels) element.hidden = other !== view;
      tabs.choose(view);
      panel.choose(left, right);
      shown = now;
    }
    place.style.setProperty("--wipe", String(choice.wipe));
    panel.wipeTo(choice.wipe);
    showLens(place, choice.lens);
    remember(choice);
  };
  addEventListener("hashchange", () => change(choiceFrom(location.hash, views)));
  addEventListener("resize", () => showLens(place, choice.lens));
  show();
  return place;
}

/**
 * The labels shown left and right: the selected ones, or the first and the last if a view has no such picture.
 * @param {string[]} labels
 * @param {Choice} choice
 */
function sides(labels, choice) {
  const known = (/** @type {string} */ label, /** @type {string | undefined} */ other) =>
    labels.includes(label) ? label : (other ?? "");
  return [known(choice.left, labels[0]), known(choice.right, labels[labels.length - 1])];
}

/**
 * Tabs as described by WAI-ARIA: only the selected one is in the tab order, and arrow keys move between tabs.
 * @param {View[]} views
 * @param {(view: View) => void} choose
 */
function tabsOf(views, choose) {
  const tabs = views.map((view) => {
    const tab = el("button", { type: "button", role: "tab" }, view.name);
    tab.addEventListener("click", () => choose(view));
    return tab;
  });
  const element = el("div", { class: "tabs", role: "tablist", "aria-label": "Views" }, ...tabs);
  element.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const at = tabs.findIndex((tab) => tab === document.activeElement);
    if (step === undefined || at < 0) return;
    event.preventDefault();
    const next = (at + step + views.length) % views.length;
    choose(views[next]);
    tabs[next].focus();
  });
  return {
    element,
    choose(/** @type {View} */ chosen) {
      for (const [i, tab] of tabs.entries()) {
        tab.setAttribute("aria-selected", String(views[i] === chosen));
        tab.tabIndex = views[i] === chosen ? 0 : -1;
      }
    },
  };
}

/**
 * The selection stored in an address, with defaults for missing values.
 * @param {string} hash
 * @param {View[]} views
 * @returns {Choice}
 */
function choiceFrom(hash, views) {
  const link = new URLSearchParams(hash.slice(1));
  const number = (/** @type {string} */ name, /** @type {number} */ usual) => {
    const value = Number(link.get(name) ?? NaN);
    return Number.isFinite(value) ? value : usual;
  };
  return {
    view: link.get("view") ?? views[0].name,
    left: link.get("left") ?? "",
    right: link.get("right") ?? "",
    wipe: clamp(number("wipe", 50), 0, 100),
    model: link.get("model") ?? "",
    lens: within({ zoom: number("zoom", 1), x: number("x", 0), y: number("y", 0) }),
  };
}

let rememberLater = 0;

/**
 * Puts the selection into the address once it stops changing, so that it can be shared.
 * @param {Choice} choice
 */
function remember(choice) {
  clearTimeout(rememberLater);
  rememberLater = setTimeout(() => history.replaceState(null, "", hashOf(choice)), 300);
}

/**
 * @param {Choice} choice
 * @returns {string}
 */
function hashOf({ view, left, right, wipe, lens, model }) {
  const link = new URLSearchParams({ view });
  if (left) link.set("left", left);
  if (right) link.set("right", right);
  if (wipe !== 50) link.set("wipe", wipe.toFixed(1));
  if (lens.zoom > 1) for (const [name, value] of Object.entries(lens)) link.set(name, value.toFixed(4));
  if (model) link.set("model", model);
  return "#" + link;
}
