//! The formulas of everything fetched between stages: textures, tables, environments, lights.

use crate::program::{Formula, part};
use crate::recorder::{Recorded, Scope, record};
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    Cone, Falloff, Frame, Incidence, LightSource, Place, Turn, coat_normal, height_derivative, height_step,
    log2_texels, turned_uv,
};
use taotie_engine::shade::dfg::between_entries;
use taotie_engine::shade::environment::{
    LevelPosition, PicturePosition, bilinear, linear, octahedral_place, octahedral_taps, picture_uv,
    share_of_smoothest,
};
use taotie_engine::shade::fresnel::f_f82;

/// The formulas called by stages.
pub(super) fn parts() -> [Formula; 3] {
    [
        part("mixed", "mix", LINEAR, record(mixed)),
        part("fresnel_schlick", "f", SCHLICK, record(schlick)),
        part("towards_viewer", "n", TOWARDS_VIEWER, record(towards)),
    ]
}

/// The formulas of fetched values. Those of textures come last: they are so short that they would be matched by
/// accident.
pub(super) fn lookups() -> Vec<Formula> {
    [environment().to_vec(), lights().to_vec(), textures().to_vec()].concat()
}

fn textures() -> [Formula; 5] {
    let step = record(|scope| vec![height_step(scope.number("texels"), scope.number("size"))]);
    [
        part("log2_texels", "level", LOG2_TEXELS, record(level)),
        part("between_entries", "entry", BETWEEN_ENTRIES, record(entry)),
        part("height_derivative", "slope", HEIGHT_DERIVATIVE, record(slope)),
        part("turned", "turned", TURNED, record(turned)),
        part("height_step", "step", HEIGHT_STEP, step),
    ]
}

fn environment() -> [Formula; 7] {
    let structured = |name: &str, structure, doc, graph| Formula {
        structure: Some(structure),
        ..part(name, "position", doc, graph)
    };
    [
        part("bilinear", "mean", BILINEAR, record(four)),
        part("to_environment", "direction", TO_ENVIRONMENT, record(to_environment)),
        structured("octahedral_place", "MapPlace", PLACE, record(place)),
        structured("octahedral_taps", "Taps", TAPS, record(taps)),
        structured("level_position", "LevelPosition", LEVELS, record(levels)),
        part("share_of_smoothest", "share", SHARE, record(share)),
        structured("picture_position", "PicturePosition", PICTURE, record(picture)),
    ]
}

fn lights() -> [Formula; 2] {
    let of = |name: &str, graph| Formula {
        structure: Some("Incidence"),
        ..part(name, "arriving", INCIDENCE, graph)
    };
    let windowed = record(|scope| incidence(scope, Falloff::Windowed(scope.number("light.range"))));
    [
        of("incidence_without_falloff", record(|scope| incidence(scope, Falloff::None))),
        of("incidence_with_falloff", windowed),
    ]
}

fn schlick(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let no_drop = Vec3::splat(scope.constant(0.0));
    f_f82(scope.vector("f0"), scope.number("f90"), no_drop, scope.number("v_dot_h")).to_array().to_vec()
}

fn towards(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let (n, smooth) = (scope.vector("n"), scope.vector("n_smooth"));
    let frame = Frame { n, smooth, v: scope.vector("v") };
    coat_normal(n, &frame).to_array().to_vec()
}

fn turned(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let row = [scope.number("a"), scope.number("b")];
    let [turned, _] = turned_uv([row, row], [scope.number("u"), scope.number("v")]);
    vec![turned]
}

fn level(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let d_x = [scope.number("du_dx"), scope.number("dv_dx")];
    let d_y = [scope.number("du_dy"), scope.number("dv_dy")];
    vec![log2_texels(d_x, d_y, [scope.number("width"), scope.number("height")])]
}

fn slope(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![height_derivative(scope.number("after"), scope.number("before"), scope.number("step"))]
}

fn entry(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let corners = ["a", "b", "c", "d"].map(|name| scope.number(name));
    vec![between_entries(corners, [scope.number("across"), scope.number("down")])]
}

fn mixed(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    linear(scope.vector("a"), scope.vector("b"), scope.number("share")).to_array().to_vec()
}

fn four(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let corners = ["a", "b", "c", "d"].map(|name| scope.vector(name));
    bilinear(corners, [scope.number("across"), scope.number("down")]).to_array().to_vec()
}

fn to_environment(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let turn = Turn { sin: scope.number("turn_sin"), cos: scope.number("turn_cos") };
    turn.to_environment(scope.vector("world")).to_array().to_vec()
}

fn place(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    octahedral_place(scope.vector("direction")).to_vec()
}

fn taps(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let (first, share) = octahedral_taps(scope.number("u"), scope.number("side"));
    vec![first, share]
}

fn levels(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let LevelPosition { below, share } = LevelPosition::of(scope.number("roughness"));
    vec![below, share]
}

fn share(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    vec![share_of_smoothest(scope.number("roughness"), scope.number("alpha"))]
}

fn picture(scope: Scope<'_>) -> Vec<Recorded<'_>> {
    let uv = picture_uv(scope.number("azimuth"), scope.number("polar"));
    let at = PicturePosition::of(uv, [scope.number("width"), scope.number("height")]);
    vec![at.left, at.right, at.top, at.bottom, at.across, at.down]
}

/// The incident light at a position, from a light at a finite distance.
fn incidence<'g>(scope: Scope<'g>, falloff: Falloff<Recorded<'g>>) -> Vec<Recorded<'g>> {
    let cone = Cone {
        axis: scope.vector("light.axis"),
        cos_inner: scope.number("light.cos_inner"),
        cos_outer: scope.number("light.cos_outer"),
    };
    let light = LightSource {
        color: scope.vector("light.color"),
        place: Place::At(scope.vector("light.place")),
        falloff,
        cone: Some(cone),
    };
    let Incidence { l, irradiance } = light.incidence(scope.vector("position"));
    [l, irradiance].iter().flat_map(|vector: &Vec3<Recorded<'g>>| vector.to_array()).collect()
}

const SCHLICK: &str = "Schlick's approximation between two reflectances.
F = F0 + (F90 − F0)(1 − v·h)⁵
Source: Schlick 1994, eq. 15, with the F90 of Lagarde and de Rousiers 2014.";

const TOWARDS_VIEWER: &str = "A mapped normal that faces away from a viewer who sees the surface, turned until it is just visible: the smallest
possible change, and a continuous one; mirroring the normal would light the wrong side of every steep slope.";

const TURNED: &str =
    "One row of the linear part of a texture's transform, applied to texture coordinates or to their change.";

const LOG2_TEXELS: &str = "The log2 of the number of finest-level texels covered by the longer of a pixel's two steps: the changes of the
texture coordinates one pixel to the right and one down, in a texture of `size` texels.";

const HEIGHT_STEP: &str = "The step in u (or v) from a point to its neighbour in the current level, whose texels are as wide as `texels` of the
finest level; `size` is the size of the finest level.";

const HEIGHT_DERIVATIVE: &str =
    "The derivative of a height by u (or v), from the heights one [`height_step`] to each side.";

const BETWEEN_ENTRIES: &str = "The value of a table interpolated between four entries: the node, the next along the cosine, and the two below;
`across` and `down` in [0, 1] as in [`TablePosition`].";

const LINEAR: &str = "The mean of `a` and `b`; `share`, in [0, 1], is the weight of `b`.";

const BILINEAR: &str = "Bilinear interpolation of the upper left and right and the lower left and right texels; `across` and `down`, in [0, 1],
are the weights of the right and the lower texels.";

const TO_ENVIRONMENT: &str = "The direction `world` in the environment's local space.";

const PLACE: &str = "The position in the unfolded square, [0, 1]², of a direction of any length.
Source: Engelhardt and Dachsbacher 2008, \"Octahedron Environment Maps\".";

const TAPS: &str = "The first of the two texels around the coordinate `u` in a map of `side` texels, counted with the border, and the
fraction of the way to the next.";

const LEVELS: &str = "Finds the levels of a `roughness` in [0, 1].
Between levels light is linear in 1/α: of all functions of α, this one has the smallest error for an isolated bright texel";

const SHARE: &str = "The weight of the smoothest level, whose roughness² is `alpha`, relative to the unfiltered light, for a lower `roughness`.";

const PICTURE: &str = "The texels around a position in an equirectangular image: columns and rows, integers.
`azimuth` is atan2(z, x), in [−π, π], and `polar`
the angle from +y, in [0, π].";

const INCIDENCE: &str = "The unshadowed incident light at `position`.";
