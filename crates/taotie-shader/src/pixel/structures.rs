//! The structures passed between the stages of a pixel: all fields of any variant, the textures of texels, and the
//! structures as parameters of a recording.

use crate::factors;
use crate::graph::Kind;
use crate::interface::ValueKind;
use crate::program::{Field, Structure};
use crate::recorder::{Recorded, Scope};
use crate::variant::Variant;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    Anisotropic, Coat, Frame, Geometry, MaterialPoint, MaterialUniforms, MaterialValues, PointLayers, Sheen,
    SurfacePoint, Texel, is_cook_torrance,
};
use taotie_engine::scene::TextureRole;
use taotie_engine::shade::{AnisotropicLobe, Compensation, MaterialSample};

const N: Kind = Kind::Number;
const V: Kind = Kind::Vector;

/// A row of a table of fields: name, type, meaning.
type Row = (&'static str, Kind, &'static str);

/// The structures whose fields depend on the variant.
pub(super) fn variable() -> Vec<Structure> {
    let mut structures = vec![
        of("Geometry", "An interpolated point of a surface, world space.", &["g"], &GEOMETRY),
        of("Texels", "The texture and vertex values at a point.", &["t"], &texels()),
        of("ShadingFrame", "The directions of a point, unit, world space.", &["f"], &FRAME),
        of("MaterialValues", MATERIAL, &["m"], &VALUES),
        of(
            "SurfacePoint",
            "A point of a surface, with everything that its reflection depends on.",
            &["p"],
            &POINT,
        ),
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
        of("TablePosition", "A position in a table.", &["q"], &TABLE_POSITION),
        of("Highlight", "The direction and width of a highlight's lobe in the environment.", &[], &HIGHLIGHT),
        of("Light", "A light prepared for shading.", &["light"], &LIGHT_SOURCE),
        of("Incidence", "The incident light at a point.", &[], &INCIDENCE),
        of("MapPlace", "A position in an unfolded octahedron, [0, 1]².", &[], &PLACE),
        of("LevelPosition", "The two levels around a roughness.", &[], &LEVEL_POSITION),
        of(
            "Taps",
            "The first of two texels, counted with the border, and the weight of the second.",
            &[],
            &TAPS,
        ),
        of("PicturePosition", PICTURE, &[], &PICTURE_POSITION),
    ]
}

const MATERIAL: &str = "The material values at a point: textures and vertex colours times their factors.";
const PICTURE: &str = "The texels around a position in an equirectangular image: columns and rows, integers.";

fn of(name: &'static str, doc: &'static str, arguments: &'static [&'static str], rows: &[Row]) -> Structure {
    let fields = rows.iter().map(|(name, kind, doc)| Field { name, kind: *kind, doc });
    Structure { name, doc, arguments, fields: fields.collect() }
}

/// The fields of all texels.
fn texels() -> Vec<Row> {
    let kind = |texel: &Texel| if texel.channels() == "rgb" { V } else { N };
    Texel::ALL.iter().map(|texel| (texel.name(), kind(texel), texel.meaning())).collect()
}

/// A uniform that recorded formulas can take.
fn uniform(field: &factors::FactorName) -> Option<Field> {
    let kind = match field.kind {
        ValueKind::Number => N,
        ValueKind::Vec3 => V,
        ValueKind::Vec2 | ValueKind::Vec4 | ValueKind::Mat4 => return None,
    };
    Some(Field { name: field.name, kind, doc: field.meaning })
}

const GEOMETRY: [Row; 15] = [
    ("n_geom", V, "The geometric normal: unit, on the visible side of the face."),
    ("normal", V, "The interpolated normal, not normalised."),
    ("normal_dx", V, "Its change to the next sample to the right."),
    ("normal_dy", V, "Its change to the next sample above or below."),
    ("tangent", V, "The interpolated tangent, not normalised."),
    ("handedness", N, "The sign of the bitangent, ±1."),
    ("facing", N, "The visible side: 1 for the front, −1 for the back."),
    ("v", V, "The direction to the viewer, unit."),
    ("position_dx", V, "The change of the position to the next sample to the right."),
    ("position_dy", V, "The change of the position to the next sample above or below."),
    ("du_dx", N, "The change of the height map's u to the next sample to the right."),
    ("dv_dx", N, "The change of the height map's v to the next sample to the right."),
    ("du_dy", N, "The change of the height map's u to the next sample above or below."),
    ("dv_dy", N, "The change of the height map's v to the next sample above or below."),
    ("height_width", N, "The width of the height map's finest level in texels."),
];

const FRAME: [Row; 4] = [
    ("n", V, "The shading normal; not unit for `bump-printed`."),
    ("n_smooth", V, "The normal before any map, on the visible side."),
    ("coat_n", V, "The clearcoat's normal."),
    ("tangent", V, "The direction of the anisotropy, perpendicular to the shading normal."),
];

const VALUES: [Row; 14] = [
    ("tint", V, "Base colour texture times vertex colour, linear RGB."),
    ("metallic", N, "[0, 1]."),
    ("roughness", N, "Perceptual roughness, widened by subpixel detail, [0, 1]."),
    ("specular", N, "The strength of a dielectric's reflection, [0, 1]."),
    ("specular_color", V, "Multiplies the dielectric's F0, linear RGB, at least 0."),
    ("occlusion", N, "The unoccluded fraction of the hemisphere, [0, 1]."),
    ("emissive", V, "Emitted radiance, linear RGB."),
    ("variance", N, "The variance of the normals within the pixel."),
    ("coat", N, "The fraction of the surface covered by the clearcoat, [0, 1]."),
    ("coat_roughness", N, "The clearcoat's perceptual roughness, widened, [0, 1]."),
    ("sheen_color", V, "Linear RGB in [0, 1]."),
    ("sheen_roughness", N, "The sheen's perceptual roughness, [0, 1]."),
    ("anisotropy", N, "The strength of the anisotropy, [0, 1]."),
    ("transmission", N, "The share of light that passes through a thin surface, [0, 1]."),
];

const POINT: [Row; 31] = [
    ("n", V, "The shading normal; not unit for `bump-printed`."),
    ("n_smooth", V, "The normal before any map, unit, on the visible side."),
    ("v", V, "The direction to the viewer, unit."),
    ("base_color", V, "ρ, linear RGB in [0, 1]."),
    ("metallic", N, "[0, 1]."),
    ("roughness", N, "Perceptual roughness, [0, 1]; α is its square."),
    ("f0", V, "Reflectance at normal incidence, linear RGB in [0, 1]."),
    ("f90", N, "Reflectance at grazing incidence, [0, 1]."),
    ("f82_drop", V, "Lazányi coefficient of the reflectance at 82°."),
    ("diffuse", V, "k_d or C_diff, linear RGB in [0, 1]."),
    ("specular", V, "k_s or C_spec, linear RGB in [0, 1]."),
    ("shininess", N, "Exponent of Phong and Blinn-Phong, at least 0."),
    ("slope", N, "Beckmann's rms slope m, above 0."),
    ("gain", V, "Multiplies the highlight, linear RGB, at least 1."),
    ("transmitted", N, "The fraction of light that the highlight leaves for diffuse reflection, [0, 1]."),
    ("ambient", V, "k_a, linear RGB."),
    ("emissive", V, "Emitted radiance, linear RGB."),
    ("occlusion", N, "The unoccluded fraction of the hemisphere, [0, 1]."),
    ("lobe_roughness", N, "The roughness of the GGX lobe closest to the highlight, [0, 1]."),
    ("tangent", V, "The direction of the anisotropy: unit, perpendicular to n."),
    ("bitangent", V, "Unit, perpendicular to n and tangent."),
    ("along", N, "α along the tangent, (0, 1]."),
    ("across", N, "α along the bitangent, (0, 1]."),
    ("anisotropy", N, "The strength of the anisotropy, [0, 1]."),
    ("coat_n", V, "The clearcoat's normal, unit."),
    ("coat", N, "The fraction of the surface covered by the clearcoat, [0, 1]."),
    ("coat_roughness", N, "The clearcoat's perceptual roughness, [0, 1]."),
    ("coat_albedo", N, "The fraction of uniform light that the clearcoat reflects, [0, 1]."),
    ("sheen_color", V, "The colour of the sheen, linear RGB in [0, 1]."),
    ("sheen_roughness", N, "The sheen's perceptual roughness, [0, 1]."),
    ("sheen_albedo", N, "The fraction of uniform light that white sheen reflects, [0, 1]."),
];

const LIGHT: [Row; 3] = [
    ("specular", V, "The radiance gathered by the highlight."),
    ("mean", V, "The irradiance divided by π at the shading normal."),
    ("coat", V, "The radiance gathered by the clearcoat's highlight."),
];

const TABLE_POSITION: [Row; 3] = [
    ("node", N, "The lower node, an integer: its row times 64 plus its column."),
    ("across", N, "The fraction of the way from this node to the next along the cosine, [0, 1]."),
    ("down", N, "The same along the roughness."),
];

const HIGHLIGHT: [Row; 2] =
    [("direction", V, "Unit, world space."), ("roughness", N, "The roughness of its GGX lobe, [0, 1].")];

const LIGHT_SOURCE: [Row; 7] = [
    ("place", V, "The position; the unit direction to a light infinitely far away. World space."),
    ("kind", N, "0: infinitely far; 1: no falloff; 2: inverse-square falloff."),
    ("color", V, "Intensity, or irradiance if it is infinitely far, linear RGB."),
    ("range", N, "The distance at which it fades to zero, model units."),
    ("axis", V, "The axis of its cone: unit, away from the light."),
    ("cos_inner", N, "The cosine of the angle at which the light begins to fade."),
    ("cos_outer", N, "The cosine of the angle at which it ends."),
];

const INCIDENCE: [Row; 2] = [
    ("l", V, "The unit direction to the light."),
    ("irradiance", V, "The irradiance on a plane facing it, linear RGB."),
];

const PLACE: [Row; 2] = [("u", N, "[0, 1]."), ("v", N, "[0, 1].")];

const LEVEL_POSITION: [Row; 2] = [
    ("below", N, "The index of the lower level; −1 if all are rougher."),
    ("share", N, "The weight of the upper level in the mean."),
];

const TAPS: [Row; 2] =
    [("first", N, "An integer."), ("share", N, "The fraction of the way to the next, [0, 1].")];

const PICTURE_POSITION: [Row; 6] = [
    ("left", N, "The left column."),
    ("right", N, "The right column; wraps from the last to the first."),
    ("top", N, "The upper row."),
    ("bottom", N, "The lower row."),
    ("across", N, "The weight of the right column, [0, 1]."),
    ("down", N, "The weight of the lower row, [0, 1]."),
];

/// The texture and channels of a field of `Texels`; `None` for values from vertices.
pub(crate) fn texel_source(field: &str, variant: &Variant) -> Option<(TextureRole, &'static str)> {
    let texel = Texel::named(field)?;
    Some((texel.role(variant.packed_occlusion)?, texel.channels()))
}

/// The structures of a stage as parameters of a recording; whatever the variant determines is a constant.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'g, 'v> {
    pub scope: Scope<'g>,
    pub variant: &'v Variant,
}

impl<'g> Inputs<'g, '_> {
    pub(super) fn number(self, path: &'static str) -> Recorded<'g> {
        self.scope.number(path)
    }

    pub(super) fn vector(self, path: &'static str) -> Vec3<Recorded<'g>> {
        self.scope.vector(path)
    }

    pub(super) fn constant(self, value: f64) -> Recorded<'g> {
        self.scope.constant(value)
    }

    fn number_or(self, known: bool, path: &'static str, value: f64) -> Recorded<'g> {
        if known { self.number(path) } else { self.constant(value) }
    }

    pub(super) fn vector_or(self, known: bool, path: &'static str, value: f64) -> Vec3<Recorded<'g>> {
        if known { self.vector(path) } else { Vec3::splat(self.constant(value)) }
    }

    /// The interpolated geometry; without tangents, the tangent is zero.
    pub(super) fn geometry(self) -> Geometry<Recorded<'g>> {
        Geometry {
            n_geom: self.vector("g.n_geom"),
            normal: self.vector("g.normal"),
            tangent: self.vector_or(self.variant.tangents, "g.tangent", 0.0),
            handedness: self.number_or(self.variant.tangents, "g.handedness", 1.0),
            facing: self.number("g.facing"),
            v: self.vector("g.v"),
        }
    }

    /// 1, or −1 if the surface is seen from behind and its normal turns with the side.
    pub(super) fn side(self) -> Recorded<'g> {
        self.number_or(self.variant.turns, "g.facing", 1.0)
    }

    /// The factors of the material.
    pub(super) fn uniforms(self) -> MaterialUniforms<Recorded<'g>> {
        let authored = &self.variant.authored;
        MaterialUniforms {
            base_color: self.vector("u.base_color"),
            f0: authored.f0.then(|| self.vector("u.f0")),
            f82: authored.f82.then(|| self.vector("u.f82")),
            dielectric_f0: self.number("u.dielectric_f0"),
            ambient: authored.ambient.then(|| self.vector("u.k_ambient")),
            diffuse: authored.diffuse.then(|| self.vector("u.k_diffuse")),
            specular: authored.specular.then(|| self.vector("u.k_specular")),
            slope: authored.slope.then(|| self.number("u.slope")),
            shininess: authored.shininess.then(|| self.number("u.shininess")),
        }
    }

    /// The values of the material.
    pub(super) fn values(self) -> MaterialValues<Recorded<'g>> {
        let variant = self.variant;
        MaterialValues {
            tint: self.vector_or(variant.is_tinted(), "m.tint", 1.0),
            metallic: self.number("m.metallic"),
            roughness: self.number("m.roughness"),
            specular: self.number("m.specular"),
            specular_color: self.vector("m.specular_color"),
            occlusion: self.number_or(variant.is_occluded(), "m.occlusion", 1.0),
            emissive: self.vector("m.emissive"),
            variance: self.number_or(variant.has_variance(), "m.variance", 0.0),
        }
    }

    /// The directions.
    pub(super) fn frame(self) -> Frame<Recorded<'g>> {
        Frame { n: self.vector("f.n"), smooth: self.vector("f.n_smooth"), v: self.vector("g.v") }
    }

    /// The point of the surface.
    pub(super) fn point(self) -> SurfacePoint<Recorded<'g>> {
        let frame = Frame { n: self.vector("p.n"), smooth: self.vector("p.n_smooth"), v: self.vector("p.v") };
        let material = MaterialPoint {
            sample: self.sample(),
            ambient: self.vector("p.ambient"),
            emissive: self.vector("p.emissive"),
            occlusion: self.number_or(self.variant.is_occluded(), "p.occlusion", 1.0),
        };
        SurfacePoint { shading: self.variant.shading, material, frame, layers: self.layers() }
    }

    fn sample(self) -> MaterialSample<Recorded<'g>> {
        let Variant { authored, shading, .. } = self.variant;
        let is_white = is_cook_torrance(*shading) && !authored.specular;
        MaterialSample {
            base_color: self.vector("p.base_color"),
            metallic: self.number("p.metallic"),
            roughness: self.number("p.roughness"),
            f0: self.vector("p.f0"),
            f90: self.number_or(!authored.f0, "p.f90", 1.0),
            f82_drop: self.vector_or(authored.f82, "p.f82_drop", 0.0),
            diffuse: self.vector("p.diffuse"),
            specular: self.vector_or(!is_white, "p.specular", 1.0),
            shininess: self.number("p.shininess"),
            slope: self.number("p.slope"),
            compensation: self.variant.compensated.then(|| Compensation {
                gain: self.vector("p.gain"),
                transmitted: self.number("p.transmitted"),
            }),
        }
    }

    fn layers(self) -> PointLayers<Recorded<'g>> {
        let layers = &self.variant.layers;
        PointLayers {
            anisotropic: (layers.taken && layers.anisotropy).then(|| AnisotropicLobe {
                tangent: self.vector("p.tangent"),
                bitangent: self.vector("p.bitangent"),
                along: self.number("p.along"),
                across: self.number("p.across"),
            }),
            coat: (layers.taken && layers.clearcoat).then(|| self.coat()),
            sheen: (layers.taken && layers.sheen).then(|| Sheen {
                color: self.vector("p.sheen_color"),
                roughness: self.number("p.sheen_roughness"),
                albedo: self.number("p.sheen_albedo"),
            }),
        }
    }

    pub(super) fn coat(self) -> Coat<Recorded<'g>> {
        Coat {
            n: self.vector("p.coat_n"),
            factor: self.number("p.coat"),
            roughness: self.number("p.coat_roughness"),
            albedo: self.number("p.coat_albedo"),
        }
    }

    /// The anisotropy of the highlight; bends the direction in which any model gathers the environment's light.
    pub(super) fn anisotropic(self) -> Option<Anisotropic<Recorded<'g>>> {
        self.variant.layers.anisotropy.then(|| Anisotropic {
            direction: self.vector("p.tangent"),
            strength: self.number("p.anisotropy"),
            roughness: self.number("p.roughness"),
        })
    }
}
