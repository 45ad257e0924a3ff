// @ts-check
// Filters and order. They are kept in the page's address, so that a view can be shared.

/**
 * @typedef {{ words: string, states: Set<string>, key: string, down: boolean, table: boolean }} Choice
 */

/** @returns {Choice} */
function choiceOfAddress() {
  const link = new URLSearchParams(location.hash.slice(1));
  const states = (link.get("state") ?? "").split(",").filter((name) => name !== "");
  return {
    words: link.get("find") ?? "",
    states: new Set(states),
    key: link.get("sort") ?? "worst",
    down: link.get("down") !== "0",
    table: link.get("as") === "table",
  };
}

/**
 * @param {Choice} choice
 */
function keepChoice({ words, states, key, down, table }) {
  const link = new URLSearchParams();
  if (words) link.set("find", words);
  if (states.size) link.set("state", [...states].join(","));
  if (key !== "worst") link.set("sort", key);
  if (!down) link.set("down", "0");
  if (table) link.set("as", "table");
  history.replaceState(null, "", "#" + link.toString());
}

/**
 * @param {Asset[]} assets
 * @param {Choice} choice
 */
function chosen(assets, { words, states, key, down }) {
  const wanted = words.toLowerCase().split(/\s+/).filter((word) => word !== "");
  const has = (/** @type {Asset} */ asset) => {
    const text = [asset.id, asset.title ?? "", asset.error ?? "", ...(asset.unmet ?? []), ...(asset.warnings ?? [])];
    const all = text.join("\n").toLowerCase();
    return wanted.every((word) => all.includes(word));
  };
  const kept = assets.filter((asset) => (!states.size || states.has(asset.state)) && (!wanted.length || has(asset)));
  return ordered(kept, key, down);
}

/**
 * The controls, which call `changed` after each change.
 * @param {Asset[]} assets
 * @param {Choice} choice
 * @param {() => void} changed
 */
function toolsOf(assets, choice, changed) {
  const find = /** @type {HTMLInputElement} */ (el("input", { type: "search", placeholder: "name, warning, error" }));
  find.value = choice.words;
  find.addEventListener("input", () => {
    choice.words = find.value;
    changed();
  });
  const sort = /** @type {HTMLSelectElement} */ (el("select", {}));
  sort.append(el("option", { value: "worst" }, "worst first"), el("option", { value: "name" }, "name"));
  sort.append(...FIGURES.map((figure) => el("option", { value: figure.key }, figure.name)));
  sort.value = choice.key;
  sort.addEventListener("change", () => {
    choice.key = sort.value;
    choice.down = sort.value !== "name";
    changed();
  });
  const turn = button("\u2195", "Reverse the order", () => {
    choice.down = !choice.down;
    changed();
  });
  const look = el("button", { type: "button", "aria-pressed": String(choice.table) }, "as a table");
  look.addEventListener("click", () => {
    choice.table = !choice.table;
    look.setAttribute("aria-pressed", String(choice.table));
    changed();
  });
  return el(
    "div",
    { class: "tools", role: "search" },
    el("label", {}, "Find", find),
    statesOf(assets, choice, changed),
    el("label", {}, "Sort by", sort),
    el("div", { class: "group" }, turn, look),
    el("p", { class: "shown", role: "status" }),
  );
}

/**
 * @param {Asset[]} assets
 * @param {Choice} choice
 * @param {() => void} changed
 */
function statesOf(assets, choice, changed) {
  const counted = STATES.map((state) => ({ ...state, count: assets.filter((asset) => asset.state === state.name).length }));
  const buttons = counted.filter(({ count }) => count > 0).map(({ name, text, count }) => {
    const pressed = () => String(choice.states.has(name));
    const element = el("button", { type: "button", "aria-pressed": pressed() }, `${text} ${count}`);
    element.addEventListener("click", () => {
      if (!choice.states.delete(name)) choice.states.add(name);
      element.setAttribute("aria-pressed", pressed());
      changed();
    });
    return element;
  });
  return el("div", { class: "group", role: "group", "aria-label": "States" }, ...buttons);
}
