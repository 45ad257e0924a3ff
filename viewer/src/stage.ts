// Draws a state: picks the materials, places camera and light, and has the film develop.

import {
    LineBasicMaterial,
    LineSegments,
    Mesh,
    PerspectiveCamera,
    type RawShaderMaterial,
    Scene,
    WebGLRenderer,
    WireframeGeometry,
    Matrix4,
} from "three";
import { blob } from "./blobs";
import { checker } from "./checker";
import type { Data } from "./data";
import { Film } from "./film";
import { ambient, environment, lights } from "./light";
import { Frame, Materials, PRINTED } from "./materials";
import { isNumbers, isShaded } from "./modes";
import { type Model, readModel } from "./model";
import { place } from "./orbit";
import { BEST, type State, TONES } from "./state";
import { Textures, frameTextures } from "./textures";
import { texts } from "./texts";

/** The places of samples in units of 1/256 pixel. */
const STEPS = 256;
const LINES = 0x6aa3ff;

export class Stage {
    private readonly scene = new Scene();
    private readonly camera = new PerspectiveCamera();
    private readonly meshes: Mesh[];
    private readonly wires: LineSegments[] = [];
    private readonly film: Film;
    private readonly checker = checker();

    private constructor(
        readonly renderer: WebGLRenderer,
        private readonly data: Data,
        private readonly model: Model,
        private readonly frame: Frame,
        private readonly materials: Materials,
    ) {
        this.film = new Film(renderer);
        this.meshes = model.geometries.map((geometry) => new Mesh(geometry, this.checker));
        for (const mesh of this.meshes) mesh.frustumCulled = false;
        this.scene.add(...this.meshes);
        this.scene.matrixWorldAutoUpdate = true;
    }

    /** Reads the model and makes what draws it. */
    static async load(canvas: HTMLCanvasElement, data: Data): Promise<Stage> {
        const renderer = opened(canvas);
        const [glb, shared] = await Promise.all([blob("asset"), frameTextures(data)]);
        const model = await readModel(glb, data.surfaces);
        const isFine = renderer.extensions.has("OES_texture_float_linear");
        const frame = new Frame(data);
        const materials = new Materials(data, new Textures(data, model, isFine), shared, frame);
        return new Stage(renderer, data, model, frame, materials);
    }

    /** The samples of a picture that stands still. */
    get samples(): number {
        return this.data.film.samples.length;
    }

    /** Draws nothing until the materials of a state are there. */
    async prepare(state: State): Promise<void> {
        const all = await Promise.all(this.data.surfaces.map((_, number) => this.material(number, state)));
        all.forEach((material, number) => {
            const mesh = this.meshes[number]!;
            const method = this.method(number, state);
            mesh.material = material;
            mesh.geometry = (method === PRINTED ? this.model.printed : this.model.geometries)[number]!;
            material.polygonOffset = state.wireframe;
        });
        this.showWires(state.wireframe);
    }

    /** Draws a state of which the materials are there, in so many samples. */
    draw(state: State, size: [number, number], samples: number): void {
        const { frame, data } = this;
        frame.setLights(lights(state, data.light));
        frame.set("ambient", ...ambient(state, data.light));
        const [sin, cos, factor] = environment(state);
        frame.set("environment_sin", sin);
        frame.set("environment_cos", cos);
        frame.set("environment_intensity", factor);
        frame.set("spacing", 1 / Math.sqrt(samples));
        const isLight = isShaded(state.mode);
        const development = {
            exposure: isLight ? state.exposure : 0,
            tone: isLight ? TONES.indexOf(state.tone as (typeof TONES)[number]) : TONES.indexOf("linear"),
            numbers: isNumbers(state.mode),
            background: data.film.background,
        };
        this.film.take(size, samples, development, (sample) => this.sample(state, size, samples > 1 ? sample : -1));
    }

    private sample(state: State, size: [number, number], sample: number): void {
        const [x, y] = this.data.film.samples[sample] ?? [STEPS / 2, STEPS / 2];
        place(this.camera, state, this.data.camera!, { size, offset: [x / STEPS, y / STEPS] });
        const clip = new Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
        this.frame.set("clip_from_world", ...clip.elements);
        this.frame.set("eye", ...this.camera.matrixWorld.elements.slice(12, 15), 1);
        this.renderer.render(this.scene, this.camera);
    }

    /** The number of the method by which a surface is drawn. */
    private method(number: number, { surface, mode }: State): number {
        const { best, drawn } = this.data.surfaces[number]!;
        const asked = surface === BEST ? best : this.data.methods.indexOf(surface);
        return mode === "uv" ? 1 : drawn[asked]!;
    }

    private material(number: number, state: State): RawShaderMaterial | Promise<RawShaderMaterial> {
        if (state.mode === "uv") return this.checker;
        const shading = this.data.shadings.indexOf(isShaded(state.mode) ? state.shading : "ggx");
        return this.materials.get(number, shading, this.method(number, state), state.mode);
    }

    private showWires(shown: boolean): void {
        if (shown && this.wires.length === 0) {
            const material = new LineBasicMaterial({ color: LINES });
            const lines = this.model.geometries.filter((geometry) => geometry.index);
            this.wires.push(...lines.map((each) => new LineSegments(new WireframeGeometry(each), material)));
            this.scene.add(...this.wires);
        }
        for (const wire of this.wires) wire.visible = shown;
    }
}

/** The renderer of a canvas. */
function opened(canvas: HTMLCanvasElement): WebGLRenderer {
    const attributes = { alpha: true, antialias: false, depth: false, preserveDrawingBuffer: true };
    const context = canvas.getContext("webgl2", { ...attributes, premultipliedAlpha: true });
    if (!context) throw new Error(texts.noWebGl);
    if (!context.getExtension("EXT_color_buffer_float")) throw new Error(texts.noFloats);
    const renderer = new WebGLRenderer({ canvas, context, ...attributes });
    renderer.setClearColor(0, 0);
    renderer.autoClear = false;
    return renderer;
}
