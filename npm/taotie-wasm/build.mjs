// Bundles the package into dist. The program is target/wasm/taotie.wasm of the repository, or TAOTIE_WASM.

import { build } from "esbuild";
import { copyFile, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = path.dirname(fileURLToPath(import.meta.url));
const [SOURCE, DIST] = ["src", "dist"].map((name) => path.join(here, name));

/** Megabytes of the whole package, compressed. */
const MOST = 6e6;

const SHIM = "/* @bjorn3/browser_wasi_shim, MIT OR Apache-2.0, © bjorn3 */";
const settings = { bundle: true, minify: true, target: "es2022", charset: "utf8", legalComments: "none", external: ["node:*"], write: false };

/** Resolves `worker:web` to the source of the worker, as text. */
const workers = {
    name: "workers",
    setup({ onResolve, onLoad }) {
        onResolve({ filter: /^worker:/ }, ({ path: name }) => ({ path: name, namespace: "worker" }));
        onLoad({ filter: /./, namespace: "worker" }, async () => {
            const { outputFiles } = await build({ ...settings, format: "iife", banner: { js: SHIM }, entryPoints: [path.join(SOURCE, "worker.ts")] });
            return { contents: outputFiles[0].text, loader: "text" };
        });
    },
};

/** Returns a bundle of entries that may import the package's sources. */
export async function bundled(options) {
    const { outputFiles } = await build({ ...settings, ...options, plugins: [workers] });
    return outputFiles[0].text;
}

const PROGRAM = process.env.TAOTIE_WASM ?? path.join(here, "../../target/wasm/taotie.wasm");

/** Reads the program and compresses it. */
export const packedProgram = async () => gzipSync(await readFile(PROGRAM), { level: 9 });

async function writeEntry(name, platform) {
    const entryPoints = [path.join(SOURCE, `${name}.ts`)];
    await build({ ...settings, platform, format: "esm", plugins: [workers], entryPoints, outdir: DIST, write: true });
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
    await Promise.all([writeEntry("browser", "browser"), ...["node", "cli", "machine"].map((name) => writeEntry(name, "node"))]);
    const packed = await packedProgram();
    await writeFile(path.join(DIST, "taotie.wasm.gz"), packed);
    // `make wasm` writes the licences of everything in the program next to it.
    await copyFile(path.join(path.dirname(PROGRAM), "THIRD-PARTY.html"), path.join(DIST, "THIRD-PARTY.html"));
    console.log(`${packed.length} bytes of program, gzipped`);
    if (packed.length > MOST) {
        console.error(`more than the limit of ${MOST} bytes`);
        process.exitCode = 1;
    }
}
