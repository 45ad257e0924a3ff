// The element <taotie-viewer>: shows a folder with `src`, files in memory with `files`, or else data in the page.

import type { TaotieViewer } from "../taotie-viewer";
import { SHOWN, said } from "./attributes";
import { make } from "./dom";
import { type Address, type Blobs, ofFiles, ofFolder, ofPage, pageAddress } from "./host";
import { type Host, mount } from "./mount";
import type { State } from "./state";
import type { Viewer } from "./viewer";
import style from "./viewer.css";

declare global {
    interface Window {
        /** The main viewer of a page, for scripts and tests. */
        taotie?: Viewer;
    }
}

const NAME = "taotie-viewer";
const sheet = new CSSStyleSheet();
sheet.replaceSync(style);

class ViewerElement extends HTMLElement implements TaotieViewer {
    static readonly observedAttributes = ["src", ...SHOWN];
    /** Keeps the link of a page's main viewer. */
    address: Address = pageAddress;
    private viewer: Viewer | undefined;
    private readonly shadow = this.attachShadow({ mode: "open" });
    private held: Record<string, BlobPart> | undefined;
    private isOpen = false;
    private loads = 0;

    constructor() {
        super();
        this.shadow.adoptedStyleSheets = [sheet];
    }

    connectedCallback(): void {
        // Elements already in the page receive their attributes first.
        if (!this.isOpen) void this.load();
    }

    disconnectedCallback(): void {
        // The data in a page can be read only once.
        if (!this.isOfPage) this.close();
    }

    attributeChangedCallback(name: string, before: string | null, value: string | null): void {
        if (before === value || !this.isConnected) return;
        if (name === "src") void this.load();
        else if (this.viewer && value !== null) this.viewer.change(this.given(this.viewer));
    }

    private close(): void {
        this.viewer?.close();
        this.viewer = undefined;
        this.isOpen = false;
        this.loads += 1;
    }

    private async load(): Promise<void> {
        this.close();
        this.isOpen = true;
        const load = this.loads;
        const viewer = await mount(this.host());
        if (load !== this.loads) return viewer?.close();
        if (!viewer) return void this.dispatchEvent(new Event("error"));
        this.viewer = viewer;
        const given = this.given(viewer);
        if (Object.keys(given).length > 0) viewer.change(given);
        viewer.listen(() => this.dispatchEvent(new Event("change")));
        if (this.isMain) window.taotie = viewer;
        this.dispatchEvent(new Event("load"));
    }

    private host(): Host {
        const { isMain } = this;
        // A new root, so that a superseded load cannot add to it.
        const root = make("div", { id: "viewer" });
        this.shadow.replaceChildren(root);
        const address = isMain ? this.address : undefined;
        return { element: this, root, blobs: this.blobs(), address, isFolded: !isMain };
    }

    private blobs(): Blobs {
        const { src, held } = this;
        if (held) return ofFiles(held);
        return src ? ofFolder(new URL(src.endsWith("/") ? src : `${src}/`, document.baseURI)) : ofPage;
    }

    /** True if the page itself contains the data. */
    private get isOfPage(): boolean {
        return !this.src && !this.held;
    }

    /** True for the main viewer of a page, whose link is kept in the address. */
    private get isMain(): boolean {
        return this.isOfPage || this.hasAttribute("linked");
    }

    /** The part of the state that the attributes set. */
    private given(viewer: Viewer): Partial<State> {
        const all = SHOWN.map((name) => {
            const value = this.getAttribute(name);
            return value === null ? {} : said(name, value, viewer);
        });
        return Object.assign({}, ...all) as Partial<State>;
    }

    get src(): string {
        return this.getAttribute("src") ?? "";
    }

    set src(value: string) {
        this.setAttribute("src", value);
    }

    get files(): Record<string, BlobPart> | undefined {
        return this.held;
    }

    set files(value: Record<string, BlobPart> | undefined) {
        this.held = value;
        if (this.isConnected) void this.load();
    }

    get light(): string {
        return this.getAttribute("light") ?? "given";
    }

    set light(value: string) {
        this.setAttribute("light", value);
    }

    get camera(): string {
        return this.getAttribute("camera") ?? "";
    }

    set camera(value: string) {
        this.setAttribute("camera", value);
    }

    get shading(): string {
        return this.getAttribute("shading") ?? "";
    }

    set shading(value: string) {
        this.setAttribute("shading", value);
    }

    get state(): State | undefined {
        return this.viewer?.state;
    }

    change(part: Partial<State>): void {
        this.viewer?.change(part);
    }

    async picture(size?: [number, number]): Promise<Blob> {
        if (!this.viewer) throw new Error(`<${NAME}> is not loaded yet: wait for its "load" event`);
        return this.viewer.picture(size);
    }
}

if (!customElements.get(NAME)) customElements.define(NAME, ViewerElement);

export { ViewerElement as TaotieViewer };
