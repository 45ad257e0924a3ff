// The report of a bake, as the program wrote it: its data, and the asset for the viewer.

import { byId } from "./dom.js";
import { unpacked } from "../../npm/taotie-wasm/src/program.js";
import { decoded } from "./parts.js";
import { count, sentence, size } from "./words.js";

/** The parts of a bake's JSON that the page shows next to the report's own words. */
export interface BakeReport {
    high_triangles: number;
    triangles: number[];
    size: [number, number];
    proof: { bytes_in: number; bytes_out: number };
}

/** The bytes of a viewer's files by name. */
export type ViewerFiles = Record<string, BlobPart>;

/** A report page, read but not run. */
export class Report {
    private readonly document: Document;
    readonly page: ReportPage;

    constructor(html: Uint8Array<ArrayBuffer>) {
        // The page's policy forbids the style, and the browser would report it.
        const text = new TextDecoder().decode(html).replace(/<style>.*?<\/style>/s, "");
        this.document = new DOMParser().parseFromString(text, "text/html");
        this.page = JSON.parse(this.text("data")) as ReportPage;
    }

    private text(name: string): string {
        return this.document.getElementById(name)?.textContent ?? "";
    }

    /** Returns the files that the viewer needs to show the asset; undefined if the report has no view of it. */
    async viewerFiles(): Promise<ViewerFiles | undefined> {
        const all = [...this.document.querySelectorAll<HTMLElement>('script[type="application/gzip"][id^="taotie-"]')];
        const files: ViewerFiles = {};
        for (const { id, textContent } of all) files[`${id.slice("taotie-".length)}.bin`] = decoded(textContent ?? "");
        const { "asset.bin": asset, ...others } = files;
        return asset === undefined ? undefined : { ...others, "asset.glb": await unpacked(asset) };
    }
}

function fact(name: string, value: string, was?: string): HTMLElement {
    const earlier = was === undefined ? [] : [" ", el("small", {}, was)];
    return el("div", {}, el("dt", {}, name), el("dd", {}, value, ...earlier));
}

const textOf = (cell: Cell | undefined): string => (cell && "text" in cell ? cell.text : cell && "mark" in cell ? cell.mark.text : "");

/** Returns the first figure of the certificate as the report words it: its name and value. */
export function mainFigure({ statement }: ReportPage): [string, string] | undefined {
    const row = statement?.tables[0]?.rows[0];
    return row && [textOf(row[0]), textOf(row.find((cell) => /\d/.test(textOf(cell))))];
}

function showFacts(report: BakeReport, page: ReportPage): void {
    const main = mainFigure(page);
    const { bytes_in: before, bytes_out: after } = report.proof;
    byId("facts").replaceChildren(
        ...(main ? [fact(sentence(main[0]), main[1])] : []),
        fact("Triangles", count(report.triangles[0] ?? 0), `from ${count(report.high_triangles)}`),
        fact("File", size(after), `from ${size(before)}`),
        ...(report.size[0] > 0 ? [fact("Map, texels", report.size.map(count).join(" × "))] : []),
    );
}

/** Shows verdict, figures, warnings and the worst places, in the report's words. */
export function showProof(report: BakeReport, { page }: Report): void {
    const { statement, features, sections } = page;
    const title = byId("result-title");
    title.textContent = statement?.verdict.text ?? "";
    title.className = statement?.verdict.tone ?? "";
    showFacts(report, page);
    const warnings = sections.filter((section) => "notices" in section);
    const others = sections.filter((section) => !("notices" in section));
    byId("proof").replaceChildren(
        ...warnings.map(sectionOf),
        ...features.map(featureOf),
        ...(statement ? [statementOf(statement)] : []),
        el("details", {}, el("summary", {}, "All figures"), ...others.map(sectionOf)),
    );
}
