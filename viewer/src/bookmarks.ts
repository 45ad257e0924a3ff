// Titled views: those of the page, and those that the user adds.

import { button, group } from "./controls";
import type { Bookmark } from "./data";
import { make, save } from "./dom";
import { manifest } from "./iiif";
import { kept, keep } from "./storage";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** The user's changes to a page's bookmarks. */
interface Changes {
    added: Bookmark[];
    /** Deleted bookmarks of the page. */
    deleted: Bookmark[];
}

const isBookmark = (value: unknown): value is Bookmark =>
    ["title", "text", "link"].every((name) => typeof (value as Record<string, unknown> | null)?.[name] === "string");

/** The changes kept by the browser under a name; empty if there are none, or if they are invalid. */
function changesOf(name: string): Changes {
    const value = kept(name) as Partial<Changes> | undefined;
    const list = (of: unknown): Bookmark[] => (Array.isArray(of) ? of.filter(isBookmark) : []);
    return { added: list(value?.added), deleted: list(value?.deleted) };
}

const isSame = (a: Bookmark, b: Bookmark): boolean => a.title === b.title && a.text === b.text && a.link === b.link;

/** The bookmarks of a model, with the user's changes, which the browser keeps under a name. */
class Bookmarks {
    private changes: Changes;

    constructor(
        private readonly own: Bookmark[],
        private readonly name: string,
    ) {
        this.changes = changesOf(name);
    }

    get all(): Bookmark[] {
        const { added, deleted } = this.changes;
        return [...this.own.filter((each) => !deleted.some((other) => isSame(each, other))), ...added];
    }

    /** True if bookmarks of the page are deleted. */
    get lacksOwn(): boolean {
        return this.changes.deleted.length > 0;
    }

    add(bookmark: Bookmark): void {
        this.keep({ ...this.changes, added: [...this.changes.added, bookmark] });
    }

    delete(bookmark: Bookmark): void {
        const { added, deleted } = this.changes;
        const isAdded = added.includes(bookmark);
        this.keep({
            added: added.filter((each) => each !== bookmark),
            deleted: isAdded ? deleted : [...deleted, bookmark],
        });
    }

    /** Restores the deleted bookmarks of the page. */
    restore(): void {
        this.keep({ ...this.changes, deleted: [] });
    }

    private keep(changes: Changes): void {
        this.changes = changes;
        const isNone = changes.added.length + changes.deleted.length === 0;
        keep(this.name, isNone ? undefined : changes);
    }
}

/** The part of the panel for bookmarks. The browser keeps changes under `key`. */
export function bookmarks(viewer: Viewer, key: string): HTMLElement {
    const { data } = viewer;
    const marks = new Bookmarks(data.bookmarks, `taotie-bookmarks:${key}`);
    const list = make("ul", { class: "bookmarks" });
    const title = make("input", { type: "text", "aria-label": texts.bookmarkTitle, placeholder: texts.bookmarkTitle });
    const text = make("textarea", { rows: "2", "aria-label": texts.bookmarkText, placeholder: texts.bookmarkText });
    const act = (change: () => void) => () => {
        change();
        show();
    };
    const restore = button(texts.restoreBookmarks, act(() => marks.restore()));
    const item = (bookmark: Bookmark): HTMLElement => {
        const go = button(bookmark.title, () => viewer.move(viewer.linked(bookmark.link)));
        const remove = button("×", act(() => marks.delete(bookmark)));
        remove.setAttribute("aria-label", texts.deleteBookmark(bookmark.title));
        return make("li", {}, go, remove, make("p", {}, bookmark.text));
    };
    const show = (): void => {
        list.replaceChildren(...marks.all.map(item));
        restore.hidden = !marks.lacksOwn;
    };
    const add = act(() => {
        const link = viewer.link();
        marks.add({ title: title.value.trim() || link || data.title, text: text.value.trim(), link });
        title.value = text.value = "";
    });
    const keepFile = (): void => {
        const json = `${JSON.stringify(marks.all, null, 2)}\n`;
        save(`${data.title}.bookmarks.json`, new Blob([json], { type: "application/json" }));
    };
    const address = make("input", { type: "url", "aria-label": texts.address, placeholder: texts.address });
    if (location.protocol.startsWith("http")) address.value = new URL(".", location.href).href;
    const keepManifest = (): void => {
        if (!/^https?:/.test(address.value)) return address.focus();
        const json = `${JSON.stringify(manifest(viewer, marks.all, address.value), null, 2)}\n`;
        save("manifest.json", new Blob([json], { type: "application/json" }));
    };
    show();
    const actions = make("p", { class: "actions" }, button(texts.addBookmark, add), button(texts.saveBookmarks, keepFile), restore);
    const iiif = make("p", { class: "actions" }, button(texts.saveManifest, keepManifest));
    return group(texts.bookmarks, marks.all.length > 0, list, title, text, actions, address, iiif);
}
