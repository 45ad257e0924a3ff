// The types of the element <taotie-viewer>.

/** What is shown. */
export interface State {
    /** Azimuth and elevation, degrees, and distance, model units. */
    view: [number, number, number];
    /** The point that is looked at, model units. */
    target: [number, number, number];
    /** A reflectance model: `ggx`, `cook-torrance`, … */
    shading: string;
    /** A surface method, or `best`. */
    surface: string;
    /** `shaded`, `clay`, `normals`, … */
    mode: string;
    wireframe: boolean;
    /** `given` or `raking`. */
    light: string;
    /** The raking light's degrees to the right, and above. */
    from: [number, number];
    /** What the raking light is fixed to: `viewer` or `object`. */
    fixed: string;
    strength: number;
    /** Radiance from all around. */
    fill: number;
    /** Whether the raking light casts shadows. */
    shadows: boolean;
    /** The environment's turn, degrees, and its factor. */
    environment: [number, number];
    /** Stops. */
    exposure: number;
    /** A tone curve: `neutral`, `linear`, `reinhard`, `aces`, `agx`. */
    tone: string;
    /** What stands right of the wipe's handle: `none`, `smooth`, `scan`. */
    beside: string;
    /** Where the handle is: a fraction of the width. */
    split: number;
}

/** A model, by the shaders of Taotie. */
export class TaotieViewer extends HTMLElement {
    /** The folder that `taotie view --folder` wrote. */
    src: string;
    /** The files of such a folder by their names, in place of `src`. */
    files: Record<string, BlobPart> | undefined;
    /** `given`, or azimuth, elevation and, if wanted, strength of the raking light: `-75,10` or `-75,10,4`. */
    light: string;
    /** Azimuth, elevation and, if wanted, distance: `30,20` or `30,20,0.5`. */
    camera: string;
    /** The reflectance model. */
    shading: string;
    /** What is shown; `undefined` until the model is there. */
    readonly state: State | undefined;
    /** Changes some of what is shown. */
    change(part: Partial<State>): void;
    /** The picture of this size, pixels, as a PNG. */
    picture(size?: [number, number]): Promise<Blob>;
}

declare global {
    interface HTMLElementTagNameMap {
        "taotie-viewer": TaotieViewer;
    }
}
