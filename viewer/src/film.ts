// Develops light for the screen like taotie::film: samples are averaged in linear light, followed by exposure, tone
// curve, background and sRGB.

import {
    BufferAttribute,
    BufferGeometry,
    Camera,
    CustomBlending,
    GLSL3,
    HalfFloatType,
    Mesh,
    NearestFilter,
    NoBlending,
    OneFactor,
    RawShaderMaterial,
    type Texture,
    type WebGLRenderer,
    WebGLRenderTarget,
} from "three";

const VERTEX = `precision highp float;
in vec3 position;
void main() {
    gl_Position = vec4(position, 1.0);
}
`;

const SHARE = `precision highp float;
uniform sampler2D light;
uniform float share;
layout(location = 0) out vec4 color;
void main() {
    color = texelFetch(light, ivec2(gl_FragCoord.xy), 0) * share;
}
`;

const DEVELOP = `precision highp float;
uniform sampler2D light;
uniform float exposure;
uniform int tone;
uniform bool numbers;
uniform vec4 background;
layout(location = 0) out vec4 color;

// Khronos PBR Neutral.
vec3 neutral(vec3 c) {
    float x = min(c.r, min(c.g, c.b));
    c -= x < 0.08 ? x - 6.25 * x * x : 0.04;
    float peak = max(c.r, max(c.g, c.b));
    if (peak < 0.76) return c;
    float lower = 1.0 - 0.0576 / (peak - 0.52);
    float keep = 1.0 / (0.15 * (peak - lower) + 1.0);
    return mix(vec3(lower), c * (lower / peak), keep);
}

// Hill's fit of ACES.
vec3 aces(vec3 c) {
    const mat3 before = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 after = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    vec3 v = before * (c / 0.6);
    vec3 a = v * (v + 0.0245786) - 0.000090537;
    vec3 b = v * (0.983729 * v + 0.4329510) + 0.238081;
    return after * (a / b);
}

// AgX, base look.
vec3 agx(vec3 c) {
    const mat3 rec2020 = mat3(0.6274, 0.0691, 0.0164, 0.3293, 0.9195, 0.0880, 0.0433, 0.0113, 0.8956);
    const mat3 srgb = mat3(1.6605, -0.1246, -0.0182, -0.5876, 1.1329, -0.1006, -0.0728, -0.0083, 1.1187);
    const mat3 inset = mat3(
        0.856627153315983, 0.137318972929847, 0.11189821299995,
        0.0951212405381588, 0.761241990602591, 0.0767994186031903,
        0.0482516061458583, 0.101439036467562, 0.811302368396859
    );
    const mat3 outset = mat3(
        1.1271005818144368, -0.1413297634984383, -0.14132976349843826,
        -0.11060664309660323, 1.157823702216272, -0.11060664309660294,
        -0.016493938717834573, -0.016493938717834257, 1.2519364065950405
    );
    vec3 x = clamp((log2(max(inset * (rec2020 * c), 1e-10)) + 12.47393) / (4.026069 + 12.47393), 0.0, 1.0);
    vec3 cubic = ((15.5 * x - 40.14) * x + 31.96) * x - 6.868;
    vec3 v = outset * (((cubic * x + 0.4298) * x + 0.1191) * x - 0.00232);
    return srgb * pow(max(v, 0.0), vec3(2.2));
}

vec3 shown(vec3 c) {
    c = clamp(c, 0.0, 1e9);
    if (tone == 0) c = neutral(c);
    if (tone == 2) c = c / (1.0 + c);
    if (tone == 3) c = aces(c);
    if (tone == 4) c = agx(c);
    return clamp(c, 0.0, 1.0);
}

vec3 encoded(vec3 c) {
    return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308))));
}

void main() {
    vec4 sum = texelFetch(light, ivec2(gl_FragCoord.xy), 0);
    float alpha = clamp(sum.a, 0.0, 1.0);
    vec3 straight = alpha > 0.0 ? sum.rgb / alpha : vec3(0.0);
    if (numbers) {
        vec3 under = encoded(background.rgb);
        color = vec4(mix(under * background.a, clamp(straight, 0.0, 1.0), alpha), max(alpha, background.a));
        return;
    }
    vec3 c = shown(straight * exposure);
    float over = max(alpha, background.a);
    c = background.a > 0.0 ? clamp(c * alpha + background.rgb * (1.0 - alpha), 0.0, 1.0) : c;
    color = vec4(encoded(c) * over, over);
}
`;

type Draw = (sample: number, target: WebGLRenderTarget) => void;

export interface Development {
    /** Stops. */
    exposure: number;
    tone: number;
    /** True if pixels are numbers rather than light. */
    numbers: boolean;
    /** Linear RGB; transparent if null. */
    background: [number, number, number] | null;
}

/** Two render targets: one sample, and the sum of all samples. */
export class Film {
    private readonly sample = target(true);
    private readonly sum = target(false);
    private readonly share = pass(SHARE, { light: { value: null }, share: { value: 1 } });
    private readonly develop = pass(DEVELOP, {
        light: { value: null },
        exposure: { value: 1 },
        tone: { value: 0 },
        numbers: { value: false },
        background: { value: [0, 0, 0, 0] },
    });
    private readonly camera = new Camera();
    private readonly quad: Mesh;

    constructor(private readonly renderer: WebGLRenderer) {
        const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
        const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(corners, 3));
        this.quad = new Mesh(geometry, this.develop);
        this.quad.frustumCulled = false;
        this.share.blending = CustomBlending;
        this.share.blendSrc = this.share.blendDst = OneFactor;
    }

    /** Takes a picture with `samples` samples; `draw` draws one of them into the target. */
    take(size: [number, number], samples: number, development: Development, draw: Draw): void {
        for (const each of [this.sample, this.sum]) each.setSize(...size);
        this.clear(this.sum);
        for (let i = 0; i < samples; i++) {
            this.clear(this.sample);
            draw(i, this.sample);
            if (samples > 1) this.add(1 / samples);
        }
        this.show(samples > 1 ? this.sum.texture : this.sample.texture, development);
    }

    private clear(target: WebGLRenderTarget): void {
        this.renderer.setRenderTarget(target);
        this.renderer.clear();
    }

    private add(share: number): void {
        this.share.uniforms["share"]!.value = share;
        this.pass(this.share, this.sample.texture, this.sum);
    }

    private show(light: Texture, { exposure, tone, numbers, background }: Development): void {
        const { uniforms } = this.develop;
        uniforms["exposure"]!.value = 2 ** exposure;
        uniforms["tone"]!.value = tone;
        uniforms["numbers"]!.value = numbers;
        uniforms["background"]!.value = background ? [...background, 1] : [0, 0, 0, 0];
        this.pass(this.develop, light, null);
    }

    private pass(material: RawShaderMaterial, light: Texture, to: WebGLRenderTarget | null): void {
        material.uniforms["light"]!.value = light;
        this.quad.material = material;
        this.renderer.setRenderTarget(to);
        this.renderer.render(this.quad, this.camera);
    }
}

function target(depthBuffer: boolean): WebGLRenderTarget {
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false };
    return new WebGLRenderTarget(1, 1, { type: HalfFloatType, depthBuffer, ...filters });
}

function pass(fragmentShader: string, uniforms: RawShaderMaterial["uniforms"]): RawShaderMaterial {
    const flat = { depthTest: false, depthWrite: false, blending: NoBlending };
    return new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader, uniforms, ...flat });
}
