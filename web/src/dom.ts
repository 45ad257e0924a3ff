// Elements of the page.

/** Returns the element with this name, which the page contains. */
export const byId = <E extends HTMLElement = HTMLElement>(name: string): E => document.getElementById(name) as E;

const addresses: string[] = [];

/** Returns a link that saves bytes as a file. */
export function download(name: string, bytes: Uint8Array<ArrayBuffer>, label: string, detail: string): HTMLElement {
    const href = URL.createObjectURL(new Blob([bytes]));
    addresses.push(href);
    return el("a", { class: "button", href, download: name }, label, " ", el("span", {}, detail));
}

/** Frees the bytes of earlier links. */
export function freeDownloads(): void {
    for (const address of addresses.splice(0)) URL.revokeObjectURL(address);
}
