//! The structures that the stages of a pixel hand on, with all fields that any variant has.

use crate::factors;
use crate::graph::Kind;
use crate::interface::ValueKind;
use crate::structures::{Field, Structure};

const N: Kind = Kind::Number;
const V: Kind = Kind::Vector;

/// A row of a table of fields: name, type, meaning.
type Row = (&'static str, Kind, &'static str);

/// The structures whose fields depend on the variant.
pub(super) fn variable() -> Vec<Structure> {
    let mut structures = vec![
        of("Geometry", "A point of a surface as interpolation gives it, world space.", &["g"], &GEOMETRY),
        of("Texels", "What textures and vertices say of a point.", &["t"], &TEXELS),
        of("ShadingFrame", "The directions of a point, unit, world space.", &["f"], &FRAME),
        of("MaterialValues", MATERIAL, &["m"], &VALUES),
        of("SurfacePoint", "A point of a surface with all that its reflection depends on.", &["p"], &POINT),
        of("EnvironmentTexels", "The light of the environment at a point, linear RGB.", &["e"], &LIGHT),
    ];
    structures.push(Structure {
        name: "MaterialUniforms",
        doc: "The factors of a surface, the same at all its points.",
        arguments: &["u"],
        fields: factors::named().filter_map(|factor| uniform(&factor)).collect(),
    });
    structures
}

/// The structures that are the same in each variant.
pub(super) fn fixed() -> Vec<Structure> {
    vec![
        of("TablePosition", "The position at which a table is read.", &["q"], &TABLE_POSITION),
        of("Highlight", "The direction and width from which a highlight gathers its light.", &[], &HIGHLIGHT),
        of("Light", "A light made ready for shading.", &["light"], &LIGHT_SOURCE),
        of("Incidence", "The light that arrives at a point.", &[], &INCIDENCE),
        of("MapPlace", "A place in an unfolded octahedron, [0, 1]².", &[], &PLACE),
        of("LevelPosition", "The two levels between which a roughness lies.", &[], &LEVEL_POSITION),
        of(
            "Taps",
            "The first of two texels, counted with the border, and the weight of the next.",
            &[],
            &TAPS,
        ),
        of("PicturePosition", PICTURE, &[], &PICTURE_POSITION),
    ]
}

const MATERIAL: &str = "The values of a material at a point: textures and vertex colours with their factors.";
const PICTURE: &str = "The texels around a place in an equirectangular picture: columns and rows, integers.";

fn of(name: &'static str, doc: &'static str, arguments: &'static [&'static str], rows: &[Row]) -> Structure {
    let fields = rows.iter().map(|(name, kind, doc)| Field { name, kind: *kind, doc });
    Structure { name, doc, arguments, fields: fields.collect() }
}

/// A uniform that a recorded formula can take.
fn uniform(field: &factors::FactorName) -> Option<Field> {
    let kind = match field.kind {
        ValueKind::Number => N,
        ValueKind::Vec3 => V,
        ValueKind::Vec2 | ValueKind::Vec4 | ValueKind::Mat4 => return None,
    };
    Some(Field { name: field.name, kind, doc: field.meaning })
}

const GEOMETRY: [Row; 15] = [
    ("n_geom", V, "The geometric normal: unit, on the side of the face that is seen."),
    ("normal", V, "The interpolated normal, not normalised."),
    ("normal_dx", V, "Its change to the next sample on the right."),
    ("normal_dy", V, "Its change to the next sample above or below."),
    ("tangent", V, "The interpolated tangent, not normalised."),
    ("handedness", N, "The sign of the bitangent, ±1."),
    ("facing", N, "The side that is seen: 1 for the front, −1 for the back."),
    ("v", V, "The direction to the viewer, unit."),
    ("position_dx", V, "The change of the position to the next sample on the right."),
    ("position_dy", V, "The change of the position to the next sample above or below."),
    ("du_dx", N, "The change of the height map's u to the next sample on the right."),
    ("dv_dx", N, "The change of the height map's v to the next sample on the right."),
    ("du_dy", N, "The change of the height map's u to the next sample above or below."),
    ("dv_dy", N, "The change of the height map's v to the next sample above or below."),
    ("height_width", N, "The texels of the height map's finest level along u."),
];

const TEXELS: [Row; 23] = [
    ("base_color", V, "Linear RGB."),
    ("alpha", N, "Opacity, [0, 1]."),
    ("color", V, "The vertex colour, linear RGB."),
    ("color_alpha", N, "The vertex colour's alpha, [0, 1]."),
    ("metallic", N, "[0, 1]."),
    ("roughness", N, "[0, 1]."),
    ("occlusion", N, "[0, 1]."),
    ("emissive", V, "Linear RGB."),
    ("normal", V, "The normal map's vector as stored, each component in [0, 1]."),
    ("normal_variance", N, "The variance of the normal map's vectors, [0, 1]."),
    ("height_du", N, "The derivative of the height map by u."),
    ("height_dv", N, "The derivative of the height map by v."),
    ("specular", N, "[0, 1]."),
    ("specular_color", V, "Linear RGB."),
    ("clearcoat", N, "[0, 1]."),
    ("clearcoat_roughness", N, "[0, 1]."),
    ("clearcoat_normal", V, "The clearcoat's normal map's vector as stored, each component in [0, 1]."),
    ("clearcoat_variance", N, "The variance of the clearcoat's normal map's vectors, [0, 1]."),
    ("sheen_color", V, "Linear RGB."),
    ("sheen_roughness", N, "[0, 1]."),
    ("anisotropy", N, "[0, 1]."),
    ("anisotropy_red", N, "The stored cosine of a turn of the anisotropy, [0, 1]."),
    ("anisotropy_green", N, "The stored sine of a turn of the anisotropy, [0, 1]."),
];

const FRAME: [Row; 4] = [
    ("n", V, "The shading normal; not unit for `bump-printed`."),
    ("n_smooth", V, "The normal before any map, on the side that is seen."),
    ("coat_n", V, "The clearcoat's normal."),
    ("tangent", V, "The direction of the anisotropy, at a right angle to the shading normal."),
];

const VALUES: [Row; 13] = [
    ("tint", V, "Base colour texture times vertex colour, linear RGB."),
    ("metallic", N, "[0, 1]."),
    ("roughness", N, "The roughness as artists set it, widened by what hides within the pixel, [0, 1]."),
    ("specular", N, "The strength of a dielectric's reflection, [0, 1]."),
    ("specular_color", V, "Multiplies the dielectric's F0, linear RGB, at least 0."),
    ("occlusion", N, "The share of the hemisphere that is open, [0, 1]."),
    ("emissive", V, "Emitted radiance, linear RGB."),
    ("variance", N, "The variance of normals within the pixel."),
    ("coat", N, "The part of the surface that the clearcoat covers, [0, 1]."),
    ("coat_roughness", N, "The clearcoat's roughness as artists set it, widened, [0, 1]."),
    ("sheen_color", V, "Linear RGB in [0, 1]."),
    ("sheen_roughness", N, "The sheen's roughness as artists set it, [0, 1]."),
    ("anisotropy", N, "The strength of the anisotropy, [0, 1]."),
];

const POINT: [Row; 31] = [
    ("n", V, "The shading normal; not unit for `bump-printed`."),
    ("n_smooth", V, "The normal before any map, unit, on the side that is seen."),
    ("v", V, "The direction to the viewer, unit."),
    ("base_color", V, "ρ, linear RGB in [0, 1]."),
    ("metallic", N, "[0, 1]."),
    ("roughness", N, "The roughness as artists set it, [0, 1]; α is its square."),
    ("f0", V, "Reflectance at normal incidence, linear RGB in [0, 1]."),
    ("f90", N, "Reflectance at grazing incidence, [0, 1]."),
    ("f82_drop", V, "Lazányi coefficient of the reflectance at 82°."),
    ("diffuse", V, "k_d or C_diff, linear RGB in [0, 1]."),
    ("specular", V, "k_s or C_spec, linear RGB in [0, 1]."),
    ("shininess", N, "Exponent of Phong and Blinn-Phong, at least 0."),
    ("slope", N, "Beckmann's rms slope m, above 0."),
    ("gain", V, "Multiplies the highlight, linear RGB, at least 1."),
    ("transmitted", N, "The share of light that the highlight leaves to the diffuse reflection, [0, 1]."),
    ("ambient", V, "k_a, linear RGB."),
    ("emissive", V, "Emitted radiance, linear RGB."),
    ("occlusion", N, "The share of the hemisphere that is open, [0, 1]."),
    ("lobe_roughness", N, "The roughness of the GGX lobe that comes nearest to the highlight, [0, 1]."),
    ("tangent", V, "The direction of the anisotropy: unit, at a right angle to n."),
    ("bitangent", V, "Unit, at a right angle to n and tangent."),
    ("along", N, "α along the tangent, (0, 1]."),
    ("across", N, "α along the bitangent, (0, 1]."),
    ("anisotropy", N, "The strength of the anisotropy, [0, 1]."),
    ("coat_n", V, "The clearcoat's normal, unit."),
    ("coat", N, "The part of the surface that the clearcoat covers, [0, 1]."),
    ("coat_roughness", N, "The clearcoat's roughness as artists set it, [0, 1]."),
    ("coat_albedo", N, "The part of equal light from everywhere that the clearcoat reflects, [0, 1]."),
    ("sheen_color", V, "The colour of the sheen, linear RGB in [0, 1]."),
    ("sheen_roughness", N, "The sheen's roughness as artists set it, [0, 1]."),
    ("sheen_albedo", N, "The part of equal light from everywhere that white sheen reflects, [0, 1]."),
];

const LIGHT: [Row; 3] = [
    ("specular", V, "The radiance that the highlight gathers."),
    ("mean", V, "The irradiance over π at the shading normal."),
    ("coat", V, "The radiance that the clearcoat's highlight gathers."),
];

const TABLE_POSITION: [Row; 3] = [
    ("node", N, "The node below, an integer: its row times 64 plus its column."),
    ("across", N, "The fraction of the way from this node to the next along the cosine, [0, 1]."),
    ("down", N, "The same of the roughness."),
];

const HIGHLIGHT: [Row; 2] =
    [("direction", V, "Unit, world space."), ("roughness", N, "The roughness of its GGX lobe, [0, 1].")];

const LIGHT_SOURCE: [Row; 7] = [
    ("place", V, "The position; the unit direction to a light infinitely far away. World space."),
    ("kind", N, "0: infinitely far; 1: no falloff; 2: by the inverse square."),
    ("color", V, "Intensity, or irradiance where it is infinitely far, linear RGB."),
    ("range", N, "The distance at which it has faded to zero, model units."),
    ("axis", V, "The axis of its cone: unit, away from the light."),
    ("cos_inner", N, "The cosine of the angle at which the light begins to fade."),
    ("cos_outer", N, "The cosine of the angle at which it ends."),
];

const INCIDENCE: [Row; 2] = [
    ("l", V, "The unit direction to the light."),
    ("irradiance", V, "The irradiance on a plane that faces it, linear RGB."),
];

const PLACE: [Row; 2] = [("u", N, "[0, 1]."), ("v", N, "[0, 1].")];

const LEVEL_POSITION: [Row; 2] = [
    ("below", N, "The number of the level below; −1 where all are rougher."),
    ("share", N, "The weight of the level above in the mean."),
];

const TAPS: [Row; 2] =
    [("first", N, "An integer."), ("share", N, "The fraction of the way to the next, [0, 1].")];

const PICTURE_POSITION: [Row; 6] = [
    ("left", N, "The left column."),
    ("right", N, "The right column, which is the first beyond the last."),
    ("top", N, "The upper row."),
    ("bottom", N, "The lower row."),
    ("across", N, "The weight of the right column, [0, 1]."),
    ("down", N, "The weight of the lower row, [0, 1]."),
];
