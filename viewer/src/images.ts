// The images of a model as textures, with the same mip levels as in the renderer.

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
    UnsignedShortType,
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

/** Decodes an image file, keeping its numbers as stored. */
export function decoded(bytes: ArrayBuffer, type: string): Promise<ImageBitmap> {
    const options: ImageBitmapOptions = { premultiplyAlpha: "none", colorSpaceConversion: "none" };
    return createImageBitmap(new Blob([bytes], { type }), options);
}

/** A texture of colours or numbers; the driver creates the levels, in linear light. */
export function imageTexture(image: ImageBitmap, use: TextureUse, isSrgb: boolean): Texture {
    const texture = sampled(new Texture(image), use);
    texture.colorSpace = isSrgb ? SRGBColorSpace : LinearSRGBColorSpace;
    texture.generateMipmaps = true;
    texture.premultiplyAlpha = false;
    return texture;
}

/** A mip level of floats, row by row. */
interface Level {
    numbers: Float32Array;
    width: number;
    height: number;
}

/** The next level: means of two by two texels. Odd sides lose their last row or column. */
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

const word = new Float32Array(1);
const bits = new Uint32Array(word.buffer);

/** The half float nearest to a number from 0 to 1. */
function half(value: number): number {
    word[0] = value;
    // three.js truncates the lower bits.
    bits[0]! += value > 0 ? 0x1000 : 0;
    return DataUtils.toHalfFloat(word[0]!);
}

/** The largest code. */
const TOP = 65535;

/** A level of a normal map: codes of (n + 1)/2, and of the variance 1 − |mean|² of the vectors it averages. */
interface Normals {
    data: Uint16Array;
    width: number;
    height: number;
}

/** The next level, as in the renderer: means of unit vectors. Vectors of the finest level may have any length. */
function halvedNormals({ data, width, height }: Normals, isFinest: boolean): Normals {
    const [w, h] = [Math.max(1, width >> 1), Math.max(1, height >> 1)];
    const [right, below] = [width > 1 ? 4 : 0, height > 1 ? 4 * width : 0];
    const means = new Uint16Array(4 * w * h);
    for (let y = 0, to = 0; y < h; y++) {
        for (let x = 0; x < w; x++, to += 4) {
            const from = 4 * (2 * y * (height > 1 ? width : 0) + 2 * x * (width > 1 ? 1 : 0));
            let [sx, sy, sz] = [0, 0, 0];
            for (let tap = 0; tap < 4; tap++) {
                const at = from + (tap & 1 ? right : 0) + (tap & 2 ? below : 0);
                const [nx, ny, nz] = [(2 * data[at]!) / TOP - 1, (2 * data[at + 1]!) / TOP - 1, (2 * data[at + 2]!) / TOP - 1];
                const length = isFinest ? Math.sqrt(nx * nx + ny * ny + nz * nz) || 1 : 1;
                sx += nx / length;
                sy += ny / length;
                sz += nz / length;
            }
            [sx, sy, sz] = [sx / 4, sy / 4, sz / 4];
            means[to] = ((sx + 1) / 2) * TOP + 0.5;
            means[to + 1] = ((sy + 1) / 2) * TOP + 0.5;
            means[to + 2] = ((sz + 1) / 2) * TOP + 0.5;
            means[to + 3] = Math.max(0, 1 - sx * sx - sy * sy - sz * sz) * TOP + 0.5;
        }
    }
    return { data: means, width: w, height: h };
}

/** A normal map from its finest level; half floats unless the driver can filter 16-bit codes (`isWide`). */
function normalTexture(finest: Normals, use: TextureUse, isWide: boolean): Texture {
    const all = [finest];
    for (let last = finest; last.width > 1 || last.height > 1; all.push(last)) last = halvedNormals(last, last === finest);
    const halves = (level: Normals) => ({ ...level, data: level.data.map((code) => half(code / TOP)) });
    const mipmaps = isWide ? all : all.map(halves);
    const type = isWide ? UnsignedShortType : HalfFloatType;
    const texture = new DataTexture(mipmaps[0]!.data, finest.width, finest.height, RGBAFormat, type);
    texture.normalized = isWide;
    texture.mipmaps = mipmaps as unknown as typeof texture.mipmaps;
    return sampled(texture, use);
}

/** A normal map from an image. */
export function imageNormals(image: ImageBitmap, use: TextureUse, isWide: boolean): Texture {
    const { width, height } = image;
    const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true })!;
    context.drawImage(image, 0, 0);
    const codes = context.getImageData(0, 0, width, height).data;
    const data = new Uint16Array(codes.length);
    for (let i = 0; i < data.length; i += 4) {
        data[i] = 257 * codes[i]!;
        data[i + 1] = 257 * codes[i + 1]!;
        data[i + 2] = 257 * codes[i + 2]!;
    }
    return normalTexture({ data, width, height }, use, isWide);
}

/** A normal map from numbers. */
export function codedNormals(all: Uint16Array, { width, height, from }: Codes, use: TextureUse, isWide: boolean): Texture {
    const data = new Uint16Array(4 * width * height);
    for (let texel = 0; texel < width * height; texel++) {
        data.set(all.subarray(from + 3 * texel, from + 3 * texel + 3), 4 * texel);
    }
    return normalTexture({ data, width, height }, use, isWide);
}

/** The texels of a texture stored as 16-bit numbers. */
function floats(all: Uint16Array, { width, height, channels, from }: Codes): Level {
    const codes = all.subarray(from, from + width * height * channels);
    return { numbers: Float32Array.from(codes, (code) => code / 65535), width, height };
}

/** A height map from numbers, in the red channel. */
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
