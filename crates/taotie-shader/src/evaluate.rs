//! Evaluates a graph for given inputs, on any lane.

use crate::graph::{Binary, Call, Graph, Id, Kind, Node, Unary};
use crate::program::Program;
use taotie_engine::math::{Lane, Mask, Vec3};

/// The error returned when a graph cannot be evaluated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EvaluateError {
    /// The number of inputs differs from that of the parameters, or is zero, which leaves constants without a type.
    #[error("expected {expected} inputs (at least one), found {found}")]
    Inputs {
        /// The number of scalars in its parameters, three per vector.
        expected: usize,
        /// The number of scalars passed.
        found: usize,
    },
    /// An operation on operands that it does not accept.
    #[error("invalid operands of node {0}")]
    Kind(usize),
    /// A call of a function that is missing from the program.
    #[error("function {0} is missing from the program")]
    Function(usize),
}

type Result<T> = std::result::Result<T, EvaluateError>;

/// The value of a node.
#[derive(Debug, Clone, Copy)]
enum Value<L: Lane> {
    Number(L),
    Vector([L; 3]),
    Truth(L::Mask),
    /// A structure that a function returned, by its index in [`Player::structures`].
    Structure(usize),
}

/// Evaluates `graph` and returns its outputs, scalar by scalar, for the scalars of its parameters; the functions that
/// it calls are those of `program`.
///
/// The operations are those of `L`, in the order of the graph: in `f64` the result matches the recorded formula bit
/// for bit.
///
/// # Errors
/// If the number of inputs differs from the parameters' scalars, or the graph does not belong to this program.
pub fn evaluate<L: Lane>(graph: &Graph, program: &Program, inputs: &[L]) -> Result<Vec<L>> {
    let (given, like) = parameters(graph, inputs)?;
    let values = Vec::with_capacity(graph.nodes().len());
    let mut player = Player { program, given, like, values, structures: Vec::new() };
    for node in graph.nodes() {
        let value = player.play(node)?;
        player.values.push(value);
    }
    let mut numbers = Vec::new();
    for output in graph.outputs() {
        match player.values[output.0] {
            Value::Number(number) => numbers.push(number),
            Value::Vector(vector) => numbers.extend(vector),
            Value::Truth(_) | Value::Structure(_) => return Err(EvaluateError::Kind(output.0)),
        }
    }
    Ok(numbers)
}

/// The inputs as the values of the parameters, and one of the scalars.
fn parameters<L: Lane>(graph: &Graph, inputs: &[L]) -> Result<(Vec<Value<L>>, L)> {
    let expected = graph.parameters().iter().map(|parameter| parameter.kind.numbers()).sum();
    let wrong = EvaluateError::Inputs { expected, found: inputs.len() };
    let Some(like) = inputs.first().filter(|_| expected == inputs.len()) else { return Err(wrong) };
    let mut rest = inputs;
    let values = graph.parameters().iter().map(|parameter| {
        let (own, others) = rest.split_at(parameter.kind.numbers());
        rest = others;
        match own {
            [x, y, z] => Value::Vector([*x, *y, *z]),
            _ => Value::Number(own[0]),
        }
    });
    Ok((values.collect(), *like))
}

struct Player<'p, L: Lane> {
    program: &'p Program,
    given: Vec<Value<L>>,
    /// Any scalar, from which constants are made.
    like: L,
    values: Vec<Value<L>>,
    /// The scalars of the structures.
    structures: Vec<Vec<L>>,
}

impl<L: Lane> Player<'_, L> {
    fn play(&mut self, node: &Node) -> Result<Value<L>> {
        let wrong = EvaluateError::Kind(self.values.len());
        let value = match node {
            Node::Parameter(number) => self.given.get(*number).copied(),
            Node::Constant(bits) => Some(Value::Number(self.like.lit(f64::from_bits(*bits)))),
            Node::Unary(operation, a) => unary(*operation, self.value(*a)),
            Node::Binary(operation, a, b) => binary(*operation, self.value(*a), self.value(*b)),
            Node::Select(operands) => select(operands.map(|operand| self.value(operand))),
            Node::Component(a, which) => self.vector(*a).map(|vector| Value::Number(vector[*which])),
            Node::Vector(parts) => self.joined(*parts),
            Node::Swizzle(a, which) => self.vector(*a).map(|vector| Value::Vector(which.map(|i| vector[i]))),
            Node::Dot(a, b) => self.vectors(*a, *b).map(|[a, b]| Value::Number(a.dot(b))),
            Node::Cross(a, b) => self.vectors(*a, *b).map(|[a, b]| Value::Vector(a.cross(b).to_array())),
            Node::Call(call) => return self.call(call),
            Node::Field(of, field) => self.field(*of, field.at),
        };
        value.ok_or(wrong)
    }

    fn value(&self, id: Id) -> Value<L> {
        self.values[id.0]
    }

    fn vector(&self, id: Id) -> Option<[L; 3]> {
        match self.value(id) {
            Value::Vector(vector) => Some(vector),
            _ => None,
        }
    }

    fn vectors(&self, a: Id, b: Id) -> Option<[Vec3<L>; 2]> {
        Some([self.vector(a)?, self.vector(b)?].map(Vec3::from_array))
    }

    fn joined(&self, parts: [Id; 3]) -> Option<Value<L>> {
        match parts.map(|part| self.value(part)) {
            [Value::Number(x), Value::Number(y), Value::Number(z)] => Some(Value::Vector([x, y, z])),
            _ => None,
        }
    }

    /// A scalar of a structure.
    fn field(&self, of: Id, at: usize) -> Option<Value<L>> {
        match self.value(of) {
            Value::Structure(number) => self.structures.get(number)?.get(at).copied().map(Value::Number),
            _ => None,
        }
    }

    fn call(&mut self, call: &Call) -> Result<Value<L>> {
        let formula =
            self.program.formulas.get(call.function).ok_or(EvaluateError::Function(call.function))?;
        let wrong = EvaluateError::Kind(self.values.len());
        let mut inputs = Vec::new();
        for argument in &call.arguments {
            match self.value(*argument) {
                Value::Number(number) => inputs.push(number),
                Value::Vector(vector) => inputs.extend(vector),
                Value::Structure(number) => inputs.extend(&self.structures[number]),
                Value::Truth(_) => return Err(wrong),
            }
        }
        let numbers = evaluate(&formula.graph, self.program, &inputs)?;
        match (call.result, &numbers[..]) {
            (Kind::Structure(_), _) => {
                self.structures.push(numbers);
                Ok(Value::Structure(self.structures.len() - 1))
            }
            (_, [number]) => Ok(Value::Number(*number)),
            (_, [x, y, z]) => Ok(Value::Vector([*x, *y, *z])),
            _ => Err(wrong),
        }
    }
}

fn unary<L: Lane>(operation: Unary, operand: Value<L>) -> Option<Value<L>> {
    let of = |x: L| match operation {
        Unary::Negate => Some(-x),
        Unary::Sqrt => Some(x.sqrt()),
        Unary::Abs => Some(x.abs()),
        Unary::Floor => Some(x.floor()),
        Unary::Exp => Some(x.exp()),
        Unary::Exp2 => Some(x.exp2()),
        Unary::Ln => Some(x.ln()),
        Unary::Log2 => Some(x.log2()),
        Unary::Mantissa => Some(x.frexp().0),
        Unary::Exponent => Some(x.frexp().1),
        Unary::Not => None,
    };
    match operand {
        Value::Number(x) => of(x).map(Value::Number),
        Value::Vector([x, y, z]) => Some(Value::Vector([of(x)?, of(y)?, of(z)?])),
        Value::Truth(mask) => (operation == Unary::Not).then(|| Value::Truth(mask.not())),
        Value::Structure(_) => None,
    }
}

fn binary<L: Lane>(operation: Binary, a: Value<L>, b: Value<L>) -> Option<Value<L>> {
    let (a, b) = match (a, b) {
        (Value::Truth(a), Value::Truth(b)) => return truths(operation, a, b).map(Value::Truth),
        (Value::Number(a), Value::Number(b)) if matches!(operation, Binary::Less | Binary::AtMost) => {
            let truth = if operation == Binary::Less { a.lt(b) } else { a.le(b) };
            return Some(Value::Truth(truth));
        }
        (Value::Number(a), Value::Number(b)) => return arithmetic(operation, a, b).map(Value::Number),
        (Value::Vector(a), Value::Vector(b)) => (a, b),
        (Value::Vector(a), Value::Number(b)) => (a, [b; 3]),
        (Value::Number(a), Value::Vector(b)) => ([a; 3], b),
        _ => return None,
    };
    let of = |i: usize| arithmetic(operation, a[i], b[i]);
    Some(Value::Vector([of(0)?, of(1)?, of(2)?]))
}

fn arithmetic<L: Lane>(operation: Binary, a: L, b: L) -> Option<L> {
    match operation {
        Binary::Add => Some(a + b),
        Binary::Subtract => Some(a - b),
        Binary::Multiply => Some(a * b),
        Binary::Divide => Some(a / b),
        Binary::Min => Some(a.min(b)),
        Binary::Max => Some(a.max(b)),
        Binary::Power => Some(a.pow(b)),
        Binary::Scale => Some(a.ldexp(b)),
        Binary::Less | Binary::AtMost | Binary::And | Binary::Or => None,
    }
}

fn truths<M: Mask>(operation: Binary, a: M, b: M) -> Option<M> {
    match operation {
        Binary::And => Some(a.and(b)),
        Binary::Or => Some(a.or(b)),
        _ => None,
    }
}

fn select<L: Lane>(operands: [Value<L>; 3]) -> Option<Value<L>> {
    match operands {
        [Value::Truth(mask), Value::Number(a), Value::Number(b)] => {
            Some(Value::Number(L::select(mask, a, b)))
        }
        [Value::Truth(mask), Value::Vector(a), Value::Vector(b)] => {
            Some(Value::Vector([0, 1, 2].map(|i| L::select(mask, a[i], b[i]))))
        }
        _ => None,
    }
}
