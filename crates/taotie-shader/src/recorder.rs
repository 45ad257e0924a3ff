//! A number that records the operations on it.

use crate::graph::{Binary, Call, Field, Graph, Id, Kind, Node, Parameter, Unary};
use std::cell::{Cell, RefCell};
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};
use taotie_engine::math::{Lane, Mask, Vec3};

/// Records the formula that `formula` runs, and returns its expression graph.
///
/// The formula declares its parameters through the [`Scope`] and returns its outputs. Numbers cannot be mixed between
/// recordings, nor outlive their own: that does not compile.
///
/// ```
/// use taotie_engine::shade::microfacets::d_ggx;
/// use taotie_shader::record;
///
/// let graph = record(|scope| {
///     let [n_dot_h, sin2_h] = ["n_dot_h", "sin2_h"].map(|name| scope.number(name));
///     vec![d_ggx(n_dot_h, sin2_h, scope.number("alpha"))]
/// });
/// assert_eq!(graph.parameters().len(), 3);
/// ```
///
/// ```compile_fail
/// taotie_shader::record(|outer| {
///     let x = outer.number("x");
///     taotie_shader::record(|inner| vec![inner.number("y") + x]);
///     vec![x]
/// });
/// ```
pub fn record(formula: impl for<'g> FnOnce(Scope<'g>) -> Vec<Recorded<'g>>) -> Graph {
    let graph = RefCell::new(Graph::default());
    let outputs: Vec<Id> =
        formula(Scope { graph: &graph, brand: PhantomData }).iter().map(|output| output.id).collect();
    let mut graph = graph.into_inner();
    graph.outputs = outputs;
    graph
}

/// The brand of one recording: an invariant lifetime.
type Brand<'g> = PhantomData<Cell<&'g ()>>;

/// A recording in progress, which creates its parameters.
#[derive(Clone, Copy)]
pub struct Scope<'g> {
    graph: &'g RefCell<Graph>,
    brand: Brand<'g>,
}

impl<'g> Scope<'g> {
    /// The parameter of this path, a number. `path` is its name, or that of a structure and a field: `s.roughness`.
    pub fn number(self, path: &'static str) -> Recorded<'g> {
        let id = self.parameter(Parameter { path, kind: Kind::Number });
        Recorded { scope: self, id }
    }

    /// The parameter of this path, a vector. `path` has the form described at [`Self::number`].
    pub fn vector(self, path: &'static str) -> Vec3<Recorded<'g>> {
        let id = self.parameter(Parameter { path, kind: Kind::Vector });
        Vec3::from_array([0, 1, 2].map(|which| self.push(Node::Component(id, which))))
    }

    /// The parameter, created on first use.
    fn parameter(self, parameter: Parameter) -> Id {
        let mut graph = self.graph.borrow_mut();
        match graph.parameters().iter().position(|known| *known == parameter) {
            Some(number) => graph.add(Node::Parameter(number)),
            None => graph.declare(parameter),
        }
    }

    /// The constant `value`.
    pub(crate) fn constant(self, value: f64) -> Recorded<'g> {
        self.push(Node::constant(value))
    }

    /// Replaces the results of `formula` by a call of a function wherever they are computed from here on; ends the
    /// previous replacement. The formula's outputs are the numbers of the function's structure.
    pub(crate) fn calling(
        self,
        callee: &Callee<'_>,
        arguments: &[Vec3<Recorded<'g>>],
        formula: impl Fn() -> Vec<Recorded<'g>>,
    ) {
        let vector =
            |vector: &Vec3<Recorded<'g>>| self.push(Node::Vector(vector.to_array().map(|part| part.id)));
        let arguments = arguments.iter().map(|argument| vector(argument).id).collect();
        let result = Kind::Structure(callee.structure);
        let call = self.push(Node::Call(Call { function: callee.function, result, arguments }));
        let field =
            |(at, name): (usize, &&'static str)| self.push(Node::Field(call.id, Field { name, at })).id;
        let fields: Vec<Id> = callee.fields.iter().enumerate().map(field).collect();
        self.graph.borrow_mut().restore();
        // From now on, computing an output finds the field in its place.
        for _ in &fields {
            let outputs = formula();
            let mut graph = self.graph.borrow_mut();
            outputs.iter().zip(&fields).for_each(|(output, field)| {
                if output.id != *field {
                    graph.replace(output.id, *field);
                }
            });
        }
    }

    fn push(self, node: Node) -> Recorded<'g> {
        let id = self.graph.borrow_mut().add(node);
        Recorded { scope: self, id }
    }
}

/// A function that returns a structure of numbers: its index in the program, the structure's name and fields.
pub(crate) struct Callee<'c> {
    pub(crate) function: usize,
    pub(crate) structure: &'static str,
    pub(crate) fields: &'c [&'static str],
}

/// A number of a recording.
///
/// Operations with a constant 0 or 1 that change nothing are not recorded: x + 0, x − 0, 1 x, x/1, and a choice by
/// two constants. 0 x is 0; only the sign of a zero may differ from the formula's.
///
/// `min` and `max` are recorded as such, not as comparisons. For NaN, which no formula accepts, the graph behaves
/// like [`Lane`]; a GPU may differ.
#[derive(Clone, Copy)]
pub struct Recorded<'g> {
    scope: Scope<'g>,
    id: Id,
}

/// A truth value of a recording.
#[derive(Clone, Copy)]
pub struct RecordedTruth<'g>(Recorded<'g>);

impl<'g> Recorded<'g> {
    fn one(self, operation: Unary) -> Self {
        self.scope.push(Node::Unary(operation, self.id))
    }

    fn two(self, operation: Binary, other: Self) -> Self {
        match self.simpler(operation, other) {
            Some(simpler) => simpler,
            None => self.scope.push(Node::Binary(operation, self.id, other.id)),
        }
    }

    /// The operand, or zero, that results from an operation with 0 or 1.
    fn simpler(self, operation: Binary, other: Self) -> Option<Self> {
        let (a, b) = (self.known(), other.known());
        match operation {
            Binary::Add if a == Some(0.0) => Some(other),
            Binary::Add | Binary::Subtract if b == Some(0.0) => Some(self),
            Binary::Multiply if a == Some(1.0) => Some(other),
            Binary::Multiply | Binary::Divide if b == Some(1.0) => Some(self),
            Binary::Multiply if a == Some(0.0) => Some(self),
            Binary::Multiply if b == Some(0.0) => Some(other),
            _ => None,
        }
    }

    /// The value of a constant.
    fn known(self) -> Option<f64> {
        match self.scope.graph.borrow().node(self.id) {
            Node::Constant(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    /// The operands of a comparison, and its result for equal ones.
    fn compared(self) -> Option<(Self, Self, bool)> {
        let of = |id| Self { id, ..self };
        match self.scope.graph.borrow().node(self.id) {
            Node::Binary(Binary::Less, a, b) => Some((of(*a), of(*b), false)),
            Node::Binary(Binary::AtMost, a, b) => Some((of(*a), of(*b), true)),
            _ => None,
        }
    }

    /// The result of a comparison of two constants.
    fn decided(self) -> Option<bool> {
        let (a, b, equal) = self.compared()?;
        let (a, b) = (a.known()?, b.known()?);
        Some(if equal { a <= b } else { a < b })
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident $operation:ident),*) => {
        $(impl $trait for Recorded<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.two(Binary::$operation, other)
            }
        })*
    };
}

operator!(Add add Add, Sub sub Subtract, Mul mul Multiply, Div div Divide);

impl Neg for Recorded<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        match self.known() {
            Some(value) => self.scope.constant(-value),
            None => self.one(Unary::Negate),
        }
    }
}

impl Mask for RecordedTruth<'_> {
    fn and(self, other: Self) -> Self {
        Self(self.0.two(Binary::And, other.0))
    }
    fn or(self, other: Self) -> Self {
        Self(self.0.two(Binary::Or, other.0))
    }
    fn not(self) -> Self {
        Self(self.0.one(Unary::Not))
    }
    /// Unknown while recording; `true` keeps everything that a formula would skip.
    fn any(self) -> bool {
        true
    }
}

impl<'g> Lane for Recorded<'g> {
    type Mask = RecordedTruth<'g>;

    fn lit(self, value: f64) -> Self {
        self.scope.push(Node::constant(value))
    }
    fn sqrt(self) -> Self {
        self.one(Unary::Sqrt)
    }
    fn abs(self) -> Self {
        self.one(Unary::Abs)
    }
    fn floor(self) -> Self {
        self.one(Unary::Floor)
    }
    fn lt(self, other: Self) -> Self::Mask {
        RecordedTruth(self.two(Binary::Less, other))
    }
    fn le(self, other: Self) -> Self::Mask {
        RecordedTruth(self.two(Binary::AtMost, other))
    }
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        match mask.0.decided() {
            Some(true) => if_true,
            Some(false) => if_false,
            None => if_true.scope.push(Node::Select([mask.0.id, if_true.id, if_false.id])),
        }
    }
    fn ldexp(self, n: Self) -> Self {
        self.two(Binary::Scale, n)
    }
    fn frexp(self) -> (Self, Self) {
        (self.one(Unary::Mantissa), self.one(Unary::Exponent))
    }
    fn exp(self) -> Self {
        self.one(Unary::Exp)
    }
    fn exp2(self) -> Self {
        self.one(Unary::Exp2)
    }
    fn ln(self) -> Self {
        self.one(Unary::Ln)
    }
    fn log2(self) -> Self {
        self.one(Unary::Log2)
    }
    fn pow(self, exponent: Self) -> Self {
        self.two(Binary::Power, exponent)
    }
    fn min(self, other: Self) -> Self {
        self.two(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.two(Binary::Max, other)
    }
}
