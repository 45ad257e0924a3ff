//! The statements of a function.

use crate::graph::{Binary, Call, Graph, Id, Kind, Node, Unary};
use crate::language::{Language, Phrase, Tightness};
use crate::names::Names;
use crate::program::{Formula, Program};
use std::collections::BTreeMap;

/// The longest expression that is inlined into another.
const LONGEST: usize = 72;

/// The lines between a function's braces.
pub(crate) fn body(formula: &Formula, program: &Program, language: Language) -> String {
    let graph = &formula.graph;
    let names = Names::new(graph, program, wishes(formula, program));
    let mut writer = Writer {
        graph,
        program,
        language,
        names,
        uses: uses(graph),
        phrases: Vec::new(),
        lines: String::new(),
    };
    for at in 0..graph.nodes().len() {
        let phrase = writer.written(Id(at));
        writer.phrases.push(phrase);
    }
    let outputs: Vec<&Phrase> = graph.outputs().iter().map(|output| writer.phrase(*output)).collect();
    let result = match (formula.structure, &outputs[..]) {
        (None, [one]) => one.text.clone(),
        (name, fields) => Phrase::call(name.unwrap_or_default(), fields).text,
    };
    format!("{}    return {result};\n", writer.lines)
}

/// The names of the fields that the outputs become.
fn wishes(formula: &Formula, program: &Program) -> BTreeMap<Id, &'static str> {
    let structure = formula.structure.and_then(|name| program.structure(name));
    let names = structure.iter().flat_map(|structure| &structure.fields).map(|field| field.name);
    formula.graph.outputs().iter().copied().zip(names).collect()
}

/// The number of uses of each node; being an output counts as one.
fn uses(graph: &Graph) -> Vec<usize> {
    let mut uses = vec![0; graph.nodes().len()];
    let operands = graph.nodes().iter().flat_map(Node::operands);
    operands.chain(graph.outputs().iter().copied()).for_each(|id| uses[id.0] += 1);
    uses
}

struct Writer<'g> {
    graph: &'g Graph,
    program: &'g Program,
    language: Language,
    names: Names<'g>,
    uses: Vec<usize>,
    /// The text of each node: its name or its expression.
    phrases: Vec<Phrase>,
    lines: String,
}

impl Writer<'_> {
    /// Returns the text of a node; writes a line that names it if it needs a name.
    fn written(&mut self, id: Id) -> Phrase {
        let phrase = self.expression(id);
        if !self.needs_name(id, &phrase) {
            return phrase;
        }
        let name = self.names.give(id);
        self.lines += &self.language.binding(&name, self.graph.kind(id), &phrase.text);
        Phrase::atom(name)
    }

    fn needs_name(&self, id: Id, phrase: &Phrase) -> bool {
        let node = self.graph.node(id);
        let is_result = self.graph.outputs() == [id] && self.uses[id.0] == 1;
        let is_short = matches!(node, Node::Parameter(_) | Node::Constant(_) | Node::Component(..))
            || matches!(node, Node::Vector([a, b, c]) if a == b && b == c)
            || matches!(node, Node::Swizzle(..) | Node::Field(..));
        if is_result || is_short || self.is_clamped(id) {
            return false;
        }
        let is_field = self.graph.outputs().len() > 1 && self.graph.outputs().contains(&id);
        let is_call = matches!(node, Node::Call(_));
        self.uses[id.0] > 1 || is_field || is_call || phrase.text.len() > LONGEST
    }

    fn phrase(&self, id: Id) -> &Phrase {
        &self.phrases[id.0]
    }

    fn expression(&self, id: Id) -> Phrase {
        match self.graph.node(id) {
            Node::Parameter(number) => Phrase::atom(self.graph.parameters()[*number].path),
            Node::Constant(bits) => Phrase::constant(f64::from_bits(*bits)),
            Node::Unary(operation, a) => self.unary(*operation, *a),
            Node::Binary(operation, a, b) => self.binary(*operation, [*a, *b]),
            Node::Select(operands) => self.language.select(operands.map(|operand| self.phrase(operand))),
            Node::Component(a, which) => self.parts(*a, &[*which]),
            Node::Swizzle(a, which) => self.parts(*a, which),
            Node::Vector([a, b, c]) if a == b && b == c => self.vector(&[self.phrase(*a)]),
            Node::Vector(parts) => self.vector(&parts.map(|part| self.phrase(part))),
            Node::Dot(a, b) => Phrase::call("dot", &[self.phrase(*a), self.phrase(*b)]),
            Node::Cross(a, b) => Phrase::call("cross", &[self.phrase(*a), self.phrase(*b)]),
            Node::Call(call) => self.call(call),
            Node::Field(of, field) => Phrase::atom(format!("{}.{}", self.phrase(*of).text, field.name)),
        }
    }

    fn parts(&self, vector: Id, which: &[usize]) -> Phrase {
        let letters: String = which.iter().map(|part| ["x", "y", "z"][*part]).collect();
        Phrase::atom(format!("{}.{letters}", self.phrase(vector).within(Tightness::Atom)))
    }

    fn vector(&self, parts: &[&Phrase]) -> Phrase {
        Phrase::call(self.language.kind(Kind::Vector), parts)
    }

    fn call(&self, call: &Call) -> Phrase {
        let arguments: Vec<&Phrase> = call.arguments.iter().map(|argument| self.phrase(*argument)).collect();
        Phrase::call(&self.program.formulas[call.function].name, &arguments)
    }

    fn unary(&self, operation: Unary, a: Id) -> Phrase {
        let operand = self.phrase(a);
        let sign = |sign: &str| Phrase {
            text: format!("{sign}{}", operand.within(Tightness::Atom)),
            tightness: Tightness::Sign,
        };
        let name = match operation {
            Unary::Negate => return sign("-"),
            Unary::Not => return sign("!"),
            Unary::Sqrt => "sqrt",
            Unary::Abs => "abs",
            Unary::Floor => "floor",
            Unary::Exp => "exp",
            Unary::Exp2 => "exp2",
            Unary::Ln => "log",
            Unary::Log2 => "log2",
            Unary::Exponent => return Phrase::atom(format!("(floor(log2({})) + 1.0)", operand.text)),
            Unary::Mantissa => {
                let power = format!("exp2(-floor(log2({})) - 1.0)", operand.text);
                return Phrase::atom(format!("({} * {power})", operand.within(Tightness::Product)));
            }
        };
        Phrase::call(name, &[operand])
    }

    fn binary(&self, operation: Binary, operands: [Id; 2]) -> Phrase {
        let [a, b] = operands.map(|operand| self.phrase(operand));
        let infix = |sign: &str, tightness: Tightness, [left, right]: [Tightness; 2]| Phrase {
            text: format!("{} {sign} {}", a.within(left), b.within(right)),
            tightness,
        };
        use Tightness::{Atom, Comparison, Product, Sign, Sum};
        match operation {
            Binary::Add => infix("+", Sum, [Sum, Product]),
            Binary::Subtract => infix("-", Sum, [Sum, Product]),
            Binary::Multiply => infix("*", Product, [Product, Sign]),
            Binary::Divide => infix("/", Product, [Product, Sign]),
            Binary::Less => infix("<", Comparison, [Sum, Sum]),
            Binary::AtMost => infix("<=", Comparison, [Sum, Sum]),
            Binary::And => infix("&&", Comparison, [Atom, Atom]),
            Binary::Or => infix("||", Comparison, [Atom, Atom]),
            Binary::Power => Phrase::call("power", &[a, b]),
            Binary::Scale => {
                Phrase { text: format!("{} * exp2({})", a.within(Product), b.text), tightness: Product }
            }
            Binary::Min => self.clamped(operands).unwrap_or_else(|| self.bounded("min", &operands)),
            Binary::Max => self.bounded("max", &operands),
        }
    }

    /// A function that takes vectors only if one of its operands is a vector.
    fn bounded(&self, name: &str, operands: &[Id]) -> Phrase {
        let wide = operands.iter().any(|operand| self.graph.kind(*operand) == Kind::Vector);
        let widened = operands.iter().map(|operand| match self.graph.kind(*operand) {
            Kind::Number if wide => self.vector(&[self.phrase(*operand)]),
            _ => self.phrase(*operand).clone(),
        });
        let widened: Vec<Phrase> = widened.collect();
        Phrase::call(name, &widened.iter().collect::<Vec<_>>())
    }

    /// `clamp` for the minimum of a constant and the maximum of another constant and a value.
    fn clamped(&self, [a, high]: [Id; 2]) -> Option<Phrase> {
        let (value, low) = self.lower_bound(a)?;
        self.graph.is_constant(high).then(|| self.bounded("clamp", &[value, low, high]))
    }

    /// The value and the constant of which `id` is the maximum, if that has no other use.
    fn lower_bound(&self, id: Id) -> Option<(Id, Id)> {
        match self.graph.node(id) {
            Node::Binary(Binary::Max, value, low) if self.uses[id.0] == 1 && self.graph.is_constant(*low) => {
                Some((*value, *low))
            }
            _ => None,
        }
    }

    /// Returns true if a node is only the inner half of a `clamp`.
    fn is_clamped(&self, id: Id) -> bool {
        let outer = |node: &Node| match node {
            Node::Binary(Binary::Min, a, high) => *a == id && self.graph.is_constant(*high),
            _ => false,
        };
        self.lower_bound(id).is_some() && self.graph.nodes().iter().any(outer)
    }
}
