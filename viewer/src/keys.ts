// Keyboard control while the picture has the focus.

import { moveLight, next, turn, zoom } from "./moves";
import { modes } from "./fields";
import type { Viewer } from "./viewer";

/** Degrees per key press, without and with Alt. */
const [STEP, FINE] = [5, 0.5];
const NEARER = 1.1;

const ARROWS: Record<string, [number, number]> = {
    ArrowLeft: [-1, 0],
    ArrowRight: [1, 0],
    ArrowUp: [0, 1],
    ArrowDown: [0, -1],
};

/** The actions other than those that change the state. */
export interface Actions {
    movesLight(): boolean;
    toggleLight(): void;
    save(): void;
    reset(): void;
}

export function listenToKeys(viewer: Viewer, actions: Actions): void {
    const arrow = (event: KeyboardEvent, [right, up]: [number, number]): void => {
        const step = event.altKey ? FINE : STEP;
        const isLight = actions.movesLight() !== event.shiftKey;
        // The model follows the key: up shows its lower side.
        const move = isLight ? moveLight(right * step, up * step) : turn(right * step, -up * step);
        viewer.move(move(viewer.state));
    };
    const others: Record<string, () => void> = {
        "+": () => viewer.move(zoom(NEARER)(viewer.state)),
        "=": () => viewer.move(zoom(NEARER)(viewer.state)),
        "-": () => viewer.move(zoom(1 / NEARER)(viewer.state)),
        l: actions.toggleLight,
        m: () => viewer.move({ mode: next(modes(viewer.data), viewer.state.mode) }),
        w: () => viewer.move({ wireframe: !viewer.state.wireframe }),
        s: actions.save,
        0: actions.reset,
    };
    viewer.canvas.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey) return;
        const way = ARROWS[event.key];
        const other = others[event.key.toLowerCase()];
        if (!way && !other) return;
        event.preventDefault();
        if (way) arrow(event, way);
        else other?.();
    });
}
