// The large parts of the page, which scripts after this one pass on as base64: in the page itself, or next to it.

/** The parts by name. */
type Name = "program" | "example";

type Arrived = (base64: string) => void;

const arrivals = new Map<string, Arrived>();
const failures: ((reason: Error) => void)[] = [];

function awaited(name: Name): Promise<string> {
    const found = new Promise<string>((done, failed) => {
        arrivals.set(name, done);
        failures.push(failed);
    });
    // It is reported when it is used.
    found.catch(() => {});
    return found;
}

const parts = { program: awaited("program"), example: awaited("example") };

Object.assign(globalThis, { taotiePart: (name: string, base64: string) => arrivals.get(name)?.(base64) });

// Scripts that cannot be loaded.
addEventListener(
    "error",
    ({ target }) => {
        if (!(target instanceof HTMLScriptElement)) return;
        for (const fail of failures) fail(new Error(`${target.src} could not be loaded; reload the page`));
    },
    true,
);

/** Returns the bytes of base64. */
export function decoded(base64: string): Uint8Array<ArrayBuffer> {
    const text = atob(base64);
    return Uint8Array.from({ length: text.length }, (_, i) => text.charCodeAt(i));
}

/** Returns the bytes of a part, compressed by gzip. */
export const part = async (name: Name): Promise<Uint8Array<ArrayBuffer>> => decoded(await parts[name]);
