// The rules of the IIIF Presentation API 4.0 for scene manifests, as far as our manifests use it.

import assert from "node:assert/strict";

const isText = (value) => typeof value === "string" && value.length > 0;
const isNumber = (value) => Number.isFinite(value);
const isLabel = (value) => Object.values(value).every((texts) => Array.isArray(texts) && texts.every(isText));
const isColor = (value) => /^#[0-9A-F]{6}$/.test(value);
const isOneOf = (...all) => (value) => all.includes(value);
const each = (...types) => (value) =>
    Array.isArray(value) && value.length > 0 && value.every((item) => types.includes(item.type) && isSound(item));
const one = (...types) => (value) => types.includes(value.type) && isSound(value);
const words = (...known) => (value) => Array.isArray(value) && value.length > 0 && value.every((word) => known.includes(word));
const metadata = (value) => value.every(({ label, value }) => isLabel(label) && isLabel(value));

const light = { "id!": isText, "color!": isColor, "intensity!": one("Quantity") };

// The allowed properties of each type; those with an exclamation mark are required.
const TYPES = {
    Manifest: {
        "@context!": isOneOf("http://iiif.io/api/presentation/4/context.json"),
        "id!": isText,
        "label!": isLabel,
        "items!": each("Scene"),
        metadata,
    },
    Scene: { "id!": isText, label: isLabel, items: each("AnnotationPage"), annotations: each("AnnotationPage") },
    AnnotationPage: { "id!": isText, "items!": each("Annotation") },
    Annotation: {
        "id!": isText,
        motivation: words("painting", "commenting", "activating"),
        body: each("Model", "PerspectiveCamera", "DirectionalLight", "AmbientLight", "TextualBody", "SpecificResource"),
        target: each("Scene", "SpecificResource", "Annotation"),
        behavior: words("hidden"),
    },
    Model: { "id!": isText, format: isOneOf("model/gltf-binary") },
    PerspectiveCamera: { "id!": isText, lookAt: one("PointSelector"), "fieldOfView!": (angle) => angle > 0 && angle < 180 },
    DirectionalLight: { ...light, "lookAt!": one("PointSelector") },
    AmbientLight: light,
    TextualBody: { "value!": isText, format: isText },
    SpecificResource: {
        "id!": isText,
        "source!": (source) => (Array.isArray(source) ? each("Annotation")(source) : one("Scene")(source)),
        selector: each("PointSelector"),
        action: words("show", "enable", "select"),
    },
    PointSelector: { "x!": isNumber, "y!": isNumber, "z!": isNumber },
    Quantity: { "quantityValue!": (value) => value >= 0 && value <= 1, "unit!": isOneOf("relative") },
};

// Fails if a resource breaks a rule, and reports the location.
function isSound({ type, ...properties }) {
    const rules = Object.entries(TYPES[type] ?? assert.fail(`unknown type ${type}`));
    const names = rules.map(([name]) => name.replace("!", ""));
    const where = properties.id ?? type;
    assert.deepEqual(Object.keys(properties).filter((name) => !names.includes(name)), [], where);
    for (const [i, [name, rule]] of rules.entries()) {
        const value = properties[names[i]];
        if (value === undefined) assert(!name.endsWith("!"), `${where} lacks ${names[i]}`);
        else assert(rule(value), `${where}: ${names[i]} is ${JSON.stringify(value)}`);
    }
    return true;
}

// All resources with an id, some of which are only references.
function* resources(value) {
    if (value === null || typeof value !== "object") return;
    if (typeof value.id === "string") yield value;
    for (const part of Object.values(value)) yield* resources(part);
}

// Fails unless a manifest follows the rules and its resources are below an address.
export function assertManifest(manifest, base) {
    assert(isSound(manifest));
    const defined = new Set();
    const named = [];
    for (const resource of resources(manifest)) {
        assert(resource.id.startsWith(base), resource.id);
        const isName = Object.keys(resource).length === 2;
        if (isName) named.push(resource.id);
        else assert(!defined.has(resource.id), `${resource.id} is defined twice`);
        defined.add(isName ? "" : resource.id);
    }
    assert.deepEqual(named.filter((id) => !defined.has(id)), [], "all references are defined");
}
