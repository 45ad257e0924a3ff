// Writes the pictures requested by cases.json: the page, the link and the size of each.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { assertQuiet, folder, newPage } from "./browser.mjs";
import { address, launchWebGl, picture, still } from "./viewer.mjs";

// Follows a link within the page and waits until the viewer has been notified.
const follow = (fragment) =>
    new Promise((done) => {
        addEventListener("hashchange", () => done(), { once: true });
        const isSame = location.hash.slice(1) === fragment;
        location.hash = fragment;
        if (isSame) done();
    });

const cases = JSON.parse(await readFile(path.join(folder, "cases.json"), "utf8"));
const browser = await launchWebGl();
const pages = new Map();
for (const { page: name, fragment, size, picture: file } of cases) {
    const page = pages.get(name) ?? (await newPage(browser, [320, 240]));
    if (!pages.has(name)) await page.goto(address(name, fragment));
    pages.set(name, page);
    await page.evaluate(follow, fragment);
    await still(page);
    await writeFile(path.resolve(folder, file), await picture(page, size));
}
pages.forEach(assertQuiet);
await browser.close();
