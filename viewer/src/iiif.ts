// Writes the initial view and the bookmarks as an IIIF manifest of version 4, like
// crates/taotie-report/src/viewer/iiif.rs: a scene with its model, and for each view a camera, lights and a comment.

import { Vector3 } from "three";
import type { Bookmark, Orbit } from "./data";
import { ambient, lights } from "./light";
import { axes } from "./orbit";
import type { State } from "./state";
import type { Viewer } from "./viewer";

const CONTEXT = "http://iiif.io/api/presentation/4/context.json";

type Resource = { id: string } & Record<string, unknown>;

/** A number with six digits. */
const digits = (value: number): number => Number(value.toPrecision(6)) + 0;
const label = (text: string) => ({ none: [text] });
const point = (at: Vector3) => ({ type: "PointSelector", x: digits(at.x), y: digits(at.y), z: digits(at.z) });
const relative = (value: number) => ({ type: "Quantity", quantityValue: digits(value), unit: "relative" });

/** The sRGB code of a channel. */
function code(linear: number): string {
    const encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
    return Math.round(255 * encoded).toString(16).padStart(2, "0").toUpperCase();
}

/** A light's colour, scaled so that its strongest channel is full, and its intensity relative to `full`. */
function colored(light: number[], full: number): [string, number] {
    const most = Math.max(...light);
    const codes = light.map((channel) => code(most > 0 ? channel / most : 1));
    return [`#${codes.join("")}`, Math.min(most / full, 1)];
}

/** The scene to which annotations are added. */
class Scene {
    private readonly center: Vector3;

    constructor(
        private readonly viewer: Viewer,
        private readonly base: string,
        private readonly lens: Orbit,
    ) {
        this.center = new Vector3(...lens.center);
    }

    get id(): string {
        return `${this.base}scene`;
    }

    get model(): Resource {
        return {
            id: `${this.id}/model`,
            type: "Annotation",
            motivation: ["painting"],
            body: [{ id: `${this.base}asset.glb`, type: "Model", format: "model/gltf-binary" }],
            target: [{ id: this.id, type: "Scene" }],
        };
    }

    /** The camera and the lights of a view. */
    painted(number: number, state: State): Resource[] {
        const { data } = this.viewer;
        const [, , back] = axes(state);
        const target = new Vector3(...state.target);
        const view = `${this.id}/views/${number}`;
        const camera = {
            id: `${view}/camera`,
            type: "PerspectiveCamera",
            fieldOfView: digits(this.lens.fov_y),
            lookAt: point(target),
        };
        const all = [this.annotation(number, camera, target.clone().addScaledVector(back, state.view[2]))];
        const parallel = lights(state, data.light).filter(([, , , kind]) => kind === 0);
        parallel.forEach((light, i) => all.push(this.light(`${view}/light/${i}`, number, light)));
        const [color, intensity] = colored(ambient(state, data.light), 1);
        const fill = { id: `${view}/fill`, type: "AmbientLight", color, intensity: relative(intensity) };
        if (intensity > 0) all.push(this.annotation(number, fill, this.center));
        return all;
    }

    /** A white matte surface facing a light of strength π reflects the maximum that a screen can show. */
    private light(id: string, number: number, light: number[]): Resource {
        const [color, intensity] = colored(light.slice(4, 7), Math.PI);
        const lookAt = point(this.center);
        const body = { id, type: "DirectionalLight", color, intensity: relative(intensity), lookAt };
        const to = new Vector3(light[0], light[1], light[2]);
        return this.annotation(number, body, this.center.clone().addScaledVector(to, 2 * this.lens.radius));
    }

    /** An annotation that adds to the scene; those of bookmarks are hidden until their comment is selected. */
    private annotation(number: number, body: Resource, place: Vector3): Resource {
        const id = `${body.id}/annotation`;
        return {
            id,
            type: "Annotation",
            motivation: ["painting"],
            body: [body],
            target: [this.target(`${id}/target`, place)],
            ...(number > 0 ? { behavior: ["hidden"] } : {}),
        };
    }

    /** The comment of a bookmark, and the annotation that shows its view when the comment is selected. */
    commented(number: number, { title, text }: Bookmark, state: State): Resource[] {
        const id = `${this.base}scene/comments/${number}`;
        const value = `${title}\n${text}`.trim();
        const shown = (source: Resource) => ({
            id: `${source.id}/shown`,
            type: "SpecificResource",
            source: [{ id: source.id, type: "Annotation" }],
            action: ["show", "enable", "select"],
        });
        const comment = {
            id,
            type: "Annotation",
            motivation: ["commenting"],
            body: [{ type: "TextualBody", value, format: "text/plain" }],
            target: [this.target(`${id}/target`, new Vector3(...state.target))],
        };
        const activating = {
            id: `${id}/view`,
            type: "Annotation",
            motivation: ["activating"],
            body: this.painted(number, state).map(shown),
            target: [{ id, type: "Annotation" }],
        };
        return [comment, activating];
    }

    private target(id: string, place: Vector3): Resource {
        const source = { id: this.id, type: "Scene" };
        return { id, type: "SpecificResource", source, selector: [point(place)] };
    }
}

/** The manifest of a page published at `address`, with these bookmarks. */
export function manifest(viewer: Viewer, bookmarks: Bookmark[], address: string): Resource {
    const { data } = viewer;
    const base = `${address.replace(/\/+$/, "")}/`;
    const scene = new Scene(viewer, base, data.camera!);
    const states = [viewer.first, ...bookmarks.map(({ link }) => viewer.linked(link))];
    const comments = bookmarks.flatMap((bookmark, i) => scene.commented(i + 1, bookmark, states[i + 1]!));
    const page = { id: `${base}scene/page`, type: "AnnotationPage" };
    const annotations = [{ id: `${base}scene/comments`, type: "AnnotationPage", items: comments }];
    const items = [scene.model, ...states.flatMap((state, number) => scene.painted(number, state))];
    const shown = { id: scene.id, type: "Scene", label: label(data.title), items: [{ ...page, items }] };
    const facts = data.facts.map(({ name, value }) => ({ label: label(name), value: label(value) }));
    return {
        "@context": CONTEXT,
        id: `${base}manifest.json`,
        type: "Manifest",
        label: label(data.title),
        items: [{ ...shown, ...(comments.length > 0 ? { annotations } : {}) }],
        ...(facts.length > 0 ? { metadata: facts } : {}),
    };
}
