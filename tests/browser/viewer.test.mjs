// Tests the pages of `taotie view` by mouse, touch, keys and pixels.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { after, test } from "node:test";
import { gzipSync } from "node:zlib";
import hyperion from "@hyperion-framework/validator";
import axe from "axe-core";
import { assertQuiet, colorAt, complaints, folder, isFirefox, newPage, pixelData, pointOf, saved, touch } from "./browser.mjs";
import { assertManifest } from "./iiif.mjs";
import { SIZE, address, launchWebGl, openViewer, picture, state, still } from "./viewer.mjs";

const { Validator } = hyperion;
const browser = await launchWebGl();
after(() => browser.close());

const pages = new Map();

// Returns the shared page with this name, showing a link in a window of the usual size.
async function shown(name, fragment = "") {
    const page = pages.get(name) ?? (await openViewer(browser, name));
    pages.set(name, page);
    await page.setViewportSize({ width: SIZE[0], height: SIZE[1] });
    await page.evaluate((fragment) => window.taotie.show(window.taotie.linked(fragment)), fragment);
    await still(page);
    return page;
}

const near = (a, b, slack = 1e-3) => assert(Math.abs(a - b) <= slack, `${a} instead of ${b}`);

// Drags the mouse over the picture by this many pixels.
async function dragCanvas(page, [x, y]) {
    const from = await pointOf(page, "canvas", [0.5, 0.5]);
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(from[0] + x, from[1] + y, { steps: 4 });
    await page.mouse.up();
    await still(page);
}

// Returns the sum of a pixel's channels at fractions of the picture.
async function light(page, at) {
    const color = await colorAt(page, await pointOf(page, "canvas", at));
    return color.reduce((sum, channel) => sum + channel);
}

test("a drag turns the model, and with shift the light", async () => {
    const page = await shown("view.html");
    const first = await state(page);
    await dragCanvas(page, [50, 25]);
    const turned = await state(page);
    near(turned.view[0], first.view[0] - 20);
    near(turned.view[1], first.view[1] + 10);
    assert.equal(turned.light, "given");
    await page.keyboard.down("Shift");
    await dragCanvas(page, [40, -20]);
    await page.keyboard.up("Shift");
    const lit = await state(page);
    assert.deepEqual(lit.view, turned.view);
    assert.equal(lit.light, "raking");
    near(lit.from[0], first.from[0] + 20);
    near(lit.from[1], first.from[1] + 10);
    assertQuiet(page);
});

test("moving pictures have fewer pixels if frames take long", async () => {
    const page = await shown("view.html");
    const widths = await page.evaluate(async () => {
        const { prototype } = WebGL2RenderingContext;
        const { getSyncParameter } = prototype;
        const begun = new Map();
        prototype.getSyncParameter = function (fence, name) {
            if (!begun.has(fence)) begun.set(fence, performance.now());
            const isLate = performance.now() - begun.get(fence) > 100;
            return isLate ? getSyncParameter.call(this, fence, name) : this.UNSIGNALED;
        };
        const widths = [];
        for (let turn = 0; turn < 4; turn++) {
            window.taotie.change({ view: [turn, 10, window.taotie.state.view[2]] });
            await new Promise((later) => setTimeout(later, 130));
            widths.push(window.taotie.canvas.width);
        }
        prototype.getSyncParameter = getSyncParameter;
        return widths;
    });
    const whole = await page.locator("canvas").evaluate((canvas) => canvas.clientWidth * devicePixelRatio);
    assert(widths[3] <= whole / 2, `${widths} of ${whole}`);
    await still(page);
    assert.equal(await page.locator("canvas").evaluate((canvas) => canvas.width), Math.round(whole));
    assertQuiet(page);
});

test("light from a side lights that side", async () => {
    const page = await shown("proof.html", "light=raking&from=-80,0&fill=0&mode=clay&surface=smooth");
    const sides = async () => [await light(page, [0.42, 0.6]), await light(page, [0.58, 0.6])];
    const [left, right] = await sides();
    assert(left > right + 30, `${left}, ${right}`);
    await page.evaluate(() => window.taotie.change({ from: [80, 0] }));
    await still(page);
    const [darker, brighter] = await sides();
    assert(brighter > darker + 30, `${darker}, ${brighter}`);
    // A light fixed to the object stays with it.
    await page.getByLabel("Fixed to").selectOption("object");
    await still(page);
    const fixed = await state(page);
    near(fixed.from[0], 80 + fixed.view[0], 0.5);
    assertQuiet(page);
});

test("keys do the same as the mouse", async () => {
    const page = await shown("view.html");
    const first = await state(page);
    await page.locator("canvas").focus();
    const press = async (...keys) => {
        for (const key of keys) await page.keyboard.press(key);
        await still(page);
        return state(page);
    };
    near((await press("ArrowRight")).view[0], first.view[0] - 5);
    near((await press("ArrowUp")).view[1], first.view[1] - 5);
    near((await press("Shift+ArrowLeft")).from[0], first.from[0] - 5);
    near((await press("l", "ArrowUp", "l")).from[1], first.from[1] + 5);
    assert((await press("+")).view[2] < first.view[2]);
    assert.equal((await press("m")).mode, "clay");
    assert.equal((await press("w")).wireframe, true);
    assert.deepEqual(await press("0"), first);
    assertQuiet(page);
});

test("touch turns and zooms", { skip: isFirefox && "Playwright has no touch input for Firefox" }, async () => {
    const page = await shown("view.html");
    const first = await state(page);
    const [x, y] = await pointOf(page, "canvas", [0.5, 0.5]);
    await touch(page, [[[x, y], [x + 50, y]]]);
    await still(page);
    const turned = await state(page);
    near(turned.view[0], first.view[0] - 20, 0.5);
    await touch(page, [[[x - 40, y], [x - 80, y]], [[x + 40, y], [x + 80, y]]]);
    await still(page);
    near((await state(page)).view[2], first.view[2] / 2, 0.1 * first.view[2]);
    assertQuiet(page);
});

test("a link reproduces every pixel", async () => {
    const page = await shown("view.html");
    await page.evaluate(() => {
        const [azimuth, elevation, distance] = window.taotie.state.view;
        const view = [azimuth + 12.3456, elevation - 3.21, distance * 0.8123];
        window.taotie.change({ view, light: "raking", from: [33.3, 44.4], shading: "cook-torrance", tone: "aces" });
    });
    await still(page);
    const again = await newPage(browser, SIZE);
    await again.goto(page.url());
    await still(again);
    assert.notEqual(page.url(), address("view.html"));
    assert.deepEqual(await state(again), await state(page));
    const [before, after] = [await picture(page, [200, 200]), await picture(again, [200, 200])];
    assert.deepEqual(after, before);
    assertQuiet(again);
    await again.close();
});

test("a saved picture contains its link", async () => {
    const page = await shown("view.html", "mode=normals");
    const png = await picture(page, [64, 64]);
    assert(png.includes("iTXttaotie:view\0\0\0\0\0mode=normals"));
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [64, 64]);
});

test("every mode draws a different picture", async () => {
    const page = await shown("view.html");
    const seen = new Set();
    const modes = await page.getByLabel("Show", { exact: true }).locator("option").evaluateAll((all) => all.map((o) => o.value));
    for (const mode of modes) {
        await page.getByLabel("Show", { exact: true }).selectOption(mode);
        await still(page);
        seen.add((await picture(page, [64, 64])).subarray(33 + 40).toString("base64"));
    }
    assert.equal(seen.size, modes.length);
    assertQuiet(page);
});

test("every reflectance model compiles", async () => {
    const page = await shown("view.html");
    const models = await page.getByLabel("Reflectance model").locator("option").count();
    assert.equal(models, 9);
    for (let number = 0; number < models; number++) {
        await page.getByLabel("Reflectance model").selectOption({ index: number });
        await still(page);
    }
    assertQuiet(page);
});

// Checks that axe finds no violations in a window of this size.
async function audit(page, [width, height], colorScheme) {
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
    await still(page);
    const { violations } = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)]), []);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
    assert(!wide, "the page is wider than the window");
}

test("axe finds no violations on a desktop and on a phone in dark mode", async () => {
    const page = await shown("view.html", "light=raking");
    await page.evaluate(axe.source);
    await audit(page, [900, 500], "light");
    await audit(page, [390, 780], "dark");
});

test("controls are hidden initially on a phone", async () => {
    const page = await newPage(browser, [390, 500]);
    await page.goto(address("proof.html"));
    await still(page);
    assert(!(await page.locator("#panel").isVisible()));
    await page.getByRole("button", { name: "Show controls" }).click();
    assert(await page.locator("#panel").isVisible());
    assertQuiet(page);
    await page.close();
});

test("the focus is visible", async () => {
    const page = await shown("view.html");
    await page.bringToFront();
    await page.locator("canvas").focus();
    await page.keyboard.press("Tab");
    await page.keyboard.press("Shift+Tab");
    const outline = await page.evaluate(() => {
        const focused = document.activeElement.shadowRoot.activeElement;
        const { outlineStyle, outlineWidth } = getComputedStyle(focused);
        return [focused.tagName, outlineStyle, parseFloat(outlineWidth) >= 2];
    });
    assert.deepEqual(outline, ["CANVAS", "solid", true]);
});

test("a wipe shows two models in the same light", async () => {
    const page = await shown("proof.html", "mode=normals");
    await page.getByLabel("Right of the wipe").selectOption("smooth");
    await still(page);
    await page.getByLabel("Right of the wipe").selectOption("scan");
    await page.evaluate(() => window.taotie.change({ split: 1 }));
    await still(page);
    const left = await colorAt(page, await pointOf(page, "canvas", [0.55, 0.4]));
    await page.evaluate(() => window.taotie.change({ split: 0.5 }));
    await still(page);
    const handle = page.getByRole("slider", { name: "Wipe" });
    const [x, y] = await pointOf(page, ".wipe", [0.5, 0.5]);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x - 60, y, { steps: 3 });
    await page.mouse.up();
    await still(page);
    const width = await page.locator("canvas").evaluate((canvas) => canvas.clientWidth);
    near((await state(page)).split, 0.5 - 60 / width, 0.01);
    await handle.focus();
    await page.keyboard.press("Home");
    await still(page);
    assert.equal((await state(page)).split, 0);
    const scan = await colorAt(page, await pointOf(page, "canvas", [0.55, 0.4]));
    assert.notDeepEqual(scan, left, "the scan's normals are its own");
    await page.keyboard.press("End");
    await still(page);
    assert.deepEqual(await colorAt(page, await pointOf(page, "canvas", [0.55, 0.4])), left);
    assertQuiet(page);
});

test("the error under the pointer matches the map", async () => {
    const page = await shown("proof.html", "mode=error");
    // Above the legend.
    const at = await pointOf(page, "canvas", [0.5, 0.3]);
    const degrees = await page.evaluate((at) => window.taotie.errorUnder(...at), at);
    assert(degrees >= 0 && degrees < 10, `${degrees}`);
    const { errors } = await page.evaluate(() => window.taotie.data);
    assert(errors.mean > 0.1 && errors.mean < 10, `${errors.mean}`);
    // The drawn colour is that of the legend at this angle.
    const place = (degrees / errors.top) * (errors.stops.length - 1);
    const [a, b] = [errors.stops[Math.floor(place)], errors.stops[Math.ceil(place)]];
    const wanted = a.map((channel, i) => channel + (b[i] - channel) * (place % 1));
    const found = await colorAt(page, at);
    assert(found.every((channel, i) => Math.abs(channel - wanted[i]) <= 12), `${found} instead of ${wanted}`);
    await page.mouse.move(at[0] + 1, at[1]);
    await page.locator(".legend output", { hasText: /[0-9]° under the pointer/ }).waitFor();
    assertQuiet(page);
});

// Returns the point of a model under a point of the window, its uncertainty, and true if the model is the asset.
const picked = (page, at) =>
    page.evaluate((at) => {
        const { point, precision, exhibit } = window.taotie.pick(...at);
        return { point: point.toArray(), precision, isAsset: exhibit.isAsset };
    }, at);

test("distances and sections are measured on the model", async () => {
    const page = await shown("proof.html");
    // Whole pixels, since Firefox rounds mouse positions.
    const pixel = async (at) => (await pointOf(page, "canvas", at)).map(Math.round);
    const ends = [await pixel([0.45, 0.5]), await pixel([0.55, 0.5])];
    const picks = [await picked(page, ends[0]), await picked(page, ends[1])];
    const points = picks.map(({ point }) => point);
    const length = Math.hypot(...points[0].map((v, i) => v - points[1][i]));
    // Half a pixel for each end: the picture shows a ball of two units with a margin, and its near side is larger.
    const height = await page.evaluate(() => window.taotie.canvas.clientHeight);
    const pixel_length = (picks[0].precision * 2 * height) / 2;
    assert(pixel_length > 0.8 && pixel_length < 1.1, `${pixel_length}`);
    await page.locator("summary", { hasText: "Measure" }).click();
    await page.getByRole("button", { name: "Section" }).click();
    for (const at of ends) await page.mouse.click(...at);
    const result = await page.locator(".result").textContent();
    const [, value, doubt, unit] = result.match(/^([0-9.]+) ± ([0-9.]+) (mm|cm|m)$/) ?? assert.fail(result);
    const metres = { mm: 1e-3, cm: 1e-2, m: 1 }[unit];
    near(value * metres, length, doubt * metres);
    const { errors } = await page.evaluate(() => window.taotie.data);
    const known = Math.hypot(...picks.map(({ precision }) => precision), errors.distance.rms, errors.distance.rms);
    near(doubt * metres, known, 0.5 * known);
    const decimals = (text) => (text.split(".")[1] ?? "").length;
    assert.equal(decimals(value), decimals(doubt), "the value is rounded to its uncertainty");
    const csv = await saved(page, () => page.getByRole("button", { name: "Profile as CSV" }).click());
    const [head, ...rows] = csv.toString().trim().split("\n");
    assert.equal(head, "along_from (m),above_from (m),along_to (m),above_to (m)");
    const svg = await saved(page, () => page.getByRole("button", { name: "Profile as SVG" }).click());
    assert.match(svg.toString(), /<title>Profile, lengths in m<\/title>/);
    const pieces = rows.map((row) => row.split(",").map(Number));
    assert(pieces.length >= 2, `${pieces.length} pieces`);
    // Between the points the ball bulges by its sagitta, and its far side lies two radii behind.
    const nearSide = pieces.flatMap(([, a, , b]) => [a, b]).filter((above) => above > -0.5);
    const sagitta = 1 - Math.sqrt(1 - (length / 2) ** 2);
    assert(Math.max(...nearSide) <= sagitta + 0.02 && Math.max(...nearSide) > 0, `${nearSide}, ${sagitta}`);
    assertQuiet(page);
});

test("right of the wipe, points are those of the scan and have no error", async () => {
    const page = await openViewer(browser, "proof.html", { fragment: "mode=error&beside=scan&split=0.3" });
    const ends = [await pointOf(page, "canvas", [0.5, 0.3]), await pointOf(page, "canvas", [0.53, 0.35])];
    const degrees = () => page.evaluate((at) => window.taotie.errorUnder(...at), ends[0]);
    const distance = ([x, y, z]) => Math.abs(Math.hypot(x, y / 0.8, z) - 1);
    const scan = [await picked(page, ends[0]), await picked(page, ends[1])];
    assert.deepEqual(scan.map(({ isAsset }) => isAsset), [false, false]);
    assert.equal(await degrees(), undefined);
    await page.locator("summary", { hasText: "Measure" }).click();
    await page.getByRole("button", { name: "Section" }).click();
    for (const at of ends) await page.mouse.click(...at);
    // The distance between asset and scan does not make points of the scan uncertain.
    const doubt = Number((await page.locator(".result").textContent()).match(/ ± ([0-9.]+) cm$/)[1]) / 100;
    const known = Math.hypot(...scan.map(({ precision }) => precision));
    near(doubt, known, 0.1 * known);
    const csv = await saved(page, () => page.getByRole("button", { name: "Profile as CSV" }).click());
    const pieces = csv.toString().trim().split("\n").length - 1;
    await page.evaluate(() => window.taotie.change({ split: 1 }));
    await still(page);
    const asset = await picked(page, ends[0]);
    assert.equal(asset.isAsset, true);
    assert((await degrees()) >= 0);
    assert(distance(scan[0].point) < 0.3 * distance(asset.point), `${scan[0].point}, ${asset.point}`);
    for (const at of ends) await page.mouse.click(...at);
    const coarse = await saved(page, () => page.getByRole("button", { name: "Profile as CSV" }).click());
    assert(pieces > coarse.toString().trim().split("\n").length - 1, "the profile is that of the scan");
    assertQuiet(page);
    await page.close();
});

test("an angle needs three different points in a row", async () => {
    const page = await openViewer(browser, "proof.html");
    await page.locator("summary", { hasText: "Measure" }).click();
    await page.getByRole("button", { name: "Angle" }).click();
    const result = page.locator(".result");
    const center = () => page.getByRole("button", { name: "Point at the centre" }).click();
    const [x, y] = await pointOf(page, "canvas", [0.53, 0.45]);
    const other = () => page.mouse.click(x, y);
    const same = /^This is the same point as the previous one/;
    const steps = [
        [center, /^Pick 2 more points/],
        [center, same],
        [other, /^Pick 1 more point/],
        [other, same],
        [center, /^[0-9.]+ ± [0-9.]+°$/],
    ];
    for (const [act, expected] of steps) {
        await act();
        assert.match(await result.textContent(), expected);
    }
    assertQuiet(page);
    await page.close();
});

// Listens to the errors of the element, without their messages in the console.
const listenToErrors = () => {
    window.refused = [];
    const hear = (event) => {
        if (event.target.localName !== "taotie-viewer") return;
        event.preventDefault();
        window.refused.push(event.message);
    };
    document.addEventListener("error", hear, true);
};

test("invalid values are refused with a message that names them and what is accepted", async () => {
    const page = await shown("view.html");
    await page.evaluate(listenToErrors);
    const first = await state(page);
    const cases = [
        [{ view: "x" }, /`view` `"x"`: expected 3 numbers: azimuth.*, elevation .* from -90 to 90, distance/],
        [{ view: [NaN, 0, 1] }, /`view` `\["NaN",0,1\]`/],
        [{ view: [0, 91, 1] }, /from -90 to 90/],
        [{ split: 2 }, /`split` `2`: .*from 0 to 1/],
        [{ wireframe: "yes" }, /`wireframe` `"yes"`: expected true or false/],
        [{ mode: "error" }, /`mode` `"error"`: expected one of: shaded, clay/],
        [{ shading: "ggx", shadng: "ggx" }, /`shadng`: expected one of: .*shading/],
        [null, /`null`: expected an object/],
    ];
    const messages = await page.evaluate((parts) => {
        for (const part of parts) window.taotie.change(part);
        return window.refused;
    }, cases.map(([part]) => part));
    assert.equal(messages.length, cases.length, messages.join("\n"));
    cases.forEach(([, expected], i) => assert.match(messages[i], expected));
    assert.deepEqual(await state(page), first);
    // The mouse reaches the end of a range without an error.
    for (let turn = 0; turn < 3; turn++) await dragCanvas(page, [0, 100]);
    assert.equal((await state(page)).view[1], 90);
    assert.equal(await page.evaluate(() => window.refused.length), cases.length);
    assertQuiet(page);
});

test("pictures of impossible sizes are refused", async () => {
    const page = await shown("view.html");
    const sizes = [[20000, 20000], [0, 10], [10.5, 10], [10], "x", null];
    const messages = await page.evaluate((sizes) => {
        const take = (size) => window.taotie.picture(size).then(({ size }) => `${size} bytes`, ({ message }) => message);
        return Promise.all(sizes.map(take));
    }, sizes);
    sizes.forEach((size, i) => assert(messages[i].includes(`\`${JSON.stringify(size)}\`: expected [width, height]`), messages[i]));
    await still(page);
    const png = await picture(page, [30, 20]);
    assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [30, 20]);
    assertQuiet(page);
});

test("a picture returns after the graphics driver was reset", async () => {
    const page = await openViewer(browser, "proof.html", { fragment: "light=raking&shadows=true&beside=scan" });
    const before = await picture(page, [96, 64]);
    const lost = await page.evaluate(async () => {
        window.loss = window.taotie.canvas.getContext("webgl2").getExtension("WEBGL_lose_context");
        const heard = new Promise((done) => window.taotie.canvas.addEventListener("webglcontextlost", done));
        window.loss.loseContext();
        await heard;
        // The browser restores nothing before all listeners have heard of the loss.
        await new Promise((later) => setTimeout(later));
        window.taotie.change({ mode: "clay" });
        window.taotie.change({ mode: "shaded" });
        const refused = await window.taotie.picture([96, 64]).catch(({ message }) => message);
        const viewer = document.querySelector("taotie-viewer");
        const texts = [refused, viewer.shadowRoot.querySelector(".message").textContent];
        const state = viewer.dataset.state;
        window.loss.restoreContext();
        return [state, ...texts];
    });
    assert.equal(lost[0], "loading");
    for (const text of lost.slice(1)) assert.match(text, /graphics driver was reset/);
    await still(page);
    assert.deepEqual(await picture(page, [96, 64]), before);
    assert.equal(await page.locator(".message").textContent(), "");
    await page.close();
});

test("without WebGL or gzip, a still picture and an explanation are shown", async () => {
    const lacks = [
        [() => void (HTMLCanvasElement.prototype.getContext = () => null), /WebGL 2/],
        [() => void delete window.DecompressionStream, /too old to unpack/],
    ];
    for (const [prepare, explanation] of lacks) {
        const page = await newPage(browser, SIZE);
        await page.addInitScript(prepare);
        await page.addInitScript(listenToErrors);
        await page.goto(address("view.html"));
        const image = page.locator("img.still");
        await image.waitFor();
        assert.equal(await image.evaluate(({ naturalWidth, naturalHeight }) => Math.max(naturalWidth, naturalHeight)), 480);
        const message = await page.getByRole("alert").textContent();
        assert.match(message, explanation);
        assert.match(message, /picture shows its initial view/);
        assert.match((await page.evaluate(() => window.refused)).join(), explanation);
        assertQuiet(page);
        await page.close();
    }
});

// The boxes of the visible parts of a viewer.
const parts = () => {
    const { shadowRoot } = document.querySelector("taotie-viewer");
    const names = [".title", ".fold", ".sides", "canvas", ".places", ".legend", "#panel"];
    const found = names.map((name) => [name, shadowRoot.querySelector(name)]).filter(([, part]) => part?.checkVisibility());
    return found.map(([name, part]) => {
        const { left, top, right, bottom } = part.getBoundingClientRect();
        return { name, left, top, right, bottom, isCut: part.scrollWidth > part.clientWidth + 1 && name !== "canvas" };
    });
};

test("nothing covers the model, or another part, in windows of any width", async () => {
    const page = await shown("proof.html", "mode=error&beside=scan&light=raking");
    const toggle = page.locator(".fold");
    for (const [width, height] of [[320, 568], [800, 500], [1600, 900]]) {
        await page.setViewportSize({ width, height });
        for (let turn = 0; turn < 2; turn++) {
            await still(page);
            const all = await page.evaluate(parts);
            const what = `${width}×${height}, ${all.map(({ name }) => name).join(" ")}`;
            assert(all.length >= 6, what);
            for (const a of all) {
                assert(!a.isCut && a.left >= 0 && a.right <= width, `${a.name} is cut off: ${what}`);
                const covers = (b) => a !== b && a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
                assert.deepEqual(all.filter(covers).map(({ name }) => name), [], `${a.name}: ${what}`);
            }
            const canvas = all.find(({ name }) => name === "canvas");
            assert(canvas.bottom - canvas.top >= 0.24 * height, `${canvas.bottom - canvas.top} rows: ${what}`);
            await toggle.click();
        }
    }
    assertQuiet(page);
});

test("the wipe names its sides", async () => {
    const page = await shown("proof.html");
    const line = page.locator(".sides");
    assert(!(await line.isVisible()));
    await page.evaluate(() => window.taotie.change({ beside: "scan", split: 0.25 }));
    await still(page);
    assert.deepEqual(await line.locator("span").allTextContents(), ["asset", "scan"]);
    const edge = await line.locator("span").first().evaluate((left) => left.getBoundingClientRect().right);
    const { x, width } = await page.locator(".wipe").boundingBox();
    near(edge, x + width / 2, 2);
    assert.match(await page.getByRole("slider", { name: "Wipe" }).getAttribute("aria-valuetext"), /25 % asset, scan/);
    await page.evaluate(() => window.taotie.change({ beside: "smooth" }));
    assert.deepEqual(await line.locator("span").allTextContents(), ["with normal map", "without normal map"]);
});

test("bookmarks can be deleted, and survive a reload", async () => {
    const page = await openViewer(browser, "view.html", { fragment: "mode=clay" });
    const titles = () => page.locator(".bookmarks li button:first-child").allTextContents();
    await page.getByLabel("Title").fill("Clay");
    await page.getByRole("button", { name: "Add this view" }).click();
    await page.getByRole("button", { name: "Delete “The rim <i>”" }).click();
    assert.deepEqual(await titles(), ["Clay"]);
    await page.reload();
    await still(page);
    assert.deepEqual(await titles(), ["Clay"]);
    await page.evaluate(() => window.taotie.change({ mode: "shaded" }));
    await page.getByRole("button", { name: "Clay", exact: true }).click();
    assert.equal((await state(page)).mode, "clay");
    await page.getByRole("button", { name: "Delete “Clay”" }).click();
    await page.getByRole("button", { name: "Restore the page's bookmarks" }).click();
    assert.deepEqual(await titles(), ["The rim <i>"]);
    assertQuiet(page);
    await page.close();
});

test("bookmarks last as long as the page if the browser denies storage", async () => {
    const page = await newPage(browser, SIZE);
    await page.addInitScript(() => {
        const get = () => {
            throw new DOMException("denied", "SecurityError");
        };
        Object.defineProperty(window, "localStorage", { get });
    });
    await page.goto(address("view.html"));
    await still(page);
    await page.getByRole("button", { name: "Delete “The rim <i>”" }).click();
    await page.getByRole("button", { name: "Add this view" }).click();
    assert.equal(await page.locator(".bookmarks li").count(), 1);
    assertQuiet(page);
    await page.close();
});

test("bookmarks show their views and are saved", async () => {
    const page = await shown("view.html");
    const first = await state(page);
    await page.getByRole("button", { name: "The rim <i>", exact: true }).click();
    await still(page);
    assert.deepEqual((await state(page)).from, [-75, 10]);
    await page.getByLabel("Title").fill("Here");
    await page.getByRole("button", { name: "Add this view" }).click();
    await page.evaluate((first) => window.taotie.show(first), first);
    await page.getByRole("button", { name: "Here", exact: true }).click();
    await still(page);
    assert.deepEqual((await state(page)).from, [-75, 10]);
    const bookmarks = JSON.parse(await saved(page, () => page.getByRole("button", { name: "Save bookmarks" }).click()));
    assert.deepEqual(bookmarks.map(({ title }) => title), ["The rim <i>", "Here"]);
    assert.equal(bookmarks[1].link, "light=raking&from=-75,10");
    assertQuiet(page);
});

test("rights and source are shown", async () => {
    const page = await shown("view.html");
    const shownFacts = await page.locator("#panel dl").first().textContent();
    assert(shownFacts.includes("Copyright") && shownFacts.includes("A museum <b>"), shownFacts);
});

test("an unreadable model shows an error message", async () => {
    const page = await newPage(browser, SIZE);
    const text = await readFile(path.join(folder, "view.html"), "utf8");
    const nothing = gzipSync("no model").toString("base64");
    await writeFile(path.join(folder, "broken.html"), text.replace(/(id="taotie-asset">)[^<]*/, `$1${nothing}`));
    await page.addInitScript(listenToErrors);
    await page.goto(address("broken.html"));
    await page.waitForSelector("taotie-viewer[data-state=failed]");
    const message = await page.getByRole("alert").textContent();
    assert(message.startsWith("The model cannot be shown: "), message);
    assert.equal(await page.evaluate(() => window.refused[0]), message.replace(/ The picture shows .*/, ""));
    assert.deepEqual(complaints(page), []);
});

// Opens a page from a server for the folder, with some files replaced, and checks that nothing is fetched from elsewhere.
async function served(name, where = "", replaced = {}) {
    const page = await newPage(browser, SIZE);
    const site = "http://localhost/";
    const elsewhere = [];
    page.on("request", (request) => request.url().startsWith(site) || elsewhere.push(request.url()));
    await page.route(`${site}**`, (route) => {
        const { pathname } = new URL(route.request().url());
        const body = replaced[pathname.slice(1)];
        return route.fulfill(body ? { body } : { path: path.join(folder, where, pathname) });
    });
    await page.goto(site + name);
    await still(page);
    assert.deepEqual(elsewhere.filter((url) => !url.startsWith("blob:") && !url.startsWith("data:")), []);
    return page;
}

test("a folder shows the same as the page", async () => {
    const page = await served("index.html", "site");
    const single = await shown("view.html");
    const pixels = async (page) => pixelData(await picture(page, [128, 128]));
    assert.deepEqual(await pixels(page), await pixels(single));
    await page.evaluate(() => window.taotie.change({ mode: "clay" }));
    await still(page);
    assert(page.url().endsWith("#mode=clay"));
    await page.close();
});

test("a file that could not be fetched is fetched again for the next change", async () => {
    const page = await served("index.html#surface=smooth", "site");
    await page.evaluate(listenToErrors);
    await page.route("**/codes.bin", (route) => route.fulfill({ status: 503 }), { times: 1 });
    await page.evaluate(() => window.taotie.change({ surface: "bump" }));
    await page.waitForFunction(() => window.refused.length > 0);
    assert.match((await page.evaluate(() => window.refused)).join(), /^codes.bin was not found .*503/);
    await page.evaluate(() => window.taotie.change({ exposure: 1 }));
    await still(page);
    await page.close();
});

// PNGs of one texel, whose alpha is 255 and 0.
const TEXELS = ["XnPwAGmgLqY9DQ5gAAAABJRU5ErkJggg==", "WHAQAFmwHrmUtcUgAAAABJRU5ErkJggg=="].map((end) =>
    Buffer.from(`iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mPYEn${end}`, "base64"),
);

// Returns a GLB whose first material has this image as its normal map, and as that of metalness and roughness.
function withMap(glb, png) {
    const json = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)));
    const old = glb.subarray(28 + glb.readUInt32LE(12));
    const bytes = Buffer.concat([old, png, Buffer.alloc(-png.length & 3)]);
    json.bufferViews.push({ buffer: 0, byteOffset: old.length, byteLength: png.length });
    json.buffers[0].byteLength = bytes.length;
    json.images.push({ bufferView: json.bufferViews.length - 1, mimeType: "image/png" });
    const { normalTexture, pbrMetallicRoughness } = json.materials[0];
    for (const { index } of [normalTexture, pbrMetallicRoughness.metallicRoughnessTexture]) {
        json.textures[index] = { source: json.images.length - 1, sampler: 0 };
    }
    const text = Buffer.from(JSON.stringify(json));
    const head = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
    const words = (...all) => Buffer.from(Uint32Array.from(all).buffer);
    const [JSON_CHUNK, BINARY_CHUNK] = [0x4e4f534a, 0x004e4942];
    const size = 28 + head.length + bytes.length;
    return Buffer.concat([glb.subarray(0, 8), words(size, head.length, JSON_CHUNK), head, words(bytes.length, BINARY_CHUNK), bytes]);
}

test("the alpha of maps without colours has no effect", async () => {
    const glb = await readFile(path.join(folder, "site/asset.glb"));
    const drawn = [];
    for (const png of TEXELS) {
        const page = await served("index.html#surface=tangent-normal", "site", { "asset.glb": withMap(glb, png) });
        for (const mode of ["tangent-normals", "roughness"]) {
            await page.evaluate((mode) => window.taotie.change({ mode }), mode);
            drawn.push(pixelData(await picture(page, [64, 64])));
        }
        assert.deepEqual(complaints(page), []);
        await page.close();
    }
    assert.deepEqual(drawn.slice(2), drawn.slice(0, 2));
});

test("an element shows a folder on a page with other content", async (t) => {
    if (!existsSync(path.join(folder, "taotie-viewer.js"))) return t.skip("no packages in viewer/");
    const attributes = 'src="site" light="-75,10,2" camera="30,20" shading="cook-torrance" auto-rotate title="A jue"';
    const listening = `<script>(${listenToErrors})()</script>`;
    const body = `<h1>Bronzes</h1>${listening}<taotie-viewer ${attributes}></taotie-viewer><script type="module" src="taotie-viewer.js"></script>`;
    const style = "<style>taotie-viewer { width: 400px; height: 250px } p { height: 2000px }</style>";
    const html = `<!doctype html><html lang="en"><title>Bronzes</title>${style}${body}<p>More.</p></html>`;
    await writeFile(path.join(folder, "bronzes.html"), html);
    const page = await served("bronzes.html");
    const current = () => page.evaluate(() => document.querySelector("taotie-viewer").state);
    const { light, from, strength, view, shading } = await current();
    assert.deepEqual([light, from, strength, view.slice(0, 2), shading], ["raking", [-75, 10], 2, [30, 20], "cook-torrance"]);
    // It has the size set by the page, hides its controls, and does not change the address.
    const { width, height } = await page.locator("taotie-viewer").boundingBox();
    assert.deepEqual([width, height], [400, 250]);
    assert(!(await page.locator("#panel").isVisible()));
    assert.equal(await page.locator("h1").count(), 1);
    const heard = page.evaluate(() => {
        const viewer = document.querySelector("taotie-viewer");
        return new Promise((done) => {
            viewer.addEventListener("change", () => done(viewer.state.from), { once: true });
            viewer.light = "60,30";
        });
    });
    assert.deepEqual(await heard, [60, 30]);
    const refused = await page.evaluate(async () => {
        const viewer = document.querySelector("taotie-viewer");
        viewer.shading = "gxx";
        viewer.setAttribute("camera", "30,120");
        viewer.setAttribute("lihgt", "given");
        viewer.files = 3;
        await new Promise((later) => setTimeout(later));
        return window.refused;
    });
    const expected = [/`auto-rotate`: .*src/, /`shading` `"gxx"`: .*ggx/, /`camera` `"30,120"`: .*-90 to 90/, /`files` `3`/, /`lihgt`: .*light/];
    assert.equal(refused.length, expected.length, refused.join("\n"));
    expected.forEach((each, i) => assert.match(refused[i], each));
    assert.equal((await current()).shading, "cook-torrance");
    await still(page);
    assert.equal(page.url(), "http://localhost/bronzes.html");
    await page.evaluate(axe.source);
    const { violations } = await page.evaluate(() => window.axe.run("taotie-viewer"));
    assert.deepEqual(violations.map(({ id }) => id), []);
    await page.evaluate(() => document.querySelector("taotie-viewer").remove());
    assert.deepEqual(complaints(page), []);
    await page.close();
});

test("the report of a bake starts with its asset", async () => {
    const page = await openViewer(browser, "baked.report.html", { size: [1000, 600] });
    assert.equal(await page.getByRole("tab", { selected: true }).textContent(), "model");
    assert.equal(await page.locator("h1").count(), 1);
    await page.getByLabel("Show", { exact: true }).selectOption("error");
    await still(page);
    await page.waitForFunction(() => location.hash === "#view=model&model=mode%3Derror");
    const at = await pointOf(page, "canvas", [0.5, 0.5]);
    const degrees = await page.evaluate((at) => window.taotie.errorUnder(...at), at);
    assert(degrees >= 0 && degrees < 20, `${degrees}`);
    await page.mouse.move(...at);
    // The wheel scrolls the page until the picture has the focus.
    const distance = (await state(page)).view[2];
    await page.mouse.wheel(0, 10);
    assert.equal((await state(page)).view[2], distance);
    await page.locator("canvas").focus();
    await page.mouse.wheel(0, -100);
    await page.waitForFunction((distance) => window.taotie.state.view[2] < distance, distance);
    await page.goto(address("baked.report.html", "view=model&model=mode%3Dnormals"));
    await still(page);
    assert.equal((await state(page)).mode, "normals");
    await page.getByRole("tab", { name: "maps" }).click();
    assert(!(await page.locator("canvas").isVisible()));
    await page.evaluate(axe.source);
    const { violations } = await page.evaluate(() => window.axe.run());
    assert.deepEqual(violations.map(({ id, nodes }) => [id, nodes.map(({ html }) => html)]), []);
    assertQuiet(page);
});

test("projection rays are shown on both sides of the wipe", async () => {
    const page = await openViewer(browser, "baked.report.html", { fragment: "view=model&model=rays%3Dtrue%26beside%3Dsmooth" });
    const { rays, beside } = await state(page);
    assert.deepEqual([rays, beside], [true, "smooth"]);
    assertQuiet(page);
    await page.close();
});

test("manifests contain the views of the page", async () => {
    const read = async (name) => JSON.parse(await readFile(path.join(folder, "site", name), "utf8"));
    const [scene, canvas] = [await read("manifest.json"), await read("manifest-3.json")];
    const base = "https://museum.example/vase/";
    assertManifest(scene, base);
    const validator = new Validator();
    assert(validator.validateManifest(canvas), JSON.stringify(validator.validators.manifest.errors));
    const painted = scene.items[0].items[0].items.map(({ body }) => body[0]);
    assert(painted.filter(({ type }) => type === "PerspectiveCamera").length === 2, "the first view and a bookmark");
    assert(painted.some(({ type }) => type === "DirectionalLight"));
    // The page writes the same.
    const page = await shown("view.html");
    await page.getByLabel("Address where the page is published").fill(base);
    const manifest = JSON.parse(await saved(page, () => page.getByRole("button", { name: "Save as IIIF manifest" }).click()));
    const comments = ({ annotations }) => annotations[0].items.slice(0, 2);
    assertManifest(manifest, base);
    assert.deepEqual(comments(manifest.items[0]), comments(scene.items[0]));
    const first = ({ items }) => items[0].items.filter(({ id }) => !id.startsWith(`${base}scene/views/2/`));
    assert.deepEqual(first(manifest.items[0]), first(scene.items[0]));
});
