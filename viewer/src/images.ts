// The images of a model as textures with the levels that the renderer has.

import {
    DataTexture,
    DataUtils,
    FloatType,
    HalfFloatType,
    LinearSRGBColorSpace,
    type MagnificationTextureFilter,
    type MinificationTextureFilter,
    NearestFilter,
    LinearFilter,
    NearestMipmapNearestFilter,
    LinearMipmapNearestFilter,
    NearestMipmapLinearFilter,
    LinearMipmapLinearFilter,
    RGBAFormat,
    SRGBColorSpace,
    Texture,
    RepeatWrapping,
    ClampToEdgeWrapping,
    MirroredRepeatWrapping,
    type Wrapping,
} from "three";
import type { Codes, TextureUse } from "./data";

const WRAPPING: Record<number, Wrapping> = {
    10497: RepeatWrapping,
    33071: ClampToEdgeWrapping,
    33648: MirroredRepeatWrapping,
};
const FILTERS: Record<number, MinificationTextureFilter> = {
    9728: NearestFilter,
    9729: LinearFilter,
    9984: NearestMipmapNearestFilter,
    9985: LinearMipmapNearestFilter,
    9986: NearestMipmapLinearFilter,
    9987: LinearMipmapLinearFilter,
};

function sampled<T extends Texture>(texture: T, { sampler: [u, v, magnify, minify] }: TextureUse): T {
    texture.wrapS = WRAPPING[u] ?? RepeatWrapping;
    texture.wrapT = WRAPPING[v] ?? RepeatWrapping;
    texture.magFilter = (FILTERS[magnify] ?? LinearFilter) as MagnificationTextureFilter;
    texture.minFilter = FILTERS[minify] ?? LinearMipmapLinearFilter;
    texture.flipY = false;
    texture.needsUpdate = true;
    return texture;
}

/** An image of a file, its numbers as they are stored. */
export function decoded(bytes: ArrayBuffer, type: string): Promise<ImageBitmap> {
    const options: ImageBitmapOptions = { premultiplyAlpha: "none", colorSpaceConversion: "none" };
    return createImageBitmap(new Blob([bytes], { type }), options);
}

/** Colours or numbers; the driver makes the levels, in linear light. */
export function imageTexture(image: ImageBitmap, use: TextureUse, isSrgb: boolean): Texture {
    const texture = sampled(new Texture(image), use);
    texture.colorSpace = isSrgb ? SRGBColorSpace : LinearSRGBColorSpace;
    texture.generateMipmaps = true;
    texture.premultiplyAlpha = false;
    return texture;
}

/** A level: so many floats a texel, row by row. */
interface Level {
    numbers: Float32Array;
    width: number;
    height: number;
}

/** The next level: means of two by two texels. Sides that are odd lose their last row or column. */
function halved({ numbers, width, height }: Level, channels: number): Level {
    const [w, h] = [Math.max(1, width >> 1), Math.max(1, height >> 1)];
    const [right, below] = [width > 1 ? channels : 0, height > 1 ? width * channels : 0];
    const means = new Float32Array(w * h * channels);
    for (let y = 0, to = 0; y < h; y++) {
        for (let x = 0; x < w; x++) {
            const from = (2 * y * (height > 1 ? width : 0) + 2 * x * (width > 1 ? 1 : 0)) * channels;
            for (let c = from; c < from + channels; c++, to++) {
                const sum = numbers[c]! + numbers[c + right]! + numbers[c + below]! + numbers[c + right + below]!;
                means[to] = sum / 4;
            }
        }
    }
    return { numbers: means, width: w, height: h };
}

function levels(finest: Level, channels: number): Level[] {
    const all = [finest];
    for (let last = finest; last.width > 1 || last.height > 1; all.push(last)) last = halved(last, channels);
    return all;
}

const half = DataUtils.toHalfFloat;

/** A level of vectors as texels: (n + 1)/2, and the variance 1 − |mean|². */
function normalTexels({ numbers, width, height }: Level): { data: Uint16Array; width: number; height: number } {
    const data = new Uint16Array(4 * width * height);
    for (let from = 0, to = 0; to < data.length; from += 3, to += 4) {
        const [x, y, z] = [numbers[from]!, numbers[from + 1]!, numbers[from + 2]!];
        data[to] = half((x + 1) / 2);
        data[to + 1] = half((y + 1) / 2);
        data[to + 2] = half((z + 1) / 2);
        data[to + 3] = half(Math.max(0, 1 - x * x - y * y - z * z));
    }
    return { data, width, height };
}

/** A normal map whose levels say how far their vectors diverge. `code` returns a channel of a texel in [0, 1]. */
function normalTexture(finest: Level, use: TextureUse): Texture {
    const { numbers, width, height } = finest;
    for (let i = 0; i < numbers.length; i += 3) {
        const [x, y, z] = [2 * numbers[i]! - 1, 2 * numbers[i + 1]! - 1, 2 * numbers[i + 2]! - 1];
        const length = Math.sqrt(x * x + y * y + z * z) || 1;
        numbers[i] = x / length;
        numbers[i + 1] = y / length;
        numbers[i + 2] = z / length;
    }
    const mipmaps = levels(finest, 3).map(normalTexels);
    const texture = new DataTexture(mipmaps[0]!.data, width, height, RGBAFormat, HalfFloatType);
    texture.mipmaps = mipmaps as unknown as typeof texture.mipmaps;
    return sampled(texture, use);
}

/** A normal map of an image. */
export function imageNormals(image: ImageBitmap, use: TextureUse): Texture {
    const { width, height } = image;
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true })!;
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const numbers = new Float32Array(3 * width * height);
    for (let from = 0, to = 0; to < numbers.length; from += 4, to += 3) {
        numbers[to] = data[from]! / 255;
        numbers[to + 1] = data[from + 1]! / 255;
        numbers[to + 2] = data[from + 2]! / 255;
    }
    return normalTexture({ numbers, width, height }, use);
}

/** The texels of a texture that is stored as numbers of 16 bits. */
function floats(all: Uint16Array, { width, height, channels, from }: Codes): Level {
    const codes = all.subarray(from, from + width * height * channels);
    return { numbers: Float32Array.from(codes, (code) => code / 65535), width, height };
}

/** A normal map of numbers. */
export const codedNormals = (all: Uint16Array, codes: Codes, use: TextureUse): Texture =>
    normalTexture(floats(all, codes), use);

/** A height map of numbers, in red. */
export function codedHeights(all: Uint16Array, codes: Codes, use: TextureUse, isFine: boolean): Texture {
    const texel = ({ numbers, width, height }: Level) => {
        const wide = new Float32Array(4 * numbers.length);
        numbers.forEach((number, i) => wide.set([number, 0, 0, 1], 4 * i));
        return { data: isFine ? wide : Uint16Array.from(wide, half), width, height };
    };
    const mipmaps = levels(floats(all, codes), 1).map(texel);
    const type = isFine ? FloatType : HalfFloatType;
    const texture = new DataTexture(mipmaps[0]!.data, codes.width, codes.height, RGBAFormat, type);
    texture.mipmaps = mipmaps as unknown as typeof texture.mipmaps;
    return sampled(texture, use);
}
