// The runs of the program for this page.

import { compiled, once } from "../../npm/taotie-wasm/src/program.js";
import { type Result, type Running, Taotie } from "../../npm/taotie-wasm/src/taotie.js";
import { thread } from "../../npm/taotie-wasm/src/thread.js";
import type { Files } from "./files.js";
import { part } from "./parts.js";
import type { BakeReport, ViewerFiles } from "./proof.js";

/** The scan and the choices of a bake. Empty choices leave the default to the program. */
export interface Request {
    files: Files;
    /** The path of the scan among the files. */
    scan: string;
    triangles: string;
    size: string;
    distance: string;
    /** True for the smallest asset that passes, whose triangles and maps are found. */
    searches: boolean;
}

/** A finished bake. */
export interface Baked {
    report: BakeReport;
    /** The written files: asset, report page, figures. */
    files: Result["files"];
    asset: string;
    page: string;
}

/** What an asset has to meet. */
const REQUIRED = "standard";
/** The folder of the viewer's files. */
const FOLDER = "view";

const program = once(async () => new Taotie(await compiled((await part("program")).buffer), thread));

/** Returns the name of a path's file, without its ending. */
const stemOf = (path: string): string => path.split("/").at(-1)!.replace(/\.[^.]*$/, "");

/** Bakes the scan; rejected with the program's words. */
export async function bake({ files, scan, triangles, size, distance, searches }: Request, running: Running): Promise<Baked> {
    const taotie = await program();
    running.signal?.throwIfAborted();
    const stem = `${stemOf(scan)}-asset`;
    const asset = `${stem}.glb`;
    const given = (value: string): string | undefined => value.trim() || undefined;
    const sizes = searches ? {} : { triangles: given(triangles), size: given(size) };
    const options = { output: asset, require: REQUIRED, "ray-distance": given(distance), ...sizes };
    const { stdout, files: made } = await taotie.bake(scan, options, { ...running, files });
    return { report: stdout as unknown as BakeReport, files: made, asset, page: `${stem}.report.html` };
}

/** Returns the files of a viewer for the asset with its scan. */
export async function viewWithScan({ files, scan }: Request, { files: made, asset }: Baked, signal: AbortSignal): Promise<ViewerFiles> {
    const taotie = await program();
    const args = ["view", `--scan=${scan}`, "--publish-scan", `--folder=${FOLDER}`, "--", asset];
    const { code, stderr, files: written } = await taotie.run(args, { files: { ...files, [asset]: made[asset]! }, signal });
    if (code !== 0) throw new Error(stderr);
    return Object.fromEntries(Object.entries(written).map(([path, bytes]) => [path.slice(FOLDER.length + 1), bytes]));
}
