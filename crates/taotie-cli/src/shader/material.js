// three.js materials that draw with a shader of Taotie: from NAME.json and its files, next to this module.
//
//     const material = await loadMaterial("NAME", { textures: { base_color_texture: texture } });
//     material.light([0, 0, 1], [3, 3, 3]);
//     scene.add(new THREE.Mesh(worldGeometry(mesh, material), material));
import * as THREE from "three";

// The shader's own radiance is linear; a canvas holds sRGB.
const ENCODED = `
#undef main
void main() {
    radiance_main();
    vec3 c = clamp(pixel_color.rgb, 0.0, 1.0);
    vec3 curve = 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055;
    pixel_color.rgb = mix(curve, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
}
`;

// Fetches a file next to this module, as `text` or `arrayBuffer`.
async function fetched(name, kind) {
    const response = await fetch(new URL(name, import.meta.url));
    if (response.ok) return response[kind]();
    throw new Error(`${name}: ${response.status} ${response.statusText}`);
}

// A texture from a file of numbers, which is read texel by texel.
async function binaryTexture({ file, width, height, format }) {
    const isFloat = format === "rgba32float";
    const [kind, type] = isFloat ? [Float32Array, THREE.FloatType] : [Uint16Array, THREE.HalfFloatType];
    const numbers = new kind(await fetched(file, "arrayBuffer"));
    const texture = new THREE.DataTexture(numbers, width, height, THREE.RGBAFormat, type);
    return Object.assign(texture, { needsUpdate: true });
}

// The textures of all slots: the tables and the environment from their files, the others as given.
async function allTextures({ interface: { textures }, tables, environment }, given) {
    const { maps, picture } = environment ?? {};
    const files = { albedo_tables: tables, environment_maps: maps, environment_picture: picture };
    const found = textures.map(async ({ name }) => {
        const value = name in files ? await binaryTexture(files[name]) : given[name];
        if (!value) throw new Error(`${name}: pass this texture in \`textures\``);
        return [name, { value }];
    });
    return Object.fromEntries(await Promise.all(found));
}

// The numbers of a uniform block, with these fields filled.
function filled(bytes, fields, values) {
    const numbers = new Float32Array(bytes / 4);
    for (const { name, offset } of fields) numbers.set([values[name] ?? 0].flat(), offset / 4);
    return numbers;
}

// A uniform block of numbers, which are rewritten with each frame.
const block = (name, numbers) => new THREE.UniformsGroup().setName(name).add(new THREE.Uniform(numbers));

// Makes the material of NAME.json. `textures` are three.js textures by the names of their slots, top row first as
// in GLTFLoader, normal maps made by `normalTexture`. `surface` is the number of the model's surface whose values are
// used, `ambient` the radiance from all around.
export async function loadMaterial(name, { textures = {}, surface = 0, ambient = [0, 0, 0] } = {}) {
    const shader = JSON.parse(await fetched(`${name}.json`, "text"));
    const source = async (end) => (await fetched(name + end, "text")).replace(/^#version 300 es\n/, "");
    const { interface: inputs, environment } = shader;
    const { uniforms: values = {}, double_sided = false, alpha = "opaque" } = shader.surfaces[surface] ?? {};
    const counted = { environment_levels: environment?.count, smoothest_alpha: environment?.smoothest_alpha };
    const straight = { ambient, spacing: 1, environment_cos: 1, environment_intensity: 1 };
    const frame = filled(shader.frame_bytes, inputs.frame, { ...straight, ...counted });
    const [lights, levels] = [new Float32Array(16 * 16), new Float32Array(environment?.levels.flat() ?? [])];
    const factors = filled(shader.material_bytes, inputs.material, values);
    const numbers = { frame, lights, environment_levels: levels, material: factors };
    const material = new THREE.RawShaderMaterial({
        name,
        glslVersion: THREE.GLSL3,
        vertexShader: await source(".vert"),
        fragmentShader: `#define main radiance_main\n${await source(".frag")}${ENCODED}`,
        uniforms: await allTextures(shader, textures),
        uniformsGroups: inputs.buffers.map((buffer) => block(buffer.block, numbers[buffer.name])),
        side: double_sided ? THREE.DoubleSide : THREE.FrontSide,
        transparent: alpha === "blend",
    });
    const place = Object.fromEntries(inputs.frame.map(({ name, offset }) => [name, offset / 4]));
    // One light from infinitely far: the direction to it, and its irradiance in linear RGB.
    material.light = (towards, color) => {
        const to = new THREE.Vector3(...towards).normalize();
        lights.set([to.x, to.y, to.z, 0, ...color, 1e18, 0, 0, 1, -2, -3]);
        frame[place.light_count] = 1;
    };
    material.onBeforeRender = (renderer, scene, camera) => {
        const clip = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse);
        const [back, eye] = [8, 12].map((from) => camera.matrixWorld.elements.slice(from, from + 3));
        frame.set(clip.elements, place.clip_from_world);
        frame.set(camera.isPerspectiveCamera ? [...eye, 1] : [...back, 0], place.eye);
    };
    return Object.assign(material, { vertex: inputs.vertex });
}

// The geometry of a mesh in world space, with the attributes that the material reads.
export function worldGeometry(mesh, material) {
    mesh.updateWorldMatrix(true, false);
    if (mesh.matrixWorld.determinant() < 0) throw new Error("a mirrored mesh: flip its triangles first");
    const geometry = mesh.geometry.clone().applyMatrix4(mesh.matrixWorld);
    for (const { name } of material.vertex) {
        const attribute = geometry.attributes[name] ?? geometry.attributes[name.replace(/^uv0$/, "uv")];
        if (!attribute) throw new Error(`the mesh lacks the attribute ${name}`);
        geometry.setAttribute(name, attribute);
    }
    return geometry;
}

// The next level of a normal map: means of vectors. Odd sides lose their last row or column.
function halved({ vectors, width, height }) {
    const [w, h] = [width, height].map((side) => Math.max(1, side >> 1));
    const at = (x, y, c) => vectors[3 * (Math.min(y, height - 1) * width + Math.min(x, width - 1)) + c];
    const means = new Float32Array(3 * w * h).map((_, i) => {
        const [c, x, y] = [i % 3, 2 * (Math.floor(i / 3) % w), 2 * Math.floor(i / 3 / w)];
        return (at(x, y, c) + at(x + 1, y, c) + at(x, y + 1, c) + at(x + 1, y + 1, c)) / 4;
    });
    return { vectors: means, width: w, height: h };
}

// A level of a normal map as texels: 1 − |mean|² is in alpha.
function texels({ vectors, width, height }) {
    const data = new Uint16Array(4 * width * height);
    for (let i = 0; i < width * height; i++) {
        const [x, y, z] = vectors.subarray(3 * i, 3 * i + 3);
        const variance = Math.max(0, 1 - x * x - y * y - z * z);
        data.set([(x + 1) / 2, (y + 1) / 2, (z + 1) / 2, variance].map(THREE.DataUtils.toHalfFloat), 4 * i);
    }
    return { data, width, height };
}

// Makes a normal map whose levels hold how far their vectors diverge, from an ordinary texture.
export function normalTexture({ image, wrapS, wrapT }) {
    const { width, height } = image;
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const vectors = new Float32Array(3 * width * height);
    for (let i = 0; i < width * height; i++) {
        const vector = new THREE.Vector3().fromArray(data, 4 * i).multiplyScalar(2 / 255).subScalar(1);
        vector.normalize().toArray(vectors, 3 * i);
    }
    const levels = [{ vectors, width, height }];
    while (levels.at(-1).vectors.length > 3) levels.push(halved(levels.at(-1)));
    const mipmaps = levels.map(texels);
    const texture = new THREE.DataTexture(mipmaps[0].data, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
    const filters = { magFilter: THREE.LinearFilter, minFilter: THREE.LinearMipmapLinearFilter };
    return Object.assign(texture, { mipmaps, wrapS, wrapT, ...filters, needsUpdate: true });
}
