//! Energy compensation and environment lighting.

use crate::inputs::{self, numbers};
use crate::program::{Formula, part};
use crate::recorder::record;
use taotie_engine::names::Named;
use taotie_engine::shade::{self, Shading};

/// The energy compensation of a lobe, given its directional albedos.
pub(crate) fn compensation() -> Formula {
    let graph = record(|scope| {
        let (dfg, f0) = (inputs::dfg(scope), scope.vector("f0"));
        let c = shade::compensation(&dfg, f0, scope.number("f90"), scope.vector("f82_drop"));
        [numbers([c.gain]), vec![c.transmitted]].concat()
    });
    Formula { structure: Some("Compensation"), ..part("compensation", "c", COMPENSATION, graph) }
}

/// The environment weights of a model that follows light to its first facet.
pub(crate) fn environment_weights(shading: Shading) -> Formula {
    let graph = record(|scope| {
        let weights = shade::environment_weights(shading, &inputs::material(scope), &inputs::dfg(scope));
        numbers([weights.specular, weights.diffuse])
    });
    let name = format!("environment_weights_{}", shading.name().replace('-', "_"));
    Formula { structure: Some("EnvironmentWeights"), ..part(&name, "weights", WEIGHTS, graph) }
}

const COMPENSATION: &str =
    "The compensation of a lobe whose directional albedos are `dfg`, for Schlick's Fresnel factor between `f0` and `f90`
Source: Turquin 2019, \"Practical multiple scattering compensation for microfacet models\", eq. 16";

const WEIGHTS: &str = "The weights for a material sample with the directional albedos `dfg` of its lobe.
Source: Karis 2013; the article's environment term.";
