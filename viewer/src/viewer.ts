// The viewer: one state, and its picture.

import { Vector2, type Vector3 } from "three";
import type { Data } from "./data";
import type { Exhibit } from "./exhibit";
import { fault, shownValue } from "./fields";
import type { Address } from "./host";
import { withText } from "./png";
import { messageOf, refuse, report } from "./report";
import { Stage } from "./stage";
import { type State, clamped, firstState, fragment, ofFragment } from "./state";
import { texts } from "./texts";

/** Milliseconds without a change after which the picture is drawn with all samples. */
const STILL = 150;
/** The frame times above which pixels are halved, and below which they are doubled, milliseconds. */
const [SLOW, QUICK] = [80, 25];
/** The maximum number of times that the pixels of a moving picture are halved. */
const COARSEST = 4;
/** The maximum side of the picture on the screen, pixels. */
const LONGEST = 4096;
/** The maximum number of pixels of a saved picture: a sample and the sum take 16 bytes per pixel. */
const MOST_PIXELS = 2 ** 26;
/** The keyword of the text chunk in a saved picture that contains its link. */
const LINK = "taotie:view";

/** A picked point of a model in world space, and the uncertainty of picking it. */
export interface Pick {
    point: Vector3;
    precision: number;
    exhibit: Exhibit;
}

export class Viewer {
    readonly first: State;
    private current: State;
    private isClosed = false;
    /** True while the browser has taken the graphics resources away. */
    private isLost = false;
    /** True if something has changed since the last frame began, and if a frame is being drawn. */
    private isAsked = false;
    private isDrawing = false;
    /** The number of times that the pixels are halved while the picture moves. */
    private halvings = 0;
    private timer = 0;
    private readonly listeners: ((state: State) => void)[] = [];

    constructor(
        private readonly stage: Stage,
        private readonly host: { element: HTMLElement; address: Address | undefined },
        readonly canvas: HTMLCanvasElement,
    ) {
        this.first = firstState(this.data);
        const { address } = host;
        this.current = this.linked(address?.read() ?? "");
        new ResizeObserver(() => this.request()).observe(canvas);
        address?.listen(() => this.move(this.linked(address.read())));
    }

    get data(): Data {
        return this.stage.data;
    }

    get state(): State {
        return this.current;
    }

    /** Calls back with the current state and with every new state. */
    listen(listener: (state: State) => void): void {
        this.listeners.push(listener);
        listener(this.current);
    }

    /** Changes parts of the state. Unless all values are valid, it changes nothing and the element reports an error. */
    change(part: Partial<State>): void {
        const wrong = fault(part, this.data);
        if (wrong === undefined) this.move(part);
        else refuse(this.host.element, wrong);
    }

    /** Changes parts of the state by values of the right form; numbers are clamped to their ranges. */
    move(part: Partial<State>): void {
        this.current = clamped({ ...this.current, ...part });
        for (const listener of this.listeners) listener(this.current);
        this.request();
    }

    /** Changes the whole state, under the conditions of `change`. */
    show(state: State): void {
        this.change(state);
    }

    /** The state described by the fragment of a link. */
    linked(fragment: string): State {
        return ofFragment(fragment, this.first, this.data);
    }

    /** The fragment of a link to the current state. */
    link(): string {
        return fragment(this.current, this.first);
    }

    /** Returns the picture in this size and with all samples, as a PNG that contains its link. */
    async picture(size: [number, number] = this.size()): Promise<Blob> {
        const { canvas, stage, current } = this;
        this.assertDrawable();
        const wrong = this.pictureFault(size);
        if (wrong !== undefined) throw new RangeError(wrong);
        await stage.prepare(current);
        this.assertDrawable();
        const [width, height] = size;
        stage.renderer.setSize(width, height, false);
        const isSized = stage.isSized(size);
        if (isSized) stage.draw(current, size, stage.samples);
        const png = isSized && stage.hasDrawn() && new Promise<Blob | null>((resolve) => canvas.toBlob(resolve));
        this.request();
        const blob = await png;
        if (!blob) throw new RangeError(texts.tooLarge(width, height));
        return withText(blob, LINK, fragment(current, this.first));
    }

    private assertDrawable(): void {
        if (this.isLost || this.isClosed) throw new Error(texts.noPicture);
    }

    /** What is wrong with the size of a picture. */
    private pictureFault(size: unknown): string | undefined {
        const most = this.stage.longestSide;
        const isSide = (side: unknown): boolean => Number.isInteger(side) && (side as number) > 0 && (side as number) <= most;
        if (!Array.isArray(size) || size.length !== 2 || !size.every(isSide)) return texts.pictureSize(shownValue(size), most);
        const [width, height] = size as [number, number];
        return width * height > MOST_PIXELS ? texts.tooLarge(width, height) : undefined;
    }

    /** The normal error under a point of the window, degrees. */
    errorUnder(x: number, y: number): Promise<number | undefined> {
        return this.stage.errorAt(this.current, this.pointOf(x, y), this.size());
    }

    /** The point of a model under a point of the window, accurate to half a pixel of the page. */
    pick(x: number, y: number): Pick | undefined {
        const hit = this.stage.hit(this.current, this.pointOf(x, y), this.size());
        if (!hit) return undefined;
        const precision = this.stage.pixelAt(hit, this.canvas.clientHeight) / 2;
        return { point: hit.point, precision, exhibit: hit.showing.exhibit };
    }

    /** The position of a world-space point in the picture, page pixels from its upper left corner. */
    placeOf(point: Vector3): [number, number] {
        const { x, y } = this.stage.seen(this.current, point, this.size());
        const { clientWidth, clientHeight } = this.canvas;
        return [((x + 1) / 2) * clientWidth, ((1 - y) / 2) * clientHeight];
    }

    /** Converts a point of the window to picture coordinates, [−1, 1]². */
    private pointOf(x: number, y: number): Vector2 {
        const { left, top, width, height } = this.canvas.getBoundingClientRect();
        return new Vector2((2 * (x - left)) / width - 1, 1 - (2 * (y - top)) / height);
    }

    /** Draws in the next frame. */
    request(): void {
        if (this.isClosed || this.isLost) return;
        this.host.element.dataset["state"] = "moving";
        clearTimeout(this.timer);
        this.isAsked = true;
        if (this.isDrawing) return;
        this.isDrawing = true;
        requestAnimationFrame(() => void this.step());
    }

    /** Draws nothing until `restore`. */
    lose(): void {
        this.isLost = true;
        clearTimeout(this.timer);
    }

    /** Draws the current state again after the browser has given new graphics resources. */
    restore(): void {
        this.isLost = false;
        this.stage.restore();
        this.request();
    }

    /** Releases the graphics resources; nothing is drawn afterwards. */
    close(): void {
        this.isClosed = true;
        clearTimeout(this.timer);
        this.stage.renderer.dispose();
    }

    private size(halvings = 0): [number, number] {
        const { clientWidth, clientHeight } = this.canvas;
        const scale = Math.min(devicePixelRatio, LONGEST / Math.max(clientWidth, clientHeight, 1)) / 2 ** (halvings / 2);
        return [Math.max(1, Math.round(clientWidth * scale)), Math.max(1, Math.round(clientHeight * scale))];
    }

    /** Draws one sample and waits for it, so that frames do not pile up; a still picture then gets all samples. */
    private async step(): Promise<void> {
        this.isAsked = false;
        const isWhole = await this.attempt(1, this.halvings);
        // Skipped frames say nothing about frame times.
        if (!this.isAsked) this.pace(await this.stage.drawn());
        this.isDrawing = false;
        if (this.isAsked) this.request();
        else if (!isWhole) this.timer = window.setTimeout(() => void this.attempt(this.stage.samples, 0), STILL);
    }

    /** Draws, and reports a failure: the scan and its textures are fetched when they are first shown. */
    private async attempt(samples: number, halvings: number): Promise<boolean> {
        try {
            return await this.draw(samples, halvings);
        } catch (error) {
            // Nothing can be prepared without graphics resources; the picture is drawn again when they are back.
            if (this.isLost || this.isClosed) return false;
            if (report(this.host.element, messageOf(error), error)) console.error(error);
            return true;
        }
    }

    /** Draws unless something changes first. Returns true if the picture has all samples and pixels and is final. */
    private async draw(samples: number, halvings: number): Promise<boolean> {
        const state = this.current;
        await this.stage.prepare(state);
        if (this.isAsked || this.isClosed || this.isLost) return false;
        const size = this.size(halvings);
        const { width, height } = this.canvas;
        if (width !== size[0] || height !== size[1]) this.stage.renderer.setSize(...size, false);
        this.stage.draw(state, size, samples);
        const isWhole = samples === this.stage.samples && halvings === 0;
        if (isWhole) this.rest();
        return isWhole;
    }

    /** Reduces the pixels of the next frame if this one took long. */
    private pace(milliseconds: number): void {
        if (milliseconds > SLOW && this.halvings < COARSEST) this.halvings += 1;
        if (milliseconds < QUICK && this.halvings > 0) this.halvings -= 1;
    }

    /** Writes the link to the address once the picture is still. */
    private rest(): void {
        this.host.address?.write(this.link());
        this.host.element.dataset["state"] = "still";
    }
}
