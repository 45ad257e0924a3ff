//! Formulas that call one another.

use crate::graph::{Graph, Kind};
use crate::outline::{Function, with_calls};
use crate::structures::Structure;
use crate::vectors::with_vectors;

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
