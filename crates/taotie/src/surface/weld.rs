//! Finding equal elements: the one tool behind every weld.

use crate::math::Vec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::Hash;

/// Elements sorted into classes of equal keys, numbered in order of first appearance.
pub(super) struct Classes {
    /// The class of each element.
    pub of: Vec<u32>,
    /// The first element of each class.
    pub firsts: Vec<u32>,
}

impl Classes {
    /// Sorts the elements 0 to `count` − 1 by `key`.
    pub fn by<K: Hash + Eq>(count: usize, key: impl Fn(usize) -> K) -> Self {
        let mut known = HashMap::with_capacity(count / 2);
        let mut firsts = Vec::new();
        let mut class_of = |i: usize| match known.entry(key(i)) {
            Entry::Occupied(class) => *class.get(),
            Entry::Vacant(place) => {
                firsts.push(i as u32);
                *place.insert(firsts.len() as u32 - 1)
            }
        };
        let of = (0..count).map(&mut class_of).collect();
        Self { of, firsts }
    }

    /// Splits each class by a further `key`.
    pub fn split_by<K: Hash + Eq>(&self, key: impl Fn(usize) -> K) -> Self {
        Self::by(self.of.len(), |i| (self.of[i], key(i)))
    }
}

/// The bits of numbers, zero having one sign, so that equal finite numbers have equal bits.
pub(super) fn bits<const N: usize>(values: [f32; N]) -> [u32; N] {
    values.map(|v| (v + 0.0).to_bits())
}

/// The classes of equal positions.
pub(super) fn by_position(positions: &[Vec3]) -> Classes {
    Classes::by(positions.len(), |i| bits(positions[i].to_array()))
}
