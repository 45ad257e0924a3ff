//! The distance between labelled regions of a raster.

/// The label of an empty texel.
pub(super) const NONE: u32 = u32::MAX;

/// Returns the least number of empty texels between two regions of different labels, counted in steps of a king on a
/// chess board; 0 where they touch, `None` where there are no two.
///
/// Every texel gets the label of the region nearest to it by two sweeps (Rosenfeld and Pfaltz 1968), which are exact for
/// this distance. Of a shortest way between two regions some step joins texels of different labels, and their distances
/// add up to the number of texels on it.
pub(super) fn narrowest_gap(labels: Vec<u32>, width: usize) -> Option<u32> {
    let texel = |label: u32| Texel { label, steps: if label == NONE { FAR } else { 0 } };
    let mut texels: Vec<Texel> = labels.into_iter().map(texel).collect();
    sweep(&mut texels, width);
    texels.reverse();
    sweep(&mut texels, width);
    let mut gap = None;
    for at in 0..texels.len() {
        let here = texels[at];
        for near in behind(at, width).map(|at| texels[at]) {
            if near.label != here.label && near.steps.max(here.steps) < FAR {
                let between = near.steps + here.steps;
                gap = Some(gap.map_or(between, |least: u32| least.min(between)));
            }
        }
    }
    gap
}

/// The steps of a texel without a label.
const FAR: u32 = u32::MAX;

/// The region nearest to a texel.
#[derive(Clone, Copy)]
struct Texel {
    label: u32,
    steps: u32,
}

/// Hands the nearest regions on from the first texel to the last.
fn sweep(texels: &mut [Texel], width: usize) {
    for at in 0..texels.len() {
        let nearest = behind(at, width).map(|at| texels[at]).min_by_key(|near| near.steps);
        if let Some(Texel { label, steps }) = nearest
            && steps < FAR
            && steps + 1 < texels[at].steps
        {
            texels[at] = Texel { label, steps: steps + 1 };
        }
    }
}

/// Returns the neighbours of a texel that come before it: to the left, and the three above.
#[inline]
fn behind(at: usize, width: usize) -> impl Iterator<Item = usize> {
    let (column, is_below) = (at % width, at >= width);
    let left = (column > 0).then(|| at - 1);
    let above_left = (column > 0 && is_below).then(|| at - width - 1);
    let above = is_below.then(|| at - width);
    let above_right = (is_below && column + 1 < width).then(|| at - width + 1);
    [left, above_left, above, above_right].into_iter().flatten()
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

    /// Against the distances of all pairs, on rasters of scattered texels.
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
