//! The distance between labelled regions of a raster.

/// The label of an empty texel.
pub(super) const NONE: u32 = u32::MAX;

/// Returns the minimum number of empty texels between two regions of different labels, counted in king's moves on a
/// chessboard; 0 if they touch, `None` if there are no two.
///
/// Every texel gets the label of the region nearest to it by two sweeps (Rosenfeld and Pfaltz 1968), which are exact
/// for this distance. On a shortest path between two regions some step joins texels of different labels, and their
/// distances add up to the number of texels on it.
pub(super) fn narrowest_gap(labels: Vec<u32>, width: usize) -> Option<u32> {
    let texel = |label: u32| u64::from(label) + if label == NONE { FAR } else { 0 };
    let mut texels: Vec<u64> = labels.into_iter().map(texel).collect();
    sweep(&mut texels, width);
    texels.reverse();
    sweep(&mut texels, width);
    let mut gap = FAR;
    for start in (0..texels.len()).step_by(width) {
        for column in 0..width {
            let here = texels[start + column];
            each_behind(&texels, Place { start, column, width }, |near| {
                // Labels are in the lower halves.
                if near as u32 != here as u32 {
                    gap = gap.min((near & !LABEL).saturating_add(here & !LABEL));
                }
            });
        }
    }
    (gap < FAR).then_some((gap / STEP) as u32)
}

/// The region nearest to a texel is encoded as a number: the steps to it in the upper half, its label in the lower,
/// so that the nearer of two is the smaller number. This is one step.
const STEP: u64 = 1 << 32;

/// The label of a texel.
const LABEL: u64 = STEP - 1;

/// The steps of a texel without a region: more than any path has, and no sum of two overflows.
const FAR: u64 = 1 << 62;

/// Propagates the nearest regions from the first texel to the last.
fn sweep(texels: &mut [u64], width: usize) {
    for start in (0..texels.len()).step_by(width) {
        for column in 0..width {
            let mut nearest = texels[start + column];
            each_behind(texels, Place { start, column, width }, |near| nearest = nearest.min(near + STEP));
            texels[start + column] = nearest;
        }
    }
}

/// The position of a texel.
#[derive(Clone, Copy)]
struct Place {
    /// The first texel of its row.
    start: usize,
    column: usize,
    width: usize,
}

/// Calls `give` with the neighbours of a texel that precede it: to the left, and the three above.
#[inline(always)]
fn each_behind(texels: &[u64], place: Place, mut give: impl FnMut(u64)) {
    let Place { start, column, width } = place;
    if column > 0 {
        give(texels[start + column - 1]);
    }
    if start > 0 {
        let above = start - width + column;
        give(texels[above]);
        if column > 0 {
            give(texels[above - 1]);
        }
        if column + 1 < width {
            give(texels[above + 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(rows: &[&str]) -> Option<u32> {
        let texels = rows.iter().flat_map(|row| row.chars());
        narrowest_gap(texels.map(|c| c.to_digit(10).unwrap_or(NONE)).collect(), rows[0].len())
    }

    #[test]
    fn gaps_are_counted_in_empty_texels() {
        assert_eq!(gap(&["1..2"]), Some(2));
        assert_eq!(gap(&["12"]), Some(0));
        assert_eq!(gap(&["1..1", "...."]), None);
        assert_eq!(gap(&["....", "...."]), None);
        assert_eq!(gap(&["1...", "....", "....", "...2"]), Some(2), "along a diagonal");
        assert_eq!(gap(&["...1", "....", "2..."]), Some(2));
        assert_eq!(gap(&["1.....", "......", "2....3"]), Some(1), "the nearest pair");
        assert_eq!(gap(&["1....1", "......", "..2..."]), Some(1));
    }

    /// Compares with the distances of all pairs, on rasters of scattered texels.
    #[test]
    fn gaps_are_those_of_all_pairs() {
        let mut state = 7u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % below
        };
        for round in 0..200 {
            let (width, height) = (1 + random(12) as usize, 1 + random(12) as usize);
            let rarity = 2 + random(12);
            let label = |_| if random(rarity) == 0 { random(3) } else { NONE };
            let labels: Vec<u32> = (0..width * height).map(label).collect();
            let place = |i: usize| ((i % width) as i64, (i / width) as i64);
            let labelled = || labels.iter().enumerate().filter(|(_, label)| **label != NONE);
            let labelled = || labelled().map(|(i, label)| (place(i), *label));
            let pairs = labelled().flat_map(|one| labelled().map(move |other| (one, other)));
            let apart = pairs.filter(|((_, a), (_, b))| a != b);
            let gaps = apart.map(|(((x, y), _), ((u, v), _))| (x - u).abs().max((y - v).abs()) as u32 - 1);
            let expected = gaps.min();
            assert_eq!(narrowest_gap(labels.clone(), width), expected, "round {round}");
        }
    }
}
