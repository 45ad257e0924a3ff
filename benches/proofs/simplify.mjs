// Simplifies a GLB with meshoptimizer and packs it: node simplify.mjs NODE SOURCE OUT RATIO
// Positions, normals and UVs are moved too (`simplifyWithUpdate`), which neither gltfpack -si nor gltf-transform does.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, source, out, ratio] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "package.json"));
const load = (name) => import(pathToFileURL(require.resolve(name)));
const [{ NodeIO }, { ALL_EXTENSIONS }, functions, { MeshoptEncoder, MeshoptSimplifier }] = await Promise.all(
  ["@gltf-transform/core", "@gltf-transform/extensions", "@gltf-transform/functions", "meshoptimizer"].map(load),
);
const { compactPrimitive, dequantize, meshopt, prune, weldPrimitive } = functions;

// As recommended by meshoptimizer's documentation.
const NORMAL_WEIGHT = 0.5;
const UV_WEIGHT = 1;
const WEIGHTS = { NORMAL: Array(3).fill(NORMAL_WEIGHT), TEXCOORD_0: Array(2).fill(UV_WEIGHT) };

function interleave(attributes) {
  const stride = attributes.reduce((sum, a) => sum + a.getElementSize(), 0);
  const count = attributes[0].getCount();
  const values = new Float32Array(count * stride);
  let offset = 0;
  for (const attribute of attributes) {
    const size = attribute.getElementSize();
    const array = attribute.getArray();
    for (let i = 0; i < count; i++) for (let k = 0; k < size; k++) values[i * stride + offset + k] = array[i * size + k];
    offset += size;
  }
  return { values, stride };
}

function deinterleave({ values, stride }, attributes) {
  let offset = 0;
  for (const attribute of attributes) {
    const size = attribute.getElementSize();
    const array = new Float32Array(attribute.getCount() * size);
    for (let i = 0; i < attribute.getCount(); i++) {
      const at = i * stride + offset;
      const vector = values.subarray(at, at + size);
      const length = size === 3 ? Math.hypot(...vector) || 1 : 1;
      for (let k = 0; k < size; k++) array[i * size + k] = vector[k] / length;
    }
    attribute.setArray(array);
    offset += size;
  }
}

function simplify(primitive) {
  primitive.setAttribute("TANGENT", null); // readers compute tangents of the new mesh
  weldPrimitive(primitive);
  const names = Object.keys(WEIGHTS).filter((name) => primitive.getAttribute(name));
  const position = primitive.getAttribute("POSITION");
  const attributes = names.map((name) => primitive.getAttribute(name));
  const weights = names.flatMap((name) => WEIGHTS[name]);
  const indices = new Uint32Array(primitive.getIndices().getArray());
  const positions = new Float32Array(position.getArray());
  const mixed = interleave(attributes);
  const target = Math.max(1, Math.round((indices.length / 3) * ratio)) * 3;
  const [count] = MeshoptSimplifier.simplifyWithUpdate(
    indices, positions, 3, mixed.values, mixed.stride, weights, null, target, 1,
  );
  primitive.getIndices().setArray(indices.slice(0, count));
  position.setArray(positions);
  deinterleave(mixed, attributes);
  compactPrimitive(primitive);
}

await Promise.all([MeshoptEncoder.ready, MeshoptSimplifier.ready]);
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ "meshopt.encoder": MeshoptEncoder });
const document = await io.read(source);
await document.transform(dequantize());
for (const mesh of document.getRoot().listMeshes()) mesh.listPrimitives().forEach(simplify);
await document.transform(prune(), meshopt({ encoder: MeshoptEncoder, level: "high" }));
await io.write(out, document);
