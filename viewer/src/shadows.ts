// Shadows of the raking light, from a shadow map that shaders read.

import {
    DepthTexture,
    DoubleSide,
    GLSL3,
    LessEqualCompare,
    LinearFilter,
    Matrix4,
    OrthographicCamera,
    RawShaderMaterial,
    type Texture,
    Vector3,
    type WebGLRenderer,
    WebGLRenderTarget,
} from "three";
import type { Orbit } from "./data";

/** Texels along a side. */
const SIDE = 2048;
/** The distance by which a point is lifted off its surface before the lookup, texels. */
const LIFT = 1.5;

const VERTEX = `precision highp float;
uniform mat4 projectionMatrix;
uniform mat4 modelViewMatrix;
in vec3 position;
void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const FRAGMENT = `precision highp float;
layout(location = 0) out vec4 color;
void main() {
    color = vec4(1.0);
}
`;

/** The end of vertex shaders, whose `main` is renamed `vertex_main`: the plane perpendicular to a corner's normal. */
export const PLANES = `
in vec3 world_normal;
uniform highp vec3 shadow_center;
out vec4 shadow_plane;
#undef main
void main() {
    vertex_main();
    shadow_plane = vec4(world_normal, dot(world_normal, position - shadow_center));
}
`;

/**
 * The function `visibility` of shaders: the mean of nine lookups, each between four texels. A point is lifted to the
 * mean of the planes of its triangle's corners if these lie above it, so that a coarse mesh does not shadow itself in
 * facets (Hanika 2021, "Hacking the Shadow Terminator"); for back faces, in the opposite direction.
 */
export const VISIBILITY = `
in vec4 shadow_plane;
uniform highp vec3 shadow_center;
uniform highp sampler2DShadow shadow_map;
uniform mat4 shadow_from_world;
uniform float shadow_lift;
uniform bool shadow_on;
float visibility(int light, vec3 position, vec3 n) {
    if (!shadow_on || light > 0) return 1.0;
    float height = shadow_plane.w - dot(shadow_plane.xyz, position - shadow_center);
    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 lifted = position + n * shadow_lift + shadow_plane.xyz * side * max(height * side, 0.0);
    vec3 at = (shadow_from_world * vec4(lifted, 1.0)).xyz;
    float sum = 0.0;
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            sum += texture(shadow_map, vec3(at.xy + vec2(x, y) / ${SIDE}.0, at.z));
        }
    }
    return sum / 9.0;
}
`;

/** The uniforms for shadows, shared by all shaders. */
export class ShadowUniforms {
    readonly all = {
        shadow_map: { value: null as Texture | null },
        shadow_from_world: { value: new Matrix4() },
        shadow_lift: { value: 0 },
        shadow_center: { value: new Vector3() },
        shadow_on: { value: false },
    };

    /** Makes shaders read this map, or none. */
    ask(map: ShadowMap | undefined): void {
        const { all } = this;
        all.shadow_on.value = map !== undefined;
        if (!map) return;
        all.shadow_map.value = map.texture;
        all.shadow_from_world.value = map.fromWorld;
        all.shadow_lift.value = map.lift;
        all.shadow_center.value = map.center;
    }
}

/** The depths of a model as seen from a light. */
export class ShadowMap {
    private readonly target: WebGLRenderTarget;
    private readonly camera = new OrthographicCamera();
    readonly material = new RawShaderMaterial({
        glslVersion: GLSL3,
        vertexShader: VERTEX,
        fragmentShader: FRAGMENT,
        side: DoubleSide,
        polygonOffset: true,
        polygonOffsetFactor: 2,
        polygonOffsetUnits: 4,
    });
    readonly fromWorld = new Matrix4();
    readonly lift: number;
    readonly center: Vector3;
    private readonly shone = new Vector3();

    constructor(private readonly lens: Orbit) {
        this.center = new Vector3(...lens.center);
        const depthTexture = new DepthTexture(SIDE, SIDE);
        depthTexture.compareFunction = LessEqualCompare;
        depthTexture.minFilter = depthTexture.magFilter = LinearFilter;
        this.target = new WebGLRenderTarget(SIDE, SIDE, { depthTexture });
        this.lift = (LIFT * 2 * lens.radius) / SIDE;
    }

    get texture(): Texture {
        return this.target.depthTexture!;
    }

    /** Draws the map for a light in this direction unless current; `draw` draws the model with the map's material. */
    cast(renderer: WebGLRenderer, to: Vector3, draw: (camera: OrthographicCamera) => void): void {
        if (this.shone.equals(to)) return;
        this.shone.copy(to);
        this.place(to);
        renderer.setRenderTarget(this.target);
        renderer.clear();
        draw(this.camera);
    }

    private place(to: Vector3): void {
        const { camera, center, lens } = this;
        const radius = 1.01 * lens.radius;
        camera.position.copy(center).addScaledVector(to, 2 * radius);
        camera.up.set(0, Math.abs(to.y) < 0.9 ? 1 : 0, Math.abs(to.y) < 0.9 ? 0 : 1);
        camera.lookAt(center);
        Object.assign(camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: radius, far: 3 * radius });
        camera.updateProjectionMatrix();
        camera.updateMatrixWorld(true);
        this.fromWorld.makeTranslation(0.5, 0.5, 0.5).multiply(new Matrix4().makeScale(0.5, 0.5, 0.5));
        this.fromWorld.multiply(camera.projectionMatrix).multiply(camera.matrixWorldInverse);
    }
}
