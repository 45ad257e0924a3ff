// The page: a scan is chosen, baked, shown and proved.

import { type Baked, type Request, bake, viewWithScan } from "./bake.js";
import { byId, download, freeDownloads } from "./dom.js";
import { type Files, noScan, ofDrop, ofList, scansIn } from "./files.js";
import { messageOf } from "../../npm/taotie-wasm/src/lines.js";
import { unpacked } from "../../npm/taotie-wasm/src/program.js";
import { part } from "./parts.js";
import { Report, mainFigure, showProof } from "./proof.js";
import { explain, hide, show } from "./show.js";
import { Work } from "./work.js";
import { count, size } from "./words.js";

/** The example, and the choices for it: the defaults are for larger scans. */
const EXAMPLE = { name: "bronze.glb", choices: { triangles: "40000", size: "1024" } };

const texts = {
    asset: "The asset under raking light. Drag to turn it; drag with Shift to move the light.",
    preparing: "The scan is being prepared for comparison.",
    both: "Left of the handle the asset, right of it the scan, under the same raking light. Drag to turn them; drag with Shift to move the light.",
    notCompared: "The scan could not be shown next to it: ",
    noView: "The browser cannot show the asset; the report contains pictures of it.",
};

const form = byId<HTMLFormElement>("settings");
const which = form.elements.namedItem("scan") as HTMLSelectElement;
const buttons = [byId<HTMLButtonElement>("start"), byId<HTMLButtonElement>("search")];

let files: Files = {};
let stop = new AbortController();
let earlier: string[][] = [];

function fail(error: unknown): void {
    const failure = byId("failure");
    failure.textContent = messageOf(error);
    failure.hidden = false;
}

/** Takes the files of a scan, and bakes it with these choices, or else the defaults. */
function take(taken: Files, choices: Record<string, string> = {}): void {
    stop.abort();
    [files, earlier] = [taken, []];
    const scans = scansIn(files);
    which.replaceChildren(...scans.map((path) => el("option", { value: path }, path)));
    byId("which").hidden = scans.length < 2;
    byId("bake-title").textContent = scans.length === 1 ? scans[0]! : "The bake";
    byId("start").textContent = "Bake";
    form.reset();
    for (const [name, value] of Object.entries(choices)) (form.elements.namedItem(name) as HTMLInputElement).value = value;
    hide();
    byId("result").hidden = true;
    byId("choose").hidden = true;
    byId("bake").hidden = false;
    form.hidden = scans.length === 0;
    if (scans.length > 0) return void work(false);
    fail(noScan(files));
}

function requestOf(searches: boolean): Request {
    const value = (name: string): string => (form.elements.namedItem(name) as HTMLInputElement | HTMLSelectElement).value;
    return { files, searches, scan: value("scan"), triangles: value("triangles"), size: value("size"), distance: value("distance") };
}

function setBusy(isBusy: boolean): void {
    for (const button of buttons) button.disabled = isBusy;
}

async function work(searches: boolean): Promise<void> {
    const request = requestOf(searches);
    stop = new AbortController();
    const { signal } = stop;
    byId("failure").hidden = true;
    setBusy(true);
    const progress = new Work();
    byId("cancel").focus();
    try {
        const baked = await bake(request, { signal, onProgress: progress.hear });
        signal.throwIfAborted();
        showBaked(request, baked, signal);
    } catch (error) {
        if (!signal.aborted) fail(error);
    }
    // A later run has its own.
    if (stop.signal !== signal) return;
    progress.end();
    setBusy(false);
}

/** Shows a finished bake; the scan follows in the viewer. */
function showBaked(request: Request, baked: Baked, signal: AbortSignal): void {
    const report = new Report(baked.files[baked.page]!);
    byId("result").hidden = false;
    showProof(baked.report, report);
    showDownloads(baked);
    remember(request, baked, report);
    byId("start").textContent = "Bake again";
    byId("result").focus();
    byId("result").scrollIntoView({ block: "start" });
    byId("status").textContent = byId("result-title").textContent;
    void look(request, { baked, report }, signal);
}

async function look(request: Request, { baked, report }: { baked: Baked; report: Report }, signal: AbortSignal): Promise<void> {
    const own = await report.viewerFiles();
    if (signal.aborted) return;
    if (!own) {
        hide();
        byId("look").hidden = false;
        return explain(texts.noView);
    }
    show(own, `${texts.asset} ${texts.preparing}`);
    try {
        const both = await viewWithScan(request, baked, signal);
        show(both, texts.both, { beside: "scan" });
    } catch (error) {
        if (!signal.aborted) explain(`${texts.asset} ${texts.notCompared}${messageOf(error)}`);
    }
}

const LABELS: Record<string, string> = { glb: "Save the asset", html: "Save the report", json: "Save the figures" };

function showDownloads({ files: made }: Baked): void {
    freeDownloads();
    const endings = Object.keys(LABELS);
    const ending = (path: string): string => path.split(".").at(-1)!;
    const sorted = Object.entries(made).sort(([a], [b]) => endings.indexOf(ending(a)) - endings.indexOf(ending(b)));
    byId("downloads").replaceChildren(...sorted.map(([path, bytes]) => download(path, bytes, LABELS[ending(path)] ?? path, size(bytes.length))));
    byId("downloads").firstElementChild?.classList.add("primary");
}

/** Lists the bakes of the same scan, once there are several. */
function remember({ searches, distance }: Request, { report }: Baked, { page }: Report): void {
    const [name = "", value = ""] = mainFigure(page) ?? [];
    const ray = distance.trim() || "auto";
    const way = searches ? "search" : "fixed sizes";
    earlier.push([way, count(report.triangles[0] ?? 0), report.size.map(count).join(" × "), ray, size(report.proof.bytes_out), value]);
    const columns = ["bake", "triangles", "map", "ray distance", "file", name].map((name) => ({ name, unit: "", numeric: false }));
    const rows = earlier.map((cells) => cells.map((text) => ({ text })));
    byId("earlier").replaceChildren(plainTableOf({ title: "Bakes of this scan", note: "", columns, rows }));
    byId("earlier").hidden = earlier.length < 2;
}

function restart(): void {
    stop.abort();
    hide();
    for (const name of ["bake", "result"]) byId(name).hidden = true;
    byId("work").hidden = true;
    byId("choose").hidden = false;
    byId("pick-files").focus();
}

async function takeExample(): Promise<void> {
    const { name, choices } = EXAMPLE;
    take({ [name]: new Blob([await unpacked(await part("example"))]) }, choices);
}

function listen(): void {
    for (const name of ["files", "folder"]) {
        const input = byId<HTMLInputElement>(name);
        byId(`pick-${name}`).addEventListener("click", () => input.click());
        input.addEventListener("change", () => {
            if (input.files?.length) take(ofList(input.files));
            // The same file may be chosen again.
            input.value = "";
        });
    }
    byId("pick-example").addEventListener("click", () => void takeExample().catch(fail));
    byId("restart").addEventListener("click", restart);
    byId("cancel").addEventListener("click", () => {
        stop.abort();
        byId("work").hidden = true;
        setBusy(false);
        byId("status").textContent = "Cancelled";
        byId("start").focus();
    });
    byId("search").addEventListener("click", () => void work(true));
    form.addEventListener("submit", (event) => {
        event.preventDefault();
        void work(false);
    });
}

/** Files may be dropped anywhere. */
function listenToDrops(): void {
    const root = document.documentElement;
    addEventListener("dragover", (event) => {
        event.preventDefault();
        root.classList.add("dragging");
    });
    addEventListener("dragleave", ({ relatedTarget }) => void (relatedTarget || root.classList.remove("dragging")));
    addEventListener("drop", (event) => {
        event.preventDefault();
        root.classList.remove("dragging");
        if (event.dataTransfer) void ofDrop(event.dataTransfer).then((dropped) => take(dropped)).catch(fail);
    });
}

listen();
listenToDrops();
