// Builds the element for pages, into crates/taotie-report, and as a module for npm, into dist. With --check, compares
// the former with the existing file; with --module FOLDER, writes only the latter.

import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = path.dirname(fileURLToPath(import.meta.url));
const PAGE = path.join(here, "../crates/taotie-report/src/viewer/bundle/viewer.js");
const [, , option, folder] = process.argv;
const MOST = 250_000;

/** Returns the source of the element, as a script or as a module. */
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
    // Carriage returns do not survive in a page.
    return outputFiles[0].text.replaceAll("\r", "");
}

async function writeModule(dist) {
    await mkdir(dist, { recursive: true });
    await writeFile(path.join(dist, "taotie-viewer.js"), await built("esm"));
    await copyFile(path.join(here, "taotie-viewer.d.ts"), path.join(dist, "taotie-viewer.d.ts"));
}

/** Writes or compares the element for pages; returns true on success. */
async function page(isCheck) {
    const script = await built("iife");
    const bytes = gzipSync(script).length;
    console.log(`${bytes} bytes gzipped`);
    if (bytes > MOST) console.error(`more than the limit of ${MOST} bytes`);
    if (!isCheck) await writeFile(PAGE, script);
    const isSame = (await readFile(PAGE, "utf8")) === script;
    if (!isSame) console.error(`${PAGE} does not match viewer/: run \`make viewer\``);
    return isSame && bytes <= MOST;
}

if (option === "--module") {
    await writeModule(folder);
} else {
    const isSound = await page(option === "--check");
    if (option !== "--check") await writeModule(path.join(here, "dist"));
    process.exitCode = isSound ? 0 : 1;
}
