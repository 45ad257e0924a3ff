//! Finds equal elements, the basis of every weld, and the shells that they connect.

use crate::groups::DisjointSets;
use crate::math::Vec3;
use crate::mesh::Mesh;
use crate::parallel;
use rayon::prelude::*;
use rustc_hash::FxBuildHasher;
use std::hash::{BuildHasher, Hash};
use std::sync::atomic::{AtomicU32, Ordering};

/// Elements grouped into classes of equal keys, numbered in order of first appearance.
pub struct Classes {
    /// The class of each element.
    pub of: Vec<u32>,
    /// The first element of each class.
    pub firsts: Vec<u32>,
}

impl Classes {
    /// Groups the elements 0 to `count` − 1, at most 2^32 − 1, by `key`.
    ///
    /// Equal elements are usually near each other, so each is first searched for among the preceding ones nearby. New
    /// ones are sorted by hash, and if hashes are equal and keys are not, by key, so that neither many elements nor
    /// keys chosen to collide take long. The classes depend on neither the hash nor the number of threads.
    pub fn by<K: Hash + Ord>(count: usize, key: impl Fn(usize) -> K + Sync) -> Self {
        let mut firsts = vec![0; count];
        parallel::pieces(&mut firsts, NEAR, &|block, part| find_near(part, block * NEAR, &key));
        let new = parallel::collect(count.div_ceil(64), |word| new_of(&firsts, word));
        let is_new = |i: usize| new[i / 64] >> (i % 64) & 1 == 1;
        let mut elements = Vec::with_capacity(new.iter().map(|word| word.count_ones() as usize).sum());
        elements.extend((0..count).filter(|i| is_new(*i)).map(|i| i as u64));
        parallel::change(&mut elements, |_, i| *i |= u64::from(hash(&key(*i as usize))) << 32);
        let mut firsts = firsts_by_hash(elements, firsts);
        // In the order of elements, whose keys are near each other.
        let differs = |i: usize| {
            let first = firsts[i] as usize;
            is_new(i) && first != i && key(first) != key(i)
        };
        let mut collided = parallel::filter(count, differs);
        collided.par_sort_unstable_by_key(|i| (key(*i), *i));
        for class in collided.chunk_by(|a, b| key(*a) == key(*b)) {
            class.iter().for_each(|i| firsts[*i] = class[0] as u32);
        }
        Self::numbered(firsts)
    }

    /// Numbers the classes, given for each element the first of its class, or an earlier one that leads there.
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

/// The number of elements among which each is first searched for; their indices plus one fit 16 bits.
const NEAR: usize = 1 << 15;

/// Writes to `firsts` the first element, from `start` onwards, that equals each one, as far as it is found quickly.
fn find_near<K: Hash + Ord>(firsts: &mut [u32], start: usize, key: &impl Fn(usize) -> K) {
    /// The maximum number of slots inspected, so that keys chosen to collide do not take long.
    const SLOTS: usize = 8;
    // The upper half of a hash, and the index of its element plus one; 0 if there is none.
    let mut table = vec![0u32; 2 * firsts.len().next_power_of_two()];
    let mask = table.len() - 1;
    for (i, first) in firsts.iter_mut().enumerate() {
        let own = key(start + i);
        let hash = hash(&own);
        *first = (start + i) as u32;
        for slot in (hash as usize..).take(SLOTS) {
            let entry = &mut table[slot & mask];
            if *entry == 0 {
                *entry = hash & 0xFFFF_0000 | (i + 1) as u32;
                break;
            }
            let near = start + (*entry & 0xFFFF) as usize - 1;
            if (*entry ^ hash) >> 16 == 0 && key(near) == own {
                *first = near as u32;
                break;
            }
        }
    }
}

/// Returns which of the 64 elements of a word are their own firsts, the lowest bit first.
fn new_of(firsts: &[u32], word: usize) -> u64 {
    let elements = firsts.iter().enumerate().skip(word * 64).take(64);
    elements.fold(0, |bits, (i, first)| bits | u64::from(*first as usize == i) << (i % 64))
}

/// Writes to `firsts` the first element with the hash of each one. Elements are passed as their hash followed by
/// their index.
fn firsts_by_hash(mut elements: Vec<u64>, firsts: Vec<u32>) -> Vec<u32> {
    elements.par_sort_unstable();
    let firsts: Vec<AtomicU32> = firsts.into_iter().map(AtomicU32::new).collect();
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

/// The bits of numbers, without the sign of zero, so that equal finite numbers have equal bits.
pub fn bits<const N: usize>(values: [f32; N]) -> [u32; N] {
    values.map(|v| (v + 0.0).to_bits())
}

/// The classes of equal positions.
pub fn by_position(positions: &[Vec3]) -> Classes {
    Classes::by(positions.len(), |i| bits(positions[i].to_array()))
}

/// Returns a label for each triangle, the same for those that are connected at shared positions.
pub fn shell_labels(mesh: &Mesh) -> Vec<u32> {
    let places = by_position(mesh.positions());
    let mut sets = DisjointSets::new(places.firsts.len());
    for [a, b, c] in mesh.triangles().iter().map(|t| t.map(|v| places.of[v as usize])) {
        sets.join(a, b);
        sets.join(b, c);
    }
    let lowest = sets.into_lowest();
    mesh.triangles().iter().map(|[v, ..]| lowest[places.of[*v as usize] as usize]).collect()
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

    /// All keys have the same hash, and every class is found.
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

    /// Equal keys are found whether they are near each other or far apart, like a map finds them.
    #[test]
    fn classes_are_those_of_a_map() {
        for spread in [1usize, 10, 40_000, 1_000_000] {
            let key = |i: usize| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20) % spread + i / 1000;
            let classes = Classes::by(150_000, key);
            let (mut known, mut firsts) = (std::collections::HashMap::new(), Vec::new());
            for i in 0..150_000 {
                let class = *known.entry(key(i)).or_insert_with(|| {
                    firsts.push(i as u32);
                    firsts.len() as u32 - 1
                });
                assert_eq!(classes.of[i], class, "{i} of {spread}");
            }
            assert_eq!(classes.firsts, firsts);
        }
    }

    #[test]
    fn zero_has_one_sign() {
        let at = |x: f32| Vec3::new(x, 1.0, 2.0);
        assert_eq!(by_position(&[at(0.0), at(-0.0), at(1.0)]).of, [0, 0, 1]);
    }
}
