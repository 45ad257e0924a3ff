// Writes the pictures that cases.json asks for: of a page, what its link names, and how large.

import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { assertQuiet, folder, newPage } from "./browser.mjs";
import { address, launchWebGl, picture, still } from "./viewer.mjs";

// Goes to a link within the page, whose viewer has heard of it then.
const follow = (fragment) =>
    new Promise((done) => {
        addEventListener("hashchange", () => done(), { once: true });
        const isThere = location.hash.slice(1) === fragment;
        location.hash = fragment;
        if (isThere) done();
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
