// Titled views: those of the page, and those that the user adds.

import { button, group } from "./controls";
import type { Bookmark } from "./data";
import { make, save } from "./dom";
import { manifest } from "./iiif";
import { texts } from "./texts";
import type { Viewer } from "./viewer";

/** The part of the panel for showing and adding bookmarks. */
export function bookmarks(viewer: Viewer): HTMLElement {
    const { data } = viewer;
    const all: Bookmark[] = [...data.bookmarks];
    const list = make("ul", { class: "bookmarks" });
    const title = make("input", { type: "text", "aria-label": texts.bookmarkTitle, placeholder: texts.bookmarkTitle });
    const text = make("textarea", { rows: "2", "aria-label": texts.bookmarkText, placeholder: texts.bookmarkText });
    const show = (bookmark: Bookmark): void => {
        const go = button(bookmark.title, () => viewer.show(viewer.linked(bookmark.link)));
        list.append(make("li", {}, go, make("p", {}, bookmark.text)));
    };
    const add = (): void => {
        const link = viewer.link();
        const bookmark = { title: title.value.trim() || link || data.title, text: text.value.trim(), link };
        all.push(bookmark);
        show(bookmark);
        title.value = text.value = "";
    };
    const keep = (): void => {
        const json = `${JSON.stringify(all, null, 2)}\n`;
        save(`${data.title}.bookmarks.json`, new Blob([json], { type: "application/json" }));
    };
    const address = make("input", { type: "url", "aria-label": texts.address, placeholder: texts.address });
    if (location.protocol.startsWith("http")) address.value = new URL(".", location.href).href;
    const keepManifest = (): void => {
        if (!/^https?:/.test(address.value)) return address.focus();
        const json = `${JSON.stringify(manifest(viewer, all, address.value), null, 2)}\n`;
        save("manifest.json", new Blob([json], { type: "application/json" }));
    };
    all.forEach(show);
    const actions = make("p", { class: "actions" }, button(texts.addBookmark, add), button(texts.saveBookmarks, keep));
    const iiif = make("p", { class: "actions" }, button(texts.saveManifest, keepManifest));
    return group(texts.bookmarks, all.length > 0, list, title, text, actions, address, iiif);
}
