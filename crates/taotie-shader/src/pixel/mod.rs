//! The pixel program of `taotie_engine::pixel`, recorded for a variant: functions that call one another, with
//! structures of exactly the fields needed.

mod lookups;
mod stages;
mod structures;

pub(crate) use structures::texel_source;

use crate::graph::{Graph, Id};
use crate::library::library;
use crate::program::{Formula, Program, Structure};
use crate::recorder::Callee;
use crate::variant::Variant;
use lookups::{lookups, parts};
use stages::{Feeds, Stage, stages};
use std::collections::BTreeSet;

/// The outputs of the function `angles`, in order.
const ANGLES: [&str; 6] = ["n_dot_l", "n_dot_v", "n_dot_h", "sin2_h", "v_dot_h", "r_dot_v"];

/// The pixel of a variant.
#[derive(Debug, Clone)]
pub struct PixelProgram {
    pub(crate) program: Program,
    /// The names of the stages, in order.
    pub(crate) stages: Vec<String>,
    /// The parameters that the stages read: arguments by their names, fields after a dot, `p.n`.
    pub(crate) read: BTreeSet<&'static str>,
}

impl PixelProgram {
    /// Records the stages of a variant.
    pub fn new(variant: &Variant) -> Self {
        let mut program = library();
        program.structures.extend(structures::fixed());
        parts().into_iter().for_each(|formula| program.add(formula));
        let angles = program.formulas.iter().position(|formula| formula.name == "angles").unwrap_or_default();
        let callee = Callee { function: angles, structure: "Angles", fields: &ANGLES };
        let mut needs = Needs { structures: structures::variable(), read: BTreeSet::new() };
        if variant.environment && !variant.unlit {
            // The mean of the environment's light is looked up by the normal.
            needs.read.insert("p.n");
        }
        if variant.shadows && !variant.unlit {
            needs.read.insert("g.n_geom");
        }
        let stages = needs.stripped(stages(variant, &callee));
        let Needs { structures, read } = needs;
        program.structures.extend(structures.into_iter().filter_map(|structure| kept(structure, &read)));
        program.narrow("Dfg", &read);
        let names = stages.iter().map(|formula| formula.name.clone()).collect();
        stages.into_iter().chain(lookups()).for_each(|formula| program.add(formula));
        Self { program, stages: names, read }
    }

    /// The functions and structures.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The stages in the order in which they run.
    pub fn stages(&self) -> impl Iterator<Item = &Formula> {
        self.stages.iter().filter_map(|name| self.program.find(name))
    }

    /// The names of the fields that remain in a structure narrowed for the variant.
    pub fn fields(&self, structure: &str) -> Vec<&'static str> {
        let structure = self.program.structure(structure);
        structure.iter().flat_map(|structure| &structure.fields).map(|field| field.name).collect()
    }
}

/// The names read by later stages from earlier ones.
struct Needs {
    structures: Vec<Structure>,
    read: BTreeSet<&'static str>,
}

impl Needs {
    /// Returns the stages that are needed, reduced to the results and parameters that are needed, in order.
    fn stripped(&mut self, stages: Vec<Stage>) -> Vec<Formula> {
        let mut kept: Vec<Formula> =
            stages.into_iter().rev().filter_map(|stage| self.needed(stage)).collect();
        kept.reverse();
        kept
    }

    /// Returns the stage reduced to what is needed; records what it reads.
    fn needed(&mut self, Stage { mut formula, feeds }: Stage) -> Option<Formula> {
        let is_read = match feeds {
            Feeds::Pixel => true,
            Feeds::Structure => {
                let structure = self.structures.iter().find(|each| formula.structure == Some(each.name))?;
                formula.graph.outputs = wanted(structure, &formula.graph, &self.read);
                !formula.graph.outputs().is_empty()
            }
            Feeds::Path(path) => self.reads(path),
        };
        if !is_read {
            return None;
        }
        formula.graph = formula.graph.stripped();
        self.read.extend(formula.graph.parameters().iter().map(|parameter| parameter.path));
        Some(formula)
    }

    /// Returns true if a stage reads an argument or any of its fields.
    fn reads(&self, path: &str) -> bool {
        reads(&self.read, path)
    }
}

/// Returns true if an argument, or any field of it, is read.
pub(crate) fn reads(read: &BTreeSet<&'static str>, path: &str) -> bool {
    read.iter().any(|each| *each == path || each.split('.').next() == Some(path))
}

/// The outputs that become fields that are read.
fn wanted(structure: &Structure, graph: &Graph, read: &BTreeSet<&'static str>) -> Vec<Id> {
    let mut rest = graph.outputs();
    let mut wanted = Vec::new();
    for field in &structure.fields {
        let (own, others) = rest.split_at(field.kind.numbers().min(rest.len()));
        rest = others;
        if is_field_read(structure, field.name, read) {
            wanted.extend(own);
        }
    }
    wanted
}

fn is_field_read(structure: &Structure, field: &str, read: &BTreeSet<&'static str>) -> bool {
    let is_it = |path: &&str| {
        path.split_once('.')
            .is_some_and(|(argument, name)| name == field && structure.arguments.contains(&argument))
    };
    read.iter().any(is_it)
}

/// Returns the structure with only the fields that are read; `None` if none is.
fn kept(mut structure: Structure, read: &BTreeSet<&'static str>) -> Option<Structure> {
    let whole = structure.clone();
    structure.fields.retain(|field| is_field_read(&whole, field.name, read));
    (!structure.fields.is_empty()).then_some(structure)
}

impl Program {
    /// Removes the fields that are not read from a structure.
    fn narrow(&mut self, name: &str, read: &BTreeSet<&'static str>) {
        if let Some(structure) = self.structures.iter_mut().find(|structure| structure.name == name) {
            let whole = structure.clone();
            structure.fields.retain(|field| is_field_read(&whole, field.name, read));
        }
    }
}
