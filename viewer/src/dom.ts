// Elements of the page.

type Child = Node | string;

/** Creates an element with attributes and children. */
export function make<K extends keyof HTMLElementTagNameMap>(
    tag: K,
    attributes: Record<string, string> = {},
    ...children: Child[]
): HTMLElementTagNameMap[K] {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
}

/** Offers a file for download. */
export function save(name: string, content: Blob): void {
    const link = make("a", { href: URL.createObjectURL(content), download: name });
    link.click();
    // By then the browser has started reading it.
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
