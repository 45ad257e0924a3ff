// The widget of taotie.Viewer in notebooks: the element <taotie-viewer>, which the script above defines, with its files
// from Python; what is shown goes both ways.

/** What each trait is of the element's state. */
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

/** What a trait changes in the element's state. */
function part(name, value) {
    if (name === "camera") return { view: value };
    if (name === "light") return value === null ? { light: "given" } : { light: "raking", from: value };
    return { [name]: value };
}

const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** Tells Python what is shown, once a frame at most. */
function teller(model, element) {
    let isWaiting = false;
    const tell = () => {
        isWaiting = false;
        for (const name of NAMES) {
            const value = SHOWN[name](element.state);
            if (!isSame(value, model.get(name))) model.set(name, value);
        }
        model.save_changes();
    };
    return () => {
        if (!isWaiting) requestAnimationFrame(tell);
        isWaiting = true;
    };
}

/** Shows what Python has said before the element was there. */
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
        const tell = teller(model, element);
        element.addEventListener("change", tell);
        tell();
    });
    el.append(element);
    return () => element.remove();
}

export default { render };
