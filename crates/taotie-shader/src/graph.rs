//! Expression graphs: each operation is stored once, however often it is used.

use rustc_hash::FxHashMap;

/// The index of a node in its [`Graph`]; operands precede the nodes that use them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id(pub(crate) usize);

/// The type of a node's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// One number.
    Number,
    /// Three numbers.
    Vector,
    /// True or false.
    Truth,
    /// A structure of this name, which a function returns.
    Structure(&'static str),
}

impl Kind {
    /// The number of scalars in a value of this type; zero for a structure.
    pub(crate) fn numbers(self) -> usize {
        match self {
            Self::Number | Self::Truth => 1,
            Self::Vector => 3,
            Self::Structure(_) => 0,
        }
    }
}

/// An operation of one operand, applied to each component of a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unary {
    /// −x.
    Negate,
    /// Logical negation.
    Not,
    /// √x.
    Sqrt,
    /// |x|.
    Abs,
    /// The largest integer not above x.
    Floor,
    /// e^x.
    Exp,
    /// 2^x.
    Exp2,
    /// The natural logarithm.
    Ln,
    /// The logarithm to base 2.
    Log2,
    /// m of x = m · 2^e, in [0.5, 1).
    Mantissa,
    /// e of x = m · 2^e.
    Exponent,
}

/// An operation of two operands, applied to each component of vectors; a scalar counts as three equal components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a − b.
    Subtract,
    /// a b.
    Multiply,
    /// a / b.
    Divide,
    /// The minimum.
    Min,
    /// The maximum.
    Max,
    /// a^b.
    Power,
    /// a · 2^b for an integral b.
    Scale,
    /// a < b.
    Less,
    /// a ≤ b.
    AtMost,
    /// Logical and.
    And,
    /// Logical or.
    Or,
}

/// An operation with its operands, or a source of a value.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Node {
    /// The parameter with this index.
    Parameter(usize),
    /// A constant, as the bits of its `f64`.
    Constant(u64),
    /// An operation of one operand.
    Unary(Unary, Id),
    /// An operation of two operands.
    Binary(Binary, Id, Id),
    /// The second operand if the first is true, else the third.
    Select([Id; 3]),
    /// A component of a vector: 0, 1 or 2.
    Component(Id, usize),
    /// A vector of three scalars.
    Vector([Id; 3]),
    /// A vector made of components of another vector.
    Swizzle(Id, [usize; 3]),
    /// The dot product of two vectors.
    Dot(Id, Id),
    /// The cross product of two vectors.
    Cross(Id, Id),
    /// The result of a function of the same program.
    Call(Call),
    /// A scalar of a structure that a function returned.
    Field(Id, Field),
}

/// A scalar of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its index among the scalars of the structure.
    pub at: usize,
}

/// A call of a function: its index in the program, the type of its result, and its arguments; a structure is one.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Call {
    /// The index of the function in its program.
    pub function: usize,
    /// The type of the result.
    pub result: Kind,
    /// A value for each argument.
    pub arguments: Vec<Id>,
}

/// An input of a graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Parameter {
    /// Its name, or the names of a structure and a field separated by a dot: `s.roughness`.
    pub path: &'static str,
    /// Number or vector.
    pub kind: Kind,
}

/// An expression graph: unique nodes, operands first.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    kinds: Vec<Kind>,
    known: FxHashMap<Node, Id>,
    /// The nodes that are currently replaced, with their own ids.
    replaced: Vec<(Node, Id)>,
    parameters: Vec<Parameter>,
    pub(crate) outputs: Vec<Id>,
}

impl Graph {
    /// Creates an empty graph with these parameters.
    pub(crate) fn of(parameters: &[Parameter]) -> Self {
        Self { parameters: parameters.to_vec(), ..Self::default() }
    }

    /// Returns the node's id; adds the node if it is new.
    pub(crate) fn add(&mut self, node: Node) -> Id {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        let id = Id(self.nodes.len());
        self.known.insert(node.clone(), id);
        self.kinds.push(self.kind_of(&node));
        self.nodes.push(node);
        id
    }

    /// Makes every later addition of the node of `id` return `other`, until [`Self::restore`].
    pub(crate) fn replace(&mut self, id: Id, other: Id) {
        let node = self.nodes[id.0].clone();
        self.known.insert(node.clone(), other);
        self.replaced.push((node, id));
    }

    /// Ends all replacements.
    pub(crate) fn restore(&mut self) {
        while let Some((node, id)) = self.replaced.pop() {
            self.known.insert(node, id);
        }
    }

    /// A new parameter.
    pub(crate) fn declare(&mut self, parameter: Parameter) -> Id {
        let number = self.parameters.len();
        self.parameters.push(parameter);
        self.add(Node::Parameter(number))
    }

    /// All nodes, operands first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The node of `id`.
    pub(crate) fn node(&self, id: Id) -> &Node {
        &self.nodes[id.0]
    }

    /// Returns true if the node of `id` is a constant.
    pub(crate) fn is_constant(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Constant(_))
    }

    /// The parameters, in order.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The nodes that are the graph's results, in order.
    pub fn outputs(&self) -> &[Id] {
        &self.outputs
    }

    /// The indices of the functions that it calls.
    pub(crate) fn called(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().filter_map(|node| match node {
            Node::Call(call) => Some(call.function),
            _ => None,
        })
    }

    /// Returns a copy without the nodes that no output needs.
    pub(crate) fn pruned(&self) -> Self {
        let mut needed = vec![false; self.nodes.len()];
        self.outputs.iter().for_each(|output| needed[output.0] = true);
        for (at, node) in self.nodes.iter().enumerate().rev() {
            let used = needed[at];
            node.operands().iter().for_each(|operand| needed[operand.0] |= used);
        }
        let mut pruned = Self::of(&self.parameters);
        let mut moved = vec![Id(0); self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate().filter(|(at, _)| needed[*at]) {
            moved[at] = pruned.add(node.with(|operand| moved[operand.0]));
        }
        pruned.outputs = self.outputs.iter().map(|output| moved[output.0]).collect();
        pruned
    }

    /// Returns a copy without the nodes and parameters that no output needs.
    pub(crate) fn stripped(&self) -> Self {
        let pruned = self.pruned();
        let is_used = |number: &usize| pruned.nodes.contains(&Node::Parameter(*number));
        let used: Vec<usize> = (0..self.parameters.len()).filter(is_used).collect();
        let parameters: Vec<Parameter> = used.iter().map(|number| self.parameters[*number]).collect();
        let mut stripped = Self::of(&parameters);
        let mut moved: Vec<Id> = Vec::with_capacity(pruned.nodes.len());
        for node in &pruned.nodes {
            let number = |old: &usize| used.iter().position(|number| number == old).unwrap_or_default();
            let node = match node {
                Node::Parameter(old) => Node::Parameter(number(old)),
                node => node.with(|operand| moved[operand.0]),
            };
            moved.push(stripped.add(node));
        }
        stripped.outputs = pruned.outputs.iter().map(|output| moved[output.0]).collect();
        stripped
    }

    /// The type of a node's value.
    pub(crate) fn kind(&self, id: Id) -> Kind {
        self.kinds[id.0]
    }

    /// The type that follows from a node's operands.
    fn kind_of(&self, node: &Node) -> Kind {
        match node {
            Node::Parameter(number) => self.parameters[*number].kind,
            Node::Constant(_) | Node::Component(..) | Node::Dot(..) | Node::Field(..) => Kind::Number,
            Node::Vector(_) | Node::Swizzle(..) | Node::Cross(..) => Kind::Vector,
            Node::Unary(Unary::Not, _) => Kind::Truth,
            Node::Binary(Binary::Less | Binary::AtMost | Binary::And | Binary::Or, ..) => Kind::Truth,
            Node::Unary(_, operand) | Node::Select([_, operand, _]) => self.kind(*operand),
            Node::Binary(_, a, b) if self.kind(*a) == Kind::Number => self.kind(*b),
            Node::Binary(..) => Kind::Vector,
            Node::Call(call) => call.result,
        }
    }
}

impl Node {
    /// The constant `value`.
    pub(crate) fn constant(value: f64) -> Self {
        Self::Constant(value.to_bits())
    }

    /// The operands of this node, in order.
    pub(crate) fn operands(&self) -> Vec<Id> {
        match self {
            Self::Parameter(_) | Self::Constant(_) => Vec::new(),
            Self::Unary(_, a) | Self::Component(a, _) | Self::Swizzle(a, _) | Self::Field(a, _) => vec![*a],
            Self::Binary(_, a, b) | Self::Dot(a, b) | Self::Cross(a, b) => vec![*a, *b],
            Self::Select(operands) | Self::Vector(operands) => operands.to_vec(),
            Self::Call(call) => call.arguments.clone(),
        }
    }

    /// The same operation with other operands.
    pub(crate) fn with(&self, mut other: impl FnMut(Id) -> Id) -> Self {
        match self {
            Self::Parameter(_) | Self::Constant(_) => self.clone(),
            Self::Unary(operation, a) => Self::Unary(*operation, other(*a)),
            Self::Binary(operation, a, b) => Self::Binary(*operation, other(*a), other(*b)),
            Self::Select(operands) => Self::Select(operands.map(other)),
            Self::Component(a, which) => Self::Component(other(*a), *which),
            Self::Field(a, field) => Self::Field(other(*a), *field),
            Self::Vector(operands) => Self::Vector(operands.map(other)),
            Self::Swizzle(a, which) => Self::Swizzle(other(*a), *which),
            Self::Dot(a, b) => Self::Dot(other(*a), other(*b)),
            Self::Cross(a, b) => Self::Cross(other(*a), other(*b)),
            Self::Call(call) => {
                let arguments = call.arguments.iter().map(|argument| other(*argument)).collect();
                Self::Call(Call { arguments, ..call.clone() })
            }
        }
    }
}
