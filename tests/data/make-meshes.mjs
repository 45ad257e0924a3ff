// Makes the files of meshes/: one plain patch, and the same patch with every supported compression.
// Run next to node_modules with meshoptimizer 1.3.0, draco3d 1.5.9 and @gltf-transform/{core,extensions} 4.5.1:
//     node make-meshes.mjs FOLDER
import { writeFileSync } from 'node:fs';
import { MeshoptEncoder } from 'meshoptimizer';
import { Document, NodeIO } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import draco3d from 'draco3d';

const [columns, rows] = [9, 7];
const count = columns * rows;

/** The patch: z = sin(4x) cos(5y) / 8 over the unit square, one array per attribute, components interleaved. */
function patch() {
  const data = { POSITION: [], NORMAL: [], TANGENT: [], TEXCOORD_0: [], COLOR_0: [], indices: [] };
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < columns; i++) {
      const [x, y] = [i / (columns - 1), j / (rows - 1)];
      const dx = Math.cos(4 * x) * Math.cos(5 * y) / 2;
      const dy = -Math.sin(4 * x) * Math.sin(5 * y) * 5 / 8;
      const [n, t] = [Math.hypot(dx, dy, 1), Math.hypot(1, dx)];
      data.POSITION.push(x, y, Math.sin(4 * x) * Math.cos(5 * y) / 8);
      data.NORMAL.push(-dx / n, -dy / n, 1 / n);
      data.TANGENT.push(1 / t, 0, dx / t, 1);
      data.TEXCOORD_0.push(x, 1 - y);
      data.COLOR_0.push(Math.round(255 * x), Math.round(255 * y), 128, 255 - 20 * j);
      if (i > 0 && j > 0) {
        const v = j * columns + i;
        data.indices.push(v - columns - 1, v - columns, v, v - columns - 1, v, v - 1);
      }
    }
  }
  return data;
}

/** Five quaternions about one axis, from no rotation to more than a quarter turn. */
function rotations() {
  return [0, 0.5, 1, 1.5, 2].flatMap((a) => [0.6 * Math.sin(a / 2), 0, 0.8 * Math.sin(a / 2), Math.cos(a / 2)]);
}

const bytesOf = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
const padded = (bytes) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);

function glb(json, binary) {
  const text = Buffer.from(JSON.stringify(json));
  const head = Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, ' ')]);
  const chunk = (kind, data) => {
    const start = Buffer.alloc(8);
    start.writeUInt32LE(data.length, 0);
    start.write(kind, 4, 'latin1');
    return Buffer.concat([start, data]);
  };
  const chunks = Buffer.concat([chunk('JSON', head), chunk('BIN\0', padded(binary))]);
  const start = Buffer.alloc(12);
  start.write('glTF', 0, 'latin1');
  start.writeUInt32LE(2, 4);
  start.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([start, chunks]);
}

function bounds(bytes) {
  const values = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
  const of = (f) => [0, 1, 2].map((axis) => f(...values.filter((_, i) => i % 3 === axis)));
  return { min: of(Math.min), max: of(Math.max) };
}

const FLOAT = 5126;

/**
 * A model of streams { bytes, count, stride, type, component, normalized }, plain or compressed:
 * `compress` turns a stream into the extension's object and its bytes.
 */
function model(streams, compress) {
  const json = {
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    buffers: [], bufferViews: [], accessors: [],
    meshes: [{ primitives: [{ attributes: {} }, { attributes: {} }] }],
    animations: [{ samplers: [{ input: 0, output: 0 }], channels: [{ sampler: 0, target: { node: 0, path: 'rotation' } }] }],
  };
  const [first, second] = json.meshes[0].primitives;
  let [stored, plain] = [Buffer.alloc(0), 0];
  for (const [name, stream] of Object.entries(streams)) {
    const length = stream.count * stream.stride;
    const view = { buffer: compress ? 1 : 0, byteOffset: compress ? plain : stored.length, byteLength: length };
    if (!/indices|times|turns/.test(name)) view.byteStride = stream.stride;
    if (compress) {
      const [name, object, bytes] = compress(stream);
      view.extensions = { [name]: { buffer: 0, byteOffset: stored.length, byteLength: bytes.length, ...object } };
      stored = Buffer.concat([stored, padded(bytes)]);
    } else {
      stored = Buffer.concat([stored, padded(stream.bytes)]);
    }
    plain += Math.ceil(length / 4) * 4;
    const accessor = { bufferView: json.bufferViews.push(view) - 1, count: stream.count, type: stream.type, componentType: stream.component };
    if (stream.normalized) accessor.normalized = true;
    if (name === 'POSITION') Object.assign(accessor, bounds(stream.bytes));
    if (name === 'times') Object.assign(accessor, { min: [0], max: [2] });
    const index = json.accessors.push(accessor) - 1;
    if (name === 'triangles_indices') first.indices = index;
    else if (name === 'any_indices') second.indices = index;
    else if (name === 'times') json.animations[0].samplers[0].input = index;
    else if (name === 'turns') json.animations[0].samplers[0].output = index;
    else first.attributes[name] = second.attributes[name] = index;
  }
  json.buffers.push({ byteLength: stored.length });
  return [json, stored, plain];
}

/** The streams; `quantised` stores some attributes in fewer bits, so that filters have something to do. */
function streams(data, quantised) {
  const floats = (values, width) => {
    const bytes = bytesOf(new Float32Array(values));
    return { bytes, count: values.length / width, stride: 4 * width, type: ['SCALAR', '', 'VEC3', 'VEC4'][width - 1] || 'VEC2', component: FLOAT, mode: 'ATTRIBUTES' };
  };
  const filtered = (stream, filter, bytes, stride, component) => ({ ...stream, filter, bytes, stride, component, normalized: component !== FLOAT });
  const indices = (array, mode) => ({ bytes: bytesOf(array), count: array.length, stride: array.BYTES_PER_ELEMENT, type: 'SCALAR', component: array.BYTES_PER_ELEMENT === 2 ? 5123 : 5125, mode });
  const wide = (values, width, last) => new Float32Array(Array.from({ length: 4 * values.length / width }, (_, k) => (k % 4 < width ? values[Math.floor(k / 4) * width + (k % 4)] : last)));
  const all = {
    POSITION: floats(data.POSITION, 3),
    NORMAL: floats(data.NORMAL, 3),
    TANGENT: floats(data.TANGENT, 4),
    TEXCOORD_0: floats(data.TEXCOORD_0, 2),
    COLOR_0: { ...floats(data.COLOR_0, 4), bytes: Uint8Array.from(data.COLOR_0), stride: 4, component: 5121, normalized: true },
    triangles_indices: indices(Uint16Array.from(data.indices), 'TRIANGLES'),
    any_indices: indices(Uint32Array.from(data.indices).subarray(0, 30).reverse(), 'INDICES'),
    times: floats([0, 0.5, 1, 1.5, 2], 1),
    turns: floats(rotations(), 4),
  };
  if (quantised) {
    const m = MeshoptEncoder;
    all.NORMAL = filtered(all.NORMAL, 'OCTAHEDRAL', m.encodeFilterOct(wide(data.NORMAL, 3, 0), count, 4, 8), 4, 5120);
    all.TANGENT = filtered(all.TANGENT, 'OCTAHEDRAL', m.encodeFilterOct(wide(data.TANGENT, 4, 0), count, 8, 12), 8, 5122);
    all.TEXCOORD_0 = filtered(all.TEXCOORD_0, 'EXPONENTIAL', m.encodeFilterExp(new Float32Array(data.TEXCOORD_0), count, 8, 15), 8, FLOAT);
    all.turns = filtered(all.turns, 'QUATERNION', m.encodeFilterQuat(new Float32Array(rotations()), 5, 8, 14), 8, 5122);
    if (quantised === 'color') {
      const colors = new Float32Array(data.COLOR_0.map((v) => v / 255));
      all.COLOR_0 = filtered(all.COLOR_0, 'COLOR', m.encodeFilterColor(colors, count, 4, 8), 4, 5121);
    }
  }
  return all;
}

function meshopt(extension, version, data) {
  const compress = ({ bytes, count, stride, mode, filter }) => {
    const object = { byteStride: stride, count, mode };
    if (filter) object.filter = filter;
    return [extension, object, Buffer.from(MeshoptEncoder.encodeGltfBuffer(bytes, count, stride, mode, version))];
  };
  const [json, stored, plain] = model(streams(data, version === 1 ? 'color' : 'all'), compress);
  json.buffers.push({ byteLength: plain, extensions: { [extension]: { fallback: true } } });
  json.extensionsUsed = json.extensionsRequired = [extension, 'KHR_mesh_quantization'];
  return glb(json, stored);
}

const dracoIO = new NodeIO().registerExtensions([KHRDracoMeshCompression]).registerDependencies({
  'draco3d.encoder': await draco3d.createEncoderModule(),
  'draco3d.decoder': await draco3d.createDecoderModule(),
});

const BITS = { POSITION: 14, NORMAL: 10, TEX_COORD: 12, COLOR: 8, GENERIC: 12 };

/** Compresses every primitive of a document with Draco. */
async function draco(document, method, encodeSpeed) {
  const options = { method, encodeSpeed, decodeSpeed: encodeSpeed, quantizationBits: BITS, quantizationVolume: 'mesh' };
  document.createExtension(KHRDracoMeshCompression).setRequired(true).setEncoderOptions(options);
  return dracoIO.writeBinary(document);
}

/** A hill of 33 x 33 vertices, z = x (1 - x) y (1 - y): only positions, enough triangles for every method. */
function hill() {
  const document = new Document();
  const buffer = document.createBuffer();
  const [positions, indices] = [[], []];
  for (let j = 0; j < 33; j++) {
    for (let i = 0; i < 33; i++) {
      const [x, y, v] = [i / 32, j / 32, j * 33 + i];
      positions.push(x, y, x * (1 - x) * y * (1 - y));
      if (i > 0 && j > 0) indices.push(v - 34, v - 33, v, v - 34, v, v - 1);
    }
  }
  const position = document.createAccessor().setType('VEC3').setArray(new Float32Array(positions)).setBuffer(buffer);
  const index = document.createAccessor().setType('SCALAR').setArray(new Uint16Array(indices)).setBuffer(buffer);
  const primitive = document.createPrimitive().setAttribute('POSITION', position).setIndices(index);
  const node = document.createNode().setMesh(document.createMesh().addPrimitive(primitive));
  document.createScene().addChild(node);
  return document;
}

await MeshoptEncoder.ready;
const folder = process.argv[2];
const save = (name, bytes) => writeFileSync(`${folder}/${name}`, bytes);
const data = patch();
const [json, stored] = model(streams(data));
save('patch.glb', glb(json, stored));
save('patch-meshopt-ext.glb', meshopt('EXT_meshopt_compression', 0, data));
save('patch-meshopt-khr.glb', meshopt('KHR_meshopt_compression', 1, data));
const plain = () => dracoIO.read(`${folder}/patch.glb`);
const [sequential, edgebreaker] = [0, 1];
save('patch-draco-sequential.glb', await draco(await plain(), sequential, 10));
save('patch-draco-edgebreaker.glb', await draco(await plain(), edgebreaker, 0));
save('hill-draco-valence.glb', await draco(hill(), edgebreaker, 0));
