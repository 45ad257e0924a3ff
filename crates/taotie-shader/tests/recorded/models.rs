//! The models in all directions and at the ends of their ranges, and the content of their graphs.

use crate::numbers::{Inputs, bits, cosines};
use crate::random::Random;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use taotie_engine::math::Lane;
use taotie_engine::names::Named;
use taotie_engine::shade::{Angles, Shading, reflect};
use taotie_shader::{Graph, Node, Program, evaluate, library, model_name};

/// The number of scalars in a material sample.
const MATERIAL: usize = 20;

/// n, v, l in all directions and a material; every eighth at the ends of its ranges.
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

/// The angles, and the light of each model, computed by the formulas themselves.
fn direct<L: Lane>(directions: &[L; 9], x: &[L; MATERIAL]) -> Vec<L> {
    let mut nvl = Inputs::of(directions);
    let a = Angles::new(nvl.vector(), nvl.vector(), nvl.vector());
    let s = Inputs::of(x).material();
    let lit = Shading::NAMES.iter().flat_map(|(_, shading)| reflect(*shading, &s, &a).to_array());
    cosines(&a).into_iter().chain(lit).collect()
}

/// The same by the recorded graphs.
fn played<L: Lane>(program: &Program, directions: &[L; 9], x: &[L; MATERIAL]) -> Vec<L> {
    let play = |name: &str, inputs: &[L]| {
        let formula = program.find(name).unwrap_or_else(|| panic!("{name} is missing"));
        evaluate(&formula.graph, program, inputs).expect("the graph is sound")
    };
    let angles = play("angles", directions);
    let inputs = [&x[..], &angles].concat();
    let lit = Shading::NAMES.iter().flat_map(|(_, shading)| play(&model_name(*shading), &inputs));
    angles.iter().copied().chain(lit).collect()
}

/// Compares the graphs with the formulas.
fn check<L: Lane + Into<f64> + Debug>(program: &Program, directions: &[L; 9], x: &[L; MATERIAL]) {
    let (expected, found) = (direct(directions, x), played(program, directions, x));
    assert_eq!(bits(&found), bits(&expected), "{directions:?}, {x:?}: {found:?} for {expected:?}");
}

#[test]
fn graphs_have_the_bits_of_the_formulas_in_double_precision() {
    let (program, mut random) = (library(), Random(17));
    for i in 0..300 {
        let (directions, x) = inputs(&mut random, i);
        check(&program, &directions, &x);
    }
}

#[test]
fn graphs_have_the_bits_of_the_formulas_in_single_precision() {
    let (program, mut random) = (library(), Random(18));
    for i in 0..300 {
        let (directions, x) = inputs(&mut random, i);
        check(&program, &directions.map(|d| d as f32), &x.map(|x| x as f32));
    }
}

/// The names of the functions that a formula calls.
fn called(program: &Program, graph: &Graph) -> Vec<String> {
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
        let mut names = called(&program, &program.find(&model_name(shading)).expect("it exists").graph);
        names.sort();
        names
    };
    assert_eq!(of(Shading::CookTorrance), ["distribution_beckmann", "fresnel", "masking_v_cavity"]);
    assert_eq!(
        of(Shading::Ggx),
        ["alpha_from_roughness", "distribution_ggx", "fresnel", "visibility_smith_ggx"]
    );
    assert_eq!(called(&program, &program.find("fresnel").expect("it exists").graph), ["pow5"]);
    let angles = &program.find("angles").expect("it exists").graph;
    let has = |test: fn(&Node) -> bool| angles.nodes().iter().any(test);
    assert!(has(|node| matches!(node, Node::Cross(..))) && has(|node| matches!(node, Node::Dot(..))));
    assert!(!has(|node| matches!(node, Node::Component(..))), "{angles:?}");
}

/// The text of all Rust files below a folder.
fn sources(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).expect("the folder is readable");
    let paths = entries.map(|entry| entry.expect("the folder is readable").path());
    let text = |path: PathBuf| {
        if path.is_dir() { sources(&path) } else { std::fs::read_to_string(&path).expect("it is UTF-8") }
    };
    paths.map(text).collect()
}

#[test]
fn documentation_stands_where_the_formula_does() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../taotie-engine/src");
    let text = ["shade", "math"].map(|module| sources(&folder.join(module))).concat();
    // There, a sentence may be wrapped over two lines.
    let text = text.replace("\n/// ", " ").replace("\n    /// ", " ");
    for formula in library().formulas() {
        assert!(!formula.doc.is_empty(), "{}", formula.name);
        for line in formula.doc.lines() {
            assert!(text.contains(line), "{}: not in taotie's source: {line}", formula.name);
        }
    }
}
