// Drives a browser and reads its pages. BROWSER is the program, FOLDER contains the pages.

import assert from "node:assert/strict";
import { readFile, readdir } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { inflateSync } from "node:zlib";
import { chromium, firefox } from "playwright-core";

export const folder = process.env.FOLDER;

const executablePath = process.env.BROWSER;
export const isFirefox = path.basename(executablePath).startsWith("firefox");

// The folder where Firefox saves downloads.
const downloadsPath = path.join(folder, "downloads");

// The system's Firefox is driven by WebDriver BiDi, which the channel name requests.
const launchFirefox = () =>
    firefox.launch({ channel: "moz-firefox", executablePath, downloadsPath, firefoxUserPrefs: { "webgl.force-enabled": true } });

// Starts the browser; the arguments are for Chromium.
export const launch = (args) => (isFirefox ? launchFirefox() : chromium.launch({ executablePath, args }));

// The requests and complaints of each page.
const heard = new WeakMap();

// The addresses that a page requested.
export const requests = (page) => heard.get(page).requests;

// Exceptions and console messages of a page.
export const complaints = (page) => heard.get(page).complaints;

// The same for a page that reads pixels back, without the warning that reading waits for drawing.
export const complaintsOfReader = (page) =>
    complaints(page).filter((text) => !text.includes("GPU stall due to ReadPixels"));

// Playwright adds a style to Firefox pages before taking a screenshot, which the page's policy blocks. Faults of the
// page itself are also reported by Chromium.
const isOfPlaywright = (text) => isFirefox && text.includes("blocked an inline style");

// Opens a page that records its requests and complaints.
export async function newPage(browser, [width, height]) {
    const page = await browser.newPage({ viewport: { width, height } });
    page.setDefaultTimeout(15_000);
    const [requests, complaints] = [[], []];
    heard.set(page, { requests, complaints });
    page.on("request", (request) => requests.push(request.url()));
    const note = (text) => isOfPlaywright(text) || complaints.push(text);
    page.on("pageerror", (error) => note(String(error)));
    page.on("console", (message) => note(message.text()));
    return page;
}

// Loads a page from disk.
export async function go(page, name) {
    await page.goto(pathToFileURL(path.join(folder, name)).href);
    await page.waitForFunction(() => [...document.images].every((image) => image.complete));
}

// Opens a page from disk in a window of this size.
export async function open(browser, name, size) {
    const page = await newPage(browser, size);
    await go(page, name);
    return page;
}

// Fails if the page requested anything except itself and data URLs, or if the browser complained. Firefox does not
// report files from disk, but everything else.
export function assertQuiet(page) {
    const { requests, complaints } = heard.get(page);
    assert.deepEqual(complaints, []);
    const isPage = (url) => url.startsWith("file:") && url.endsWith(".html");
    assert(isFirefox || requests.some(isPage), "nothing was watched");
    assert.deepEqual(requests.filter((url) => !url.startsWith("data:") && !isPage(url)), []);
}

// Waits until changes to the page have been drawn.
export function settle(page) {
    return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

// Scrolls to the first matching element and returns its left, top, width and height in the window.
export async function place(page, selector) {
    const element = page.locator(selector).first();
    await element.evaluate((element) => element.scrollIntoView({ block: "center" }));
    await settle(page);
    const { x, y, width, height } = await element.boundingBox();
    return [x, y, width, height];
}

// Returns the point of an element at these fractions of its width and height.
export async function pointOf(page, selector, [u, v]) {
    const [x, y, width, height] = await place(page, selector);
    return [x + u * width, y + v * height];
}

// Presses the mouse at one point, moves it in steps to another and releases it.
export async function drag(page, from, to) {
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 5 });
    await page.mouse.up();
    await settle(page);
}

// Clicks the centre of the first matching element `clickCount` times in a row.
export async function click(page, selector, clickCount = 1) {
    await page.mouse.click(...(await pointOf(page, selector, [0.5, 0.5])), { clickCount });
    await settle(page);
}

// Moves the mouse without a button.
export async function hover(page, at) {
    await page.mouse.move(...at);
    await settle(page);
}

// Turns the wheel at a point; negative deltas scroll up.
export async function wheel(page, at, delta) {
    await page.mouse.move(...at);
    await page.mouse.wheel(0, delta);
    await settle(page);
}

// Presses and releases a key by name, such as `ArrowLeft`.
export async function key(page, name) {
    await page.keyboard.press(name);
    await settle(page);
}

// Touches the screen with fingers that move together in steps and leave it, as pairs of start and end points.
// Playwright itself only has a tap with one finger.
export async function touch(page, fingers) {
    const devtools = await page.context().newCDPSession(page);
    const send = (type, touchPoints) => devtools.send("Input.dispatchTouchEvent", { type, touchPoints });
    const at = (share) =>
        fingers.map(([from, to]) => ({
            x: from[0] + (to[0] - from[0]) * share,
            y: from[1] + (to[1] - from[1]) * share,
        }));
    await devtools.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 5 });
    await send("touchStart", at(0));
    for (let step = 1; step <= 8; step++) await send("touchMove", at(step / 8));
    await send("touchEnd", []);
    await settle(page);
}

// Returns the bytes of the file that `act` saves. Playwright is not notified of Firefox downloads: poll their folder.
export async function saved(page, act) {
    if (!isFirefox) {
        const [download] = await Promise.all([page.waitForEvent("download"), act()]);
        return readFile(await download.path());
    }
    const names = () => readdir(downloadsPath).catch(() => []);
    const before = await names();
    await act();
    for (const end = Date.now() + 15_000; Date.now() < end; await page.waitForTimeout(50)) {
        const [name] = (await names()).filter((name) => !before.includes(name) && !name.endsWith(".part"));
        const bytes = name && (await readFile(path.join(downloadsPath, name)));
        if (bytes?.length) return bytes;
    }
    throw new Error("nothing was saved");
}

// Returns the compressed pixels of a PNG, which may be in several chunks.
export function pixelData(png) {
    const chunks = [];
    for (let at = 8, length; at < png.length; at += 12 + length) {
        length = png.readUInt32BE(at);
        if (png.toString("latin1", at + 4, at + 8) === "IDAT") chunks.push(png.subarray(at + 8, at + 8 + length));
    }
    return Buffer.concat(chunks);
}

// Returns the colour of a point of the window. PNG filters do not change the first pixel, so no decoder is needed.
export async function colorAt(page, [x, y]) {
    const clip = { x: Math.floor(x), y: Math.floor(y), width: 1, height: 1 };
    const png = await page.screenshot({ clip, caret: "initial" });
    const [, red, green, blue] = inflateSync(pixelData(png));
    return [red, green, blue];
}

export const isSame = (a, b) => a.every((value, i) => Math.abs(value - b[i]) <= 3);

// Fails unless a point, in fractions of an element, has this colour.
export async function assertColor(page, selector, [u, v], wanted) {
    const found = await colorAt(page, await pointOf(page, selector, [u, v]));
    assert(isSame(found, wanted), `${selector} at ${u}, ${v}: ${found} instead of ${wanted}`);
}
