// Values that the browser keeps between visits. It may refuse to, in private windows and frames: then they last as
// long as the page.

/** Pages without an address, such as the cells of notebooks, share one storage: nothing is kept for them. */
const hasAddress = location.protocol !== "about:";

/** The value kept under a name; undefined if there is none. */
export function kept(name: string): unknown {
    try {
        return hasAddress ? (JSON.parse(localStorage.getItem(name) ?? "null") ?? undefined) : undefined;
    } catch {
        return undefined;
    }
}

/** Keeps a value under a name; undefined removes it. */
export function keep(name: string, value: unknown): void {
    if (!hasAddress) return;
    try {
        if (value === undefined) localStorage.removeItem(name);
        else localStorage.setItem(name, JSON.stringify(value));
    } catch {
        // The storage is denied or full.
    }
}
