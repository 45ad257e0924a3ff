// The viewer on the page: the asset, and the scan under the wipe once it is ready.

import type { State, TaotieViewer } from "../../viewer/taotie-viewer";
import { byId } from "./dom.js";
import type { ViewerFiles } from "./proof.js";

/** The raking light: azimuth and elevation, degrees. */
const LIGHT = "-75,10";

/** The parts of a view that stay when the model is baked again. */
const kept = ({ view, target, light, from, mode, shading, strength, fill }: State): Partial<State> => ({ view, target, light, from, mode, shading, strength, fill });

const current = (): TaotieViewer | null => byId("look").querySelector("taotie-viewer");

/** Shows files in the viewer, with `part` of a state and the earlier view of the same scan. */
export function show(files: ViewerFiles, note: string, part: Partial<State> = {}): void {
    const look = byId("look");
    const earlier = current()?.state;
    const viewer = document.createElement("taotie-viewer");
    viewer.light = LIGHT;
    viewer.files = files;
    viewer.addEventListener("load", () => viewer.change({ ...(earlier ? kept(earlier) : {}), ...part }), { once: true });
    current()?.remove();
    look.append(viewer);
    look.hidden = false;
    explain(note);
}

export function explain(note: string): void {
    byId("look-note").textContent = note;
}

/** Removes the viewer, with its view. */
export function hide(): void {
    current()?.remove();
    byId("look").hidden = true;
}
