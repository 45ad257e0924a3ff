// Draws FOLDER's model.glb with three.js according to its view.json, in the given page, and writes three.png.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { complaints, folder, launch, newPage } from "./browser.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));

// There is no server at this address: requests are answered below.
const SITE = "http://localhost";

// model-viewer warns when its first frame takes over half a second. The page then waits for two more.
const isOfModelViewer = (text) => text === "rAF timed out in updateSource";

// Finds a file that the page requests, next to this script or in the folder.
function file(url) {
    const name = new URL(url).pathname.slice(1);
    const places = [here, path.join(here, "node_modules"), folder];
    return places.map((place) => path.join(place, name)).find(existsSync);
}

// WebGL without a graphics card.
const browser = await launch(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
const page = await newPage(browser, [512, 512]);
page.on("pageerror", (error) => {
    throw error;
});
await page.route(`${SITE}/**`, (route) => {
    const path = file(route.request().url());
    return route.fulfill(path ? { path } : { status: 404 });
});
await page.goto(`${SITE}/${process.argv[2]}`);
await page.waitForFunction(() => typeof picture === "string", null, { timeout: 60_000 });
assert.deepEqual(complaints(page).filter((text) => !isOfModelViewer(text)), []);
const [, data] = (await page.evaluate(() => picture)).split(",");
await writeFile(path.join(folder, "three.png"), Buffer.from(data, "base64"));
await browser.close();
