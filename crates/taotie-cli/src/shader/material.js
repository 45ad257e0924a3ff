// three.js materials that draw with a shader of Taotie: from NAME.json and its files, next to this module.
//
//     mesh.material = await loadMaterial("NAME", { textures: { base_color_texture: texture } });
//
// Meshes stay in their scene: transforms, skins, morph targets, instances, lights, shadows, fog, tone mapping and output
// colour space are three.js's. Needs WebGLRenderer; tested with three.js r187.
import * as THREE from "three";

// The attributes as three.js declares them, if a macro asks for it, and as its GLTFLoader names them.
const MACROS = { tangent: "USE_TANGENT", color: "USE_COLOR_ALPHA", uv1: "USE_UV1", uv2: "USE_UV2", uv3: "USE_UV3" };
const BUILT_IN = ["position", "normal", "uv", ...Object.keys(MACROS)];
const attributeName = (name) => name.replace(/^uv0$/, "uv").replace(/^uv(?=[4-9]|\d\d)/, "texcoord_");

// The remedy for an attribute that a mesh lacks.
const CURES = { normal: "computeVertexNormals() adds it", tangent: "export tangents, or add them with computeTangents()" };

// A varying of the shader, and its value in the vertex shader below.
const VARYINGS = {
    position: [["vec3 interpolated_position", "worldPosition.xyz"]],
    normal: [["vec3 interpolated_normal", "normalize((vec4(transformedNormal, 0.0) * viewMatrix).xyz)"]],
    tangent: [
        ["vec3 interpolated_tangent", "normalize((vec4(transformedTangent, 0.0) * viewMatrix).xyz)"],
        ["float interpolated_handedness", "tangent.w * sign(determinant(placed))"],
    ],
    color: [["vec4 interpolated_color", "color"]],
};
const varyingsOf = (name) => VARYINGS[name] ?? [[`vec2 interpolated_${name}`, attributeName(name)]];

// Reads what three.js's own materials read, and hands it to the fragment shader in world space.
function vertexShader({ surface, interface: { vertex } }) {
    const names = vertex.map(({ name }) => name);
    const own = names.map(attributeName).filter((name) => !BUILT_IN.includes(name));
    const varyings = names.flatMap(varyingsOf).map(([declared, value]) => {
        // The paper's bump mapping takes normals in object space.
        const isObject = surface === "bump-printed" && declared.endsWith("_normal");
        return [declared, isObject ? "normalize(objectNormal)" : value];
    });
    return `
#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
${own.map((name) => `in vec2 ${name};`).join("\n")}
${varyings.map(([declared]) => `${declared.startsWith("float") ? "flat " : ""}out ${declared};`).join("\n")}
void main() {
    #include <morphinstance_vertex>
    #include <batching_vertex>
    #include <beginnormal_vertex>
    #include <morphnormal_vertex>
    #include <skinbase_vertex>
    #include <skinnormal_vertex>
    #include <defaultnormal_vertex>
    #include <begin_vertex>
    #include <morphtarget_vertex>
    #include <skinning_vertex>
    #include <project_vertex>
    #include <logdepthbuf_vertex>
    #include <clipping_planes_vertex>
    vec4 worldPosition = vec4(transformed, 1.0);
    mat3 placed = mat3(modelMatrix);
#ifdef USE_BATCHING
    worldPosition = batchingMatrix * worldPosition;
    placed *= mat3(batchingMatrix);
#endif
#ifdef USE_INSTANCING
    worldPosition = instanceMatrix * worldPosition;
    placed *= mat3(instanceMatrix);
#endif
    worldPosition = modelMatrix * worldPosition;
    #include <shadowmap_vertex>
    #include <fog_vertex>
${varyings.map(([declared, value]) => `    ${declared.split(" ")[1]} = ${value};`).join("\n")}
}
`;
}

// The radiance from the lights of three.js: its chunk sums RE_Direct over them, with shadows, and finds `irradiance`.
const LIGHTS = `
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
#define RE_Direct(light, at, n, v, coat, m, sum) lit += reflect_light(p, to_world(light.direction)) * light.color
#define RE_IndirectDiffuse
vec3 to_world(vec3 direction) {
    return normalize((vec4(direction, 0.0) * viewMatrix).xyz);
}
vec3 host_lights(SurfacePoint p, vec3 position) {
    vec3 lit = vec3(0.0);
    vec3 normal = (viewMatrix * vec4(p.n, 0.0)).xyz;
    vec3 vViewPosition = -(viewMatrix * vec4(position, 1.0)).xyz;
    #include <lights_fragment_begin>
    return lit + own_radiance(p, irradiance * RECIPROCAL_PI) - own_radiance(p, vec3(0.0));
}
`;

// The shader of Taotie, lit and finished by three.js.
const fragmentShader = (text, isLit) => `
#define HOST_LIGHTS
#define main radiance_main
${text}
#undef main
#define gl_FragColor pixel_color
#include <common>
#include <packing>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
${isLit ? LIGHTS : ""}
void main() {
    #include <clipping_planes_fragment>
    #include <logdepthbuf_fragment>
    radiance_main();
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
    #include <fog_fragment>
    #include <premultiplied_alpha_fragment>
}
`;

// Warns once of each fault.
const warned = new Set();
function warnOnce(text) {
    if (!warned.has(text)) console.warn(text);
    warned.add(text);
}

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

// Returns the offset of each field, in floats.
const offsets = (fields) => Object.fromEntries(fields.map(({ name, offset }) => [name, offset / 4]));

// A material that draws with a shader of Taotie.
class ShadedMaterial extends THREE.ShaderMaterial {
    // Binds the description of a shader, and the numbers of its uniform blocks by their names.
    bind(shader, numbers) {
        const buffers = shader.interface.buffers.filter(({ name }) => name in numbers);
        const uniformsGroups = buffers.map((buffer) => block(buffer.block, numbers[buffer.name]));
        const [frame, own] = [shader.interface.frame, shader.interface.material].map(offsets);
        const attributes = shader.interface.vertex.map(({ name }) => ({ name, attribute: attributeName(name) }));
        const isObjectSpace = "normal_matrix_x" in own;
        return Object.assign(this, { shader, numbers, uniformsGroups, attributes, isObjectSpace, offsets: { frame, own } });
    }

    copy(source) {
        super.copy(source);
        this.map = source.map;
        const copies = Object.entries(source.numbers).map(([name, numbers]) => [name, numbers.slice()]);
        return this.bind(source.shader, Object.fromEntries(copies));
    }

    // Also releases the uniform blocks, of which a driver binds a few dozen.
    dispose() {
        super.dispose();
        this.uniformsGroups.forEach((each) => each.dispose());
    }

    // three.js calls this for each combination of lights and geometries.
    onBeforeCompile(parameters) {
        const { instancing, batching, skinning, instancingColor, batchingColor, morphColors } = parameters;
        const faults = {
            "area lights have no effect": parameters.numRectAreaLights > 0,
            "colours of instances and morph targets have no effect": instancingColor || batchingColor || morphColors,
            "normals in object space do not follow instances and skins": this.isObjectSpace && (instancing || batching || skinning),
        };
        for (const [fault, isThere] of Object.entries(faults)) isThere && warnOnce(`${this.name}: ${fault}`);
    }

    onBeforeRender(renderer, scene, camera, geometry, object) {
        this.check(scene, geometry, object);
        const [back, eye] = [8, 12].map((from) => camera.matrixWorld.elements.slice(from, from + 3));
        this.numbers.frame.set(camera.isPerspectiveCamera ? [...eye, 1] : [...back, 0], this.offsets.frame.eye);
        if (this.isObjectSpace) this.turnNormals(object, renderer.info.render.frame);
    }

    // Throws if the mesh lacks an attribute; warns if the scene has light that the shader does not read.
    check(scene, geometry, object) {
        for (const { name, attribute } of this.attributes) {
            if (geometry.attributes[attribute]) continue;
            const cure = CURES[name] ? `: ${CURES[name]}` : "";
            throw new Error(`${this.name}: the mesh "${object.name}" lacks the attribute ${attribute}${cure}`);
        }
        const isUnread = scene.environment && !this.shader.environment;
        if (isUnread) warnOnce(`${this.name}: scene.environment has no effect; write the shader with --env`);
    }

    // Turns normals in object space with the mesh. Blocks are uploaded once per frame, hence one mesh per material.
    turnNormals({ matrixWorld }, frame) {
        const { elements } = new THREE.Matrix3().getNormalMatrix(matrixWorld);
        const { frame: drawn, elements: before } = this.turned ?? {};
        if (drawn === frame && elements.some((number, i) => number !== before[i])) {
            throw new Error(`${this.name}: normals in object space need a material for each mesh: use clone()`);
        }
        this.turned = { frame, elements };
        for (const [axis, from] of [["x", 0], ["y", 3], ["z", 6]]) {
            const at = this.offsets.own[`normal_matrix_${axis}`];
            this.numbers.material.set(elements.slice(from, from + 3), at);
        }
    }
}

// Makes the material of NAME.json. `textures` are three.js textures by the names of their slots, top row first as
// in GLTFLoader, normal maps made by `normalTexture`. `surface` is the number of the model's surface whose values are
// used.
export async function loadMaterial(name, { textures = {}, surface = 0 } = {}) {
    const shader = JSON.parse(await fetched(`${name}.json`, "text"));
    const text = (await fetched(`${name}.frag`, "text")).replace(/^#version 300 es\n/, "");
    const { interface: inputs, environment } = shader;
    const { uniforms: values = {}, double_sided = false, alpha = "opaque" } = shader.surfaces[surface] ?? {};
    const counted = { environment_levels: environment?.count, smoothest_alpha: environment?.smoothest_alpha };
    const straight = { spacing: 1, environment_cos: 1, environment_intensity: 1 };
    const numbers = {
        frame: filled(shader.frame_bytes, inputs.frame, { ...straight, ...counted }),
        environment_levels: new Float32Array(environment?.levels.flat() ?? []),
        material: filled(shader.material_bytes, inputs.material, values),
    };
    const macros = inputs.vertex.map(({ name }) => MACROS[name]).filter(Boolean);
    const lib = THREE.UniformsLib;
    const material = new ShadedMaterial({
        name,
        glslVersion: THREE.GLSL3,
        defines: Object.fromEntries(macros.map((macro) => [macro, ""])),
        vertexShader: vertexShader(shader),
        fragmentShader: fragmentShader(text, inputs.buffers.some(({ name }) => name === "lights")),
        uniforms: { ...THREE.UniformsUtils.merge([lib.lights, lib.fog]), ...(await allTextures(shader, textures)) },
        side: double_sided ? THREE.DoubleSide : THREE.FrontSide,
        transparent: alpha === "blend",
        // As GLTFLoader does.
        depthWrite: alpha !== "blend",
        lights: true,
        fog: true,
        clipping: true,
    });
    const opacity = values.alpha?.[0] ?? 1;
    // The shadows of masked surfaces have holes too.
    if (alpha === "mask" && textures.base_color_texture && opacity > 0) {
        const alphaTest = values.cutoff[0] / opacity;
        Object.assign(material, { map: textures.base_color_texture, alphaTest });
    }
    return material.bind(shader, numbers);
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

// The bytes of a texture that a canvas can draw.
function drawnBytes(image) {
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height).data;
}

const COPY = {
    vertexShader: "in vec3 position; void main() { gl_Position = vec4(position, 1.0); }",
    fragmentShader: `precision highp float; uniform sampler2D map; out vec4 copied;
        void main() { copied = texelFetch(map, ivec2(gl_FragCoord.xy), 0); }`,
    glslVersion: THREE.GLSL3,
};

// The bytes of a texture that only the GPU can read, such as one from KTX2Loader.
function readBytes(texture, renderer) {
    if (!renderer) throw new Error("normalTexture: a compressed texture also needs the renderer, as second argument");
    const { width, height } = texture.image;
    const [target, before] = [new THREE.WebGLRenderTarget(width, height), renderer.getRenderTarget()];
    const material = new THREE.RawShaderMaterial({ ...COPY, uniforms: { map: { value: texture } } });
    const corners = new THREE.Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3);
    const triangle = new THREE.Mesh(new THREE.BufferGeometry().setAttribute("position", corners), material);
    triangle.frustumCulled = false;
    const bytes = new Uint8Array(4 * width * height);
    renderer.setRenderTarget(target);
    renderer.render(triangle, new THREE.Camera());
    renderer.readRenderTargetPixels(target, 0, 0, width, height, bytes);
    renderer.setRenderTarget(before);
    [target, material, triangle.geometry].forEach((each) => each.dispose());
    return bytes;
}

// Makes a normal map whose levels hold how far their vectors diverge, from an ordinary texture. Compressed textures need
// the `renderer`.
export function normalTexture(texture, renderer) {
    const { image, wrapS, wrapT } = texture;
    const { width, height } = image;
    const data = texture.isCompressedTexture || image.data ? readBytes(texture, renderer) : drawnBytes(image);
    const vectors = new Float32Array(3 * width * height);
    for (let i = 0; i < width * height; i++) {
        const vector = new THREE.Vector3().fromArray(data, 4 * i).multiplyScalar(2 / 255).subScalar(1);
        vector.normalize().toArray(vectors, 3 * i);
    }
    const levels = [{ vectors, width, height }];
    while (levels.at(-1).vectors.length > 3) levels.push(halved(levels.at(-1)));
    const mipmaps = levels.map(texels);
    const made = new THREE.DataTexture(mipmaps[0].data, width, height, THREE.RGBAFormat, THREE.HalfFloatType);
    const filters = { magFilter: THREE.LinearFilter, minFilter: THREE.LinearMipmapLinearFilter };
    return Object.assign(made, { mipmaps, wrapS, wrapT, ...filters, needsUpdate: true });
}
