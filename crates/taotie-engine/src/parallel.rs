//! Parallel loops whose machinery is compiled only once, for any loop body.
//!
//! Rayon's iterators are compiled separately for each loop that uses them. Here a loop is a function of an index, and
//! all results are in index order, regardless of scheduling.

use crate::error::Result;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The maximum number of elements a thread takes at a time.
const LONGEST: usize = 4096;

/// The number of elements up to which waking other threads takes longer than the work: a model may have a million
/// tiny meshes.
const FEW: usize = 16;

/// Calls `work` with each number below `count`.
pub(crate) fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    match count {
        0 | 1 => (0..count).for_each(work),
        _ => (0..count).into_par_iter().with_max_len(1).for_each(work),
    }
}

/// Calls `work` with the index and elements of each piece of `size` elements; the last one may be shorter.
pub fn pieces<T: Send>(all: &mut [T], size: usize, work: &(dyn Fn(usize, &mut [T]) + Sync)) {
    let pieces: Vec<Mutex<&mut [T]>> = all.chunks_mut(size.max(1)).map(Mutex::new).collect();
    each(pieces.len(), &|i| work(i, &mut pieces[i].lock().unwrap_or_else(PoisonError::into_inner)));
}

/// Calls `change` with the index of each element and the element.
pub fn change<T: Send>(all: &mut [T], change: impl Fn(usize, &mut T) + Sync) {
    let size = cheap_piece_size(all.len());
    pieces(all, size, &|piece, part| {
        for (i, element) in part.iter_mut().enumerate() {
            change(piece * size + i, element);
        }
    });
}

/// Returns the value of each number below `count`.
pub fn collect<T: Send + Default + Clone>(count: usize, value: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let mut values = vec![T::default(); count];
    change(&mut values, |i, out| *out = value(i));
    values
}

/// Returns the value of each number below `count`, for expensive tasks: one number at a time.
pub fn tasks<T: Send>(count: usize, task: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    pieces(&mut results, 1, &|i, slot| slot[0] = Some(task(i)));
    results.into_iter().flatten().collect()
}

/// Returns the numbers below `count` for which `is` holds.
pub fn filter(count: usize, is: impl Fn(usize) -> bool + Sync) -> Vec<usize> {
    let size = cheap_piece_size(count);
    let parts = tasks(count.div_ceil(size), &|piece| {
        let numbers = piece * size..((piece + 1) * size).min(count);
        numbers.filter(|i| is(*i)).collect::<Vec<usize>>()
    });
    parts.concat()
}

/// Returns the count of numbers below `count` for which `is` holds.
pub(crate) fn count(count: usize, is: impl Fn(usize) -> bool + Sync) -> usize {
    fold(count, |sum: &mut usize, i| *sum += usize::from(is(i))).into_iter().sum()
}

/// Returns sums over pieces of the numbers below `count`, in order; each starts from the default. The pieces depend
/// on the number of threads.
pub fn fold<T: Send + Default>(count: usize, add: impl Fn(&mut T, usize) + Sync) -> Vec<T> {
    let size = piece_size(count);
    tasks(count.div_ceil(size), &|piece| {
        let mut sum = T::default();
        (piece * size..((piece + 1) * size).min(count)).for_each(|i| add(&mut sum, i));
        sum
    })
}

/// The number of elements a thread takes at a time: several pieces per thread, since some take longer than others.
fn piece_size(count: usize) -> usize {
    count.div_ceil(rayon::current_num_threads() * 32).clamp(1, LONGEST)
}

/// Like [`piece_size`], for elements that take next to no time: a few are one piece.
fn cheap_piece_size(count: usize) -> usize {
    if count <= FEW { FEW } else { piece_size(count) }
}

/// Returns the first number below `count` for which `is` holds. Pieces after one with such a number are skipped.
pub fn first(count: usize, is: impl Fn(usize) -> bool + Sync) -> Option<usize> {
    let size = cheap_piece_size(count);
    let lowest = AtomicUsize::new(count);
    each(count.div_ceil(size), &|piece| {
        let mut numbers = piece * size..((piece + 1) * size).min(lowest.load(Ordering::Relaxed));
        if let Some(found) = numbers.find(|i| is(*i)) {
            lowest.fetch_min(found, Ordering::Relaxed);
        }
    });
    let lowest = lowest.into_inner();
    (lowest < count).then_some(lowest)
}

/// Returns the value of each number below `count`, for expensive tasks as in [`tasks`]. Numbers after one that fails
/// are skipped.
///
/// # Errors
/// That of the first number that fails, however the work is scheduled.
pub fn try_tasks<T: Send>(count: usize, task: &(dyn Fn(usize) -> Result<T> + Sync)) -> Result<Vec<T>> {
    let lowest = AtomicUsize::new(count);
    let results = tasks(count, &|i| {
        let is_wanted = i <= lowest.load(Ordering::Relaxed);
        is_wanted.then(|| task(i).inspect_err(|_| _ = lowest.fetch_min(i, Ordering::Relaxed)))
    });
    results.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn results_stand_in_the_order_of_the_numbers() {
        for len in [0usize, 1, 63, 100_000] {
            assert_eq!(collect(len, |i| i * 3), (0..len).map(|i| i * 3).collect::<Vec<_>>());
            assert_eq!(tasks(len.min(100), &|i| i.to_string()).len(), len.min(100));
            let thirds = filter(len, |i| i % 3 == 0);
            assert_eq!(thirds, (0..len).filter(|i| i % 3 == 0).collect::<Vec<_>>());
            assert_eq!(count(len, |i| i % 3 == 0), thirds.len());
            let sum: usize = fold(len, |sum: &mut usize, i| *sum += i).into_iter().sum();
            assert_eq!(sum, (0..len).sum::<usize>());
        }
        assert_eq!(tasks(3, &|i| i.to_string()), ["0", "1", "2"]);
    }

    #[test]
    fn pieces_come_with_their_numbers() {
        let mut rows = vec![0; 10];
        pieces(&mut rows, 4, &|i, row| row.iter_mut().for_each(|v| *v = i * 10 + row_length(i)));
        assert_eq!(rows, [4, 4, 4, 4, 14, 14, 14, 14, 22, 22]);
        fn row_length(i: usize) -> usize {
            if i == 2 { 2 } else { 4 }
        }
    }

    #[test]
    fn the_first_is_found_wherever_it_stands() {
        for len in [0usize, 1, 63, 100_000] {
            for wanted in [0, 1, len / 2, len.saturating_sub(1), len] {
                let expected = (wanted..len).next();
                assert_eq!(first(len, |i| i >= wanted), expected, "one of {len} and all after it");
                assert_eq!(first(len, |i| i == wanted), expected, "only one of {len}");
            }
        }
    }

    #[test]
    fn the_first_error_is_told_and_numbers_after_it_are_skipped() {
        assert_eq!(try_tasks(3, &|i| Ok(i.to_string())).unwrap(), ["0", "1", "2"]);
        for _ in 0..100 {
            let result = try_tasks(1000, &|i| {
                if i % 100 == 7 { Err(Error::invalid(i.to_string(), "bad")) } else { Ok(i) }
            });
            assert!(result.unwrap_err().to_string().starts_with("7:"));
        }
        let called = AtomicUsize::new(0);
        let cancelled = try_tasks(100_000, &|_| {
            called.fetch_add(1, Ordering::Relaxed);
            Err::<(), _>(Error::Cancelled)
        });
        assert!(matches!(cancelled, Err(Error::Cancelled)) && called.into_inner() < 1000);
    }
}
