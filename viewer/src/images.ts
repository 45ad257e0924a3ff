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

/** A mip level, row by row. */
interface Level<T> {
    data: T;
    width: number;
    height: number;
}

/** All levels; `halved` returns the next one. */
function levels<T>(finest: Level<T>, halved: (level: Level<T>) => Level<T>): Level<T>[] {
    const all = [finest];
    for (let last = finest; last.width > 1 || last.height > 1; all.push(last)) last = halved(last);
    return all;
}

/** The next level: its sides, its number of texels, and a function for the numbers of the four texels that each averages. */
function halving({ width, height }: Level<unknown>) {
    // Odd sides lose their last row or column.
    const sides = { width: Math.max(1, width >> 1), height: Math.max(1, height >> 1) };
    const [right, below] = [width > 1 ? 1 : 0, height > 1 ? width : 0];
    const tap = (texel: number, number: number): number => {
        const [x, y] = [texel % sides.width, Math.floor(texel / sides.width)];
        return (2 * x + (number & 1)) * right + (2 * y + (number >> 1)) * below;
    };
    return { sides, texels: sides.width * sides.height, tap };
}

/** The next level of heights: means. */
function halvedHeights(level: Level<Float32Array>): Level<Float32Array> {
    const { data } = level;
    const { sides, texels, tap } = halving(level);
    const means = new Float32Array(texels);
    for (let to = 0; to < texels; to++) {
        let sum = 0;
        for (let i = 0; i < 4; i++) sum += data[tap(to, i)]!;
        means[to] = sum / 4;
    }
    return { data: means, ...sides };
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
type Normals = Level<Uint16Array>;

/** The next level, as in the renderer: means of unit vectors. Vectors of the finest level may have any length. */
function halvedNormals(level: Normals, isFinest: boolean): Normals {
    const { data } = level;
    const { sides, texels, tap } = halving(level);
    const means = new Uint16Array(4 * texels);
    for (let to = 0; to < texels; to++) {
        let [sx, sy, sz] = [0, 0, 0];
        for (let i = 0; i < 4; i++) {
            const at = 4 * tap(to, i);
            const [nx, ny, nz] = [(2 * data[at]!) / TOP - 1, (2 * data[at + 1]!) / TOP - 1, (2 * data[at + 2]!) / TOP - 1];
            const length = isFinest ? Math.sqrt(nx * nx + ny * ny + nz * nz) || 1 : 1;
            sx += nx / length;
            sy += ny / length;
            sz += nz / length;
        }
        [sx, sy, sz] = [sx / 4, sy / 4, sz / 4];
        means[4 * to] = ((sx + 1) / 2) * TOP + 0.5;
        means[4 * to + 1] = ((sy + 1) / 2) * TOP + 0.5;
        means[4 * to + 2] = ((sz + 1) / 2) * TOP + 0.5;
        means[4 * to + 3] = Math.max(0, 1 - sx * sx - sy * sy - sz * sz) * TOP + 0.5;
    }
    return { data: means, ...sides };
}

/** A normal map from its finest level; half floats unless the driver can filter 16-bit codes (`isWide`). */
function normalTexture(finest: Normals, use: TextureUse, isWide: boolean): Texture {
    const all = levels(finest, (level) => halvedNormals(level, level === finest));
    const halves = (level: Normals) => ({ ...level, data: level.data.map((code) => half(code / TOP)) });
    const mipmaps = isWide ? all : all.map(halves);
    const type = isWide ? UnsignedShortType : HalfFloatType;
    const texture = new DataTexture(mipmaps[0]!.data, finest.width, finest.height, RGBAFormat, type);
    texture.normalized = isWide;
    texture.mipmaps = mipmaps as unknown as typeof texture.mipmaps;
    return sampled(texture, use);
}

/** A normal map from the codes of an image. */
export function imageNormals({ data: codes, width, height }: Level<Uint8Array>, use: TextureUse, isWide: boolean): Texture {
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

/** A height map from numbers, in the red channel. */
export function codedHeights(all: Uint16Array, { width, height, from }: Codes, use: TextureUse, isFine: boolean): Texture {
    const texel = ({ data, width, height }: Level<Float32Array>) => {
        const wide = new Float32Array(4 * data.length);
        data.forEach((number, i) => wide.set([number, 0, 0, 1], 4 * i));
        return { data: isFine ? wide : Uint16Array.from(wide, half), width, height };
    };
    const heights = Float32Array.from(all.subarray(from, from + width * height), (code) => code / TOP);
    const mipmaps = levels({ data: heights, width, height }, halvedHeights).map(texel);
    const type = isFine ? FloatType : HalfFloatType;
    const texture = new DataTexture(mipmaps[0]!.data, width, height, RGBAFormat, type);
    texture.mipmaps = mipmaps as unknown as typeof texture.mipmaps;
    return sampled(texture, use);
}
