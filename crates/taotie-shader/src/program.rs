//! Formulas that call one another, and the structures passed between them.

use crate::graph::{Call, Graph, Id, Kind, Node, Parameter};
use crate::vectors::with_vectors;
use rustc_hash::FxHashMap;

/// A formula as a function: its graph and its documentation.
#[derive(Debug, Clone)]
pub struct Formula {
    /// Its name in the shader.
    pub name: String,
    /// The name of its result in calls, in the notation of the field: `d`, `alpha`.
    pub symbol: &'static str,
    /// Its documentation: meaning, formula, ranges, units and source, line by line.
    pub doc: &'static str,
    /// The structure that it returns, with the outputs as fields; `None` for a number or a vector.
    pub structure: Option<&'static str>,
    /// Its expression graph.
    pub graph: Graph,
}

/// A formula that returns a number or a vector.
pub(crate) fn part(name: &str, symbol: &'static str, doc: &'static str, graph: Graph) -> Formula {
    Formula { name: name.into(), symbol, doc, structure: None, graph }
}

impl Formula {
    /// Returns true if it returns no structure, so that calls of it can be found in other formulas.
    fn is_found(&self) -> bool {
        self.structure.is_none()
    }
}

/// Formulas, each of which calls only earlier ones.
#[derive(Debug, Clone, Default)]
pub struct Program {
    pub(crate) formulas: Vec<Formula>,
    pub(crate) structures: Vec<Structure>,
}

impl Program {
    /// Adds a recorded formula: with vectors for equal channels, and calls of the formulas already in the program.
    pub(crate) fn add(&mut self, mut formula: Formula) {
        let kinds = match formula.structure {
            Some(structure) => self.structure(structure).map(Structure::layout).unwrap_or_default(),
            None if formula.graph.outputs().len() == 3 => vec![Kind::Vector],
            None => vec![Kind::Number; formula.graph.outputs().len()],
        };
        formula.graph = with_vectors(&formula.graph, &kinds);
        let functions = self.formulas.iter().enumerate();
        for (number, function) in functions.filter(|(_, function)| function.is_found()) {
            if let Some(graph) = with_calls(&formula.graph, Function { number, body: &function.graph }) {
                formula.graph = graph;
            }
        }
        self.formulas.push(formula);
    }

    /// The structure with this name.
    pub(crate) fn structure(&self, name: &str) -> Option<&Structure> {
        self.structures.iter().find(|structure| structure.name == name)
    }

    /// The structure that is the type of arguments with this name.
    pub(crate) fn structure_of(&self, argument: &str) -> Option<&Structure> {
        self.structures.iter().find(|structure| structure.arguments.contains(&argument))
    }

    /// The formulas; a call refers to one by its index here.
    pub fn formulas(&self) -> &[Formula] {
        &self.formulas
    }

    /// The formula with this name.
    pub fn find(&self, name: &str) -> Option<&Formula> {
        self.formulas.iter().find(|formula| formula.name == name)
    }

    /// The formulas with these names and all that they call, in the order of the program.
    pub(crate) fn needed(&self, names: &[&str]) -> Vec<&Formula> {
        let mut needed: Vec<bool> =
            self.formulas.iter().map(|formula| names.contains(&formula.name.as_str())).collect();
        for (at, formula) in self.formulas.iter().enumerate().rev() {
            let used = needed[at];
            formula.graph.called().for_each(|function| needed[function] |= used);
        }
        self.formulas.iter().zip(needed).filter_map(|(formula, needed)| needed.then_some(formula)).collect()
    }
}

/// A structure: its type name, its documentation, the arguments of this type, and its fields.
#[derive(Debug, Clone)]
pub(crate) struct Structure {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) arguments: &'static [&'static str],
    pub(crate) fields: Vec<Field>,
}

/// A field of a structure: its name, its type, and its meaning with range and unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) doc: &'static str,
}

impl Structure {
    /// The types of the fields.
    pub(crate) fn layout(&self) -> Vec<Kind> {
        self.fields.iter().map(|field| field.kind).collect()
    }
}

/// A function to look for: its index in the program and its body, which has one output.
#[derive(Clone, Copy)]
struct Function<'f> {
    number: usize,
    body: &'f Graph,
}

/// Returns the graph with every occurrence of the function's body replaced by a call; `None` if there is none.
///
/// Nodes are never stored twice, so if a formula used the function, the recorded body appears in its graph, with the
/// arguments in place of the parameters.
fn with_calls(graph: &Graph, function: Function<'_>) -> Option<Graph> {
    let is_output = |at| bound(graph, Id(at), function.body).is_some();
    if !(0..graph.nodes().len()).any(is_output) {
        return None;
    }
    let mut called = Graph::of(graph.parameters());
    let mut moved: Vec<Id> = Vec::with_capacity(graph.nodes().len());
    for node in graph.nodes() {
        let id = called.add(node.with(|operand| moved[operand.0]));
        let id = call(&mut called, id, function).unwrap_or(id);
        moved.push(id);
    }
    called.outputs = graph.outputs().iter().map(|output| moved[output.0]).collect();
    Some(called.pruned())
}

/// The call that computes the value of `id`, if `id` is the function's output.
fn call(graph: &mut Graph, id: Id, function: Function<'_>) -> Option<Id> {
    let bound = bound(graph, id, function.body)?;
    let result = function.body.kind(*function.body.outputs().first()?);
    let arguments = arguments(graph, function.body, &bound)?;
    Some(graph.add(Node::Call(Call { function: function.number, result, arguments })))
}

/// Returns the values in place of a function's nodes if `id` is its output.
fn bound(graph: &Graph, id: Id, body: &Graph) -> Option<FxHashMap<Id, Id>> {
    let [output] = body.outputs()[..] else { return None };
    if graph.kind(id) != body.kind(output) || shape(graph.node(id)) != shape(body.node(output)) {
        return None;
    }
    let mut bound = FxHashMap::default();
    matches(graph, id, &mut Pattern { body, at: output, bound: &mut bound }).then_some(bound)
}

/// A node of a function's body, and the nodes of the body found so far.
struct Pattern<'p> {
    body: &'p Graph,
    at: Id,
    bound: &'p mut FxHashMap<Id, Id>,
}

/// Returns true if `id` matches the pattern, with any values in place of the parameters.
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

/// The values of the parameters; scalars are widened to vectors if the function takes vectors. A structure is
/// recovered from the values of its fields.
fn arguments(graph: &mut Graph, body: &Graph, bound: &FxHashMap<Id, Id>) -> Option<Vec<Id>> {
    let mut arguments = Arguments { graph, given: Vec::new() };
    for (number, parameter) in body.parameters().iter().enumerate() {
        let at = body.nodes().iter().position(|node| *node == Node::Parameter(number));
        let value = at.and_then(|at| bound.get(&Id(at)).copied());
        arguments.add(parameter, value)?;
    }
    arguments.given.into_iter().map(|(_, value)| value).collect()
}

/// The arguments of a call, by name.
struct Arguments<'g> {
    graph: &'g mut Graph,
    given: Vec<(&'static str, Option<Id>)>,
}

impl Arguments<'_> {
    /// Adds the value of a parameter; `None` if its type does not match. The function must not read a structure's
    /// field.
    fn add(&mut self, parameter: &Parameter, value: Option<Id>) -> Option<()> {
        let Some((argument, field)) = parameter.path.split_once('.') else {
            let value = self.fitting(parameter.kind, value?)?;
            self.given.push((parameter.path, Some(value)));
            return Some(());
        };
        let of = match value {
            Some(value) => Some(self.structure(field, value)?),
            None => None,
        };
        let known = self.given.iter_mut().find(|(name, _)| *name == argument);
        match (known, of) {
            (None, _) => self.given.push((argument, of)),
            (Some((_, Some(known))), Some(of)) if *known != of => return None,
            (Some((_, known)), Some(of)) => *known = Some(of),
            (Some(_), None) => {}
        }
        Some(())
    }

    /// The structure whose field `value` is; `None` if it is not a field.
    fn structure(&self, field: &str, value: Id) -> Option<Id> {
        match self.graph.node(value) {
            Node::Field(of, found) if found.name == field => Some(*of),
            _ => None,
        }
    }

    /// The value converted to this type.
    fn fitting(&mut self, kind: Kind, value: Id) -> Option<Id> {
        match (kind, self.graph.kind(value)) {
            (Kind::Vector, Kind::Number) => Some(self.graph.add(Node::Vector([value; 3]))),
            (Kind::Number, Kind::Vector) => None,
            _ => Some(value),
        }
    }
}
