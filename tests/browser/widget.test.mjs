// Tests the notebook widget in a page that passes traits like anywidget. `state.json` in the folder contains the
// traits and the names of the viewer's files, which are next to it, as is `module.mjs`.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { after, test } from "node:test";
import { complaints, drag, folder, newPage, pointOf, settle } from "./browser.mjs";
import { launchWebGl } from "./viewer.mjs";

const PAGE = "<!doctype html><title>Notebook</title><link rel=icon href=data:,><h1>Notebook</h1><main></main>";
const browser = await launchWebGl();
after(() => browser.close());

// Browsers do not load modules from disk.
const server = createServer(async (request, response) => {
    const name = path.basename(request.url);
    const kind = { "index.html": "text/html", "module.mjs": "text/javascript" }[name] ?? "application/octet-stream";
    response.setHeader("content-type", kind);
    response.end(name === "index.html" ? PAGE : await readFile(path.join(folder, name)));
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
after(() => server.close());

// Renders the widget; `window.model` has its traits, and `window.sent` records what is sent to Python.
async function render({ files, traits }) {
    const bytes = async (name) => new DataView(await (await fetch(name)).arrayBuffer());
    const held = await Promise.all(files.map(async (name) => [name, await bytes(name)]));
    const values = new Map(Object.entries({ ...traits, _files: Object.fromEntries(held) }));
    const listeners = new Map();
    window.sent = [];
    window.model = {
        get: (name) => values.get(name),
        set(name, value) {
            values.set(name, value);
            for (const heard of listeners.get(`change:${name}`) ?? []) heard();
        },
        on: (name, heard) => void listeners.set(name, [...(listeners.get(name) ?? []), heard]),
        save_changes: () => void window.sent.push(Object.fromEntries([...values].filter(([name]) => !name.startsWith("_")))),
    };
    const { default: widget } = await import("./module.mjs");
    window.remove = widget.render({ model: window.model, el: document.querySelector("main") });
}

async function still(page) {
    await page.waitForFunction(() => document.querySelector("taotie-viewer")?.dataset.state === "still", null, { timeout: 60_000 });
    await settle(page);
}

const get = (page, name) => page.evaluate((name) => window.model.get(name), name);
const state = (page) => page.evaluate(() => document.querySelector("taotie-viewer").state);

test("state from Python is shown, and changes are sent both ways", async () => {
    const page = await newPage(browser, [720, 400]);
    await page.goto(`http://127.0.0.1:${server.address().port}/index.html`);
    await page.evaluate(render, JSON.parse(await readFile(path.join(folder, "state.json"), "utf8")));
    await still(page);

    const first = await state(page);
    assert.deepEqual([first.light, first.from, first.mode], ["raking", [-75, 10], "normals"]);
    const [azimuth, elevation, distance] = await get(page, "camera");
    assert.deepEqual([azimuth, elevation, distance], first.view);

    const from = await pointOf(page, "canvas", [0.5, 0.5]);
    await drag(page, from, [from[0] + 50, from[1] + 25]);
    await still(page);
    const turned = await get(page, "camera");
    assert(Math.abs(turned[0] - (azimuth - 20)) < 1e-3 && Math.abs(turned[1] - (elevation + 10)) < 1e-3, String(turned));
    assert.deepEqual(await page.evaluate(() => window.sent.at(-1).camera), turned);

    await page.evaluate(() => {
        window.model.set("camera", [30, 20, window.model.get("camera")[2]]);
        window.model.set("light", null);
        window.model.set("mode", "error");
        window.model.set("beside", "scan");
    });
    await still(page);
    const set = await state(page);
    assert.deepEqual([set.view.slice(0, 2), set.light, set.mode, set.beside], [[30, 20], "given", "error", "scan"]);
    const sent = await page.evaluate(() => window.sent.length);
    await settle(page);
    assert.equal(await page.evaluate(() => window.sent.length), sent, "nothing is sent repeatedly");
    assert.equal((await get(page, "height")), 300);
    const box = await page.locator("taotie-viewer").boundingBox();
    assert.equal(Math.round(box.height), 300);

    await page.evaluate(() => window.remove());
    assert.equal(await page.locator("taotie-viewer").count(), 0);
    assert.deepEqual(complaints(page), []);
});
