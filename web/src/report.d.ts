// What the scripts of report pages offer, crates/taotie-report/src/page, which this page contains too.

interface Notice {
    text: string;
    tone: "good" | "bad" | "changed";
}

type Cell = { text: string } | { code: string } | { number: { value: number | null; digits: number } } | { mark: Notice & { why: string } };

interface Statement {
    verdict: Notice;
    facts: { name: string; value: string }[];
    tables: { title: string; rows: Cell[][] }[];
}

interface ReportPage {
    statement: Statement | null;
    features: unknown[];
    sections: Record<string, unknown>[];
}

declare function el(tag: string, attributes?: Record<string, string>, ...children: (Node | string)[]): HTMLElement;
declare function statementOf(statement: Statement): HTMLElement;
declare function featureOf(view: unknown): HTMLElement;
declare function sectionOf(section: unknown): HTMLElement;
declare function plainTableOf(table: { title: string; note: string; columns: { name: string; unit: string; numeric: boolean }[]; rows: Cell[][] }): HTMLElement;
