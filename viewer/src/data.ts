// The data of a page, as written by crates/taotie-report/src/viewer.

export interface Orbit {
    azimuth: number;
    elevation: number;
    distance: number;
    target: [number, number, number];
    fov_y: number;
    aspect: number;
    center: [number, number, number];
    radius: number;
}

export interface Environment {
    maps: [number, number];
    picture: [number, number];
    levels: number[][];
    count: number;
    smoothest_alpha: number;
    rotation: number;
    intensity: number;
}

export interface Light {
    /** Sixteen numbers per light. */
    lights: number[][];
    ambient: [number, number, number];
    environment: Environment | null;
}

export interface Film {
    exposure: number;
    tone: string;
    background: [number, number, number] | null;
    /** Positions within a pixel, in 1/256 pixel. */
    samples: [number, number][];
}

export interface Shader {
    fragment: number[];
    vertex: number[];
    inputs: string[];
    blocks: [string, string][];
    textures: string[];
}

export interface TextureUse {
    texture: number;
    /** WebGL constants for wrapping in u and v, magnification and minification. */
    sampler: [number, number, number, number];
}

export interface Dress {
    looks: number[][];
    factors: Record<string, number[]>;
    printed_bump: number;
    textures: Record<string, TextureUse>;
}

export interface Surface {
    material: number;
    double_sided: boolean;
    blended: boolean;
    best: number;
    drawn: number[];
    normal_matrix: [number[], number[], number[]];
    own: Dress;
    clay: Dress;
}

export interface Codes {
    width: number;
    height: number;
    channels: number;
    from: number;
}

export interface TextureData {
    encoding: "srgb" | "linear" | "normal";
    codes: Codes | null;
}

export interface ModelData {
    glb: string;
    codes: string;
    surfaces: Surface[];
    textures: TextureData[];
}

export interface ErrorMap {
    width: number;
    height: number;
    from: number;
    /** The uv set of its layout. */
    uv_set: number;
    /** The transform from these uvs to the map: the rows of the linear part, then the offset. */
    transform: [number, number, number, number, number, number];
}

/** Degrees on the surface. */
export interface Errors {
    /** Angles between the normals of asset and scan, or the uncertainty of normals from photographs. */
    quantity: "error" | "uncertainty";
    maps: (ErrorMap | null)[];
    top: number;
    stops: [number, number, number][];
    steps: number;
    /** The mean on the surface, degrees: of errors, according to the proof. */
    mean: number | null;
    /** The distance between the shapes of asset and scan, in the unit of the model. */
    distance: { rms: number; hausdorff: number } | null;
}

/** A titled view, with the fragment of its link. */
export interface Bookmark {
    title: string;
    text: string;
    link: string;
}

export interface Data {
    version: string;
    title: string;
    facts: { name: string; value: string }[];
    /** True if lengths of the model are in metres; otherwise their unit is unknown. */
    in_metres: boolean;
    bookmarks: Bookmark[];
    camera: Orbit | null;
    light: Light;
    film: Film;
    shadings: string[];
    methods: string[];
    shading: string;
    method: string | null;
    tables: [number, number];
    frame: { fields: [string, number][]; bytes: number } | null;
    texts: { pieces: string[]; shaders: Shader[] };
    /** The asset, and the scan if there is one. */
    models: ModelData[];
    errors: Errors | null;
    /** The number of projection rays that found the scan, the first in the blob `rays`; null without rays. */
    rays: number | null;
}
