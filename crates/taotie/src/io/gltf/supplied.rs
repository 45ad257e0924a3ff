//! The elements that accessors hold in place of those of their buffer views.

use super::reason::Reason;
use gltf::json::accessor::ComponentType;
use std::collections::BTreeMap;

/// The elements of an accessor, without gaps, in the type that they were packed in.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::io) struct Supplied {
    /// The type of a component.
    pub component: ComponentType,
    /// The number of components of an element.
    pub width: usize,
    /// The elements, little-endian.
    pub bytes: Vec<u8>,
}

impl Supplied {
    /// Returns the number of elements.
    pub fn count(&self) -> usize {
        self.bytes.len() / (self.width * self.component.size())
    }
}

/// The elements that accessors hold in place of those of their buffer views, or why they cannot be had.
pub(super) type Supply = BTreeMap<usize, Reason<Supplied>>;
