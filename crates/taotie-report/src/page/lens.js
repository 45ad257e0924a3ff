// @ts-check
// The lens: the visible part of every picture. All pictures share one, so they move in step.

/**
 * `zoom` is at least 1, which shows the whole picture; `x` and `y` are the top left corner of the visible part, in
 * fractions of the picture.
 * @typedef {{ zoom: number, x: number, y: number }} Lens
 */

const MOST_ZOOM = 64;

/** @type {Lens} */
const WHOLE = { zoom: 1, x: 0, y: 0 };

/**
 * The nearest lens that stays within the picture.
 * @param {Lens} lens
 * @returns {Lens}
 */
function within({ zoom, x, y }) {
  const kept = clamp(zoom, 1, MOST_ZOOM);
  const room = 1 - 1 / kept;
  return { zoom: kept, x: clamp(x, 0, room), y: clamp(y, 0, room) };
}

/**
 * Zooms by `factor` about the point (u, v) of the frame, in fractions of its size.
 * @param {Lens} lens
 * @param {number} factor
 * @param {number} u
 * @param {number} v
 * @returns {Lens}
 */
function zoomed(lens, factor, u, v) {
  const zoom = clamp(lens.zoom * factor, 1, MOST_ZOOM);
  const gain = 1 / lens.zoom - 1 / zoom;
  return within({ zoom, x: lens.x + u * gain, y: lens.y + v * gain });
}

/**
 * Moves the picture under the frame by fractions of the frame.
 * @param {Lens} lens
 * @param {number} du
 * @param {number} dv
 * @returns {Lens}
 */
function panned(lens, du, dv) {
  return within({ zoom: lens.zoom, x: lens.x - du / lens.zoom, y: lens.y - dv / lens.zoom });
}

/**
 * Applies the lens to every frame below `place`: the style sheet positions pictures by these numbers.
 * @param {HTMLElement} place
 * @param {Lens} lens
 */
function showLens(place, { zoom, x, y }) {
  place.style.setProperty("--zoom", String(zoom));
  place.style.setProperty("--x", String(x));
  place.style.setProperty("--y", String(y));
  place.classList.toggle("zoomed", zoom > 1);
  for (const frame of place.querySelectorAll(".frame")) frame.classList.toggle("pixels", beyondPixels(frame, zoom));
}

/**
 * Returns true if a picture's pixel is larger than a screen pixel.
 * @param {Element} frame
 * @param {number} zoom
 */
function beyondPixels(frame, zoom) {
  const picture = frame.querySelector("img");
  return picture !== null && frame.clientWidth * zoom * devicePixelRatio > Number(picture.getAttribute("width"));
}
