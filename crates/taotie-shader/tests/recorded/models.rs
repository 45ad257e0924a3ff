//! The models in all directions and at the ends of their ranges, and what their graphs are made of.

use crate::random::Random;
use std::path::{Path, PathBuf};
use taotie::math::{Lane, Vec3};
use taotie::names::Named;
use taotie::shade::{Angles, MaterialSample, Shading, reflect};
use taotie_shader::{EvaluateError, Graph, Node, evaluate, library, model_name};

/// The numbers of a material sample, and of the angles.
const MATERIAL: usize = 20;
const ANGLES: usize = 6;

fn material<L: Lane>(x: &[L]) -> MaterialSample<L> {
    let vector = |at: usize| Vec3::new(x[at], x[at + 1], x[at + 2]);
    MaterialSample {
        base_color: vector(0),
        metallic: x[3],
        roughness: x[4],
        f0: vector(5),
        f90: x[8],
        f82_drop: vector(9),
        diffuse: vector(12),
        specular: vector(15),
        shininess: x[18],
        slope: x[19],
        compensation: None,
    }
}

fn angles<L: Lane>(a: &Angles<L>) -> [L; ANGLES] {
    [a.n_dot_l, a.n_dot_v, a.n_dot_h, a.sin2_h, a.v_dot_h, a.r_dot_v]
}

/// n, v, l of all directions and a material; every eighth at the ends of its ranges.
fn inputs(random: &mut Random, i: usize) -> ([f64; 9], [f64; MATERIAL]) {
    let [n, v, mut l] = std::array::from_fn(|_| random.unit());
    if i % 4 == 1 {
        l = (n * (2.0 * n.dot(v)) - v + random.vector() * 1e-3).normalize();
    }
    if i % 32 == 2 {
        l = -v;
    }
    let directions = [n.to_array(), v.to_array(), l.to_array()].concat();
    let mut x = [0.0; MATERIAL];
    x.fill_with(|| if i % 8 == 3 { random.next().round() } else { random.next() });
    x[18] *= 500.0;
    (std::array::from_fn(|k| directions[k]), x)
}

fn vectors<L: Lane>(x: &[L; 9]) -> Angles<L> {
    let [n, v, l] = [0, 3, 6].map(|at| Vec3::new(x[at], x[at + 1], x[at + 2]));
    Angles::new(n, v, l)
}

/// The results of the formulas themselves: the angles, and the light of each model.
fn direct<L: Lane>(directions: &[L; 9], x: &[L; MATERIAL]) -> ([L; ANGLES], Vec<[L; 3]>) {
    let a = vectors(directions);
    let lit = Shading::NAMES.iter().map(|(_, shading)| reflect(*shading, &material(x), &a).to_array());
    (angles(&a), lit.collect())
}

/// The results of the recorded graphs for the same.
fn played<L: Lane>(directions: &[L; 9], x: &[L; MATERIAL]) -> ([L; ANGLES], Vec<[L; 3]>) {
    let program = library();
    let graph = |name: &str| &program.find(name).unwrap_or_else(|| panic!("{name} is missing")).graph;
    let a: [L; ANGLES] = to_array(evaluate(graph("angles"), &program, directions));
    let inputs = [&x[..], &a].concat();
    let lit = Shading::NAMES
        .iter()
        .map(|(_, shading)| to_array(evaluate(graph(&model_name(*shading)), &program, &inputs)));
    (a, lit.collect())
}

fn to_array<L, const N: usize>(numbers: Result<Vec<L>, EvaluateError>) -> [L; N] {
    let numbers = numbers.expect("the graph is sound");
    numbers.try_into().unwrap_or_else(|numbers: Vec<L>| panic!("{} outputs for {N}", numbers.len()))
}

#[test]
fn graphs_have_the_bits_of_the_formulas_in_double_precision() {
    let mut random = Random(17);
    for i in 0..300 {
        let (directions, x) = inputs(&mut random, i);
        let (expected, found) = (direct(&directions, &x), played(&directions, &x));
        let bits = |(a, lit): &([f64; ANGLES], Vec<[f64; 3]>)| {
            a.iter().chain(lit.iter().flatten()).map(|number| number.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&found), bits(&expected), "case {i}: {found:?} for {expected:?}");
    }
}

#[test]
fn graphs_have_the_bits_of_the_formulas_in_single_precision() {
    let mut random = Random(18);
    for i in 0..300 {
        let (directions, x) = inputs(&mut random, i);
        let (directions, x) = (directions.map(|d| d as f32), x.map(|x| x as f32));
        let (expected, found) = (direct(&directions, &x), played(&directions, &x));
        let bits = |(a, lit): &([f32; ANGLES], Vec<[f32; 3]>)| {
            a.iter().chain(lit.iter().flatten()).map(|number| number.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&found), bits(&expected), "case {i}: {found:?} for {expected:?}");
    }
}

/// The names of the functions that a formula calls.
fn called(graph: &Graph) -> Vec<String> {
    let program = library();
    let name = |node: &Node| match node {
        Node::Call(call) => Some(program.formulas()[call.function].name.clone()),
        _ => None,
    };
    graph.nodes().iter().filter_map(name).collect()
}

#[test]
fn models_call_their_parts_and_work_on_vectors() {
    let program = library();
    let of = |shading| {
        let mut names = called(&program.find(&model_name(shading)).expect("it is there").graph);
        names.sort();
        names
    };
    assert_eq!(of(Shading::CookTorrance), ["distribution_beckmann", "fresnel", "masking_v_cavity"]);
    assert_eq!(
        of(Shading::Ggx),
        ["alpha_from_roughness", "distribution_ggx", "fresnel", "visibility_smith_ggx"]
    );
    assert_eq!(called(&program.find("fresnel").expect("it is there").graph), ["pow5"]);
    let angles = &program.find("angles").expect("it is there").graph;
    let has = |test: fn(&Node) -> bool| angles.nodes().iter().any(test);
    assert!(has(|node| matches!(node, Node::Cross(..))) && has(|node| matches!(node, Node::Dot(..))));
    assert!(!has(|node| matches!(node, Node::Component(..))), "{angles:?}");
}

/// The text of all Rust files below a folder.
fn sources(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).expect("the folder is readable");
    let paths = entries.map(|entry| entry.expect("the folder is readable").path());
    let text = |path: PathBuf| {
        if path.is_dir() { sources(&path) } else { std::fs::read_to_string(&path).expect("it is text") }
    };
    paths.map(text).collect()
}

#[test]
fn documentation_stands_where_the_formula_does() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../taotie/src");
    let text = ["shade", "math"].map(|module| sources(&folder.join(module))).concat();
    // A sentence may run over two lines there.
    let text = text.replace("\n/// ", " ").replace("\n    /// ", " ");
    for formula in library().formulas() {
        assert!(!formula.doc.is_empty(), "{}", formula.name);
        for line in formula.doc.lines() {
            assert!(text.contains(line), "{}: not in taotie's source: {line}", formula.name);
        }
    }
}
