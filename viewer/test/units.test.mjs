// Tests the parts of the viewer that need no browser.

import assert from "node:assert/strict";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const resolveDir = path.join(path.dirname(fileURLToPath(import.meta.url)), "../src");
const contents = ["once", "images"].map((name) => `export * from "./${name}";`).join("\n");
const { outputFiles } = await build({ stdin: { contents, resolveDir }, bundle: true, format: "esm", target: "es2022", write: false });
const { Once, codedHeights, codedNormals } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);

test("a value is made once, and again after a failure", async () => {
    const once = new Once();
    let made = 0;
    const fail = async () => {
        made += 1;
        throw new Error("no network");
    };
    const succeed = async () => {
        made += 1;
        return "value";
    };
    const [a, b] = [once.get("key", fail), once.get("key", fail)];
    await assert.rejects(a, /no network/);
    await assert.rejects(b, /no network/);
    assert.equal(made, 1);
    assert.deepEqual([await once.get("key", succeed), await once.get("key", fail)], ["value", "value"]);
    assert.equal(made, 2);
    assert.equal(await once.get("other", succeed), "value");
    assert.equal(made, 3);
});

const USE = { texture: 0, sampler: [10497, 10497, 9729, 9987] };
const sizes = ({ mipmaps }) => mipmaps.map(({ width, height }) => [width, height]);

test("levels of heights are means, and odd sides lose their last row or column", () => {
    const heights = (width, height, codes) => codedHeights(Uint16Array.from([7, ...codes]), { width, height, channels: 1, from: 1 }, USE, true);
    const red = ({ mipmaps }, level) => [...mipmaps[level].data].filter((_, i) => i % 4 === 0);
    const wide = heights(5, 2, [0, 65535, 0, 0, 1, 65535, 0, 0, 0, 1]);
    assert.deepEqual(sizes(wide), [[5, 2], [2, 1], [1, 1]]);
    assert.deepEqual([red(wide, 1), red(wide, 2)], [[0.5, 0], [0.25]]);
    const high = heights(1, 3, [0, 65535, 1]);
    assert.deepEqual(sizes(high), [[1, 3], [1, 1]]);
    assert.deepEqual(red(high, 1), [0.5]);
});

test("levels of normals are means of unit vectors with their variance", () => {
    const code = (value) => ((value + 1) / 2) * 65535;
    // Half of these vectors are shorter; the last column is ignored.
    const [x, y, z] = [[1, 0, 0], [0, 0.5, 0], [0, 0, 1]].map((n) => n.map(code));
    const texture = codedNormals(Uint16Array.from([...x, ...y, ...z, ...y, ...x, ...z]), { width: 3, height: 2, channels: 3, from: 0 }, USE, true);
    assert.deepEqual(sizes(texture), [[3, 2], [1, 1]]);
    const expected = [code(0.5), code(0.5), code(0), 0.5 * 65535];
    texture.mipmaps[1].data.forEach((value, i) => assert(Math.abs(value - expected[i]) <= 4, `${value} instead of ${expected[i]}`));
});
