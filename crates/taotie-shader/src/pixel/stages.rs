//! The stages of a variant's pixel, in the order in which they run.

use super::inputs::Inputs;
use super::points::has_coat;
use crate::graph::Graph;
use crate::program::{Formula, part};
use crate::recorder::{Callee, Recorded, record};
use crate::variant::{Alpha, Variant};
use taotie_engine::pixel::takes_albedos;

/// A recorded stage, and what it feeds.
pub(super) struct Stage {
    pub formula: Formula,
    pub feeds: Feeds,
}

/// The consumer of a stage's result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Feeds {
    /// The pixel's own colour or opacity.
    Pixel,
    /// Stages that take its structure.
    Structure,
    /// Stages that take this argument, or this field of one, which is looked up at the result of the stage.
    Path(&'static str),
}

/// The stages of a variant; `angles` is the index of that function.
pub(super) fn stages(variant: &Variant, angles: &Callee<'_>) -> Vec<Stage> {
    let mut stages = Vec::new();
    if variant.alpha != Alpha::Opaque {
        stages.push(stage(variant, ALPHA, |inputs| vec![inputs.alpha()]));
    }
    if variant.unlit {
        stages.push(stage(variant, UNLIT, |inputs| inputs.unlit()));
        return stages;
    }
    stages.push(stage(variant, FRAME, |inputs| inputs.shading_frame()));
    stages.push(stage(variant, VALUES, |inputs| inputs.material_values()));
    stages.extend(tables(variant));
    stages.push(stage(variant, POINT, |inputs| inputs.surface_point()));
    if variant.environment {
        stages.push(stage(variant, HIGHLIGHT, |inputs| inputs.highlight()));
        stages.extend(
            has_coat(variant).then(|| stage(variant, COAT_HIGHLIGHT, |inputs| inputs.coat_highlight())),
        );
        stages.push(stage(variant, ENVIRONMENT, |inputs| inputs.reflect_environment()));
    }
    stages.push(stage(variant, OWN, |inputs| inputs.own()));
    let graph = record(|scope| Inputs { scope, variant }.reflect_light(angles));
    stages.push(of(LIGHT, graph));
    stages
}

/// The stages that compute lookup positions in tables.
fn tables(variant: &Variant) -> Vec<Stage> {
    let mut tables = Vec::new();
    if takes_albedos(variant.shading) {
        tables.push(stage(variant, ALBEDO, |inputs| inputs.albedo_position()));
    }
    if has_coat(variant) {
        tables.push(stage(variant, COAT_ALBEDO, |inputs| inputs.coat_position()));
    }
    if variant.layers.taken && variant.layers.sheen {
        tables.push(stage(variant, SHEEN_ALBEDO, |inputs| inputs.sheen_position()));
    }
    tables
}

/// A stage's name, the name of its result, its structure, what it feeds, and its documentation.
#[derive(Clone, Copy)]
struct Title {
    name: &'static str,
    symbol: &'static str,
    structure: Option<&'static str>,
    feeds: Feeds,
    doc: &'static str,
}

fn stage(
    variant: &Variant,
    title: Title,
    run: impl for<'g> Fn(Inputs<'g, '_>) -> Vec<Recorded<'g>>,
) -> Stage {
    of(title, record(|scope| run(Inputs { scope, variant })))
}

fn of(title: Title, graph: Graph) -> Stage {
    let Title { name, symbol, structure, feeds, doc } = title;
    Stage { formula: Formula { structure, ..part(name, symbol, doc, graph) }, feeds }
}

const ALPHA: Title = Title {
    name: "opacity",
    symbol: "alpha",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Opacity, [0, 1]: factor, texture and vertex colour.",
};

const UNLIT: Title = Title {
    name: "unlit_color",
    symbol: "color",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "The colour of an unlit surface, linear RGB.
Source: KHR_materials_unlit.",
};

const FRAME: Title = Title {
    name: "shading_frame",
    symbol: "f",
    structure: Some("ShadingFrame"),
    feeds: Feeds::Structure,
    doc: "The shading normal, by the method of the surface, and the other directions at a point.
Source: Mikkelsen 2008 and 2020.",
};

const VALUES: Title = Title {
    name: "material_values",
    symbol: "m",
    structure: Some("MaterialValues"),
    feeds: Feeds::Structure,
    doc: "The values of the material: textures times factors, roughness widened by subpixel detail.
Source: glTF 2.0, §3.9; Tokuyoshi and Kaplanyan 2019; Toksvig 2005.",
};

const ALBEDO: Title = Title {
    name: "albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("dfg"),
    doc: "The position at which the table of the lobe's directional albedos is sampled.",
};

const COAT_ALBEDO: Title = Title {
    name: "coat_albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("coat_dfg"),
    doc: "The position at which the table of GGX is sampled for the clearcoat.",
};

const SHEEN_ALBEDO: Title = Title {
    name: "sheen_albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("sheen_table"),
    doc: "The position at which the sheen's table is sampled.",
};

const POINT: Title = Title {
    name: "surface_point",
    symbol: "p",
    structure: Some("SurfacePoint"),
    feeds: Feeds::Structure,
    doc: "Everything that reflection depends on.
Source: glTF 2.0, appendix B; KHR_materials_ior; KHR_materials_specular; Turquin 2019 for compensation.",
};

const HIGHLIGHT: Title = Title {
    name: "highlight",
    symbol: "highlight",
    structure: Some("Highlight"),
    feeds: Feeds::Path("e.specular"),
    doc: "The highlight of the base that gathers the environment's light.
Source: McAuley 2015, \"Rendering the World of Far Cry 4\", for anisotropy.",
};

const COAT_HIGHLIGHT: Title = Title {
    name: "coat_highlight",
    symbol: "highlight",
    structure: Some("Highlight"),
    feeds: Feeds::Path("e.coat"),
    doc: "The highlight of the clearcoat that gathers the environment's light.",
};

const ENVIRONMENT: Title = Title {
    name: "reflect_environment",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Radiance to the viewer from the environment, linear RGB.
Source: Karis 2013, \"Real Shading in Unreal Engine 4\", the split sum; Lagarde and de Rousiers 2014 for occlusion.",
};

const OWN: Title = Title {
    name: "own_radiance",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Emission and reflection of the `ambient` light, linear RGB.",
};

const LIGHT: Title = Title {
    name: "reflect_light",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Radiance to the viewer per unit of irradiance on a plane facing the light in direction `l` (unit, world
space), linear RGB: f · n·l.",
};
