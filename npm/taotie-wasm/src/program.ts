// The compiled program, which the package contains compressed.

/** The name of the program's file. */
export const PROGRAM = "taotie.wasm.gz";

/** Unpacks bytes compressed by gzip. */
export async function unpacked(bytes: BlobPart): Promise<ArrayBuffer> {
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** Compiles the program from its bytes, compressed or not: some servers unpack what they send. */
export async function compiled(bytes: ArrayBuffer): Promise<WebAssembly.Module> {
    const isPacked = new Uint8Array(bytes)[0] === 0x1f;
    return WebAssembly.compile(isPacked ? await unpacked(bytes) : bytes);
}

/** Returns a function that does the work once and remembers the result, unless it fails. */
export function once<T>(work: () => Promise<T>): () => Promise<T> {
    let held: Promise<T> | undefined;
    return () => {
        held ??= work().catch((error: unknown) => {
            held = undefined;
            throw error;
        });
        return held;
    };
}
