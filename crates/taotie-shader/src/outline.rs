//! Finds a function's body in a graph, and calls the function instead.
//!
//! Nodes are never written twice, so where a formula used the function its body stands as it was recorded, with the
//! arguments in the parameters' places.

use crate::graph::{Call, Graph, Id, Kind, Node};
use rustc_hash::FxHashMap;

/// A function to look for: its number in the program and its body, of one output.
#[derive(Clone, Copy)]
pub(crate) struct Function<'f> {
    pub(crate) number: usize,
    pub(crate) body: &'f Graph,
}

/// The graph with a call wherever the function's body stands.
pub(crate) fn with_calls(graph: &Graph, function: Function<'_>) -> Graph {
    let mut called = Graph::of(graph.parameters());
    let mut moved: Vec<Id> = Vec::with_capacity(graph.nodes().len());
    for node in graph.nodes() {
        let id = called.add(node.with(|operand| moved[operand.0]));
        let id = call(&mut called, id, function).unwrap_or(id);
        moved.push(id);
    }
    called.outputs = graph.outputs().iter().map(|output| moved[output.0]).collect();
    called.pruned()
}

/// The call that gives what `id` is, if it is the function's output.
fn call(graph: &mut Graph, id: Id, function: Function<'_>) -> Option<Id> {
    let [output] = function.body.outputs()[..] else { return None };
    if graph.kind(id) != function.body.kind(output) {
        return None;
    }
    let mut bound = FxHashMap::default();
    if !matches(graph, id, &mut Pattern { body: function.body, at: output, bound: &mut bound }) {
        return None;
    }
    let arguments = arguments(graph, function.body, &bound)?;
    let result = function.body.kind(output);
    Some(graph.add(Node::Call(Call { function: function.number, result, arguments })))
}

/// A node of a function's body, and what of the body is found already.
struct Pattern<'p> {
    body: &'p Graph,
    at: Id,
    bound: &'p mut FxHashMap<Id, Id>,
}

/// Says whether `id` is the pattern with values in the parameters' places.
fn matches(graph: &Graph, id: Id, pattern: &mut Pattern<'_>) -> bool {
    if let Some(known) = pattern.bound.get(&pattern.at) {
        return *known == id;
    }
    let (own, other) = (pattern.body.node(pattern.at), graph.node(id));
    let fits = match own {
        Node::Parameter(_) => graph.kind(id) != Kind::Truth,
        _ => shape(own) == shape(other) && operands_match(graph, (own, other), pattern),
    };
    if fits {
        pattern.bound.insert(pattern.at, id);
    }
    fits
}

fn operands_match(graph: &Graph, (own, other): (&Node, &Node), pattern: &mut Pattern<'_>) -> bool {
    own.operands().into_iter().zip(other.operands()).all(|(at, id)| {
        let mut operand = Pattern { body: pattern.body, at, bound: &mut *pattern.bound };
        matches(graph, id, &mut operand)
    })
}

/// The operation without its operands.
fn shape(node: &Node) -> Node {
    node.with(|_| Id(0))
}

/// The values in the parameters' places; numbers widened to vectors where the function takes these.
fn arguments(graph: &mut Graph, body: &Graph, bound: &FxHashMap<Id, Id>) -> Option<Vec<Id>> {
    let mut arguments = Vec::new();
    for (number, parameter) in body.parameters().iter().enumerate() {
        let at = body.nodes().iter().position(|node| *node == Node::Parameter(number))?;
        let value = *bound.get(&Id(at))?;
        arguments.push(match (parameter.kind, graph.kind(value)) {
            (Kind::Vector, Kind::Number) => graph.add(Node::Vector([value; 3])),
            (Kind::Number, Kind::Vector) => return None,
            _ => value,
        });
    }
    Some(arguments)
}
