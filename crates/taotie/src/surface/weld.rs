//! Finding equal elements: the one tool behind every weld.

use crate::math::Vec3;
use rayon::prelude::*;
use rustc_hash::FxBuildHasher;
use std::hash::{BuildHasher, Hash};
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

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
    /// Elements whose hash is not theirs alone are sorted by it, and by key where hashes are equal, so that neither
    /// many elements nor keys that were chosen to collide take long. The classes depend on neither the hash nor the
    /// number of threads.
    pub fn by<K: Hash + Ord>(count: usize, key: impl Fn(usize) -> K + Sync) -> Self {
        let mut elements = not_alone(count, |i| hash(&key(i)));
        elements.par_sort_unstable();
        let firsts: Vec<AtomicU32> = (0..count as u32).into_par_iter().map(AtomicU32::new).collect();
        elements
            .par_chunk_by_mut(|a, b| a >> 32 == b >> 32)
            .filter(|alike| alike.len() > 1)
            .for_each(|alike| find_firsts(alike, &key, &firsts));
        Self::numbered(firsts.into_iter().map(AtomicU32::into_inner).collect())
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

/// The elements, behind their hashes in the upper 32 bits, that may have the same hash as another.
///
/// Each hash has a bit among eight or more an element. Most vertices of a scan are alone at their place, so this
/// leaves few to be sorted.
fn not_alone(count: usize, hash: impl Fn(usize) -> u32 + Sync) -> Vec<u64> {
    let bits = (8 * count).next_power_of_two().clamp(64, 1 << 30);
    let words = || (0..bits / 64).into_par_iter().map(|_| AtomicU64::new(0)).collect::<Vec<_>>();
    let (once, again) = (words(), words());
    let place = |hash: u32| {
        let bit = (u64::from(hash) * bits as u64 >> 32) as usize;
        (bit / 64, 1 << (bit % 64))
    };
    (0..count).into_par_iter().for_each(|i| {
        let (word, mask) = place(hash(i));
        if once[word].fetch_or(mask, Ordering::Relaxed) & mask != 0 {
            again[word].fetch_or(mask, Ordering::Relaxed);
        }
    });
    let element = |i: usize| {
        let hash = hash(i);
        let (word, mask) = place(hash);
        let shared = again[word].load(Ordering::Relaxed) & mask != 0;
        shared.then_some(u64::from(hash) << 32 | i as u64)
    };
    (0..count).into_par_iter().filter_map(element).collect()
}

/// Writes down the first of those elements of equal hash whose keys are equal too.
fn find_firsts<K: Ord>(alike: &mut [u64], key: &impl Fn(usize) -> K, firsts: &[AtomicU32]) {
    let index = |element: &u64| *element as u32 as usize;
    let same = |a: &u64, b: &u64| key(index(a)) == key(index(b));
    if !alike.windows(2).all(|pair| same(&pair[0], &pair[1])) {
        alike.sort_unstable_by_key(|element| (key(index(element)), index(element)));
    }
    for class in alike.chunk_by(same) {
        for other in &class[1..] {
            firsts[index(other)].store(index(&class[0]) as u32, Ordering::Relaxed);
        }
    }
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
