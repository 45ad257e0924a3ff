//! What accessors hold in place of what their buffer views say.

use super::reason::Reason;
use gltf::json::accessor::ComponentType;
use std::collections::BTreeMap;

/// The elements of an accessor, without gaps, in the type that they were packed in.
pub(super) struct Supplied {
    /// The type of a component.
    pub component: ComponentType,
    /// How many components an element has.
    pub width: usize,
    /// Little-endian.
    pub bytes: Vec<u8>,
}

impl Supplied {
    /// How many elements there are.
    pub fn count(&self) -> usize {
        self.bytes.len() / (self.width * self.component.size())
    }
}

/// What accessors hold in place of what their buffer views say, or why it cannot be had.
pub(super) type Supply = BTreeMap<usize, Reason<Supplied>>;
