// Modes that show values of the pixel program instead of radiance. It computes them anyway; only its result changes.

/** The value that a mode shows if the shader has the field of that structure, and a constant otherwise. */
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

/** Returns true for modes whose pixels are numbers rather than light. */
export const isNumbers = (mode: string): boolean =>
    mode === "error" || (mode in VALUES && mode !== "base-color");

/** Returns true for modes that show the shaded surface. */
export const isShaded = (mode: string): boolean => mode === "shaded" || mode === "clay";

const RESULT = "return vec4(radiance, ";

/** Returns the fragment shader for a mode. */
export function inMode(text: string, mode: string): string {
    const shown = VALUES[mode];
    if (!shown) return text;
    const structure = new RegExp(`struct ${shown.structure} \\{[^}]*\\b${shown.field};`);
    return text.replace(RESULT, `return vec4(${structure.test(text) ? shown.value : shown.otherwise}, `);
}
