//! Accessor elements that replace those of buffer views.

use super::reason::Reason;
use gltf::json::accessor::ComponentType;
use std::collections::BTreeMap;

/// The elements of an accessor, without gaps, in their packed type.
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

/// The accessor elements that replace those of buffer views, or the reason why they are unavailable.
pub(super) type Supply = BTreeMap<usize, Reason<Supplied>>;
