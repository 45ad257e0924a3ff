// three.js in Chromium without a window or a GPU: three.mjs FOLDER MESH SHADING NODE_MODULES_PARENT. Uses the protocol
// of answer.py, and accepts --cold WIDTH HEIGHT PNG.

import fs from "node:fs";
import http from "node:http";
import os from "node:os";
import path from "node:path";
import readline from "node:readline";
import { createRequire } from "node:module";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const [folder, mesh, , packages, cold, ...request] = process.argv.slice(2);
const { chromium } = createRequire(path.join(path.resolve(packages), "x.js"))("playwright-core");
const BROWSERS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const KINDS = { ".html": "text/html", ".js": "text/javascript" };

function browser() {
    const folders = (process.env.PATH ?? "").split(path.delimiter);
    const all = BROWSERS.flatMap((name) => folders.map((folder) => path.join(folder, name)));
    const found = process.env.BROWSER ?? all.find((file) => fs.existsSync(file));
    if (!found) throw new Error("Chromium not found; specify it in BROWSER");
    return found;
}

function file(url) {
    const name = decodeURIComponent(url.split("?")[0]);
    if (name === "/") return path.join(here, "three.html");
    return name.startsWith("/scene/") ? path.join(folder, path.basename(name)) : path.join(packages, name);
}

function serve() {
    const server = http.createServer((asked, answer) => {
        fs.readFile(file(asked.url), (error, data) => {
            const kind = KINDS[path.extname(file(asked.url))] ?? "application/octet-stream";
            answer.writeHead(error ? 404 : 200, { "content-type": kind });
            answer.end(data);
        });
    });
    return new Promise((ready) => server.listen(0, "127.0.0.1", () => ready(server)));
}

// The memory of all processes with the profile's name and of their children, MiB.
function memory(profile) {
    const mine = new Set();
    const parents = new Map();
    for (const id of fs.readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
        try {
            const stat = fs.readFileSync(`/proc/${id}/stat`, "utf8");
            parents.set(id, stat.slice(stat.lastIndexOf(")") + 2).split(" ")[1]);
            if (fs.readFileSync(`/proc/${id}/cmdline`, "utf8").includes(profile)) mine.add(id);
        } catch {}
    }
    for (let grew = true; grew; ) {
        grew = false;
        for (const [id, parent] of parents)
            if (!mine.has(id) && mine.has(parent)) grew = !!mine.add(id);
    }
    let kib = 0;
    for (const id of mine) {
        try {
            kib += Number(/^Pss:\s+(\d+)/m.exec(fs.readFileSync(`/proc/${id}/smaps_rollup`, "utf8"))[1]);
        } catch {}
    }
    return kib / 1024;
}

const server = await serve();
const profile = fs.mkdtempSync(path.join(os.tmpdir(), "three-"));
const context = await chromium.launchPersistentContext(profile, {
    executablePath: browser(),
    headless: false,
    args: ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update"],
});
const page = context.pages()[0] ?? (await context.newPage());
page.on("pageerror", (error) => console.error(String(error)));
const view = "background=[13,13,15]&step=0.01";
await page.goto(`http://127.0.0.1:${server.address().port}/?mesh=${mesh}&${view}`);
await page.waitForFunction("window.loaded", null, { timeout: 60000 });

async function answer(words) {
    const [width, height, frames] = words.map(Number);
    const result = await page.evaluate((all) => window.timed(...all), [width, height, frames, !!words[3]]);
    if (words[3]) fs.writeFileSync(words[3], Buffer.from(result.png.split(",")[1], "base64"));
    return { ms: result.ms, about: result.about, peak_mib: Math.round(memory(profile)) };
}

if (cold === "--cold") await answer([request[0], request[1], 0, request[2]]);
else
    for await (const line of readline.createInterface({ input: process.stdin }))
        console.log(JSON.stringify(await answer(line.split(" "))));
await context.close();
server.close();
fs.rmSync(profile, { recursive: true, force: true });
