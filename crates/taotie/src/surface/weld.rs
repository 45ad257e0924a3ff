//! Finding equal elements: the one tool behind every weld.

use crate::math::Vec3;
use crate::parallel;
use rayon::prelude::*;
use rustc_hash::FxBuildHasher;
use std::hash::{BuildHasher, Hash};
use std::sync::atomic::{AtomicU32, Ordering};

/// Elements sorted into classes of equal keys, numbered in order of first appearance.
pub(crate) struct Classes {
    /// The class of each element.
    pub of: Vec<u32>,
    /// The first element of each class.
    pub firsts: Vec<u32>,
}

impl Classes {
    /// Sorts the elements 0 to `count` − 1, at most 2^32 − 1, by `key`.
    ///
    /// Elements are sorted by hash, and where hashes are equal and keys are not, by key, so that neither many elements
    /// nor keys that were chosen to collide take long. The classes depend on neither the hash nor the number of
    /// threads.
    pub fn by<K: Hash + Ord>(count: usize, key: impl Fn(usize) -> K + Sync) -> Self {
        let hashed = |i: usize| u64::from(hash(&key(i))) << 32 | i as u64;
        let mut firsts = firsts_by_hash(parallel::collect(count, hashed));
        // In the order of elements, since those that are alike are most often near each other.
        let differs = |i: usize| {
            let first = firsts[i] as usize;
            first != i && key(first) != key(i)
        };
        let mut collided = parallel::filter(count, differs);
        collided.par_sort_unstable_by_key(|i| (key(*i), *i));
        for class in collided.chunk_by(|a, b| key(*a) == key(*b)) {
            class.iter().for_each(|i| firsts[*i] = class[0] as u32);
        }
        Self::numbered(firsts)
    }

    /// Numbers the classes, given the first element of its class for each element.
    fn numbered(mut of: Vec<u32>) -> Self {
        let mut firsts = Vec::with_capacity(of.len());
        for i in 0..of.len() {
            let first = of[i] as usize;
            if first == i {
                of[i] = firsts.len() as u32;
                firsts.push(i as u32);
            } else {
                of[i] = of[first];
            }
        }
        Self { of, firsts }
    }

    /// Splits each class by a further `key`.
    pub fn split_by<K: Hash + Ord>(&self, key: impl Fn(usize) -> K + Sync) -> Self {
        Self::by(self.of.len(), |i| (self.of[i], key(i)))
    }
}

/// The first of the elements with the hash of each one. They come as their hash and below it their number.
fn firsts_by_hash(mut elements: Vec<u64>) -> Vec<u32> {
    elements.par_sort_unstable();
    // Each element is alike with itself at least, so none keeps its zero.
    let firsts: Vec<AtomicU32> = vec![0; elements.len()].into_iter().map(AtomicU32::new).collect();
    elements.par_chunk_by(|a, b| a >> 32 == b >> 32).for_each(|alike| {
        let first = alike[0] as u32;
        alike.iter().for_each(|i| firsts[*i as u32 as usize].store(first, Ordering::Relaxed));
    });
    drop(elements);
    firsts.into_iter().map(AtomicU32::into_inner).collect()
}

/// The same on every machine and in every run.
fn hash(key: &impl Hash) -> u32 {
    FxBuildHasher.hash_one(key) as u32
}

/// The bits of numbers, zero having one sign, so that equal finite numbers have equal bits.
pub(crate) fn bits<const N: usize>(values: [f32; N]) -> [u32; N] {
    values.map(|v| (v + 0.0).to_bits())
}

/// The classes of equal positions.
pub(crate) fn by_position(positions: &[Vec3]) -> Classes {
    Classes::by(positions.len(), |i| bits(positions[i].to_array()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_numbered_by_first_appearance() {
        let keys = [7, 3, 7, 9, 3, 7, 1];
        let classes = Classes::by(keys.len(), |i| keys[i]);
        assert_eq!((classes.of, classes.firsts), (vec![0, 1, 0, 2, 1, 0, 3], vec![0, 1, 3, 6]));
    }

    /// All keys have one hash, and every class is found.
    #[test]
    fn collisions_are_told_apart() {
        #[derive(PartialEq, Eq, PartialOrd, Ord)]
        struct Colliding(usize);
        impl Hash for Colliding {
            fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
                state.write_u32(1);
            }
        }
        let classes = Classes::by(100_000, |i| Colliding(i * 7 % 50_000));
        assert_eq!(classes.firsts, (0..50_000).collect::<Vec<u32>>());
        assert!((0..100_000).all(|i| classes.of[i] == (i % 50_000) as u32));
    }

    #[test]
    fn zero_has_one_sign() {
        let at = |x: f32| Vec3::new(x, 1.0, 2.0);
        assert_eq!(by_position(&[at(0.0), at(-0.0), at(1.0)]).of, [0, 0, 1]);
    }
}
