// The materials of surfaces: the generated shaders, with the uniforms and textures that they read.

import {
    DoubleSide,
    FrontSide,
    GLSL3,
    RawShaderMaterial,
    type Texture,
    Uniform,
    UniformsGroup,
    type IUniform,
} from "three";
import type { Data, Dress, ModelData, Shader, Surface } from "./data";
import { inMode } from "./modes";
import { Once } from "./once";
import { PLANES, ShadowUniforms, VISIBILITY } from "./shadows";
import type { Textures } from "./textures";

/** The maximum number of lights in a shader, and the numbers per light. */
const MOST_LIGHTS = 16;
const LIGHT = 16;
/** The index of `bump-printed` among the methods. */
export const PRINTED = 3;

/** Clamps radiance to the range of half floats. */
const ENDED = `
#undef main
void main() {
    radiance_main();
    pixel_color.rgb = min(pixel_color.rgb, vec3(60000.0));
}
`;

/** A uniform block of numbers, which are rewritten for each frame. */
function block(name: string, numbers: Float32Array): UniformsGroup {
    return new UniformsGroup().setName(name).add(new Uniform(numbers));
}

/** The uniform blocks that all surfaces share. */
export class Frame {
    readonly shadows = new ShadowUniforms();
    private readonly places: Map<string, number>;
    private readonly frame: Float32Array;
    private readonly lights = new Float32Array(MOST_LIGHTS * LIGHT);
    readonly groups: Record<string, UniformsGroup>;

    constructor({ frame, light: { environment } }: Data) {
        this.places = new Map(frame?.fields.map(([name, offset]) => [name, offset / 4]));
        this.frame = new Float32Array((frame?.bytes ?? 16) / 4);
        this.groups = {
            frame: block("FrameBlock", this.frame),
            lights: block("LightBlock", this.lights),
            environment_levels: block("EnvironmentBlock", new Float32Array(environment?.levels.flat() ?? [0, 0, 0, 0])),
        };
        this.set("environment_levels", environment?.count ?? 1);
        this.set("smoothest_alpha", environment?.smoothest_alpha ?? 1);
    }

    /** Writes a value of the frame. */
    set(name: string, ...values: number[]): void {
        this.frame.set(values, this.places.get(name) ?? 0);
    }

    setLights(all: number[][]): void {
        all.slice(0, MOST_LIGHTS).forEach((light, i) => this.lights.set(light, LIGHT * i));
        this.set("light_count", Math.min(all.length, MOST_LIGHTS));
    }
}

const joined = ({ texts }: Data, pieces: number[]): string =>
    pieces.map((piece) => texts.pieces[piece]).join("\n\n").replace(/^#version 300 es\n/, "");

/** Turns the factors of a surface into ordinary uniforms: as blocks, they would exceed the limit of some drivers. */
const unblocked = (text: string): string =>
    text.replace(/layout\(std140\) uniform MaterialBlock \{\s*(MaterialUniforms material;)\s*\};/, "uniform $1");

/** Creates the materials of surfaces, each once. */
export class Materials {
    private readonly made = new Once<string, RawShaderMaterial>();

    constructor(
        private readonly data: Data,
        private readonly model: ModelData,
        private readonly textures: Textures,
        private readonly frameTextures: Record<string, Texture>,
        private readonly frame: Frame,
    ) {}

    /** Returns the material of a surface for the indices of model and method, in a mode. */
    get(number: number, shading: number, method: number, mode: string): Promise<RawShaderMaterial> {
        const key = [number, shading, method, mode].join();
        return this.made.get(key, () => this.make(number, shading, method, mode));
    }

    private async make(number: number, shading: number, method: number, mode: string): Promise<RawShaderMaterial> {
        const surface = this.model.surfaces[number]!;
        const dress = mode === "clay" ? surface.clay : surface.own;
        const shader = this.data.texts.shaders[dress.looks[shading]![method]!]!;
        const fragment = inMode(unblocked(joined(this.data, shader.fragment)), mode);
        return new RawShaderMaterial({
            glslVersion: GLSL3,
            vertexShader: `#define main vertex_main\n${joined(this.data, shader.vertex)}${PLANES}`,
            fragmentShader: `#define main radiance_main\n${fragment}${VISIBILITY}${ENDED}`,
            uniforms: await this.uniforms(surface, dress, shader, method === PRINTED),
            uniformsGroups: this.groups(shader),
            side: surface.double_sided ? DoubleSide : FrontSide,
            transparent: surface.blended,
            // Surfaces behind a pane or a lens are drawn too.
            depthWrite: !surface.blended,
            polygonOffsetFactor: 1,
            polygonOffsetUnits: 1,
        });
    }

    private groups(shader: Shader): UniformsGroup[] {
        return shader.blocks.flatMap(([name]) => this.frame.groups[name] ?? []);
    }

    private async uniforms(
        surface: Surface,
        dress: Dress,
        shader: Shader,
        isPrinted: boolean,
    ): Promise<Record<string, IUniform>> {
        const numbers = isPrinted ? { ...dress.factors, bump: [dress.printed_bump] } : dress.factors;
        const single = Object.entries(numbers).map(([name, values]) => [name, values.length > 1 ? values : values[0]]);
        const textures = shader.textures.map(async (slot) => {
            const use = dress.textures[slot];
            const value = use ? await this.textures.get(surface, slot, use) : this.frameTextures[slot];
            return [slot, { value }] as const;
        });
        const material = { value: Object.fromEntries(single) };
        return { material, ...this.frame.shadows.all, ...Object.fromEntries(await Promise.all(textures)) };
    }
}
