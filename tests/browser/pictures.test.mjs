// Tests the pictures of the report page: the wipe, the shared lens, the choice of left and right.

import assert from "node:assert/strict";
import { after, test } from "node:test";
import { assertColor, assertQuiet, click, drag, key, launch, open, place, pointOf, touch, wheel } from "./browser.mjs";

const [RED, GREEN, BLUE, GREY] = [[200, 30, 30], [30, 160, 60], [40, 60, 200], [128, 128, 128]];
const WIPE = ".wipe .frame";

const browser = await launch(["--disable-gpu"]);
after(() => browser.close());

// Checks points of the wipe by their fraction of the width, away from the knob of the handle.
async function assertWipe(page, colors) {
    for (const [share, color] of colors) await assertColor(page, WIPE, [share, 0.3], color);
}

const handle = (page, property) => page.locator(".handle").evaluate((handle, name) => handle[name], property);

test("the wipe follows mouse, touch and keys", async () => {
    const page = await open(browser, "wipe.html", [1200, 900]);
    await assertWipe(page, [[0.1, RED], [0.4, RED], [0.6, BLUE], [0.9, BLUE]]);
    const [x, y, width, height] = await place(page, WIPE);
    const at = (share) => [x + share * width, y + height / 2];
    await drag(page, at(0.5), at(0.25));
    await assertWipe(page, [[0.1, RED], [0.22, RED], [0.28, BLUE], [0.4, BLUE]]);
    assert.equal(await handle(page, "ariaValueNow"), "25");
    await touch(page, [[at(0.25), at(0.75)]]);
    await assertWipe(page, [[0.72, RED], [0.78, BLUE]]);
    await page.locator(".handle").focus();
    await key(page, "Home");
    await assertWipe(page, [[0.05, BLUE]]);
    for (const name of ["PageUp", "PageUp", "PageUp", "ArrowRight"]) await key(page, name);
    assert.equal(await handle(page, "ariaValueText"), "31 % red, 69 % blue");
    await assertWipe(page, [[0.29, RED], [0.33, BLUE]]);
    await drag(page, at(0.31), [x + width * 3, y]);
    assert.equal(await handle(page, "ariaValueNow"), "100");
    await assertWipe(page, [[0.95, RED]]);
    assertQuiet(page);
});

// Returns the part of each visible picture that its frame shows: left, top, right, bottom in fractions.
function partsSeen(page) {
    return page.locator(".view:not([hidden]) .frame img").evaluateAll((images) =>
        images.map((image) => {
            const all = image.getBoundingClientRect();
            const frame = image.closest(".frame").getBoundingClientRect();
            const x = (v) => (v - all.x) / all.width;
            const y = (v) => (v - all.y) / all.height;
            return [x(frame.left), y(frame.top), x(frame.right), y(frame.bottom)];
        }),
    );
}

function assertNear(found, wanted, tolerance) {
    const near = found.every((value, i) => Math.abs(value - wanted[i]) < tolerance);
    assert(near, `${found} instead of ${wanted} within ${tolerance}`);
}

// Returns the visible part of all five pictures, which must be the same.
async function partSeen(page) {
    const parts = await partsSeen(page);
    assert.equal(parts.length, 5);
    for (const part of parts) assertNear(part, parts[0], 1e-3);
    return parts[0];
}

const WHOLE = [0, 0, 1, 1];

test("all pictures zoom and move in step", async () => {
    const page = await open(browser, "views.html", [1200, 900]);
    assertNear(await partSeen(page), WHOLE, 5e-4);
    // Over the second small picture, at three quarters of its width and one quarter of its height.
    const pointer = await pointOf(page, "figure:nth-child(2) .frame", [0.75, 0.25]);
    for (let turn = 0; turn < 4; turn++) await wheel(page, pointer, -240);
    const [left, top, right, bottom] = await partSeen(page);
    const zoom = 1 / (right - left);
    assert(zoom > 4, `zoom ${zoom}`);
    assertNear([(bottom - top) * zoom], [1], 1e-3);
    assertNear([left + 0.75 * (right - left), top + 0.25 * (bottom - top)], [0.75, 0.25], 0.01);
    await assertColor(page, "figure:nth-child(1) .frame", [0.05, 0.5], GREY);
    const rendering = (image) => getComputedStyle(image).imageRendering;
    assert.equal(await page.locator(".wipe img").first().evaluate(rendering), "pixelated");

    // Dragging the wipe's picture to the right by half a frame moves all pictures by that.
    const [x, y, width] = await place(page, WIPE);
    await drag(page, [x + 0.1 * width, y + 20], [x + 0.6 * width, y + 20]);
    const [moved] = await partSeen(page);
    assertNear([moved], [left - 0.5 / zoom], 5e-3);

    // Far to the right: pictures stop at their borders, and the first quarter fills all frames.
    for (let i = 0; i < 6; i++) await drag(page, [x + 0.1 * width, y + 20], [x + 0.95 * width, y + 20]);
    const corner = await partSeen(page);
    assertNear([corner[0]], [0], 1e-3);
    for (const [nth, color] of [[1, RED], [2, GREEN], [3, BLUE]])
        await assertColor(page, `figure:nth-child(${nth}) .frame`, [0.9, 0.9], color);

    // The other view has the same lens, and a double click shows the whole picture again.
    await click(page, "[role=tab]:nth-child(2)");
    assertNear(await partSeen(page), corner, 1e-3);
    await click(page, ".view:not([hidden]) figure:nth-child(3) .frame", 2);
    assertNear(await partSeen(page), WHOLE, 5e-4);
    assertQuiet(page);
});

test("two fingers zoom, and the wheel still scrolls the page", async () => {
    const page = await open(browser, "long.html", [420, 800]);
    const [x, y, width, height] = await place(page, WIPE);
    const at = (u, v) => [x + u * width, y + v * height];
    await touch(page, [[at(0.4, 0.2), at(0.2, 0.2)], [at(0.6, 0.2), at(0.8, 0.2)]]);
    const [left, top, right] = await partSeen(page);
    const zoom = 1 / (right - left);
    assert(zoom >= 2.5 && zoom < 3.5, `fingers three times as far apart zoom by ${zoom}`);
    assertNear([left + 0.5 / zoom, top + 0.2 / zoom], [0.5, 0.2], 0.05);

    await click(page, WIPE, 2);
    const scrolled = await page.evaluate(() => scrollY);
    const middle = await pointOf(page, WIPE, [0.5, 0.5]);
    await wheel(page, [middle[0], middle[1] - 60], 200);
    await page.waitForFunction((before) => scrollY > before + 50, scrolled);
    assertNear(await partSeen(page), WHOLE, 5e-4);
    assertQuiet(page);
});

// Returns the selected view, and the labels of its left and right pictures.
async function chosen(page) {
    const view = ".view:not([hidden])";
    const selectors = ["[role=tab][aria-selected=true]", `${view} .tag.left`, `${view} .tag.right`];
    return Promise.all(selectors.map((selector) => page.locator(selector).textContent()));
}

test("selections persist by label", async () => {
    const page = await open(browser, "views.html", [1200, 900]);
    assert.deepEqual(await chosen(page), ["first", "red", "blue"]);
    await click(page, "figure:nth-child(3) [aria-label='Show blue on the left']");
    await click(page, "figure:nth-child(2) [aria-label='Show green on the right']");
    assert.deepEqual(await chosen(page), ["first", "blue", "green"]);
    await click(page, "[role=tab]:nth-child(2)");
    assert.deepEqual(await chosen(page), ["second", "blue", "green"]);
    await assertColor(page, ".view:not([hidden]) .wipe .frame", [0.25, 0.25], BLUE);
    await click(page, ".view:not([hidden]) [title='Swap left and right']");
    assert.deepEqual(await chosen(page), ["second", "green", "blue"]);
    await page.locator("[role=tab][aria-selected=true]").focus();
    await key(page, "ArrowRight");
    assert.deepEqual(await chosen(page), ["first", "green", "blue"]);
    await page.waitForFunction(() => location.hash === "#view=first&left=green&right=blue");

    // The address written by the page restores the same state.
    await page.reload();
    assert.deepEqual(await chosen(page), ["first", "green", "blue"]);
    await page.evaluate(() => (location.hash = "#view=second&left=nobody&right=red&zoom=4&x=0.5&wipe=many"));
    await page.waitForFunction(() => document.querySelector("[role=tab]:nth-child(2)").ariaSelected === "true");
    assert.deepEqual(await chosen(page), ["second", "green", "red"]);
    assertNear(await partSeen(page), [0.5, 0, 0.75, 0.25], 5e-4);
    assertQuiet(page);
});
