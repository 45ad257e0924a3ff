// @ts-check
// The wipe: two pictures in one frame, and a handle that reveals one or the other.

/**
 * A frame that shows part of a picture.
 * @param {...Node} children
 * @returns {HTMLElement}
 */
function frameOf(...children) {
  return el("div", { class: "frame" }, ...children);
}

/**
 * @param {Picture} picture
 * @returns {HTMLElement}
 */
function imageOf({ label, uri, width, height }) {
  const size = { width: String(width), height: String(height) };
  return el("img", { src: uri, alt: label, draggable: "false", decoding: "sync", ...size });
}

/**
 * The handle between left and right.
 * @param {(percent: number) => void} set
 * @param {() => number} get
 * @returns {HTMLElement}
 */
function handleOf(get, set) {
  const handle = el("div", {
    class: "handle",
    role: "slider",
    tabindex: "0",
    "aria-label": "Wipe between the left and the right picture",
    "aria-orientation": "horizontal",
    "aria-valuemin": "0",
    "aria-valuemax": "100",
  });
  handle.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.stopPropagation();
    event.preventDefault();
    handle.focus({ preventScroll: true });
    handle.setPointerCapture(event.pointerId);
  });
  handle.addEventListener("pointermove", (event) => {
    const frame = handle.parentElement;
    if (frame && handle.hasPointerCapture(event.pointerId)) set(spot(frame, event).u * 100);
  });
  handle.addEventListener("keydown", (event) => {
    const to = afterKey(event, get());
    if (to === undefined) return;
    event.preventDefault();
    set(to);
  });
  return handle;
}

/**
 * The position to which a key moves the handle; `undefined` if it does not move it.
 * @param {KeyboardEvent} event
 * @param {number} percent
 * @returns {number | undefined}
 */
function afterKey(event, percent) {
  const step = event.shiftKey ? 10 : 1;
  switch (event.key) {
    case "ArrowLeft":
    case "ArrowDown":
      return percent - step;
    case "ArrowRight":
    case "ArrowUp":
      return percent + step;
    case "PageDown":
      return percent - 10;
    case "PageUp":
      return percent + 10;
    case "Home":
      return 0;
    case "End":
      return 100;
  }
}
