// Compares an asset in Taotie's page, with three.js's own material and in model-viewer, in Chromium without a GPU: seconds
// to the first image, and frames per second while the pointer rotates it. `node bench.mjs MODEL.glb PAGE.html`; PAGE is
// from `taotie view --samples 1`, which stops drawing once it is finished.

import { createServer } from "node:http";
import { readFile, stat } from "node:fs/promises";
import path from "node:path";
import { chromium } from "playwright-core";

const [model, page] = process.argv.slice(2);
const [ROUNDS, SECONDS, SIZE] = [3, 5, { width: 800, height: 600 }];
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm" };
const here = import.meta.dirname;
const given = { "/model.glb": model, "/taotie.html": page };

const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://here");
    try {
        const bytes = await readFile(given[pathname] ?? path.join(here, path.normalize(pathname)));
        response.writeHead(200, { "content-type": TYPES[path.extname(pathname)] ?? "application/octet-stream" }).end(bytes);
    } catch {
        response.writeHead(404).end();
    }
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
const address = `http://127.0.0.1:${server.address().port}`;

const VIEWERS = [
    ["taotie view", "taotie.html", () => document.querySelector("taotie-viewer")?.dataset.state === "still"],
    ["three.js, a light", "three.html", () => globalThis.isShown],
    ["three.js, an environment", "three.html?environment", () => globalThis.isShown],
    ["model-viewer", "model-viewer.html", () => globalThis.isShown],
];

// Counts the browser's frames in which something is drawn.
function watch() {
    let isDrawn = false;
    for (const name of ["drawElements", "drawArrays"]) {
        const draw = WebGL2RenderingContext.prototype[name];
        WebGL2RenderingContext.prototype[name] = function (...all) {
            isDrawn = true;
            return draw.apply(this, all);
        };
    }
    globalThis.counted = 0;
    const count = () => {
        globalThis.counted += isDrawn ? 1 : 0;
        isDrawn = false;
        requestAnimationFrame(count);
    };
    requestAnimationFrame(count);
}

// Frames drawn per second while the pointer moves in a circle.
async function frames(page) {
    const [x, y] = [SIZE.width / 2, SIZE.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    const start = Date.now();
    const before = await page.evaluate(() => globalThis.counted);
    for (let angle = 0; Date.now() - start < 1000 * SECONDS; angle += 0.05) {
        await page.mouse.move(x + 100 * Math.sin(angle), y + 40 * Math.cos(angle));
    }
    const after = await page.evaluate(() => globalThis.counted);
    await page.mouse.up();
    return (after - before) / ((Date.now() - start) / 1000);
}

const median = (numbers) => numbers.toSorted((a, b) => a - b)[Math.floor(numbers.length / 2)];
const runs = new Map(VIEWERS.map(([name]) => [name, []]));
for (let round = 0; round < ROUNDS; round++) {
    for (const [name, file, isShown] of VIEWERS) {
        const browser = await chromium.launch({
            executablePath: process.env.BROWSER,
            args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        });
        const tab = await browser.newPage({ viewport: SIZE });
        await tab.addInitScript(watch);
        const start = Date.now();
        await tab.goto(`${address}/${file}`, { waitUntil: "commit" });
        await tab.waitForFunction(isShown, null, { timeout: 120_000, polling: 20 });
        const seconds = (Date.now() - start) / 1000;
        // Its image then fills the window, like those of the others.
        if (name === "taotie view") await tab.getByRole("button", { name: "Hide controls" }).click();
        runs.get(name).push([seconds, await frames(tab)]);
        if (round === 0) await tab.screenshot({ path: path.join(process.env.FOLDER ?? ".", `${name.replaceAll(/\W+/g, "-")}.png`) });
        await browser.close();
    }
}
server.close();
console.log(`${(await stat(model)).size} bytes of model, ${(await stat(page)).size} of page\n`);
console.log("| viewer | seconds to the first image | frames per second |\n|---|---|---|");
for (const [name, all] of runs) {
    console.log(`| ${name} | ${median(all.map(([s]) => s)).toFixed(1)} | ${median(all.map(([, f]) => f)).toFixed(1)} |`);
}
