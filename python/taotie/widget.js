// The notebook widget of taotie.Viewer: the element <taotie-viewer>, defined by the script above, with its files from
// Python; the displayed state is synchronised in both directions.

/** Reads each trait from the element's state. */
const SHOWN = {
    camera: (state) => state.view,
    target: (state) => state.target,
    light: (state) => (state.light === "raking" ? state.from : null),
    shadows: (state) => state.shadows,
    mode: (state) => state.mode,
    shading: (state) => state.shading,
    surface: (state) => state.surface,
    beside: (state) => state.beside,
    split: (state) => state.split,
};
const NAMES = Object.keys(SHOWN);

/** Returns the change of the element's state for a trait. */
function part(name, value) {
    if (name === "camera") return { view: value };
    if (name === "light") return value === null ? { light: "given" } : { light: "raking", from: value };
    return { [name]: value };
}

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** Returns a function that sends the displayed state to Python, at most once per frame. */
function sender(model, element) {
    let isWaiting = false;
    const send = () => {
        isWaiting = false;
        for (const name of NAMES) {
            const value = SHOWN[name](element.state);
            if (!isSame(value, model.get(name))) model.set(name, value);
        }
        model.save_changes();
    };
    return () => {
        if (!isWaiting) requestAnimationFrame(send);
        isWaiting = true;
    };
}

/** Applies the traits that Python set before the element existed. */
function begin(model, element) {
    const said = NAMES.filter((name) => model.get("_said").includes(name));
    element.change(Object.assign({}, ...said.map((name) => part(name, model.get(name)))));
    for (const name of NAMES) {
        model.on(`change:${name}`, () => {
            const value = model.get(name);
            if (!isSame(value, SHOWN[name](element.state))) element.change(part(name, value));
        });
    }
}

function render({ model, el }) {
    const element = document.createElement("taotie-viewer");
    element.style.cssText = `display: block; width: 100%; height: ${model.get("height")}px`;
    element.files = model.get("_files");
    element.addEventListener("load", () => {
        begin(model, element);
        const send = sender(model, element);
        element.addEventListener("change", send);
        send();
    });
    el.append(element);
    return () => element.remove();
}

export default { render };
