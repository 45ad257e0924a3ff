//! Every formula of the library matches the formula itself bit for bit.

use crate::numbers::{Inputs, bits, cosines};
use crate::random::Random;
use std::fmt::Debug;
use taotie_engine::math::{Lane, Vec3};
use taotie_engine::names::Named;
use taotie_engine::shade::sampling::mirrored;
use taotie_engine::shade::{
    Angles, Compensation, Shading, SubPixelVariance, coat_fresnel, coat_lobe, compensation,
    curvature_variance, environment_weights, fresnel, lights, microfacets, reflect, sheen,
    specular_occlusion,
};
use taotie_shader::{Formula, Graph, Kind, Program, evaluate, library};

fn shading(name: &str) -> Shading {
    Shading::from_name(&name.replace('_', "-")).expect("the model has this name")
}

fn vectors<L: Lane>(vectors: &[Vec3<L>]) -> Vec<L> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

/// The result of the formula with this name, computed directly.
fn direct<L: Lane>(name: &str, numbers: &[L]) -> Vec<L> {
    let mut x = Inputs::of(numbers);
    if let Some(model) = name.strip_prefix("environment_weights_") {
        let weights = environment_weights(shading(model), &x.material(), &x.dfg());
        return vectors(&[weights.specular, weights.diffuse]);
    }
    if let Some(model) = name.strip_prefix("reflect_") {
        let (mut s, a) = (x.material(), x.angles());
        let single = model.strip_suffix("_compensated");
        s.compensation = single.map(|_| Compensation { gain: x.vector(), transmitted: x.number() });
        return vectors(&[reflect(shading(single.unwrap_or(model)), &s, &a)]);
    }
    structured(name, &mut x).unwrap_or_else(|| vec![number(name, &mut x)])
}

/// The formulas of vectors.
fn structured<L: Lane>(name: &str, x: &mut Inputs<'_, L>) -> Option<Vec<L>> {
    match name {
        "fresnel" => Some(vectors(&[fresnel::f_f82(x.vector(), x.number(), x.vector(), x.number())])),
        "compensation" => {
            let c = compensation(&x.dfg(), x.vector(), x.number(), x.vector());
            Some([vectors(&[c.gain]), vec![c.transmitted]].concat())
        }
        "angles" => Some(cosines(&Angles::new(x.vector(), x.vector(), x.vector())).to_vec()),
        "anisotropic_lobe" => {
            let lobe = x.anisotropic();
            Some(vec![lobe.lobe(&x.angles(), x.vector(), x.vector())])
        }
        "normalize_or" => Some(vectors(&[x.vector().normalize_or(x.vector())])),
        "mirrored" => Some(vectors(&[mirrored(x.vector(), x.vector())])),
        "curvature_variance" => Some(vec![curvature_variance(x.vector(), x.vector())]),
        "coat_lobe" => Some(vec![coat_lobe(x.number(), &x.angles())]),
        "widened_roughness" => {
            let roughness = x.number();
            let variance = SubPixelVariance { curvature: x.number(), normal_variance: x.number() };
            Some(vec![variance.widened(roughness)])
        }
        _ => None,
    }
}

/// The formulas of numbers.
fn number<L: Lane>(name: &str, x: &mut Inputs<'_, L>) -> L {
    match name {
        "pow5" => fresnel::pow5(x.number()),
        "alpha_from_roughness" => microfacets::alpha_from_roughness(x.number()),
        "masking_v_cavity" => microfacets::g_v_cavity(x.number(), x.number(), x.number(), x.number()),
        "visibility_smith_ggx" => microfacets::v_smith_ggx(x.number(), x.number(), x.number()),
        "masking_schlick" => microfacets::g1_schlick_ggx(x.number(), x.number()),
        "masking_k_for_lights" => microfacets::k_for_lights(x.number()),
        "distribution_beckmann" => microfacets::d_beckmann(x.number(), x.number(), x.number()),
        "distribution_ggx" => microfacets::d_ggx(x.number(), x.number(), x.number()),
        "coat_fresnel" => coat_fresnel(x.number()),
        "distribution_charlie" => sheen::d_charlie(x.number(), x.number()),
        "visibility_neubelt" => sheen::v_neubelt(x.number(), x.number()),
        "specular_occlusion" => specular_occlusion(x.number(), x.number(), x.number()),
        "divergence_ggx" => microfacets::divergence_ggx(x.number()),
        "alpha_squared_from_divergence_ggx" => microfacets::alpha_squared_from_divergence_ggx(x.number()),
        "inverse_square" => lights::inverse_square(x.number()),
        "range_window" => lights::range_window(x.number(), x.number()),
        "spot_cone" => lights::spot_cone(x.number(), x.number(), x.number()),
        "fresnel_dielectric" => fresnel::f_dielectric(x.number(), x.number()),
        "fresnel_conductor" => fresnel::f_conductor(x.number(), x.number(), x.number()),
        _ => panic!("{name} has no counterpart here: add it"),
    }
}

/// A random number for each scalar of the parameters.
fn inputs(random: &mut Random, graph: &Graph) -> Vec<f64> {
    let count = |kind| if kind == Kind::Vector { 3 } else { 1 };
    let all = graph.parameters().iter().map(|parameter| count(parameter.kind)).sum();
    (0..all).map(|_| 0.02 + 0.96 * random.next()).collect()
}

/// Compares a formula's graph with the formula itself.
fn check<L: Lane + Into<f64> + Debug>(formula: &Formula, program: &Program, x: &[L]) {
    let found = evaluate(&formula.graph, program, x).expect("the graph is sound");
    assert_eq!(bits(&found), bits(&direct(&formula.name, x)), "{} of {x:?}", formula.name);
}

#[test]
fn every_formula_has_its_own_bits() {
    let (program, mut random) = (library(), Random(23));
    for formula in program.formulas() {
        for _ in 0..100 {
            let x = inputs(&mut random, &formula.graph);
            check(formula, &program, &x);
            check(formula, &program, &x.iter().map(|x| *x as f32).collect::<Vec<_>>());
        }
    }
}
