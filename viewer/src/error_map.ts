// The error of the model's normals on its surface, in the colours of its legend.

import { DataTexture, NearestFilter, type RawShaderMaterial, RGBAFormat, type Texture, UnsignedByteType } from "three";
import type { ErrorMap, Errors } from "./data";
import type { Blobs } from "./host";
import { plain } from "./plain";

/** The number that stands for none. */
const NONE = 0xffff;
/** The colour of what was not measured. */
const GREY = [96, 96, 96] as const;

const FRAGMENT = `uniform sampler2D colors;
void main() {
    color = vec4(texture(colors, place).rgb, 1.0);
}
`;

export class ErrorMaps {
    private constructor(
        readonly errors: Errors,
        private readonly codes: Uint16Array,
    ) {}

    static async load(errors: Errors, blob: Blobs): Promise<ErrorMaps> {
        return new ErrorMaps(errors, new Uint16Array(await blob("errors")));
    }

    /** Degrees at a place of a surface's map; none where nothing was measured. */
    at(surface: number, u: number, v: number): number | undefined {
        const map = this.errors.maps[surface];
        if (!map) return undefined;
        const [x, y] = [Math.floor(u * map.width), Math.floor(v * map.height)];
        if (x < 0 || y < 0 || x >= map.width || y >= map.height) return undefined;
        const code = this.codes[map.from + y * map.width + x];
        return code === undefined || code === NONE ? undefined : code / this.errors.steps;
    }

    /** Draws a surface in the colours of its errors, which are codes of sRGB. */
    material(surface: number): RawShaderMaterial {
        const map = this.errors.maps[surface];
        const colors = this.texture(map ?? { width: 1, height: 1, from: 0 }, !map);
        return plain(FRAGMENT, { colors: { value: colors } });
    }

    private texture({ width, height, from }: ErrorMap, isUnknown: boolean): Texture {
        const colors = new Uint8Array(4 * width * height).fill(255);
        for (let i = 0; i < width * height; i++) {
            const code = isUnknown ? NONE : this.codes[from + i]!;
            colors.set(code === NONE ? GREY : this.color(code / this.errors.steps), 4 * i);
        }
        const texture = new DataTexture(colors, width, height, RGBAFormat, UnsignedByteType);
        texture.minFilter = texture.magFilter = NearestFilter;
        texture.needsUpdate = true;
        return texture;
    }

    private color(degrees: number): [number, number, number] {
        const { stops, top } = this.errors;
        const at = Math.min(degrees / top, 1) * (stops.length - 1);
        const [low, share] = [Math.floor(at), at % 1];
        const [a, b] = [stops[low]!, stops[Math.min(low + 1, stops.length - 1)]!];
        return [0, 1, 2].map((i) => Math.round(a[i]! + (b[i]! - a[i]!) * share)) as [number, number, number];
    }
}
