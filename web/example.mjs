// Makes the example of the page, `bronze.glb.gz`: the demo's bronze with its relief as geometry, simplified.
// TAOTIE is the program; takes two minutes.

import { execFileSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const EXAMPLE = fileURLToPath(new URL("bronze.glb.gz", import.meta.url));
const TRIANGLES = 100_000;
/** Patina, not metal, which is dark under a single light. */
const MATERIAL = { name: "bronze", pbrMetallicRoughness: { baseColorFactor: [0.3, 0.34, 0.27, 1], metallicFactor: 0, roughnessFactor: 0.55 } };

const padded = (bytes, filler) => Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);

function chunk(kind, bytes) {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(bytes.length);
    head.write(kind, 4, "latin1");
    return Buffer.concat([head, bytes]);
}

function glb(document, bytes) {
    const chunks = Buffer.concat([chunk("JSON", padded(Buffer.from(JSON.stringify(document)), " ")), chunk("BIN\0", padded(bytes, 0))]);
    const head = Buffer.alloc(12);
    head.write("glTF", "latin1");
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(12 + chunks.length, 8);
    return Buffer.concat([head, chunks]);
}

/** Returns a GLB with only the positions and triangles of one with a single mesh. */
function shapeOf(file) {
    const length = file.readUInt32LE(12);
    const document = JSON.parse(file.subarray(20, 20 + length));
    const payload = file.subarray(20 + length + 8);
    const [primitive] = document.meshes[0].primitives;
    const accessors = [primitive.attributes.POSITION, primitive.indices].map((index) => document.accessors[index]);
    const views = accessors.map(({ bufferView }) => document.bufferViews[bufferView]);
    const parts = views.map(({ byteOffset, byteLength }) => payload.subarray(byteOffset, byteOffset + byteLength));
    const { scene, scenes, nodes } = document;
    return glb(
        {
            asset: { version: "2.0", generator: document.asset.generator },
            scene,
            scenes,
            nodes,
            meshes: [{ name: "bronze", primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
            materials: [MATERIAL],
            accessors: accessors.map((accessor, bufferView) => ({ ...accessor, bufferView })),
            bufferViews: [
                { ...views[0], byteOffset: 0 },
                { ...views[1], byteOffset: parts[0].length },
            ],
            buffers: [{ byteLength: parts[0].length + parts[1].length }],
        },
        Buffer.concat(parts),
    );
}

const folder = await mkdtemp(path.join(os.tmpdir(), "taotie-example-"));
const taotie = (...args) => execFileSync(process.env.TAOTIE ?? "taotie", args, { cwd: folder, stdio: "inherit" });
taotie("demo", "--high", "--out", "demo", "--size", "64");
taotie("bake", "demo/jue-high.glb", "-o", "bronze.glb", "--triangles", String(TRIANGLES), "--maps", "normal", "--size", "256", "--no-verify");
const shape = gzipSync(shapeOf(await readFile(path.join(folder, "bronze.glb"))), { level: 9 });
await writeFile(EXAMPLE, shape);
await rm(folder, { recursive: true });
console.log(`${EXAMPLE}: ${shape.length} bytes`);
