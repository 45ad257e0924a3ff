//! Finds the vectors in a recording of scalars.
//!
//! A formula treats the three channels of a colour alike, so its recording holds each operation three times. Here
//! three nodes of the same shape become one vector node; sums of three products become dot products, and differences
//! of rotated products cross products. Each remaining operation computes the same as the three did: no value changes.

use crate::graph::{Binary, Graph, Id, Kind, Node, Unary};
use rustc_hash::FxHashMap;

/// The recording with vectors, and with outputs of these types: three scalars become one vector.
pub(crate) fn with_vectors(recorded: &Graph, outputs: &[Kind]) -> Graph {
    let mut packer = Packer {
        recorded,
        packed: Graph::of(recorded.parameters()),
        numbers: FxHashMap::default(),
        triples: FxHashMap::default(),
        components: FxHashMap::default(),
    };
    let mut rest = recorded.outputs();
    for kind in outputs {
        let (own, others) = rest.split_at(kind.numbers().min(rest.len()));
        rest = others;
        let output = packer.output(own);
        packer.packed.outputs.extend(output);
    }
    packer.packed.pruned()
}

/// y, z, x.
const NEXT: [usize; 3] = [1, 2, 0];
/// z, x, y.
const AFTER_NEXT: [usize; 3] = [2, 0, 1];

struct Packer<'r> {
    recorded: &'r Graph,
    packed: Graph,
    numbers: FxHashMap<Id, Id>,
    triples: FxHashMap<[Id; 3], Id>,
    /// The packed vector, and the component of it, for each recorded scalar that is a component.
    components: FxHashMap<Id, (Id, usize)>,
}

impl Packer<'_> {
    /// The packed output for one recorded scalar or three.
    fn output(&mut self, numbers: &[Id]) -> Option<Id> {
        match *numbers {
            [x, y, z] => {
                let vector = self.triple([x, y, z]);
                Some(self.widened(vector))
            }
            [number] => Some(self.number(number)),
            _ => None,
        }
    }

    /// The packed node for a recorded node.
    fn number(&mut self, id: Id) -> Id {
        if let Some(known) = self.numbers.get(&id) {
            return *known;
        }
        let packed = match self.components.get(&id) {
            Some((vector, which)) => self.packed.add(Node::Component(*vector, *which)),
            None => match self.of_vectors(id) {
                Some(number) => number,
                None => self.as_it_is(id),
            },
        };
        self.numbers.insert(id, packed);
        packed
    }

    /// The packed node of the same operation; an argument that was a vector is one again.
    fn as_it_is(&mut self, id: Id) -> Id {
        let recorded = self.recorded;
        if let Node::Vector(parts) = recorded.node(id) {
            let vector = self.triple(*parts);
            return self.widened(vector);
        }
        let node = recorded.node(id).with(|operand| self.number(operand));
        self.packed.add(node)
    }

    /// The scalar computed from vectors if `id` is computed from all their components.
    fn of_vectors(&mut self, id: Id) -> Option<Id> {
        match self.scalar_product(id) {
            None => self.largest_component(id),
            product => product,
        }
    }

    /// The largest component of a vector, if `id` is the maximum of its three components.
    fn largest_component(&mut self, id: Id) -> Option<Id> {
        let (first_two, z) = self.operands(Binary::Max, id)?;
        let (x, y) = self.operands(Binary::Max, first_two)?;
        let vector = self.triple([x, y, z]);
        if !self.is_whole(vector) {
            return None;
        }
        let [x, y, z] = [0, 1, 2].map(|which| self.packed.add(Node::Component(vector, which)));
        let first_two = self.packed.add(Node::Binary(Binary::Max, x, y));
        Some(self.packed.add(Node::Binary(Binary::Max, first_two, z)))
    }

    /// The dot product that `id` is, if it is the sum of three products of vector components.
    fn scalar_product(&mut self, id: Id) -> Option<Id> {
        let (first_two, third) = self.operands(Binary::Add, id)?;
        let (first, second) = self.operands(Binary::Add, first_two)?;
        let [x, y, z] = [first, second, third].map(|product| self.operands(Binary::Multiply, product));
        let ((x, y), z) = (x.zip(y)?, z?);
        let (a, b) = (self.triple([x.0, y.0, z.0]), self.triple([x.1, y.1, z.1]));
        (self.is_whole(a) && self.is_whole(b)).then(|| self.packed.add(Node::Dot(a, b)))
    }

    /// The operands of `id` if it is this operation.
    fn operands(&self, operation: Binary, id: Id) -> Option<(Id, Id)> {
        match self.recorded.node(id) {
            Node::Binary(found, a, b) if *found == operation => Some((*a, *b)),
            _ => None,
        }
    }

    /// Returns true if a packed node is a proper vector, not three scalars put together.
    fn is_whole(&self, id: Id) -> bool {
        self.packed.kind(id) == Kind::Vector && !matches!(self.packed.node(id), Node::Vector(_))
    }

    /// The packed node for three recorded scalars: a vector, or one scalar if they are the same.
    fn triple(&mut self, parts: [Id; 3]) -> Id {
        if parts[0] == parts[1] && parts[1] == parts[2] {
            return self.number(parts[0]);
        }
        if let Some(known) = self.triples.get(&parts) {
            return *known;
        }
        let packed = match self.of_components(parts) {
            Some(vector) => vector,
            None => match self.alike(parts) {
                Some(vector) => self.noted(parts, vector),
                None => {
                    let numbers = parts.map(|part| self.number(part));
                    self.packed.add(Node::Vector(numbers))
                }
            },
        };
        self.triples.insert(parts, packed);
        packed
    }

    /// The vector of three known components, rotated if they are.
    fn of_components(&mut self, parts: [Id; 3]) -> Option<Id> {
        let [a, b, c] = parts.map(|part| self.components.get(&part).copied());
        let ((a, i), (b, j), (c, k)) = (a?, b?, c?);
        (a == b && b == c).then(|| self.swizzled(a, [i, j, k]))
    }

    /// Records the components of a vector, so that they are found individually and in rotated order.
    fn noted(&mut self, parts: [Id; 3], vector: Id) -> Id {
        if self.is_whole(vector) {
            let (flat, turn) = self.unturned(vector);
            for (part, which) in parts.into_iter().zip(turn) {
                self.components.entry(part).or_insert((flat, which));
            }
        }
        vector
    }

    /// One vector operation for three scalar operations, if they are alike.
    fn alike(&mut self, parts: [Id; 3]) -> Option<Id> {
        let recorded = self.recorded;
        match parts.map(|part| recorded.node(part)) {
            [Node::Component(a, i), Node::Component(b, j), Node::Component(c, k)] if a == b && b == c => {
                let vector = self.number(*a);
                Some(self.swizzled(vector, [*i, *j, *k]))
            }
            [Node::Unary(one, a), Node::Unary(two, b), Node::Unary(three, c)]
                if one == two && two == three =>
            {
                self.unary(*one, [*a, *b, *c])
            }
            [Node::Binary(one, a, d), Node::Binary(two, b, e), Node::Binary(three, c, f)]
                if one == two && two == three =>
            {
                self.binary(*one, [[*a, *b, *c], [*d, *e, *f]])
            }
            [Node::Select([m, a, d]), Node::Select([n, b, e]), Node::Select([o, c, f])]
                if m == n && n == o =>
            {
                let mask = self.number(*m);
                Some(self.choice(mask, [[*a, *b, *c], [*d, *e, *f]]))
            }
            _ => None,
        }
    }

    fn unary(&mut self, operation: Unary, parts: [Id; 3]) -> Option<Id> {
        let operand = self.triple(parts);
        let (operand, turn) = self.unturned(operand);
        let plain = operation != Unary::Not && self.is_whole(operand);
        plain.then(|| {
            let vector = self.packed.add(Node::Unary(operation, operand));
            self.swizzled(vector, turn)
        })
    }

    /// The choice between two vectors.
    fn choice(&mut self, mask: Id, operands: [[Id; 3]; 2]) -> Id {
        let [a, b] = operands.map(|parts| self.triple(parts));
        let ((flat_a, turn_a), (flat_b, turn_b)) = (self.unturned(a), self.unturned(b));
        let (a, b, turn) = match [a, b].map(|id| self.packed.kind(id) == Kind::Number) {
            [true, false] => (a, flat_b, turn_b),
            [false, true] => (flat_a, b, turn_a),
            _ if turn_a == turn_b => (flat_a, flat_b, turn_a),
            _ => (a, b, [0, 1, 2]),
        };
        let (a, b) = (self.widened(a), self.widened(b));
        let vector = self.packed.add(Node::Select([mask, a, b]));
        self.swizzled(vector, turn)
    }

    /// A power remains scalar, since its bounds are those of a function.
    fn binary(&mut self, operation: Binary, operands: [[Id; 3]; 2]) -> Option<Id> {
        use Binary::{Add, Divide, Max, Min, Multiply, Subtract};
        if ![Add, Subtract, Multiply, Divide, Min, Max].contains(&operation) {
            return None;
        }
        let [a, b] = operands.map(|parts| self.triple(parts));
        let numbers = [a, b].map(|id| self.packed.kind(id) == Kind::Number);
        if !(numbers[0] || self.is_whole(a)) || !(numbers[1] || self.is_whole(b)) {
            return None;
        }
        if let Some(product) = self.vector_product(operation, a, b) {
            return Some(product);
        }
        let ((flat_a, turn_a), (flat_b, turn_b)) = (self.unturned(a), self.unturned(b));
        let turn = match numbers {
            [true, _] => turn_b,
            [_, true] => turn_a,
            _ if turn_a == turn_b => turn_a,
            _ => return Some(self.packed.add(Node::Binary(operation, a, b))),
        };
        let vector = self.packed.add(Node::Binary(operation, flat_a, flat_b));
        Some(self.swizzled(vector, turn))
    }

    /// a × b for a.yzx b.zxy − a.zxy b.yzx.
    fn vector_product(&mut self, operation: Binary, left: Id, right: Id) -> Option<Id> {
        if operation != Binary::Subtract {
            return None;
        }
        let (a, b) = self.turned_product(left, [NEXT, AFTER_NEXT])?;
        let turned = self.turned_product(right, [AFTER_NEXT, NEXT])?;
        ((a, b) == turned).then(|| self.packed.add(Node::Cross(a, b)))
    }

    /// a and b of the product of these, rotated like this.
    fn turned_product(&self, id: Id, turns: [[usize; 3]; 2]) -> Option<(Id, Id)> {
        match self.packed.node(id) {
            Node::Binary(Binary::Multiply, a, b) => {
                let [(a, turn_a), (b, turn_b)] = [*a, *b].map(|factor| self.unturned(factor));
                ([turn_a, turn_b] == turns).then_some((a, b))
            }
            _ => None,
        }
    }

    /// The vector of which `id` is a rotated copy, and the rotation.
    fn unturned(&self, id: Id) -> (Id, [usize; 3]) {
        match self.packed.node(id) {
            Node::Swizzle(vector, turn) => (*vector, *turn),
            _ => (id, [0, 1, 2]),
        }
    }

    fn swizzled(&mut self, vector: Id, turn: [usize; 3]) -> Id {
        if turn == [0, 1, 2] { vector } else { self.packed.add(Node::Swizzle(vector, turn)) }
    }

    /// The vector, or three equal scalars as one.
    fn widened(&mut self, id: Id) -> Id {
        match self.packed.kind(id) {
            Kind::Number => self.packed.add(Node::Vector([id; 3])),
            _ => id,
        }
    }
}
