// @ts-check
// Builds the page from its data. Elements are created for assets only as they are scrolled to.

/** The number of assets added at a time. */
const CHUNK = 100;

/**
 * @param {Asset[]} assets
 */
function factsOf(assets) {
  const made = assets.filter((asset) => asset.bytes_out !== undefined);
  const sum = (/** @type {(asset: Asset) => number | undefined} */ of) => made.reduce((all, asset) => all + (of(asset) ?? 0), 0);
  const angles = made.flatMap((asset) => (asset.mean_angle === undefined ? [] : [asset.mean_angle])).sort((a, b) => a - b);
  const sigmas = made.flatMap((asset) => (asset.sigma === undefined ? [] : [asset.sigma])).sort((a, b) => a - b);
  const facts = [
    ["Assets", written(assets.length, 0)],
    ["Size of the input", bytes(sum((asset) => asset.bytes_in))],
    ["Size of the output", bytes(sum((asset) => asset.bytes_out))],
    ...(angles.length ? [["Mean normal error, median", degrees(angles[angles.length >> 1] ?? 0)]] : []),
    ...(sigmas.length ? [["Uncertainty of normals from photographs, median", degrees(sigmas[sigmas.length >> 1] ?? 0)]] : []),
    ["Total processing time", time(assets.reduce((all, asset) => all + (asset.seconds ?? 0), 0))],
  ];
  return el("dl", {}, ...facts.map(([name, value]) => el("div", {}, el("dt", {}, name ?? ""), el("dd", {}, value ?? ""))));
}

/**
 * @param {Asset[]} assets
 */
function subtitleOf(assets) {
  const count = assets.filter((asset) => asset.photographs !== undefined).length;
  const scans = "Scans and the low-poly assets baked from them";
  const photographs = "photographs under changing light and the normals estimated from them";
  if (!count) return scans;
  return count === assets.length ? photographs.replace("p", "P") : `${scans}; ${photographs}`;
}

/**
 * A list that grows while its end is visible.
 * @param {HTMLElement} list
 * @param {Asset[]} assets
 * @param {(asset: Asset) => HTMLElement} make
 * @param {HTMLElement} end
 */
function growing(list, assets, make, end) {
  let count = 0;
  const grow = () => {
    const next = assets.slice(count, count + CHUNK);
    count += next.length;
    list.append(...next.map(make));
    return next.length > 0;
  };
  grow();
  const watcher = new IntersectionObserver(
    (seen) => {
      if (!seen.some((entry) => entry.isIntersecting) || !grow()) return;
      // Observing again reports the end if it is still visible.
      watcher.unobserve(end);
      watcher.observe(end);
    },
    { rootMargin: "1500px" },
  );
  watcher.observe(end);
  return () => watcher.disconnect();
}

/**
 * @param {{ title: string, version: string, assets: Asset[] }} data
 */
function galleryOf({ title, version, assets }) {
  const choice = choiceOfAddress();
  const place = el("div", {});
  const end = el("div", { class: "more" });
  let stop = () => {};
  const show = () => {
    stop();
    const shown = chosen(assets, choice);
    const status = tools.querySelector(".shown");
    if (status) status.textContent = shown.length === assets.length ? `${assets.length} assets` : `${shown.length} of ${assets.length} assets`;
    if (!shown.length) {
      place.replaceChildren(...note("none", "No assets match."));
      return;
    }
    if (!choice.table) {
      const cards = el("ul", { class: "cards" });
      place.replaceChildren(cards);
      stop = growing(cards, shown, (asset) => cardOf(asset, choice.key), end);
      return;
    }
    const body = el("tbody", {});
    const sort = (/** @type {string} */ key) => {
      choice.down = choice.key === key ? !choice.down : key !== "name";
      choice.key = key;
      const select = tools.querySelector("select");
      if (select) select.value = key;
      changed();
    };
    const table = el("table", {}, el("thead", {}, rowsHead(choice.key, choice.down, sort)), body);
    place.replaceChildren(el("section", {}, el("div", { class: "scroller", role: "region", tabindex: "0", "aria-label": title }, table)));
    stop = growing(body, shown, rowOf, end);
  };
  const changed = () => {
    keepChoice(choice);
    show();
  };
  const tools = toolsOf(assets, choice, changed);
  show();
  return [
    el("header", { class: "head" }, el("h1", {}, title), ...note("subtitle", subtitleOf(assets)), factsOf(assets)),
    tools,
    place,
    end,
    el("footer", {}, `Made by taotie ${version}. The same data is in collection.json next to this page.`),
  ];
}

function main() {
  const data = document.getElementById("data")?.textContent ?? "";
  document.getElementById("report")?.replaceChildren(...galleryOf(JSON.parse(data)));
}

main();
