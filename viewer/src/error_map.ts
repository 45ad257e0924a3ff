// The normal error on the model's surface, in the colours of its legend.

import {
    DataTexture,
    Matrix3,
    NearestFilter,
    type RawShaderMaterial,
    RepeatWrapping,
    RGBAFormat,
    type Texture,
    UnsignedByteType,
} from "three";
import type { ErrorMap, Errors } from "./data";
import type { Blobs } from "./host";
import { plain } from "./plain";

/** The code for no value. */
const NONE = 0xffff;
/** The colour of unmeasured texels. */
const GREY = [96, 96, 96] as const;

const FRAGMENT = `uniform sampler2D colors;
uniform mat3 mapFromUv;
void main() {
    color = vec4(texture(colors, (mapFromUv * vec3(place, 1.0)).xy).rgb, 1.0);
}
`;

/** The map for surfaces without one: a single texel without a value. */
const UNKNOWN: ErrorMap = { width: 1, height: 1, from: 0, uv_set: 0, transform: [1, 0, 0, 1, 0, 0] };

export class ErrorMaps {
    private constructor(
        readonly errors: Errors,
        private readonly codes: Uint16Array,
    ) {}

    static async load(errors: Errors, blob: Blobs): Promise<ErrorMaps> {
        return new ErrorMaps(errors, new Uint16Array(await blob("errors")));
    }

    /** Degrees at a point of a surface, whose uvs in a set `uvOf` returns; undefined if not measured there. */
    at(surface: number, uvOf: (set: number) => [number, number] | undefined): number | undefined {
        const map = this.errors.maps[surface];
        const uv = map && uvOf(map.uv_set);
        if (!map || !uv) return undefined;
        const [a, b, c, d, e, f] = map.transform;
        const texel = (place: number, count: number) => Math.min(Math.floor((place - Math.floor(place)) * count), count - 1);
        const x = texel(a * uv[0] + b * uv[1] + e, map.width);
        const y = texel(c * uv[0] + d * uv[1] + f, map.height);
        const code = this.codes[map.from + y * map.width + x];
        return code === undefined || code === NONE ? undefined : code / this.errors.steps;
    }

    /** The material that draws a surface in its error colours, which are encoded in sRGB. */
    material(surface: number): RawShaderMaterial {
        const map = this.errors.maps[surface];
        const shown = map ?? UNKNOWN;
        const [a, b, c, d, e, f] = shown.transform;
        const mapFromUv = { value: new Matrix3(a, b, e, c, d, f, 0, 0, 1) };
        return plain(FRAGMENT, { colors: { value: this.texture(shown, !map) }, mapFromUv }, shown.uv_set);
    }

    private texture({ width, height, from }: ErrorMap, isUnknown: boolean): Texture {
        const colors = new Uint8Array(4 * width * height).fill(255);
        for (let i = 0; i < width * height; i++) {
            const code = isUnknown ? NONE : this.codes[from + i]!;
            colors.set(code === NONE ? GREY : this.color(code / this.errors.steps), 4 * i);
        }
        const texture = new DataTexture(colors, width, height, RGBAFormat, UnsignedByteType);
        texture.minFilter = texture.magFilter = NearestFilter;
        texture.wrapS = texture.wrapT = RepeatWrapping;
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
