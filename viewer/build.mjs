// Builds the page's script and style for crates/taotie-report; with --check compares them with those that are there.

import { build } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = path.dirname(fileURLToPath(import.meta.url));
const bundle = path.join(here, "../crates/taotie-report/src/viewer/bundle");
const MOST = 250_000;

const { outputFiles } = await build({
    entryPoints: { viewer: path.join(here, "src/main.ts") },
    outdir: bundle,
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    charset: "utf8",
    legalComments: "none",
    banner: { js: "/* three.js, MIT, © 2010-2026 three.js authors; meshoptimizer, MIT, © 2016-2026 Arseny Kapoulkine */" },
    loader: { ".css": "css" },
    write: false,
});

const bytes = outputFiles.reduce((sum, file) => sum + gzipSync(file.contents).length, 0);
console.log(`${bytes} bytes by gzip`);
let failed = bytes > MOST;
if (failed) console.error(`that is more than ${MOST}`);
for (const file of outputFiles) {
    // A carriage return would not survive a page.
    const text = file.text.replaceAll("\r", "");
    if (!process.argv.includes("--check")) {
        await writeFile(file.path, text);
    } else if ((await readFile(file.path, "utf8")) !== text) {
        console.error(`${file.path} is not what viewer/ makes: run \`make viewer\``);
        failed = true;
    }
}
process.exitCode = failed ? 1 : 0;
