// Separates what the command writes to stderr: messages for people, and lines of progress.

/** The progress of a run. */
export interface Progress {
    /** The stage, in words: `simplify`. */
    stage: string;
    /** The fraction of the stage that is done, in [0, 1]. */
    done: number;
    /** Seconds left for the whole work; `null` while that is unknown. */
    left_s: number | null;
}

/** The option with which the command writes progress as lines of JSON. */
export const OPTION = "--progress";

/** Returns the progress that a line of stderr states; undefined if it is a message. */
export function progressOf(line: string): Progress | undefined {
    if (!line.startsWith('{"stage":')) return undefined;
    try {
        return JSON.parse(line) as Progress;
    } catch {
        return undefined;
    }
}

/** Returns the message of anything that was thrown. */
export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** Splits bytes into lines. */
export class Lines {
    private readonly decoder = new TextDecoder();
    private rest = "";

    constructor(private readonly heard: (line: string) => void) {}

    add(bytes: Uint8Array): void {
        const lines = (this.rest + this.decoder.decode(bytes, { stream: true })).split("\n");
        this.rest = lines.pop()!;
        for (const line of lines) this.heard(line);
    }

    /** Passes on what follows the last line end. */
    end(): void {
        if (this.rest) this.heard(this.rest);
        this.rest = "";
    }
}
