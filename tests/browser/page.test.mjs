// Tests the report page except for its pictures: text, tables, histograms, widths; and a comparison by the command.

import assert from "node:assert/strict";
import { after, test } from "node:test";
import { assertQuiet, click, colorAt, complaints, drag, go, hover } from "./browser.mjs";
import { isSame, launch, newPage, open, place, settle } from "./browser.mjs";

const WIPE = ".wipe .frame";

// A title that tries to be more than text.
const NASTY = "</script><img src=x onerror=\"document.title='pwned'\">";

const browser = await launch(["--disable-gpu"]);
after(() => browser.close());

test("text is only text, and there are no network requests", async () => {
    const page = await open(browser, "full.html", [1200, 900]);
    assert.equal(await page.title(), NASTY);
    assert.equal(await page.locator("h1").textContent(), NASTY);
    const sources = await page.evaluate(() => [...document.images].map((image) => image.src));
    assert.deepEqual(sources.filter((source) => !source.startsWith("data:")), []);
    assert.equal(await page.locator("script").count(), 2);
    assertQuiet(page);
    // The browser itself blocks everything that an injected script might try.
    await page.evaluate(async () => {
        await fetch("http://127.0.0.1:9/").catch((error) => error);
        await Object.assign(new Image(), { src: "http://127.0.0.1:9/x.png" }).decode().catch((error) => error);
        document.body.insertAdjacentHTML("beforeend", "<b onclick='document.title = 1'>x</b>");
        document.querySelector("b").click();
    });
    await settle(page);
    assert.equal(await page.title(), NASTY);
    const refused = complaints(page).filter((text) => text.includes("Content Security Policy"));
    assert(refused.length >= 3, complaints(page).join("\n"));
});

test("verdict and warnings come before everything else", async () => {
    const page = await open(browser, "full.html", [1200, 900]);
    assert.deepEqual(await page.locator(".notices li").allTextContents(), ["It holds.", NASTY]);
    const tones = await page.locator(".notices li").evaluateAll((items) => items.map((item) => item.className));
    assert.deepEqual(tones, ["good", "changed"]);
    const top = (selector) => page.locator(selector).first().evaluate((element) => element.getBoundingClientRect().top);
    const [notices, facts, pictures] = await Promise.all([".notices", "dl", WIPE].map(top));
    assert(notices < facts && facts < pictures, `${notices}, ${facts}, ${pictures}`);
    assertQuiet(page);
});

test("a certificate comes first, and fills one sheet of paper", async () => {
    // A4 within margins of 14 mm, in pixels of 1/96 inch.
    const [width, height] = [210 - 28, 297 - 28].map((mm) => Math.floor((mm * 96) / 25.4));
    const page = await open(browser, "certificate.html", [width, height]);
    await page.emulateMedia({ media: "print" });
    const box = (selector) =>
        page.locator(selector).first().evaluate((element) => {
            const { top, bottom, right } = element.getBoundingClientRect();
            return { top: top + scrollY, bottom: bottom + scrollY, right };
        });
    const [statement, feature, viewer] = await Promise.all([".statement", ".feature", ".viewer"].map(box));
    assert(statement.bottom <= height, `${statement.bottom} of ${height}`);
    assert(statement.bottom <= feature.top && feature.bottom <= viewer.top, "certificate, worst patch, pictures");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert(wide <= width, `${wide} of ${width}`);
    const after = await page.locator(".statement").evaluate((element) => getComputedStyle(element).breakAfter);
    assert.equal(after, "page");
    assert.equal(await page.locator(".side-by-side img").count(), 3);
    assertQuiet(page);
});

const column = (page, nth) => page.locator(`td:nth-child(${nth})`).allTextContents();

test("tables are sorted and copied", async () => {
    const page = await open(browser, "full.html", [1200, 900]);
    const written = ['b, "quoted"', "none", "a10", "a9"];
    assert.deepEqual(await column(page, 1), written);
    assert.deepEqual(await column(page, 2), ["9.50", "–", "−12.00", "12\u{202f}345.68"]);
    const align = (cell) => getComputedStyle(cell).textAlign;
    assert.equal(await page.locator("td:nth-child(2)").first().evaluate(align), "right");
    const orders = [
        [2, ["a10", 'b, "quoted"', "a9", "none"]],
        [2, ["a9", 'b, "quoted"', "a10", "none"]],
        [2, written],
        [1, ["a9", "a10", 'b, "quoted"', "none"]],
    ];
    for (const [nth, names] of orders) {
        await click(page, `th:nth-child(${nth}) button`);
        assert.deepEqual(await column(page, 1), names);
    }
    // The digit, followed by the number of its reason.
    await click(page, "th:nth-child(3) button");
    assert.deepEqual(await column(page, 3), ["1", "21", "31", "4"]);
    assert.equal(await page.locator(".reasons").innerText(), "it differs");
    const csv = await page.evaluate(() => {
        const { sections } = JSON.parse(document.getElementById("data").textContent);
        return csvOf(...Object.values(sections[1].table).slice(2));
    });
    const lines = ["name,mean (°),judged", '"b, ""quoted""",9.5,3', "none,,1", "a10,-12,2", "a9,12345.678,4", ""];
    assert.equal(csv, lines.join("\r\n"));
    assertQuiet(page);
});

// Returns the ratio of the heights of the first two histograms.
async function ratio(page) {
    const height = (counts) => counts.getBBox().height;
    const panels = await page.locator(".panels .counts").all();
    const [first, second] = await Promise.all(panels.slice(0, 2).map((counts) => counts.evaluate(height)));
    return first / second;
}

test("histograms switch scales and are read together", async () => {
    const page = await open(browser, "full.html", [1200, 900]);
    const linear = await ratio(page);
    assert(Math.abs(linear - 2) < 0.01, `1000 against 500: ${linear}`);
    await click(page, ".histogram input");
    const logarithmic = await ratio(page);
    const wanted = (Math.log10(1000) + 0.3) / (Math.log10(500) + 0.3);
    assert(Math.abs(logarithmic - wanted) < 0.01, `${logarithmic} instead of ${wanted}`);
    const [x, y, width, height] = await place(page, ".panels svg");
    // In the last of six bins between the margins.
    await hover(page, [x + width * 0.94, y + height / 2]);
    const read = await page.locator(".readout").allTextContents();
    assert.deepEqual(read, ["≥ 2.5 °: 7, 0.67 %", "≥ 2.5 °: 1, 0.19 %"]);
    assertQuiet(page);
});

test("pages with little or no content work", async () => {
    const page = await newPage(browser, [800, 600]);
    for (const name of ["empty.html", "hollow.html", "odd.html"]) {
        await go(page, name);
        for (let nth = 1; nth <= 3; nth++) {
            await page.evaluate((nth) => document.querySelector(`[role=tab]:nth-child(${nth})`)?.click(), nth);
            const buttons = page.locator("th button, .lens button, .name button");
            await buttons.evaluateAll((buttons) => buttons.forEach((button) => button.click()));
            await settle(page);
        }
        assertQuiet(page);
    }
    assert.equal(await page.locator(".wipe").count(), 1, "one picture needs no wipe");
});

test("the page fits every width", async () => {
    const page = await open(browser, "full.html", [1800, 1000]);
    for (const width of [1800, 1200, 1000, 700, 400, 320]) {
        await page.setViewportSize({ width, height: 900 });
        await settle(page);
        const wide = await page.evaluate(() => document.documentElement.scrollWidth);
        assert(wide <= width, `${wide} at a width of ${width}`);
        const [, , frame] = await place(page, WIPE);
        assert(frame > Math.min(width, 800) * 0.45, `${frame} at a width of ${width}`);
    }
    const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const light = await ground();
    await page.emulateMedia({ colorScheme: "dark" });
    assert.notEqual(await ground(), light);
    assertQuiet(page);
});

test("a comparison opens from disk, and its wipe works", async () => {
    const page = await open(browser, "compared/report.html", [1200, 900]);
    const [x, y, width, height] = await place(page, WIPE);
    const at = (share) => [x + share * width, y + height / 2];
    const seen = () => colorAt(page, [x + 0.4 * width, y + 0.3 * height]);
    const smooth = await seen();
    await drag(page, at(0.5), at(0.2));
    const tilted = await seen();
    assert(smooth[0] > tilted[0] + 20, `smooth ${smooth} left of the handle, tilted ${tilted} right of it`);
    await drag(page, at(0.2), at(0.8));
    assert(isSame(await seen(), smooth));
    assert.equal(await page.locator("table").count(), 4);
    assertQuiet(page);
});
