// Tests the page that bakes in the browser, which `make web` builds: from disk as one file, and from a server. TAOTIE is the
// native program, whose asset must be the same.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { after, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import axe from "axe-core";
import { bytes, folder as scans, native } from "../../npm/taotie-wasm/test/native.mjs";
import { complaintsOfReader, newPage, requests, saved, settle } from "./browser.mjs";
import { launchWebGl } from "./viewer.mjs";

const WEB = fileURLToPath(new URL("../../target/web", import.meta.url));
const SITE = path.join(WEB, "site");
const RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"];
const SECONDS = 1000;
const PATIENCE = 240 * SECONDS;

const kinds = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };
const asked = [];
const server = createServer(async (request, response) => {
    asked.push(request.url);
    const name = path.join(SITE, path.basename(new URL(request.url, "http://x").pathname));
    response.setHeader("content-type", kinds[path.extname(name)] ?? "application/octet-stream");
    response.end(await readFile(name));
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const origin = `http://127.0.0.1:${server.address().port}`;
const ADDRESSES = { "one file on disk": pathToFileURL(path.join(WEB, "taotie.html")).href, "a server": `${origin}/index.html` };

const browser = await launchWebGl();
after(() => browser.close());
after(() => server.close());

const scan = (name) => path.join(scans, name);

async function opened(address, size = [1280, 900]) {
    const page = await newPage(browser, size);
    await page.goto(address);
    await page.waitForSelector("#pick-example");
    return page;
}

const choose = (page, ...names) => page.setInputFiles("#files", names.map(scan));

/** Waits for a result or an error, and returns the error. */
async function finished(page) {
    const isDone = () => document.querySelector("#work").hidden && (!document.querySelector("#failure").hidden || !document.querySelector("#result").hidden);
    await page.waitForFunction(isDone, null, { timeout: PATIENCE });
    return (await page.locator("#failure").isVisible()) ? page.locator("#failure").textContent() : "";
}

async function bakeAgain(page, choices) {
    for (const [name, value] of Object.entries(choices)) {
        const field = page.locator(`[name=${name}]`);
        if (name === "size") await field.selectOption(value);
        else await field.fill(value);
    }
    await page.click("#start");
    return finished(page);
}

/** Fails if anything but the page's own files was asked for, or if the browser complained. */
function assertQuiet(page) {
    assert.deepEqual(complaintsOfReader(page), []);
    const isInside = (url) => /^(blob|data):/.test(url) || url.startsWith(`${origin}/`) || url.startsWith(pathToFileURL(WEB).href);
    assert.deepEqual(requests(page).filter((url) => !isInside(url)), []);
}

const stateOf = (page) => page.evaluate(() => document.querySelector("taotie-viewer")?.state);

for (const [where, address] of Object.entries(ADDRESSES)) {
    test(`from ${where}: bake, progress, view, proof, the native program's bytes, downloads`, async () => {
        const page = await opened(address);
        assert.match(await page.locator("main").textContent(), /Nothing leaves this machine/);
        await choose(page, "waves.obj");
        await page.waitForFunction(() => document.querySelector("#progress").value > 0.1, null, { timeout: PATIENCE });
        assert.match(await page.locator("#stage").textContent(), /^[A-Z][a-z -]+$/);
        await page.waitForFunction(() => /^About \d+ seconds? left/.test(document.querySelector("#left").textContent), null, { timeout: PATIENCE });
        assert.equal(await finished(page), "");
        assert.equal(await page.locator("#result-title").textContent(), "All requirements are met.");

        assert.equal(await bakeAgain(page, { triangles: "500", size: "512" }), "");
        const args = ["bake", "waves.obj", "-o", "waves-asset.glb", "--require=standard", "--triangles=500", "--size=512", "--json"];
        const wanted = native(args);
        const words = await page.locator("#result-title").textContent();
        assert.equal(words.startsWith("All"), wanted.code === 0, words);
        const link = (name) => page.locator(`#downloads a[download="${name}"]`);
        assert(bytes("waves-asset.glb").equals(await saved(page, () => link("waves-asset.glb").click())), "the asset differs");
        const figures = JSON.parse(await saved(page, () => link("waves-asset.report.json").click()));
        assert.deepEqual(figures.certificate, JSON.parse(wanted.stdout).certificate);
        const mean = await page.locator("#facts dd").first().textContent();
        assert.match(mean, /^\d+\.\d+°$/);
        assert((await page.locator("#proof .statement").textContent()).includes(mean));
        assert.equal(await page.locator("#earlier tbody tr").count(), 2);

        await page.waitForFunction(() => document.querySelector("taotie-viewer")?.state?.beside === "scan", null, { timeout: PATIENCE });
        assert.equal((await stateOf(page)).light, "raking");
        assertQuiet(page);
        // The browser itself refuses every connection.
        const refused = await page.evaluate((url) => fetch(url, { mode: "no-cors" }).then(() => false, () => true), `${origin}/probe`);
        assert(refused && !asked.includes("/probe"), "the policy allows a connection");
        await page.close();
    });
}

test("a run is cancelled at once, and another begins", async () => {
    const page = await opened(ADDRESSES["one file on disk"]);
    await choose(page, "waves.obj");
    await page.locator("#cancel").click();
    assert(await page.locator("#work").isHidden());
    assert(await page.locator("#failure").isHidden());
    assert(await page.locator("#start").isEnabled());
    assert.equal(await page.evaluate(() => document.activeElement.id), "start");
    assert.equal(await bakeAgain(page, { triangles: "300", size: "512" }), "");
    assertQuiet(page);
    await page.close();
});

test("errors are the program's words, and a later scan works", async () => {
    const page = await opened(ADDRESSES["a server"]);
    await choose(page, "broken.ply");
    const wanted = native(["bake", "broken.ply", "-o", "x.glb", "--size=2048"]).stderr;
    assert.equal(`taotie: error: ${await finished(page)}`, wanted.trim());
    await page.click("#restart");
    await page.setInputFiles("#files", [{ name: "notes.txt", mimeType: "text/plain", buffer: Buffer.from("x") }]);
    assert.match(await finished(page), /^None of the files is a scan: notes.txt. Expected one of: .*\.ply/);
    await page.click("#restart");
    await choose(page, "broken.ply", "waves.obj");
    await page.locator("#cancel").click();
    assert.deepEqual(await page.locator("#which option").allTextContents(), ["waves.obj", "broken.ply"]);
    assert(await page.locator("#which").isVisible());
    assertQuiet(page);
    await page.close();
});

test("every state is accessible, at every width, by keyboard", async () => {
    const page = await opened(ADDRESSES["a server"]);
    const check = async (state) => {
        await page.evaluate(axe.source);
        const { violations } = await page.evaluate((values) => window.axe.run({ runOnly: { type: "tag", values } }), RULES);
        const found = violations.map(({ id, nodes }) => `${state}: ${id}: ${nodes.map(({ target }) => target).join(", ")}`);
        assert.deepEqual(found, []);
        for (const width of [320, 480, 1600]) {
            await page.setViewportSize({ width, height: 800 });
            await settle(page);
            assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${state} at ${width}`);
        }
    };
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "pick-files");
    await check("start");
    await page.keyboard.press("Tab");
    await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.activeElement.id === "cancel");
    await check("work");
    await page.keyboard.press("Enter");
    assert(await page.locator("#work").isHidden());
    assert.equal(await bakeAgain(page, { triangles: "2000", size: "512" }), "");
    assert.equal(await page.evaluate(() => document.activeElement.id), "result");
    await check("result");
    await page.close();
});
