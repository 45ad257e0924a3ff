// The model: the meshes of the GLB in the form that shaders read, and its images.

import { BufferAttribute, BufferGeometry, Matrix3, type Mesh, MeshBasicMaterial, Vector3 } from "three";
import { type GLTF, GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import type { Surface } from "./data";
import { texts } from "./texts";

/** The parts of the glTF JSON that are read here. */
interface Json {
    meshes: { name?: string }[];
    images?: { bufferView: number; mimeType: string }[];
    textures?: { source?: number; extensions?: Record<string, { source: number }> }[];
    materials?: unknown[];
}

export interface Model {
    /** The geometry of each surface, world space. */
    geometries: BufferGeometry[];
    /** The same geometries with object-space normals. */
    printed: BufferGeometry[];
    /** Returns the bytes and the type of the image in a slot of a material. */
    image(material: number, slot: string): Promise<{ bytes: ArrayBuffer; type: string }>;
}

/** The path in glTF to the texture of each slot. */
const PLACES: Record<string, string[]> = {
    base_color_texture: ["pbrMetallicRoughness", "baseColorTexture"],
    metallic_roughness_texture: ["pbrMetallicRoughness", "metallicRoughnessTexture"],
    occlusion_texture: ["occlusionTexture"],
    emissive_texture: ["emissiveTexture"],
    normal_texture: ["normalTexture"],
    specular_texture: ["extensions", "KHR_materials_specular", "specularTexture"],
    specular_color_texture: ["extensions", "KHR_materials_specular", "specularColorTexture"],
    clearcoat_texture: ["extensions", "KHR_materials_clearcoat", "clearcoatTexture"],
    clearcoat_roughness_texture: ["extensions", "KHR_materials_clearcoat", "clearcoatRoughnessTexture"],
    clearcoat_normal_texture: ["extensions", "KHR_materials_clearcoat", "clearcoatNormalTexture"],
    sheen_color_texture: ["extensions", "KHR_materials_sheen", "sheenColorTexture"],
    sheen_roughness_texture: ["extensions", "KHR_materials_sheen", "sheenRoughnessTexture"],
    anisotropy_texture: ["extensions", "KHR_materials_anisotropy", "anisotropyTexture"],
};

type Members = Record<string, unknown> | undefined;

function imageOf(json: Json, material: number, slot: string): number {
    const place = PLACES[slot] ?? [];
    const found = place.reduce<unknown>((value, name) => (value as Members)?.[name], json.materials?.[material]);
    const texture = json.textures?.[(found as { index?: number } | undefined)?.index ?? -1];
    const image = texture?.source ?? texture?.extensions?.["EXT_texture_webp"]?.source;
    if (image === undefined) throw new Error(texts.noTexture(slot));
    return image;
}

/** The values of an attribute as floats. */
function floats(attribute: BufferAttribute, size: number): Float32Array {
    const values = new Float32Array(attribute.count * size);
    for (let i = 0, to = 0; i < attribute.count; i++) {
        for (let c = 0; c < size; c++) values[to++] = attribute.getComponent(i, c);
    }
    return values;
}

/** Transforms unit vectors by a matrix, keeping any numbers after the first three of each. */
function turned(values: Float32Array, size: number, matrix: Matrix3): Float32Array {
    const vector = new Vector3();
    for (let i = 0; i < values.length; i += size) {
        vector.fromArray(values, i).applyMatrix3(matrix).normalize().toArray(values, i);
    }
    return values;
}

/** The shader names of attributes. */
const NAMES: Record<string, string> = { uv: "uv0" };

/** The geometry of a mesh in world space; glTF stores it as integers, which the node's matrix dequantizes. */
function worldGeometry(mesh: Mesh): BufferGeometry {
    const geometry = new BufferGeometry();
    const matrices: Record<string, Matrix3> = {
        normal: new Matrix3().getNormalMatrix(mesh.matrixWorld),
        tangent: new Matrix3().setFromMatrix4(mesh.matrixWorld),
    };
    for (const [name, attribute] of Object.entries(mesh.geometry.attributes)) {
        const size = attribute.itemSize;
        const values = floats(attribute as BufferAttribute, size);
        const matrix = matrices[name];
        const shown = NAMES[name] ?? name.replace(/^texcoord_(\d+)$/, "uv$1");
        geometry.setAttribute(shown, new BufferAttribute(matrix ? turned(values, size, matrix) : values, size));
    }
    geometry.setIndex(mesh.geometry.index);
    geometry.attributes["position"]!.applyMatrix4(mesh.matrixWorld);
    const normals = geometry.attributes["normal"];
    if (normals) geometry.setAttribute("world_normal", normals);
    return withFourColors(geometry);
}

/** Extends colours to the four components that shaders read; without alpha the fourth is 1. */
function withFourColors(geometry: BufferGeometry): BufferGeometry {
    const color = geometry.attributes["color"];
    if (!color || color.itemSize === 4) return geometry;
    const wide = new Float32Array(4 * color.count).fill(1);
    for (let i = 0; i < color.count; i++) wide.set([color.getX(i), color.getY(i), color.getZ(i)], 4 * i);
    return geometry.setAttribute("color", new BufferAttribute(wide, 4));
}

/** The geometry with object-space normals. */
function withObjectNormals(geometry: BufferGeometry, { normal_matrix }: Surface): BufferGeometry {
    const copy = new BufferGeometry();
    for (const [name, attribute] of Object.entries(geometry.attributes)) copy.setAttribute(name, attribute);
    copy.setIndex(geometry.index);
    const normals = geometry.attributes["normal"];
    if (!normals) return copy;
    const toObject = new Matrix3().fromArray(normal_matrix.flat()).invert();
    const turned = new Float32Array(3 * normals.count);
    const normal = new Vector3();
    for (let i = 0; i < normals.count; i++) {
        normal.fromBufferAttribute(normals, i).applyMatrix3(toObject).normalize().toArray(turned, 3 * i);
    }
    return copy.setAttribute("normal", new BufferAttribute(turned, 3));
}

async function parsed(glb: ArrayBuffer): Promise<GLTF> {
    await MeshoptDecoder.ready;
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder);
    // We create materials ourselves, so no image is decoded twice.
    const plain = () => Promise.resolve(new MeshBasicMaterial());
    loader.register(() => ({ name: "TAOTIE", loadMaterial: plain }) as unknown as never);
    return loader.parseAsync(glb, "");
}

/** Reads the GLB of a page. */
export async function readModel(glb: ArrayBuffer, surfaces: Surface[]): Promise<Model> {
    const gltf = await parsed(glb);
    const json = gltf.parser.json as Json;
    const geometries: BufferGeometry[] = [];
    gltf.scene.updateMatrixWorld(true);
    gltf.scene.traverse((object) => {
        if (!(object as Mesh).isMesh) return;
        const place = gltf.parser.associations.get(object)?.meshes ?? -1;
        geometries[Number(json.meshes[place]?.name)] = worldGeometry(object as Mesh);
    });
    // A surface without triangles has no mesh.
    const all = surfaces.map((_, i) => geometries[i] ?? new BufferGeometry());
    if (!geometries.some(Boolean)) throw new Error(texts.noMesh(0));
    return {
        geometries: all,
        printed: all.map((geometry, i) => withObjectNormals(geometry, surfaces[i]!)),
        async image(material, slot) {
            const number = imageOf(json, material, slot);
            const { bufferView, mimeType } = json.images![number]!;
            const bytes = (await gltf.parser.getDependency("bufferView", bufferView)) as ArrayBuffer;
            return { bytes, type: mimeType };
        },
    };
}

