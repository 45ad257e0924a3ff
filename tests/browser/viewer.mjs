// Helpers for tests of `taotie view` pages.

import assert from "node:assert/strict";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { folder, launch, newPage } from "./browser.mjs";

// WebGL without a graphics card.
export const launchWebGl = () => launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);

export const address = (name, fragment = "") => pathToFileURL(path.join(folder, name)).href + (fragment && `#${fragment}`);

// Width and height of a small window that is quick to draw.
export const SIZE = [720, 320];

// Waits until the picture is drawn with all samples.
export async function still(page) {
    const ended = () => ["still", "failed"].find((state) => document.querySelector("taotie-viewer")?.dataset.state === state);
    const state = await (await page.waitForFunction(ended, null, { timeout: 60_000 })).jsonValue();
    assert.equal(state, "still", await page.locator(".message").first().textContent().catch(() => ""));
}

// Opens a viewer page in a window of this size and waits until its picture is still.
export async function openViewer(browser, name, { fragment, size = SIZE } = {}) {
    const page = await newPage(browser, size);
    await page.goto(address(name, fragment));
    await still(page);
    return page;
}

export const state = (page) => page.evaluate(() => window.taotie.state);

// Returns the picture in this size as a PNG file.
export async function picture(page, size) {
    const data = await page.evaluate(async (size) => {
        const blob = await window.taotie.picture(size);
        const bytes = new Uint8Array(await blob.arrayBuffer());
        let text = "";
        for (const byte of bytes) text += String.fromCharCode(byte);
        return btoa(text);
    }, size);
    return Buffer.from(data, "base64");
}
