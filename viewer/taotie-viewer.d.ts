// The types of the element <taotie-viewer>.

/** The state of the view. */
export interface State {
    /** Azimuth and elevation, degrees, and distance, model units. */
    view: [number, number, number];
    /** The point that the camera looks at, model units. */
    target: [number, number, number];
    /** A reflectance model: `ggx`, `cook-torrance`, … */
    shading: string;
    /** A surface method, or `best`. */
    surface: string;
    /** `shaded`, `clay`, `normals`, … */
    mode: string;
    wireframe: boolean;
    /** Some projection rays of the bake, on report pages of bakes. */
    rays: boolean;
    /** `given` or `raking`. */
    light: string;
    /** The direction of the raking light: degrees to the right, and above. */
    from: [number, number];
    /** The frame that the raking light is fixed to: `viewer` or `object`. */
    fixed: string;
    strength: number;
    /** Ambient radiance. */
    fill: number;
    /** Whether the raking light casts shadows. */
    shadows: boolean;
    /** The rotation of the environment, degrees, and its intensity factor. */
    environment: [number, number];
    /** Stops. */
    exposure: number;
    /** A tone curve: `neutral`, `linear`, `reinhard`, `aces`, `agx`. */
    tone: string;
    /** The model right of the wipe handle: `none`, `smooth`, `scan`. */
    beside: string;
    /** The position of the handle, as a fraction of the width. */
    split: number;
}

/** The events of the element. */
export interface TaotieViewerEventMap {
    /** The model is loaded. */
    load: Event;
    /** The state has changed. */
    change: Event;
    /**
     * The model cannot be shown, or an attribute or value is not accepted: `message` names it and the accepted values.
     * `preventDefault()` keeps the message of a value out of the console.
     */
    error: ErrorEvent;
}

/** A model drawn by the shaders of Taotie. */
export class TaotieViewer extends HTMLElement {
    /** The folder written by `taotie view --folder`. */
    src: string;
    /** The files of such a folder by name, instead of `src`. */
    files: Record<string, BlobPart> | undefined;
    /** `given`, or azimuth, elevation and optionally strength of the raking light: `-75,10` or `-75,10,4`. */
    light: string;
    /** Azimuth, elevation and optionally distance: `30,20` or `30,20,0.5`. */
    camera: string;
    /** The reflectance model. */
    shading: string;
    /** The state of the view; `undefined` until the model is loaded. */
    readonly state: State | undefined;
    /** Changes parts of the state. If a name or value is not accepted, nothing changes and the event `error` follows. */
    change(part: Partial<State>): void;
    /** Returns the picture in this size, pixels, as a PNG; rejected if the browser cannot draw it. */
    picture(size?: [number, number]): Promise<Blob>;

    addEventListener<K extends keyof TaotieViewerEventMap>(
        type: K,
        listener: (this: TaotieViewer, event: TaotieViewerEventMap[K]) => void,
        options?: boolean | AddEventListenerOptions,
    ): void;
    addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;

    removeEventListener<K extends keyof TaotieViewerEventMap>(
        type: K,
        listener: (this: TaotieViewer, event: TaotieViewerEventMap[K]) => void,
        options?: boolean | EventListenerOptions,
    ): void;
    removeEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | EventListenerOptions): void;
}

declare global {
    interface HTMLElementTagNameMap {
        "taotie-viewer": TaotieViewer;
    }
}
