// Builds the element for pages, into crates/taotie-report, and as a module for npm, into dist; with --check compares
// the former with the one that is there.

import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = path.dirname(fileURLToPath(import.meta.url));
const page = path.join(here, "../crates/taotie-report/src/viewer/bundle/viewer.js");
const dist = path.join(here, "dist");
const MOST = 250_000;

/** The text of the element, as a script or as a module. */
async function built(format) {
    const { outputFiles } = await build({
        entryPoints: [path.join(here, "src/main.ts")],
        bundle: true,
        minify: true,
        format,
        target: "es2022",
        charset: "utf8",
        legalComments: "none",
        banner: { js: "/* three.js, MIT, © 2010-2026 three.js authors; meshoptimizer, MIT, © 2016-2026 Arseny Kapoulkine */" },
        loader: { ".css": "text" },
        write: false,
    });
    // A carriage return would not survive a page.
    return outputFiles[0].text.replaceAll("\r", "");
}

async function writeModule() {
    await mkdir(dist, { recursive: true });
    await writeFile(path.join(dist, "taotie-viewer.js"), await built("esm"));
    await copyFile(path.join(here, "taotie-viewer.d.ts"), path.join(dist, "taotie-viewer.d.ts"));
}

const script = await built("iife");
const bytes = gzipSync(script).length;
console.log(`${bytes} bytes by gzip`);
let failed = bytes > MOST;
if (failed) console.error(`that is more than ${MOST}`);
if (!process.argv.includes("--check")) {
    await writeFile(page, script);
    await writeModule();
} else if ((await readFile(page, "utf8")) !== script) {
    console.error(`${page} is not what viewer/ makes: run \`make viewer\``);
    failed = true;
}
process.exitCode = failed ? 1 : 0;
