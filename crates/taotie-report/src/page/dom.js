// @ts-check
// Elements. Text from the data is only ever inserted as text: nothing here parses markup.

/**
 * Creates an element with attributes and children.
 * @param {string} tag
 * @param {Record<string, string>} [attributes]
 * @param {...(Node | string)} children
 * @returns {HTMLElement}
 */
function el(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/**
 * Creates an element of a drawing.
 * @param {string} tag
 * @param {Record<string, string | number>} [attributes]
 * @param {...(Node | string)} children
 * @returns {SVGElement}
 */
function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/**
 * Creates a button with an action.
 * @param {string} text
 * @param {string} hint A description of the action, for tooltips and screen readers.
 * @param {() => void} action
 * @returns {HTMLElement}
 */
function button(text, hint, action) {
  const element = el("button", { type: "button", title: hint, "aria-label": hint }, text);
  element.addEventListener("click", action);
  return element;
}

/**
 * Creates a paragraph, or nothing if the text is empty.
 * @param {string} kind Its class.
 * @param {string} text
 * @returns {HTMLElement[]}
 */
function note(kind, text) {
  return text ? [el("p", { class: kind }, text)] : [];
}

/**
 * @param {number} value
 * @param {number} low
 * @param {number} high
 */
function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}
