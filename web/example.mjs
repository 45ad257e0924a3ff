// Makes the example of the page, `bronze.glb`: the demo's bronze with its relief as geometry, simplified and packed.
// TAOTIE is the program; takes two minutes.

import { execFileSync } from "node:child_process";
import { mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const EXAMPLE = fileURLToPath(new URL("bronze.glb", import.meta.url));
const TRIANGLES = 120_000;
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

/** Returns a GLB with only the positions and triangles of a packed one of a single mesh. */
function shapeOf(packed) {
    const length = packed.readUInt32LE(12);
    const document = JSON.parse(packed.subarray(20, 20 + length));
    const payload = packed.subarray(20 + length + 8);
    const [primitive] = document.meshes[0].primitives;
    const [parts, views] = [[], []];
    const [compressed, plain] = [[], []].map(() => ({ size: 0 }));
    for (const accessor of [primitive.attributes.POSITION, primitive.indices].map((index) => document.accessors[index])) {
        const view = document.bufferViews[accessor.bufferView];
        const packing = view.extensions.EXT_meshopt_compression;
        parts.push(padded(payload.subarray(packing.byteOffset, packing.byteOffset + packing.byteLength), 0));
        packing.byteOffset = compressed.size;
        view.byteOffset = plain.size;
        compressed.size += parts.at(-1).length;
        plain.size += view.byteLength;
        accessor.bufferView = views.push(view) - 1;
    }
    const { asset, extensionsUsed, extensionsRequired, nodes, scenes, scene, accessors } = document;
    delete asset.extensions;
    const isKept = (name) => ["EXT_meshopt_compression", "KHR_mesh_quantization"].includes(name);
    const [position, indices] = [primitive.attributes.POSITION, primitive.indices].map((index) => accessors[index]);
    return glb(
        {
            asset,
            extensionsUsed: extensionsUsed.filter(isKept),
            extensionsRequired: extensionsRequired.filter(isKept),
            scene,
            scenes,
            nodes,
            meshes: [{ name: "bronze", primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
            materials: [MATERIAL],
            accessors: [position, indices],
            bufferViews: views,
            buffers: [{ byteLength: compressed.size }, { byteLength: plain.size, extensions: { EXT_meshopt_compression: { fallback: true } } }],
        },
        Buffer.concat(parts),
    );
}

const folder = await mkdtemp(path.join(os.tmpdir(), "taotie-example-"));
const taotie = (...args) => execFileSync(process.env.TAOTIE ?? "taotie", args, { cwd: folder, stdio: "inherit" });
taotie("demo", "--high", "--out", "demo", "--size", "64");
taotie("bake", "demo/jue-high.glb", "-o", "bronze.glb", "--triangles", String(TRIANGLES), "--maps", "normal", "--size", "256", "--meshopt", "--no-verify");
const shape = shapeOf(await readFile(path.join(folder, "bronze.glb")));
await writeFile(EXAMPLE, shape);
await rm(folder, { recursive: true });
console.log(`${EXAMPLE}: ${shape.length} bytes`);
