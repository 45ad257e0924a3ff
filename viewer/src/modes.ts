// Values of the pixel program shown instead of its radiance. The program computes them; only what it returns changes.

/** What a mode shows, where the shader has the field of that structure; else a constant. */
interface Shown {
    structure: string;
    field: string;
    value: string;
    otherwise: string;
}

const VALUES: Record<string, Shown> = {
    "base-color": { structure: "SurfacePoint", field: "base_color", value: "p.base_color", otherwise: "radiance" },
    normals: { structure: "ShadingFrame", field: "n", value: "f.n * 0.5 + 0.5", otherwise: "vec3(0.5)" },
    "tangent-normals": { structure: "Texels", field: "normal", value: "t.normal", otherwise: "vec3(0.5, 0.5, 1.0)" },
    roughness: { structure: "MaterialValues", field: "roughness", value: "vec3(m.roughness)", otherwise: "vec3(1.0)" },
    metallic: { structure: "SurfacePoint", field: "metallic", value: "vec3(p.metallic)", otherwise: "vec3(0.0)" },
    occlusion: { structure: "MaterialValues", field: "occlusion", value: "vec3(m.occlusion)", otherwise: "vec3(1.0)" },
};

/** Modes whose pixels are numbers and no light. */
export const isNumbers = (mode: string): boolean =>
    mode === "error" || (mode in VALUES && mode !== "base-color");

/** Modes that show the shaded surface. */
export const isShaded = (mode: string): boolean => mode === "shaded" || mode === "clay";

const RESULT = "return vec4(radiance, ";

/** The fragment shader that returns what a mode shows. */
export function inMode(text: string, mode: string): string {
    const shown = VALUES[mode];
    if (!shown) return text;
    const structure = new RegExp(`struct ${shown.structure} \\{[^}]*\\b${shown.field};`);
    return text.replace(RESULT, `return vec4(${structure.test(text) ? shown.value : shown.otherwise}, `);
}
