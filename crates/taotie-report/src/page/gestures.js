// @ts-check
// Gestures on a picture: wheel and pinch zoom about the pointer, dragging pans, a double click resets.

/** @typedef {{ u: number, v: number }} Spot A point of a frame, in fractions of its size. */

/** The time after scrolling the page during which the wheel over a picture still scrolls the page, milliseconds. */
const SCROLLING = 180;

let lastScroll = -SCROLLING;
addEventListener("scroll", () => (lastScroll = performance.now()), { passive: true });

/**
 * @param {HTMLElement} frame
 * @param {() => Lens} get
 * @param {(lens: Lens) => void} set
 */
function listenToGestures(frame, get, set) {
  frame.addEventListener("wheel", (event) => onWheel(event, frame, get, set), { passive: false });
  frame.addEventListener("dblclick", () => set(WHOLE));
  listenToFingers(frame, get, set);
}

/**
 * @param {WheelEvent} event
 * @param {HTMLElement} frame
 * @param {() => Lens} get
 * @param {(lens: Lens) => void} set
 */
function onWheel(event, frame, get, set) {
  const lens = get();
  // Keep scrolling a page that is being scrolled, or whose pictures cannot be zoomed out further.
  if (performance.now() - lastScroll < SCROLLING || (lens.zoom === 1 && event.deltaY > 0)) return;
  event.preventDefault();
  const { u, v } = spot(frame, event);
  const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
  // A trackpad pinch arrives as a wheel event with Ctrl, in small steps.
  const speed = event.ctrlKey ? 0.01 : 0.002;
  set(zoomed(lens, Math.exp(-clamp(event.deltaY * lines, -400, 400) * speed), u, v));
}

/**
 * @param {HTMLElement} frame
 * @param {() => Lens} get
 * @param {(lens: Lens) => void} set
 */
function listenToFingers(frame, get, set) {
  /** @type {Map<number, Spot>} */
  const fingers = new Map();
  frame.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    fingers.set(event.pointerId, spot(frame, event));
    frame.setPointerCapture(event.pointerId);
  });
  frame.addEventListener("pointermove", (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const to = spot(frame, event);
    const still = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    set(still ? pinched(get(), frame, { still, from, to }) : panned(get(), to.u - from.u, to.v - from.v));
    fingers.set(event.pointerId, to);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    frame.addEventListener(end, (event) => fingers.delete(/** @type {PointerEvent} */ (event).pointerId));
}

/**
 * One finger moves while the other keeps still.
 * @param {Lens} lens
 * @param {HTMLElement} frame
 * @param {{ still: Spot, from: Spot, to: Spot }} fingers
 * @returns {Lens}
 */
function pinched(lens, frame, { still, from, to }) {
  /** @param {Spot} spot */
  const away = ({ u, v }) => Math.hypot((u - still.u) * frame.clientWidth, (v - still.v) * frame.clientHeight);
  return zoomed(lens, away(to) / Math.max(away(from), 1), still.u, still.v);
}

/**
 * @param {HTMLElement} frame
 * @param {MouseEvent} event
 * @returns {Spot}
 */
function spot(frame, event) {
  const box = frame.getBoundingClientRect();
  return { u: (event.clientX - box.left) / box.width, v: (event.clientY - box.top) / box.height };
}
