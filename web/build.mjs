// Builds the page: target/web/site with separate files for a server, target/web/taotie.html as one file that opens from disk.

import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gunzipSync } from "node:zlib";
import { bundled, packedProgram } from "../npm/taotie-wasm/build.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const repository = path.join(here, "..");
const REPORT = "crates/taotie-report/src";
const SINGLE = "taotie.html";
/** The sizes of maps offered, texels. */
const SIZES = [512, 1024, 2048, 4096];

const read = (name) => readFile(path.join(repository, name), "utf8").then((text) => text.replaceAll("\r", ""));

/** Returns the first group of a pattern that a text must contain. */
function found(text, pattern) {
    const match = pattern.exec(text.replace(/\s+/g, " "));
    if (!match) throw new Error(`docs/help/bake.md lacks ${pattern}`);
    return match[1];
}

/** Formats and defaults, as the command's help states them. */
async function facts() {
    const help = await read("docs/help/bake.md");
    return {
        formats: found(help, /The high-poly scan \(([^)]*)\)/).split(", "),
        triangles: found(help, /turns the search off \[default: (\d+)/),
        size: found(help, /--size <[^>]*> .*?\[default: (\d+)\]/),
        distance: found(help, /--ray-distance <[^>]*> .*?\[default: (\w+)\]/),
    };
}

/** The script of report pages without the line that starts it: their functions. */
async function reportScript() {
    const document = await read(`${REPORT}/document.rs`);
    const names = [...document.matchAll(/include_str!\("(page\/\w+\.js)"\)/g)].map(([, name]) => name);
    const parts = await Promise.all(names.map((name) => read(`${REPORT}/${name}`)));
    const script = `"use strict";\n${parts.join("")}`;
    const start = "\nmain();\n";
    if (!script.endsWith(start)) throw new Error("the script of report pages does not end with main()");
    return script.slice(0, -start.length);
}

/** The count of triangles of a GLB. */
function trianglesOf(glb) {
    const document = JSON.parse(glb.subarray(20, 20 + glb.readUInt32LE(12)));
    return document.accessors[document.meshes[0].primitives[0].indices].count / 3;
}

const part = (name, bytes) => `taotiePart(${JSON.stringify(name)}, "${bytes.toString("base64")}");`;
const grouped = (number) => new Intl.NumberFormat("en").format(number);
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

const policyOf = (scripts, style) =>
    `default-src 'none'; connect-src 'none'; script-src ${scripts} 'wasm-unsafe-eval'; style-src ${style}; worker-src blob:; ` +
    "img-src data: blob:; base-uri 'none'; form-action 'none'";

/** Fills the names in braces. */
const filled = (template, values) => template.replace(/\{(\w+)\}/g, (_, name) => values[name]);

/** The texts and controls of the page. */
function contentOf(known, example) {
    const option = (size) => `<option value="${size}"${String(size) === known.size ? " selected" : ""}>${grouped(size)} × ${grouped(size)}</option>`;
    return {
        formats: known.formats.map((ending) => ending.slice(1)).join(", ").replace(/, (\w+)$/, " or $1"),
        triangles: grouped(known.triangles),
        distance: known.distance,
        sizes: SIZES.map(option).join(""),
        example: grouped(trianglesOf(gunzipSync(example))),
    };
}

const known = await facts();
const [template, example, program] = await Promise.all([read("web/src/index.html"), readFile(path.join(here, "bronze.glb.gz")), packedProgram()]);
const style = (await read(`${REPORT}/page.css`)) + (await read("web/src/style.css"));
const scripts = {
    report: await reportScript(),
    app: await bundled({ entryPoints: [path.join(here, "src/main.ts")], format: "iife", define: { FORMATS: JSON.stringify(known.formats) } }),
    viewer: await read(`${REPORT}/viewer/bundle/viewer.js`),
    example: part("example", example),
    program: part("program", program),
};
const content = contentOf(known, example);
const license = "Made with Taotie, MIT or Apache-2.0.";

const single = filled(template, {
    ...content,
    policy: policyOf(Object.values(scripts).map(hash).join(" "), hash(style)),
    style: `<style>${style}</style>`,
    scripts: Object.values(scripts).map((script) => `<script>${script}</script>`).join("\n"),
    footer: `${license} This file works offline.`,
});
const site = filled(template, {
    ...content,
    policy: policyOf("'self'", "'self'"),
    style: '<link rel="stylesheet" href="style.css">',
    scripts: Object.keys(scripts).map((name) => `<script defer src="${name}.js"></script>`).join("\n"),
    footer: `${license} Also as <a href="${SINGLE}" download>one file</a> that works offline (${(single.length / 1e6).toFixed(0)} MB).`,
});

const folder = path.join(repository, "target/web");
await rm(folder, { recursive: true, force: true });
await mkdir(path.join(folder, "site"), { recursive: true });
const files = { "index.html": site, "style.css": style, [SINGLE]: single };
for (const [name, script] of Object.entries(scripts)) files[`${name}.js`] = script;
for (const [name, text] of Object.entries(files)) await writeFile(path.join(folder, "site", name), text);
await writeFile(path.join(folder, SINGLE), single);
console.log(`target/web/site, target/web/${SINGLE}: ${single.length} bytes`);
