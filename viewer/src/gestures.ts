// Mouse and touch: one finger turns the model or moves the light, two fingers zoom and pan.

import { moveLight, pan, turn, zoom } from "./moves";
import type { Viewer } from "./viewer";

/** Degrees by which the model turns for each pixel of movement. */
const TURN = 0.4;
const LIGHT = 0.5;
/** The zoom factor for each pixel of the wheel. */
const WHEEL = 1.0015;

type Point = { x: number; y: number };

const middle = ([a, b]: [Point, Point]): Point => ({ x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 });
const apart = ([a, b]: [Point, Point]): number => Math.hypot(a.x - b.x, a.y - b.y);

/** `movesLight` returns true if a plain drag moves the light. */
export function listenToGestures(viewer: Viewer, movesLight: () => boolean): void {
    const { canvas } = viewer;
    const fingers = new Map<number, Point>();
    const lens = viewer.data.camera!;

    const drag = (event: PointerEvent, before: Point): void => {
        const [x, y] = [event.clientX - before.x, event.clientY - before.y];
        const isLight = movesLight() !== (event.shiftKey || (event.buttons & 2) !== 0);
        const isPan = event.ctrlKey || (event.buttons & 4) !== 0;
        const height = Math.max(canvas.clientHeight, 1);
        if (isPan) viewer.move(pan(x / height, y / height, lens)(viewer.state));
        else if (isLight) viewer.move(moveLight(x * LIGHT, -y * LIGHT)(viewer.state));
        else viewer.move(turn(x * TURN, y * TURN)(viewer.state));
    };

    const pinch = (before: [Point, Point], after: [Point, Point]): void => {
        const height = Math.max(canvas.clientHeight, 1);
        const [from, to] = [middle(before), middle(after)];
        viewer.move(zoom(apart(after) / Math.max(apart(before), 1))(viewer.state));
        viewer.move(pan((to.x - from.x) / height, (to.y - from.y) / height, lens)(viewer.state));
    };

    canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => {
        const before = fingers.get(event.pointerId);
        if (!before) return;
        const pair = [...fingers.values()];
        fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        if (pair.length === 1) drag(event, before);
        if (pair.length === 2) pinch(pair as [Point, Point], [...fingers.values()] as [Point, Point]);
    });
    const leave = (event: PointerEvent): void => void fingers.delete(event.pointerId);
    canvas.addEventListener("pointerup", leave);
    canvas.addEventListener("pointercancel", leave);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    const roll = (event: WheelEvent): void => {
        // The wheel scrolls a scrollable page until the picture has the focus.
        const { scrollHeight } = document.documentElement;
        if (scrollHeight > innerHeight && !canvas.matches(":focus")) return;
        event.preventDefault();
        viewer.move(zoom(WHEEL ** -event.deltaY)(viewer.state));
    };
    canvas.addEventListener("wheel", roll, { passive: false });
}
