//! Each stage's graph matches the pixel program bit for bit, for all models, methods and layers.

use crate::direct::Direct;
use crate::random::Random;
use crate::variants::{Case, all};
use std::collections::BTreeMap;
use taotie_engine::math::Lane;
use taotie_shader::{Formula, Kind, PixelProgram, evaluate};

/// The numbers of parameters by their paths.
type Numbers<L> = BTreeMap<&'static str, Vec<L>>;

/// The paths of vectors that are directions.
fn is_direction(path: &str) -> bool {
    let names = [
        "g.n_geom",
        "g.normal",
        "g.tangent",
        "g.v",
        "f.n",
        "f.n_smooth",
        "f.coat_n",
        "f.tangent",
        "p.n",
        "p.n_smooth",
        "p.v",
        "p.tangent",
        "p.bitangent",
        "p.coat_n",
        "l",
        "g.position_dx",
        "g.position_dy",
    ];
    names.contains(&path)
}

fn numbers(random: &mut Random, formula: &Formula) -> Numbers<f64> {
    let mut numbers = Numbers::new();
    for parameter in formula.graph.parameters() {
        let mut between = || 0.02 + 0.96 * random.next();
        let values = match (parameter.path, parameter.kind) {
            ("g.facing" | "g.handedness", _) => vec![if random.next() < 0.5 { -1.0 } else { 1.0 }],
            ("u.shininess" | "p.shininess", _) => vec![200.0 * between()],
            (path, Kind::Vector) if is_direction(path) => random.unit().to_array().to_vec(),
            (_, Kind::Vector) => vec![between(), between(), between()],
            _ => vec![between()],
        };
        numbers.insert(parameter.path, values);
    }
    numbers
}

/// The outputs of a stage as evaluated from its recording.
fn played<L: Lane>(pixel: &PixelProgram, formula: &Formula, numbers: &Numbers<L>) -> Vec<L> {
    let inputs: Vec<L> =
        formula.graph.parameters().iter().flat_map(|parameter| numbers[parameter.path].clone()).collect();
    evaluate(&formula.graph, pixel.program(), &inputs).expect("the graph is sound")
}

/// The same outputs by the pixel program.
fn direct<L: Lane>(case: &Case, pixel: &PixelProgram, formula: &Formula, numbers: &Numbers<L>) -> Vec<L> {
    let like = *numbers.values().next().and_then(|values| values.first()).expect("it takes an input");
    let all = Direct { case, numbers, like }.stage(&formula.name);
    match formula.structure {
        Some(structure) => pixel.fields(structure).iter().flat_map(|field| all[field].clone()).collect(),
        None => all["result"].clone(),
    }
}

/// The bits of numbers; a zero has no sign.
fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| if *number == 0.0 { 0 } else { number.to_bits() }).collect()
}

fn check(case: &Case, random: &mut Random) {
    let pixel = PixelProgram::new(&case.variant());
    for formula in pixel.stages() {
        for _ in 0..12 {
            let double = numbers(random, formula);
            let (found, wanted) = (played(&pixel, formula, &double), direct(case, &pixel, formula, &double));
            assert_eq!(bits(&found), bits(&wanted), "{}: {}\n{double:?}", case.name, formula.name);
            let single: Numbers<f32> = double
                .iter()
                .map(|(path, values)| (*path, values.iter().map(|value| *value as f32).collect()))
                .collect();
            let wide = |numbers: Vec<f32>| bits(&numbers.iter().map(|n| f64::from(*n)).collect::<Vec<_>>());
            let (found, wanted) = (played(&pixel, formula, &single), direct(case, &pixel, formula, &single));
            assert_eq!(wide(found), wide(wanted), "{}: {}\n{single:?}", case.name, formula.name);
        }
    }
}

#[test]
fn stages_have_the_bits_of_the_pixel_program() {
    let mut random = Random(31);
    let cases = all();
    assert!(cases.len() > 9 * 6 * 2);
    cases.iter().for_each(|case| check(case, &mut random));
}

#[test]
fn every_stage_takes_part_somewhere() {
    let mut names: Vec<String> = Vec::new();
    for case in all() {
        names.extend(PixelProgram::new(&case.variant()).stages().map(|formula| formula.name.clone()));
    }
    names.sort();
    names.dedup();
    assert_eq!(names.len(), 14, "{names:?}");
}
