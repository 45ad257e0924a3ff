// The textures that shaders read: those of the model, the albedo tables, and the environment maps.

import { DataTexture, FloatType, HalfFloatType, NearestFilter, RGBAFormat, type Texture, type WebGLRenderer } from "three";
import type { Data, ModelData, Surface, TextureUse } from "./data";
import { halves } from "./halves";
import type { Blobs } from "./host";
import { codedHeights, codedNormals, decoded, imageNormals, imageTexture } from "./images";
import type { Model } from "./model";
import { Once } from "./once";
import { pixels } from "./pixels";

/** A texture that is read without filtering. */
function numbers(data: Float32Array | Uint16Array, [width, height]: [number, number]): Texture {
    const type = data instanceof Float32Array ? FloatType : HalfFloatType;
    const texture = new DataTexture(data, width, height, RGBAFormat, type);
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.needsUpdate = true;
    return texture;
}

/** The textures of the frame, by slot name. */
export async function frameTextures({ tables, light }: Data, blob: Blobs): Promise<Record<string, Texture>> {
    const environment = async (name: string, size: [number, number]): Promise<Texture> =>
        numbers(halves(new Uint8Array(await blob(name)), size), size);
    const textures: Record<string, Texture> = {
        albedo_tables: numbers(new Float32Array(await blob("albedo_tables")), tables),
    };
    if (light.environment) {
        textures["environment_maps"] = await environment("environment_maps", light.environment.maps);
        textures["environment_picture"] = await environment("environment_picture", light.environment.picture);
    }
    return textures;
}

/** The page data and driver features that textures depend on. */
export interface Source {
    blobs: Blobs;
    /** The same bytes, kept after they are first read. */
    kept: Blobs;
    renderer: WebGLRenderer;
    /** True if 32-bit floats can be filtered. */
    isFine: boolean;
    /** True if 16-bit codes can be filtered. */
    isWide: boolean;
}

/** The textures of surfaces, each created once. */
export class Textures {
    private readonly made = new Once<string, Texture>();

    constructor(
        private readonly data: ModelData,
        private readonly model: Model,
        private readonly source: Source,
    ) {}

    /** The texture in a slot of a surface. */
    get(surface: Surface, slot: string, use: TextureUse): Promise<Texture> {
        const kind = slot === "height_texture" ? "height" : this.data.textures[use.texture]!.encoding;
        const key = [use.texture, kind, slot.endsWith("normal_texture"), ...use.sampler].join();
        return this.made.get(key, () => this.make(surface, slot, use));
    }

    private async make({ material }: Surface, slot: string, use: TextureUse): Promise<Texture> {
        const { codes, encoding } = this.data.textures[use.texture]!;
        const { kept, renderer, isFine, isWide } = this.source;
        const isNormal = slot.endsWith("normal_texture");
        if (codes && (slot === "height_texture" || encoding === "normal")) {
            const all = new Uint16Array(await kept(this.data.codes));
            return isNormal ? codedNormals(all, codes, use, isWide) : codedHeights(all, codes, use, isFine);
        }
        const { bytes, type } = await this.model.image(material, slot);
        const image = await decoded(bytes, type);
        if (!isNormal) return imageTexture(image, use, encoding === "srgb");
        const { width, height } = image;
        return imageNormals({ data: await pixels(renderer, image), width, height }, use, isWide);
    }
}
