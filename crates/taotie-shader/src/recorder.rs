//! A number that writes down what is done with it.

use crate::graph::{Binary, Graph, Id, Kind, Node, Parameter, Unary};
use std::cell::{Cell, RefCell};
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Neg, Sub};
use taotie::math::{Lane, Mask, Vec3};

/// Records the formula that `formula` runs, and gives its expression graph.
///
/// The formula declares its parameters by the [`Scope`] and returns its outputs. Numbers of one recording cannot enter
/// another, nor leave their own: that does not compile.
///
/// ```
/// use taotie::shade::ndf::d_ggx;
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

/// The mark of one recording: a lifetime that neither shrinks nor grows.
type Brand<'g> = PhantomData<Cell<&'g ()>>;

/// A recording in progress, which hands out its parameters.
#[derive(Clone, Copy)]
pub struct Scope<'g> {
    graph: &'g RefCell<Graph>,
    brand: Brand<'g>,
}

impl<'g> Scope<'g> {
    /// A new parameter, a number. `path` is its name, or those of a structure and a field: `s.roughness`.
    pub fn number(self, path: &'static str) -> Recorded<'g> {
        let id = self.graph.borrow_mut().declare(Parameter { path, kind: Kind::Number });
        Recorded { scope: self, id }
    }

    /// A new parameter, a vector. `path` is as with [`Self::number`].
    pub fn vector(self, path: &'static str) -> Vec3<Recorded<'g>> {
        let id = self.graph.borrow_mut().declare(Parameter { path, kind: Kind::Vector });
        Vec3::from_array([0, 1, 2].map(|which| self.push(Node::Component(id, which))))
    }

    fn push(self, node: Node) -> Recorded<'g> {
        let id = self.graph.borrow_mut().add(node);
        Recorded { scope: self, id }
    }
}

/// A number of a recording.
///
/// `min` and `max` are recorded as such and not as comparisons. For NaN, which no formula takes, the graph's meaning is
/// that of [`Lane`], a machine's may be another.
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
        self.scope.push(Node::Binary(operation, self.id, other.id))
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
        self.one(Unary::Negate)
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
    /// Unknown while recording; `true` keeps what a formula would skip.
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
        if_true.scope.push(Node::Select([mask.0.id, if_true.id, if_false.id]))
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
