// Draws a state: places camera and light, and develops the picture.

import {
    type Intersection,
    Matrix4,
    type Mesh,
    PerspectiveCamera,
    Raycaster,
    type Vector2,
    Vector3,
    WebGLRenderer,
    type WebGLRenderTarget,
} from "three";
import type { Data } from "./data";
import { Exhibit, type Shared, Showing } from "./exhibit";
import { TONES } from "./fields";
import { type Development, Film } from "./film";
import type { Blobs } from "./host";
import { ambient, environment, lights, toLight } from "./light";
import { Frame } from "./materials";
import { isNumbers, isShaded } from "./modes";
import { Once } from "./once";
import { place } from "./orbit";
import type { ShadowMap } from "./shadows";
import type { State } from "./state";
import { texts } from "./texts";
import { frameTextures } from "./textures";

/** Steps per pixel in sample positions. */
const STEPS = 256;
/** The smallest cosine between view direction and normal used for the length that a pixel covers. */
const STEEPEST = 0.1;

/** The extensions for filtering 32-bit floats and 16-bit codes. */
const [FINE, WIDE] = ["OES_texture_float_linear", "EXT_texture_norm16"];

/** A point of a model that is visible in the picture, and the meshes that show it. */
export interface Hit extends Intersection {
    showing: Showing;
}

export class Stage {
    private readonly camera = new PerspectiveCamera();
    private film: Film;
    private readonly main: Showing;
    /** The models shown right of the wipe handle, by name. */
    private readonly companions = new Once<string, Showing>();
    private companion: Showing | undefined;
    /** All models shown so far. */
    private readonly showings: Showing[];
    private readonly shadows = new Map<Showing, ShadowMap>();

    private constructor(
        readonly renderer: WebGLRenderer,
        private readonly shared: Shared,
        asset: Exhibit,
    ) {
        this.film = new Film(renderer);
        this.main = new Showing(asset);
        this.showings = [this.main];
    }

    /** Loads the model and creates the stage that draws it. */
    static async load(canvas: HTMLCanvasElement, data: Data, blobs: Blobs): Promise<Stage> {
        const renderer = opened(canvas);
        const [isFine, isWide] = [FINE, WIDE].map((name) => renderer.extensions.has(name)) as [boolean, boolean];
        const read = new Once<string, ArrayBuffer>();
        const kept: Blobs = (name) => read.get(name, () => blobs(name));
        const source = { blobs, kept, renderer, isFine, isWide };
        const shared = { ...source, data, frame: new Frame(data), textures: await frameTextures(data, blobs) };
        return new Stage(renderer, shared, await Exhibit.load(0, shared));
    }

    get data(): Data {
        return this.shared.data;
    }

    /** The number of samples of a still picture. */
    get samples(): number {
        return this.shared.data.film.samples.length;
    }

    /** Resolves when everything that a state needs is ready. */
    async prepare(state: State): Promise<void> {
        await this.main.prepare(state);
        const companion = await this.companionOf(state);
        await companion?.prepare(companionState(state));
        this.companion = companion;
    }

    /** The longest side of a picture that the graphics driver can draw, pixels. */
    get longestSide(): number {
        const gl = this.renderer.getContext();
        const sides = gl.getParameter(gl.MAX_VIEWPORT_DIMS) as Int32Array;
        const number = (name: GLenum) => gl.getParameter(name) as number;
        return Math.min(...sides, number(gl.MAX_TEXTURE_SIZE), number(gl.MAX_RENDERBUFFER_SIZE));
    }

    /** True if the picture has this size; browsers reduce those that are too large. */
    isSized([width, height]: [number, number]): boolean {
        const gl = this.renderer.getContext();
        return gl.drawingBufferWidth === width && gl.drawingBufferHeight === height;
    }

    /** Replaces render targets and shadow maps, whose content is lost with the context. */
    restore(): void {
        prepareRenderer(this.renderer);
        this.film = new Film(this.renderer);
        this.shadows.clear();
        for (const showing of this.showings) showing.forgetShadow();
    }

    /** False if the graphics driver has run out of memory, or has been reset. */
    hasDrawn(): boolean {
        const gl = this.renderer.getContext();
        return gl.getError() !== gl.OUT_OF_MEMORY && !gl.isContextLost();
    }

    /** Draws a prepared state with `samples` samples. */
    draw(state: State, size: [number, number], samples: number): void {
        const { frame, data } = this.shared;
        frame.setLights(lights(state, data.light));
        frame.set("ambient", ...ambient(state, data.light));
        const [sin, cos, factor] = environment(state);
        frame.set("environment_sin", sin);
        frame.set("environment_cos", cos);
        frame.set("environment_intensity", factor);
        frame.set("spacing", 1 / Math.sqrt(samples));
        const isShadowed = state.shadows && state.light === "raking" && isShaded(state.mode);
        for (const showing of [this.main, this.companion]) {
            if (showing && isShadowed) this.shadows.set(showing, showing.cast(this.renderer, toLight(state)));
            else if (showing) this.shadows.delete(showing);
        }
        this.film.take(size, samples, development(state, data), (sample, target) => {
            this.place(state, size, samples > 1 ? sample : -1);
            this.sample(state, size, target);
        });
    }

    /** Resolves when the graphics card has finished its work, with the elapsed milliseconds. */
    async drawn(): Promise<number> {
        const gl = this.renderer.getContext() as WebGL2RenderingContext;
        const start = performance.now();
        const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        const isDone = () => !fence || gl.isContextLost() || gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
        while (!isDone()) await new Promise((later) => setTimeout(later));
        gl.deleteSync(fence);
        return performance.now() - start;
    }

    /** The intersection with the model shown at a point of the picture, [−1, 1]². */
    hit(state: State, point: Vector2, size: [number, number]): Hit | undefined {
        this.place(state, size, -1);
        const ray = new Raycaster();
        ray.setFromCamera(point, this.camera);
        const isRight = ((point.x + 1) / 2) * size[0] >= this.handle(state, size[0]);
        const showing = (isRight && this.companion) || this.main;
        const [found] = ray.intersectObjects(showing.meshes, false);
        return found && { ...found, showing };
    }

    /** The length on the surface that a pixel covers at a hit, in a picture with `rows` rows. */
    pixelAt({ point, face }: Intersection, rows: number): number {
        const { matrixWorld, matrixWorldInverse, projectionMatrix } = this.camera;
        const depth = -point.clone().applyMatrix4(matrixWorldInverse).z;
        const sight = new Vector3().setFromMatrixPosition(matrixWorld).sub(point).normalize();
        const slope = face ? Math.abs(face.normal.dot(sight)) : 1;
        return (2 * depth) / (projectionMatrix.elements[5]! * rows * Math.max(slope, STEEPEST));
    }

    /** The position of a world-space point in the picture, [−1, 1]². */
    seen(state: State, point: Vector3, size: [number, number]): Vector3 {
        this.place(state, size, -1);
        return point.clone().project(this.camera);
    }

    /** The value of the error map at a point of the picture, [−1, 1]², degrees; undefined right of the wipe handle. */
    async errorAt(state: State, point: Vector2, size: [number, number]): Promise<number | undefined> {
        const hit = this.hit(state, point, size);
        const { face, barycoord } = hit ?? {};
        if (hit?.showing !== this.main || !face || !barycoord) return undefined;
        const { meshes } = hit.showing;
        const number = meshes.indexOf(hit.object as Mesh);
        const { attributes } = meshes[number]!.geometry;
        const weights = new Vector3(barycoord.x, barycoord.y, barycoord.z);
        const along = (of: (i: number) => number) => weights.dot(new Vector3(of(face.a), of(face.b), of(face.c)));
        const maps = await hit.showing.exhibit.errorMaps();
        return maps.at(number, (set) => {
            const uvs = attributes[`uv${set}`];
            return uvs && [along((i) => uvs.getX(i)), along((i) => uvs.getY(i))];
        });
    }

    private place(state: State, size: [number, number], sample: number): void {
        const { data, frame } = this.shared;
        const [x, y] = data.film.samples[sample] ?? [STEPS / 2, STEPS / 2];
        place(this.camera, state, data.camera!, { size, offset: [x / STEPS, y / STEPS] });
        const clip = new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
        frame.set("clip_from_world", ...clip.elements);
        frame.set("eye", ...this.camera.matrixWorld.elements.slice(12, 15), 1);
    }

    /** The column of the wipe handle in a picture of this width: the companion is drawn from there on. */
    private handle({ split }: State, width: number): number {
        return this.companion ? Math.round(split * width) : width;
    }

    private sample(state: State, [width, height]: [number, number], target: WebGLRenderTarget): void {
        const { renderer, camera, main, companion } = this;
        const handle = this.handle(state, width);
        const part = (from: number, to: number, showing: Showing): void => {
            target.scissorTest = companion !== undefined;
            target.scissor.set(from, 0, to - from, height);
            this.shared.frame.shadows.ask(this.shadows.get(showing));
            renderer.setRenderTarget(target);
            if (to > from) showing.draw(renderer, camera);
        };
        part(0, handle, main);
        if (companion) part(handle, width, companion);
        target.scissorTest = false;
    }

    private companionOf({ beside: shown }: State): Promise<Showing> | undefined {
        if (shown === "none") return undefined;
        return this.companions.get(shown, async () => {
            const showing = new Showing(shown === "scan" ? await Exhibit.load(1, this.shared) : this.main.exhibit);
            this.showings.push(showing);
            return showing;
        });
    }
}

/** The state of the model right of the wipe handle. */
function companionState(state: State): State {
    if (state.beside === "scan") return { ...state, surface: "best" };
    return { ...state, surface: "smooth", mode: state.mode === "error" ? "clay" : state.mode };
}

function development(state: State, { film }: Data): Development {
    const isLight = isShaded(state.mode);
    return {
        exposure: isLight ? state.exposure : 0,
        tone: TONES.indexOf(isLight ? (state.tone as (typeof TONES)[number]) : "linear"),
        numbers: isNumbers(state.mode),
        background: film.background,
    };
}

/** Creates the renderer for a canvas. */
function opened(canvas: HTMLCanvasElement): WebGLRenderer {
    const attributes = { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true };
    const context = canvas.getContext("webgl2", { ...attributes, premultipliedAlpha: true });
    if (!context) throw new Error(texts.noWebGl);
    if (!context.getExtension("EXT_color_buffer_float")) throw new Error(texts.noFloats);
    const renderer = new WebGLRenderer({ canvas, context, ...attributes });
    renderer.autoClear = false;
    prepareRenderer(renderer);
    return renderer;
}

/** Sets what a new context lacks. The extensions are used by our textures only. */
function prepareRenderer(renderer: WebGLRenderer): void {
    renderer.setClearColor(0, 0);
    for (const name of [FINE, WIDE]) renderer.extensions.has(name);
}
