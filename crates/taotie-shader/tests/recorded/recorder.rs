//! The content of recordings, and their inputs.

use taotie_engine::math::{Dual, Lane};
use taotie_engine::shade::microfacets::{d_beckmann, d_ggx};
use taotie_shader::{EvaluateError, Kind, Program, evaluate, library, record};

#[test]
fn nothing_is_written_twice() {
    let graph = record(|scope| {
        let (x, y) = (scope.number("x"), scope.number("y"));
        vec![(x + y) * (x + y) + x.lit(2.0) / x.lit(2.0)]
    });
    let twice = graph.nodes().iter().enumerate().any(|(i, node)| graph.nodes()[..i].contains(node));
    assert!(!twice && graph.nodes().len() == 7, "{:?}", graph.nodes());
}

#[test]
fn inputs_are_counted() {
    let program = library();
    let graph = record(|scope| vec![scope.vector("v").length(), scope.number("x")]);
    assert_eq!(graph.parameters().iter().map(|p| p.kind).collect::<Vec<_>>(), [Kind::Vector, Kind::Number]);
    assert_eq!(evaluate(&graph, &program, &[3.0, 0.0, 4.0, 7.0]), Ok(vec![5.0, 7.0]));
    let wrong = EvaluateError::Inputs { expected: 4, found: 3 };
    assert_eq!(evaluate(&graph, &program, &[3.0, 0.0, 4.0]), Err(wrong));
    let empty = record(|_| Vec::new());
    assert!(evaluate::<f64>(&empty, &program, &[]).is_err(), "constants have no type without inputs");
}

#[test]
fn derivatives_are_recorded_too() {
    let graph = record(|scope| {
        let [n_dot_h, sin2_h] = ["n_dot_h", "sin2_h"].map(|name| Dual::<_, 1>::constant(scope.number(name)));
        let width = Dual::variable(scope.number("width"), 0);
        let (ggx, beckmann) = (d_ggx(n_dot_h, sin2_h, width), d_beckmann(n_dot_h, sin2_h, width));
        vec![ggx.value, ggx.partials[0], beckmann.value, beckmann.partials[0]]
    });
    let x = [0.96, 0.0784, 0.4];
    let [n_dot_h, sin2_h] = [x[0], x[1]].map(Dual::<f64, 1>::constant);
    let width = Dual::variable(x[2], 0);
    let (ggx, beckmann) = (d_ggx(n_dot_h, sin2_h, width), d_beckmann(n_dot_h, sin2_h, width));
    let expected = vec![ggx.value, ggx.partials[0], beckmann.value, beckmann.partials[0]];
    assert_eq!(evaluate(&graph, &Program::default(), &x), Ok(expected));
}
