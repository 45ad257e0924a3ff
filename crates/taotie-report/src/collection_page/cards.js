// @ts-check
// Assets as cards.

/**
 * @param {Asset} asset
 */
function nameOf(asset) {
  return asset.title ?? asset.id.slice(asset.id.lastIndexOf("/") + 1);
}

/**
 * @param {Asset} asset
 */
function markOfState(asset) {
  const state = STATES.find((state) => state.name === asset.state);
  return el("span", { class: `mark ${state?.tone ?? ""}` }, state?.text ?? asset.state);
}

/**
 * The problems of an asset, as text.
 * @param {Asset} asset
 * @returns {string[]}
 */
function complaintsOf(asset) {
  return [...(asset.error ? [asset.error] : []), ...(asset.unmet ?? [])];
}

/** The number of characters of warnings that are shown without a click. */
const SHORT = 160;

/**
 * The warnings of an asset as a list, which is closed if it is long.
 * @param {Asset} asset
 * @returns {HTMLElement[]}
 */
function warningsOf(asset) {
  const warnings = asset.warnings ?? [];
  if (!warnings.length) return [];
  const title = warnings.length === 1 ? "1 warning" : `${warnings.length} warnings`;
  const isShort = warnings.join("").length <= SHORT;
  const list = el("ul", {}, ...warnings.map((text) => el("li", {}, text)));
  return [el("details", { class: "warnings", ...(isShort ? { open: "" } : {}) }, el("summary", {}, title), list)];
}

/**
 * @param {Asset} asset
 */
function linksOf(asset) {
  const links = [
    ["view", asset.viewer],
    [asset.photographs === undefined ? "proof" : "report", asset.report],
    ["turntable", asset.turntable],
    [asset.photographs === undefined ? "model" : "relief", asset.model],
  ];
  const present = links.filter(([, address]) => address !== undefined);
  return present.map(([text, address]) => el("a", { href: address ?? "", "aria-label": `${text}: ${nameOf(asset)}` }, text ?? ""));
}

/**
 * @param {Asset} asset
 */
function plateOf(asset) {
  const to = asset.viewer ?? asset.report ?? asset.model;
  const picture = asset.thumbnail
    ? el("img", { src: asset.thumbnail, alt: "", loading: "lazy", decoding: "async", width: "256", height: "256" })
    : el("span", {}, "no picture");
  const plate = to ? el("a", { href: to, class: "plate", "aria-label": nameOf(asset) }) : el("div", { class: "plate" });
  plate.append(picture);
  return plate;
}

/**
 * @param {Asset} asset
 * @param {string} key The figure by which the cards are sorted.
 */
function cardOf(asset, key) {
  const shown = FIGURES.filter((figure) => figure.key === key || ["mean", "sigma", "photographs", "shape", "color", "bytes"].includes(figure.key));
  const facts = shown.flatMap((figure) => {
    const value = figure.of(asset);
    if (value === undefined) return [];
    const name = el("dt", figure.key === key ? { class: "chosen" } : {}, figure.name);
    return [el("div", {}, name, el("dd", {}, figure.text(value)))];
  });
  const name = nameOf(asset);
  return el(
    "li",
    { class: "card" },
    plateOf(asset),
    el("h2", {}, name),
    ...(name === asset.id ? [] : note("id", asset.id)),
    el("div", {}, markOfState(asset)),
    ...complaintsOf(asset).flatMap((text) => note("why", text)),
    ...warningsOf(asset),
    ...(facts.length ? [el("dl", {}, ...facts)] : []),
    el("div", { class: "links" }, ...linksOf(asset)),
  );
}
