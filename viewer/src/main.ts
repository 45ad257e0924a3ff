// The element <taotie-viewer>: shows a folder with `src`, files in memory with `files`, or else data in the page.

import type { TaotieViewer } from "../taotie-viewer";
import { SHOWN, type Shown, isShown, said, unknown } from "./attributes";
import { make } from "./dom";
import { shownValue } from "./fields";
import { type Address, type Source, ofFiles, ofFolder, ofPage, pageAddress } from "./host";
import { type Host, mount } from "./mount";
import { refuse, report } from "./report";
import type { State } from "./state";
import { texts } from "./texts";
import type { Viewer } from "./viewer";
import style from "./viewer.css";

declare global {
    interface Window {
        /** The main viewer of a page, for scripts and tests. */
        taotie?: Viewer;
    }
}

const NAME = "taotie-viewer";

/** The style; undefined in browsers that cannot share it, which show an explanation only. */
function sheet(): CSSStyleSheet | undefined {
    try {
        const made = new CSSStyleSheet();
        made.replaceSync(style);
        return made;
    } catch {
        return undefined;
    }
}

const shared = sheet();

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
        if (shared) this.shadow.adoptedStyleSheets = [shared];
        const heard = (all: MutationRecord[]) => this.refuseUnknown(all.map(({ attributeName }) => attributeName!));
        new MutationObserver(heard).observe(this, { attributes: true });
    }

    connectedCallback(): void {
        // Elements already in the page receive their attributes first.
        if (!this.isOpen) void this.load();
        this.refuseUnknown(this.getAttributeNames());
    }

    disconnectedCallback(): void {
        // The data in a page can be read only once.
        if (!this.isOfPage) this.close();
    }

    attributeChangedCallback(name: string, before: string | null, value: string | null): void {
        if (before === value || !this.isConnected) return;
        if (name === "src") void this.load();
        else if (this.viewer && value !== null && isShown(name)) this.apply(this.viewer, [name]);
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
        const host = this.host(() => load === this.loads);
        const viewer = host && (await mount(host));
        if (load !== this.loads) return viewer?.close();
        if (!viewer) return;
        this.viewer = viewer;
        this.apply(viewer, SHOWN);
        viewer.listen(() => this.dispatchEvent(new Event("change")));
        if (this.isMain) window.taotie = viewer;
        this.dispatchEvent(new Event("load"));
    }

    /** The host of a viewer; undefined, with an error, if the source is not an address. */
    private host(isCurrent: () => boolean): Host | undefined {
        const { isMain } = this;
        // A new root, so that a superseded load cannot add to it.
        const root = make("div", { id: "viewer" });
        this.shadow.replaceChildren(root);
        const address = isMain ? this.address : undefined;
        const source = this.source();
        return source && { element: this, root, source, address, isFolded: !isMain, isCurrent };
    }

    private source(): Source | undefined {
        const { src, held } = this;
        if (held) return ofFiles(held);
        if (!src) return ofPage();
        try {
            return ofFolder(src);
        } catch (error) {
            this.dataset["state"] = "failed";
            report(this, texts.invalidSource(shownValue(src)), error);
            return undefined;
        }
    }

    /** True if the page itself contains the data. */
    private get isOfPage(): boolean {
        return !this.src && !this.held;
    }

    /** True for the main viewer of a page, whose link is kept in the address. */
    private get isMain(): boolean {
        return this.isOfPage || this.hasAttribute("linked");
    }

    /** Applies the attributes with these names; invalid ones are reported and have no effect. */
    private apply(viewer: Viewer, names: readonly Shown[]): void {
        const parts = names.map((name) => {
            const value = this.getAttribute(name);
            const part = value === null ? {} : said(name, value, viewer);
            if (typeof part !== "string") return part;
            refuse(this, part);
            return {};
        });
        const all = Object.assign({}, ...parts) as Partial<State>;
        if (Object.keys(all).length > 0) viewer.move(all);
    }

    private refuseUnknown(names: string[]): void {
        for (const wrong of names.map(unknown)) if (wrong !== undefined) refuse(this, wrong);
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
        const isSound = value === undefined || (typeof value === "object" && value !== null && !Array.isArray(value));
        if (!isSound) refuse(this, texts.invalidFiles(shownValue(value)));
        else this.held = value;
        if (isSound && this.isConnected) void this.load();
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
        if (this.viewer) this.viewer.change(part);
        else refuse(this, texts.notLoaded);
    }

    async picture(size?: [number, number]): Promise<Blob> {
        if (!this.viewer) throw new Error(texts.notLoaded);
        return this.viewer.picture(size);
    }
}

if (!customElements.get(NAME)) customElements.define(NAME, ViewerElement);

export { ViewerElement as TaotieViewer };
