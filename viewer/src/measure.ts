// Distances, angles and sections between points of the model.

import { Vector3 } from "three";
import { button, group } from "./controls";
import { make, save } from "./dom";
import { measuredText, uncertain } from "./lengths";
import { axes, degrees } from "./orbit";
import { type Piece, csv, profile, svg } from "./section";
import { texts } from "./texts";
import type { Pick, Viewer } from "./viewer";

const KINDS = ["distance", "angle", "section"] as const;
type Kind = (typeof KINDS)[number];
const POINTS: Record<Kind, number> = { distance: 2, angle: 3, section: 2 };
/** The maximum movement during a click, pixels. */
const CLICK = 4;
const SVG = "http://www.w3.org/2000/svg";

/** The measurement in progress, and its drawing over the picture. */
export class Measure {
    private kind: Kind | undefined;
    private points: Pick[] = [];
    private readonly overlay = document.createElementNS(SVG, "svg");
    private readonly result = make("output", { class: "result" });
    private readonly files = make("p", { class: "actions" });
    private readonly buttons: Map<Kind, HTMLButtonElement>;
    readonly panel: HTMLElement;

    constructor(private readonly viewer: Viewer) {
        this.overlay.setAttribute("class", "overlay");
        this.overlay.setAttribute("aria-hidden", "true");
        const made = KINDS.map((kind) => [kind, button(texts.measures[kind], () => this.choose(kind))] as const);
        this.buttons = new Map(made);
        const center = button(texts.pointInTheMiddle, () => void this.addMiddle());
        const row = make("p", { class: "actions" }, ...this.buttons.values(), center);
        this.panel = group(texts.measure, false, row, this.result, this.files);
        this.choose(undefined);
        this.listen();
        viewer.listen(() => this.draw());
    }

    /** The drawing over the picture. */
    get element(): SVGElement {
        return this.overlay;
    }

    /** Begins a measurement; choosing the same kind again ends it. */
    private choose(kind: Kind | undefined): void {
        this.kind = kind === this.kind ? undefined : kind;
        this.points = [];
        this.buttons.forEach((each, name) => each.setAttribute("aria-pressed", String(name === this.kind)));
        this.report();
    }

    private listen(): void {
        const { canvas } = this.viewer;
        let from = [0, 0];
        canvas.addEventListener("pointerdown", ({ clientX, clientY }) => void (from = [clientX, clientY]));
        canvas.addEventListener("pointerup", ({ clientX, clientY }) => {
            const isClick = Math.hypot(clientX - from[0]!, clientY - from[1]!) <= CLICK;
            if (this.kind && isClick) this.add(this.viewer.pick(clientX, clientY));
        });
    }

    /** Adds the point at the centre of the picture, for keyboard users. */
    private addMiddle(): void {
        const { left, top, width, height } = this.viewer.canvas.getBoundingClientRect();
        if (this.kind) this.add(this.viewer.pick(left + width / 2, top + height / 2));
    }

    private add(point: Pick | undefined): void {
        if (!point || !this.kind) return;
        if (this.points.length === POINTS[this.kind]) this.points = [];
        if (this.points.at(-1)?.point.equals(point.point)) {
            this.result.textContent = texts.samePoint;
            return;
        }
        this.points.push(point);
        this.report();
    }

    private report(): void {
        this.draw();
        this.files.replaceChildren();
        const [a, b, c] = this.points;
        const { kind } = this;
        if (!kind) this.result.textContent = texts.measureNothing;
        else if (!a || !b || (kind === "angle" && !c)) this.result.textContent = texts.measureMore(POINTS[kind] - this.points.length);
        else if (kind === "angle") this.result.textContent = this.angle(a, b, c!);
        else this.result.textContent = this.distance(a, b);
        if (kind === "section" && a && b) this.offer(a, b);
    }

    private distance(a: Pick, b: Pick): string {
        const { in_metres } = this.viewer.data;
        return measuredText(a.point.distanceTo(b.point), Math.hypot(this.doubt(a), this.doubt(b)), in_metres);
    }

    /** The angle at `b`: the uncertainty of each end turns one side, that of `b` turns both. */
    private angle(a: Pick, b: Pick, c: Pick): string {
        const sides = [a, c].map((end) => [this.doubt(end), end.point.distanceTo(b.point)] as const);
        const turns = sides.flatMap(([doubt, length]) => [doubt / length, this.doubt(b) / length]);
        return texts.angle(uncertain(angle(a.point, b.point, c.point), degrees(Math.hypot(...turns))));
    }

    /** The uncertainty of a point: that of picking it, and the distance between asset and scan if that is known. */
    private doubt({ precision, exhibit }: Pick): number {
        const distance = exhibit.isAsset ? this.viewer.data.errors?.distance : undefined;
        return Math.hypot(precision, distance?.rms ?? 0);
    }

    /** Offers the profile of the model of the first point. */
    private offer({ point: a, exhibit }: Pick, { point: b }: Pick): void {
        const [, , back] = axes(this.viewer.state);
        const pieces: Piece[] = profile(exhibit.model.geometries, [a, b], back);
        const file = (name: string, type: string, text: string) => () => save(name, new Blob([text], { type }));
        const { title, in_metres } = this.viewer.data;
        const unit = in_metres ? "m" : "model units";
        const drawing = svg(pieces, a.distanceTo(b), unit);
        this.files.append(
            button(texts.profile("CSV"), file(`${title}.profile.csv`, "text/csv", csv(pieces, unit))),
            button(texts.profile("SVG"), file(`${title}.profile.svg`, "image/svg+xml", drawing)),
        );
    }

    /** Draws the points and the lines between them at their current positions in the picture. */
    private draw(): void {
        const places = this.points.map(({ point }) => this.viewer.placeOf(point));
        const line = document.createElementNS(SVG, "polyline");
        line.setAttribute("points", places.map((place) => place.join()).join(" "));
        const dots = places.map(([x, y]) => {
            const dot = document.createElementNS(SVG, "circle");
            for (const [name, value] of Object.entries({ cx: x, cy: y, r: 5 })) dot.setAttribute(name, String(value));
            return dot;
        });
        this.overlay.replaceChildren(line, ...dots);
    }
}

/** The angle at `b`, degrees. */
function angle(a: Vector3, b: Vector3, c: Vector3): number {
    return degrees(new Vector3().subVectors(a, b).angleTo(new Vector3().subVectors(c, b)));
}
