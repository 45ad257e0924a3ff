// Converts the textures of a model to WebP, in one step so that nothing is encoded twice:
// node textures.mjs NODE SOURCE OUT SIDE QUALITY
// NODE is the folder of npm's packages; SIDE limits width and height in texels, 0 keeps them.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, source, out, side, quality] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "package.json"));
const load = (name) => import(pathToFileURL(require.resolve(name)));
const [{ NodeIO }, { ALL_EXTENSIONS }, { textureCompress }, { default: encoder }] = await Promise.all(
  ["@gltf-transform/core", "@gltf-transform/extensions", "@gltf-transform/functions", "sharp"].map(load),
);

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const document = await io.read(source);
const resize = Number(side) ? [Number(side), Number(side)] : undefined;
// Maximum effort: the smallest file for the quality.
await document.transform(
  textureCompress({ encoder, targetFormat: "webp", resize, quality: Number(quality), effort: 100 }),
);
await io.write(out, document);
