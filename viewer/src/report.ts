// Errors that the element reports to its page.

/** The message of anything that was thrown. */
export const messageOf = (error: unknown): string => (error instanceof Error ? error.message : String(error));

/** Dispatches the event `error` with a message; returns true unless a listener prevents its default. */
export function report(element: HTMLElement, message: string, error: unknown = new RangeError(message)): boolean {
    return element.dispatchEvent(new ErrorEvent("error", { message, error, cancelable: true }));
}

/** Reports a value that is not accepted; also in the console, unless a listener prevents the event's default. */
export function refuse(element: HTMLElement, message: string): void {
    if (report(element, message)) console.error(`<${element.localName}>: ${message}`);
}
