//! Names for values that are used more than once.

use crate::graph::{Binary, Graph, Id, Node, Unary};
use crate::program::Program;
use std::collections::BTreeMap;

/// The names of a function's values.
pub(crate) struct Names<'g> {
    graph: &'g Graph,
    program: &'g Program,
    given: BTreeMap<Id, String>,
    /// The names of a structure's fields, for the outputs that become these fields.
    wished: BTreeMap<Id, &'static str>,
}

impl<'g> Names<'g> {
    pub(crate) fn new(graph: &'g Graph, program: &'g Program, wished: BTreeMap<Id, &'static str>) -> Self {
        Self { graph, program, given: BTreeMap::new(), wished }
    }

    /// Gives a value its name, distinct from those of all other values, arguments and functions.
    pub(crate) fn give(&mut self, id: Id) -> String {
        let wish = match self.wished.get(&id) {
            Some(wish) => wish.to_string(),
            None => self.unlike_fields(self.suggested(id)),
        };
        let mut name = wish.clone();
        for number in 2.. {
            if !self.is_taken(&name) {
                break;
            }
            name = format!("{wish}_{number}");
        }
        self.given.insert(id, name.clone());
        name
    }

    fn is_taken(&self, name: &str) -> bool {
        let is_argument = |path: &str| path.split('.').next() == Some(name);
        self.given.values().any(|given| given == name)
            || self.graph.parameters().iter().any(|parameter| is_argument(parameter.path))
            || self.program.find(name).is_some()
    }

    /// The name, prefixed with `raw_` if it is that of a field computed from the value.
    fn unlike_fields(&self, name: String) -> String {
        let is_field = self.wished.values().any(|wish| *wish == name);
        if is_field { format!("raw_{name}") } else { name }
    }

    /// The name of a value that has one.
    fn label(&self, id: Id) -> Option<String> {
        match self.graph.node(id) {
            Node::Parameter(number) => {
                let path = self.graph.parameters()[*number].path;
                Some(path.rsplit('.').next().unwrap_or(path).to_owned())
            }
            Node::Field(_, field) => Some(field.name.to_owned()),
            _ => self.given.get(&id).cloned(),
        }
    }

    /// A name that describes the value.
    fn suggested(&self, id: Id) -> String {
        match self.graph.node(id) {
            Node::Call(call) => self.program.formulas[call.function].symbol.to_owned(),
            Node::Binary(operation, a, b) => self.of_two(*operation, [*a, *b]),
            Node::Dot(a, b) if a == b => self.about(*a, "", "_squared_length", "squared_length"),
            Node::Dot(a, b) => self.between([*a, *b], "_dot_", "cosine"),
            Node::Cross(a, b) => self.between([*a, *b], "_cross_", "perpendicular"),
            Node::Unary(Unary::Sqrt, a) => match self.label(*a) {
                Some(label) if label.contains("squared_length") => label.replacen("squared_", "", 1),
                _ => "root".into(),
            },
            Node::Unary(Unary::Exp | Unary::Exp2, _) => "exponential".into(),
            Node::Unary(Unary::Not, _) => "condition".into(),
            Node::Select(_) => "chosen".into(),
            Node::Vector(_) => "vector".into(),
            _ => "value".into(),
        }
    }

    fn of_two(&self, operation: Binary, [a, b]: [Id; 2]) -> String {
        let word = match operation {
            Binary::Multiply if a == b => return self.about(a, "", "_squared", "square"),
            Binary::Subtract if self.is_one(a) => return self.about(b, "one_minus_", "", "complement"),
            Binary::Min | Binary::Max if self.graph.is_constant(b) => return self.bounded(a),
            Binary::Add => "sum",
            Binary::Subtract => "difference",
            Binary::Multiply => "product",
            Binary::Divide => "ratio",
            Binary::Min => "smaller",
            Binary::Max => "larger",
            Binary::Power | Binary::Scale => "raised",
            Binary::Less | Binary::AtMost | Binary::And | Binary::Or => "condition",
        };
        word.into()
    }

    /// The name of a clamped value.
    fn bounded(&self, id: Id) -> String {
        match self.label(id) {
            Some(label) => format!("{label}_kept"),
            None => self.suggested(id),
        }
    }

    fn about(&self, id: Id, before: &str, after: &str, otherwise: &str) -> String {
        self.label(id).map_or(otherwise.into(), |label| format!("{before}{label}{after}"))
    }

    fn between(&self, [a, b]: [Id; 2], word: &str, otherwise: &str) -> String {
        let labels = self.label(a).zip(self.label(b));
        labels.map_or(otherwise.into(), |(a, b)| format!("{a}{word}{b}"))
    }

    fn is_one(&self, id: Id) -> bool {
        *self.graph.node(id) == Node::constant(1.0)
    }
}
