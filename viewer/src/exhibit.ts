// A model on the page, and sets of meshes that show it.

import {
    BufferAttribute,
    BufferGeometry,
    LineBasicMaterial,
    LineSegments,
    Mesh,
    type PerspectiveCamera,
    type RawShaderMaterial,
    Scene,
    type Texture,
    type Vector3,
    type WebGLRenderer,
    WireframeGeometry,
} from "three";
import { checker } from "./checker";
import type { Data, ModelData, Orbit } from "./data";
import { ErrorMaps } from "./error_map";
import { BEST } from "./fields";
import { type Frame, Materials, PRINTED } from "./materials";
import { isShaded } from "./modes";
import { type Model, readModel } from "./model";
import { Once } from "./once";
import { ShadowMap } from "./shadows";
import type { State } from "./state";
import { type Source, Textures } from "./textures";

const LINES = 0x6aa3ff;
/** The colours of projection rays that found the scan, and of those that did not. */
const RAYS = [0x3fd0a0, 0xff3b30] as const;

/** The resources shared by all models. */
export interface Shared extends Source {
    data: Data;
    frame: Frame;
    textures: Record<string, Texture>;
}

export class Exhibit {
    private readonly checker = checker();
    private readonly errors = new Once<number, RawShaderMaterial>();

    private constructor(
        private readonly shared: Shared,
        private readonly data: ModelData,
        readonly model: Model,
        private readonly materials: Materials,
    ) {}

    /** Loads the model with this index. */
    static async load(number: number, shared: Shared): Promise<Exhibit> {
        const data = shared.data.models[number]!;
        const model = await readModel(await shared.blobs(data.glb), data.surfaces);
        const textures = new Textures(data, model, shared);
        const materials = new Materials(shared.data, data, textures, shared.textures, shared.frame);
        return new Exhibit(shared, data, model, materials);
    }

    get lens(): Orbit {
        return this.shared.data.camera!;
    }

    get surfaces(): number {
        return this.data.surfaces.length;
    }

    /** True for the asset, false for the scan. */
    get isAsset(): boolean {
        return this.data === this.shared.data.models[0];
    }

    /** The index of the method by which a surface is drawn. */
    method(number: number, { surface, mode }: State): number {
        const { best, drawn } = this.data.surfaces[number]!;
        const asked = surface === BEST ? best : this.shared.data.methods.indexOf(surface);
        return mode === "uv" ? 1 : drawn[asked]!;
    }

    async material(number: number, state: State): Promise<RawShaderMaterial> {
        const { mode } = state;
        if (mode === "uv") return this.checker;
        if (mode === "error" && this.isAsset) return this.errorMaterial(number);
        const drawn = mode === "error" ? "clay" : mode;
        const shading = this.shared.data.shadings.indexOf(isShaded(mode) ? state.shading : "ggx");
        return this.materials.get(number, shading, this.method(number, state), drawn);
    }

    /** The normal errors of the model. */
    errorMaps(): Promise<ErrorMaps> {
        return ErrorMaps.load(this.shared.data.errors!, this.shared.kept);
    }

    /** The projection rays of the model: those that found the scan, and those that did not. */
    async rays(): Promise<LineSegments[]> {
        const { data, kept } = this.shared;
        if (data.rays === null || !this.isAsset) return [];
        const ends = new Float32Array(await kept("rays"));
        const parts = [ends.subarray(0, data.rays * 6), ends.subarray(data.rays * 6)];
        return parts.map((part, kind) => {
            const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(part, 3));
            // Rays that missed are seen through the model.
            const lines = new LineSegments(geometry, new LineBasicMaterial({ color: RAYS[kind]!, depthTest: kind === 0 }));
            lines.frustumCulled = false;
            return lines;
        });
    }

    private errorMaterial(number: number): Promise<RawShaderMaterial> {
        return this.errors.get(number, async () => (await this.errorMaps()).material(number));
    }
}

/** Meshes that show a model in one state. */
export class Showing {
    private readonly scene = new Scene();
    readonly meshes: Mesh[];
    private readonly wires: LineSegments[] = [];
    private readonly rays: LineSegments[] = [];
    private shadow: ShadowMap | undefined;

    constructor(readonly exhibit: Exhibit) {
        this.meshes = exhibit.model.geometries.map((geometry) => new Mesh(geometry));
        for (const mesh of this.meshes) mesh.frustumCulled = false;
        this.scene.add(...this.meshes);
    }

    /** Resolves when the materials for a state are ready. */
    async prepare(state: State): Promise<void> {
        const { exhibit } = this;
        const all = await Promise.all(this.meshes.map((_, number) => exhibit.material(number, state)));
        all.forEach((material, number) => {
            const mesh = this.meshes[number]!;
            const isPrinted = exhibit.method(number, state) === PRINTED;
            mesh.material = material;
            mesh.geometry = (isPrinted ? exhibit.model.printed : exhibit.model.geometries)[number]!;
            material.polygonOffset = state.wireframe;
        });
        this.showWires(state.wireframe);
        await this.showRays(state.rays);
    }

    draw(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
        renderer.render(this.scene, camera);
    }

    /** Draws the view of a light in this direction, for the shadows. */
    cast(renderer: WebGLRenderer, to: Vector3): ShadowMap {
        const { scene } = this;
        this.shadow ??= new ShadowMap(this.exhibit.lens);
        scene.overrideMaterial = this.shadow.material;
        const areShown = this.wires.some(({ visible }) => visible);
        // Lines cast no shadows.
        this.showWires(false);
        const rays = this.rays.filter(({ visible }) => visible);
        for (const lines of rays) lines.visible = false;
        this.shadow.cast(renderer, to, (camera) => renderer.render(scene, camera));
        this.showWires(areShown);
        for (const lines of rays) lines.visible = true;
        scene.overrideMaterial = null;
        return this.shadow;
    }

    /** Makes `cast` draw the shadow map again. */
    forgetShadow(): void {
        this.shadow = undefined;
    }

    private async showRays(shown: boolean): Promise<void> {
        if (shown && this.rays.length === 0) {
            const loaded = await this.exhibit.rays();
            // Another state may have been prepared in the meantime.
            if (this.rays.length === 0 && loaded.length > 0) {
                this.rays.push(...loaded);
                this.scene.add(...loaded);
            }
        }
        for (const lines of this.rays) lines.visible = shown;
    }

    private showWires(shown: boolean): void {
        if (shown && this.wires.length === 0) {
            const material = new LineBasicMaterial({ color: LINES });
            const lines = this.exhibit.model.geometries.filter((geometry) => geometry.index);
            this.wires.push(...lines.map((each) => new LineSegments(new WireframeGeometry(each), material)));
            this.scene.add(...this.wires);
        }
        for (const wire of this.wires) wire.visible = shown;
    }
}
