//! Fills the space between UV islands, so that no filter or mip level shows a seam, and the colours of invisible
//! texels.

use super::maps::{BakedMaps, Plane, TexelStatus};
use crate::parallel;

/// Texels around each UV island that take the value of the nearest covered one before the rest is filled: more than
/// any bilinear or anisotropic lookup at the finest level reaches across a border.
const PADDING: u32 = 4;

/// The minimum alpha of a visible texel: one of 255 codes.
const SEEN: f32 = 1.0 / 255.0;

/// Gives free texels values: `steps` of dilation of the UV islands, each texel copied from a neighbour; or with
/// `None` first a narrow padding and then, for the rest, the mean of the smallest non-empty square of 2ⁿ texels
/// around them, aligned like mip levels. Each texel of any mip level is thus the mean of the covered texels below it,
/// and of nothing else. Texels with alpha 0 take the colours around them.
pub(super) fn fill(maps: &mut BakedMaps, steps: Option<u32>) {
    let size = [maps.width as usize, maps.height as usize];
    let mut known: Vec<bool> = maps.texels.iter().map(|texel| *texel != TexelStatus::Free).collect();
    if !known.contains(&true) {
        return;
    }
    fill_hidden(maps, &known, size);
    maps.filled_planes().for_each(|(plane, numbers)| match (plane.channels(), plane.is_label()) {
        (1, false) => fill_missing(numbers.as_chunks_mut::<1>().0, (&known, size), mean),
        (1, true) => fill_missing(numbers.as_chunks_mut::<1>().0, (&known, size), first),
        _ => fill_missing(vectors(numbers), (&known, size), mean),
    });
    for _ in 0..steps.unwrap_or(PADDING) {
        let grown = neighbours(&known, size);
        if grown.is_empty() {
            break;
        }
        maps.filled_planes().for_each(|(plane, numbers)| match plane.channels() {
            1 => copy(numbers, &grown),
            _ => copy(vectors(numbers), &grown),
        });
        grown.iter().for_each(|(to, _)| known[*to] = true);
    }
    if steps.is_none() {
        maps.filled_planes().for_each(|(plane, numbers)| match (plane.channels(), plane.is_label()) {
            (1, false) => pull_push(numbers.as_chunks_mut::<1>().0, (&known, size), mean),
            (1, true) => pull_push(numbers.as_chunks_mut::<1>().0, (&known, size), first),
            _ => pull_push(vectors(numbers), (&known, size), mean),
        });
    }
}

fn vectors(numbers: &mut [f32]) -> &mut [[f32; 3]] {
    numbers.as_chunks_mut().0
}

/// Gives baked texels whose value is missing, NaN, those around them; zero if all are missing.
fn fill_missing<const N: usize>(
    plane: &mut [[f32; N]],
    (baked, size): (&[bool], [usize; 2]),
    joined: impl Fn([Option<[f32; N]>; 4]) -> Option<[f32; N]> + Sync,
) {
    let is_missing = |texel: &[f32; N]| texel[0].is_nan();
    if !plane.iter().any(is_missing) {
        return;
    }
    let known: Vec<bool> = baked.iter().zip(&*plane).map(|(is, texel)| *is && !is_missing(texel)).collect();
    let mut filled = plane.to_vec();
    if known.contains(&true) {
        pull_push(&mut filled, (&known, size), joined);
    }
    for (texel, filled) in plane.iter_mut().zip(filled).filter(|(texel, _)| is_missing(texel)) {
        *texel = if is_missing(&filled) { [0.0; N] } else { filled };
    }
}

/// Gives baked texels with alpha 0, which are invisible, the colours of visible texels around them.
fn fill_hidden(maps: &mut BakedMaps, baked: &[bool], size: [usize; 2]) {
    if !maps.has(Plane::Albedo) || !maps.has(Plane::Alpha) {
        return;
    }
    let alpha = maps.numbers(Plane::Alpha);
    let seen: Vec<bool> = baked.iter().zip(alpha).map(|(is, alpha)| *is && *alpha >= SEEN).collect();
    if seen == baked || !seen.contains(&true) {
        return;
    }
    let mut known = seen;
    let albedo = maps.vectors_mut(Plane::Albedo);
    for _ in 0..PADDING {
        let grown = neighbours(&known, size);
        copy(albedo, &grown);
        grown.iter().for_each(|(to, _)| known[*to] = true);
    }
    pull_push(albedo, (&known, size), mean);
    // Free texels have no colour yet.
    albedo.iter_mut().zip(baked).filter(|(_, is)| !**is).for_each(|(color, _)| *color = [0.0; 3]);
}

/// Returns the free texels next to known ones, each with its first known neighbour: left, right, above, below.
fn neighbours(known: &[bool], [width, height]: [usize; 2]) -> Vec<(usize, usize)> {
    let row = |y: usize| {
        let is_free = move |x: &usize| !known[y * width + x];
        (0..width).filter(is_free).filter_map(move |x| {
            let i = y * width + x;
            let sides = [
                (x > 0).then(|| i - 1),
                (x + 1 < width).then(|| i + 1),
                (y > 0).then(|| i - width),
                (y + 1 < height).then(|| i + width),
            ];
            sides.into_iter().flatten().find(|k| known[*k]).map(|k| (i, k))
        })
    };
    parallel::fold(height, |found: &mut Vec<(usize, usize)>, y| found.extend(row(y))).concat()
}

fn copy<T: Copy>(plane: &mut [T], from: &[(usize, usize)]) {
    if !plane.is_empty() {
        from.iter().for_each(|(to, from)| plane[*to] = plane[*from]);
    }
}

/// A level of the gap-filling pyramid; `None` if a texel covers no known texel.
struct PyramidLevel<const N: usize> {
    size: [usize; 2],
    texels: Vec<Option<[f32; N]>>,
}

/// Fills unknown texels from the means of ever larger squares.
///
/// Source: Gortler et al. 1996, "The lumigraph", §3.4, with boxes as filters.
fn pull_push<const N: usize>(
    plane: &mut [[f32; N]],
    (known, size): (&[bool], [usize; 2]),
    joined: impl Fn([Option<[f32; N]>; 4]) -> Option<[f32; N]> + Sync,
) {
    let mut levels = vec![coarser(size, |i| known[i].then(|| plane[i]), &joined)];
    while let Some(last) = levels.last().filter(|level| level.texels.contains(&None)) {
        levels.push(coarser(last.size, |i| last.texels[i], &joined));
    }
    for k in (1..levels.len()).rev() {
        let (fine, coarse) = levels.split_at_mut(k);
        let (fine, coarse) = (&mut fine[k - 1], &coarse[0]);
        let width = fine.size[0];
        parallel::pieces(&mut fine.texels, width, &|y, row| {
            for (x, texel) in row.iter_mut().enumerate() {
                *texel = texel.or(coarse.texels[y / 2 * coarse.size[0] + x / 2]);
            }
        });
    }
    let coarse = &levels[0];
    parallel::pieces(plane, size[0], &|y, row| {
        for (x, texel) in row.iter_mut().enumerate().filter(|(x, _)| !known[y * size[0] + x]) {
            *texel = coarse.texels[y / 2 * coarse.size[0] + x / 2].unwrap_or(*texel);
        }
    });
}

/// Joins the known texels in squares of two by two.
fn coarser<const N: usize>(
    [width, height]: [usize; 2],
    at: impl Fn(usize) -> Option<[f32; N]> + Sync,
    joined: &(impl Fn([Option<[f32; N]>; 4]) -> Option<[f32; N]> + Sync),
) -> PyramidLevel<N> {
    let size = [width.div_ceil(2), height.div_ceil(2)];
    let square = |i: usize| {
        let (x, y) = (i % size[0] * 2, i / size[0] * 2);
        let corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
        joined(corners.map(|(x, y)| (x < width && y < height).then(|| at(y * width + x)).flatten()))
    };
    PyramidLevel { size, texels: parallel::collect(size[0] * size[1], square) }
}

/// Returns the mean of the known texels.
fn mean<const N: usize>(texels: [Option<[f32; N]>; 4]) -> Option<[f32; N]> {
    let (mut sum, mut count) = ([0.0; N], 0);
    for texel in texels.into_iter().flatten() {
        (0..N).for_each(|k| sum[k] += texel[k]);
        count += 1;
    }
    (count > 0).then(|| sum.map(|v| v / count as f32))
}

/// Returns the first known texel, for numbers that have no mean.
fn first<const N: usize>(texels: [Option<[f32; N]>; 4]) -> Option<[f32; N]> {
    texels.into_iter().flatten().next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{MapKind, Maps};

    /// Returns two UV islands of different heights on a map of 64 × 64.
    fn islands() -> BakedMaps {
        let mut maps = BakedMaps::new([64, 64], Maps::default().with(MapKind::Height).with(MapKind::Albedo));
        for y in 0..64 {
            for x in 0..64 {
                let height = match (x, y) {
                    (3..=20, 5..=30) => 1.0,
                    (40..=60, 9..=44) => 3.0,
                    _ => continue,
                };
                maps.texels[y * 64 + x] = TexelStatus::Met;
                maps.numbers_mut(Plane::Height)[y * 64 + x] = height;
                maps.vectors_mut(Plane::Albedo)[y * 64 + x] = [height; 3];
            }
        }
        maps
    }

    #[test]
    fn texels_that_no_dilation_reaches_have_no_label() {
        let mut maps = BakedMaps::new([8, 8], Maps::default().with(MapKind::ObjectId));
        (maps.texels[9], maps.numbers_mut(Plane::ObjectId)[9]) = (TexelStatus::Met, 0.0);
        fill(&mut maps, Some(1));
        let labels = maps.numbers(Plane::ObjectId);
        assert_eq!((labels[9], labels[8], labels[63]), (0.0, 0.0, -1.0));
    }

    #[test]
    fn every_mip_texel_is_made_of_islands_alone() {
        let mut maps = islands();
        // The initial values of free texels must not show up anywhere.
        for i in 0..maps.numbers(Plane::Height).len() {
            if maps.texels[i] == TexelStatus::Free {
                maps.numbers_mut(Plane::Height)[i] = -1000.0;
            }
        }
        let before = maps.clone();
        fill(&mut maps, None);
        let rounding = 1e-5;
        let is_of_islands = |v: &f32| (1.0 - rounding..=3.0 + rounding).contains(v);
        for (i, texel) in before.texels.iter().enumerate() {
            assert!(
                *texel == TexelStatus::Free
                    || maps.numbers(Plane::Height)[i] == before.numbers(Plane::Height)[i]
            );
            assert!(is_of_islands(&maps.numbers(Plane::Height)[i]), "{}", maps.numbers(Plane::Height)[i]);
        }
        let mut level = maps.numbers(Plane::Height).to_vec();
        let mut width = 64;
        while width > 2 {
            let at = |x: usize, y: usize| level[y * width + x];
            let half = width / 2;
            let next: Vec<f32> = (0..half * half)
                .map(|i| (i % half * 2, i / half * 2))
                .map(|(x, y)| (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4.0)
                .collect();
            (level, width) = (next, half);
            // A texel that covers only one UV island and its surroundings belongs to that island: none is darker than
            // every island.
            assert!(level.iter().all(is_of_islands));
        }
        assert!(level[0] < 1.5 && level[1] > 2.5, "both UV islands are still distinct: {level:?}");
    }

    #[test]
    fn what_is_not_there_has_the_colour_of_what_is_around_it() {
        let green = [0.1, 0.9, 0.2];
        for steps in [None, Some(3)] {
            let kinds = Maps::default().with(MapKind::Albedo).with(MapKind::Alpha);
            let mut maps = BakedMaps::new([64, 64], kinds);
            for (i, (x, y)) in (0..64 * 64).map(|i| (i, (i % 64, i / 64))) {
                if (8..56).contains(&x) && (8..56).contains(&y) {
                    let is_leaf = (20..30).contains(&x);
                    maps.texels[i] = TexelStatus::Met;
                    maps.vectors_mut(Plane::Albedo)[i] = if is_leaf { green } else { [0.0; 3] };
                    maps.numbers_mut(Plane::Alpha)[i] = if is_leaf { 1.0 } else { 0.0 };
                }
            }
            let before = maps.clone();
            fill(&mut maps, steps);
            let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
            for i in (0..64 * 64).filter(|i| before.texels[*i] == TexelStatus::Met) {
                assert!(
                    near(maps.vectors(Plane::Albedo)[i], green),
                    "{i}: {:?}",
                    maps.vectors(Plane::Albedo)[i]
                );
                assert_eq!(maps.numbers(Plane::Alpha)[i], before.numbers(Plane::Alpha)[i]);
            }
            // Texels that no step reaches are unchanged.
            let corner = if steps.is_none() { green } else { [0.0; 3] };
            assert!(near(maps.vectors(Plane::Albedo)[0], corner), "{:?}", maps.vectors(Plane::Albedo)[0]);
        }
    }

    #[test]
    fn numbers_of_things_are_never_averaged() {
        let mut maps = BakedMaps::new([64, 64], Maps::default().with(MapKind::MaterialId));
        for (x, id) in [(3, 2.0), (4, 5.0), (60, 9.0)] {
            maps.texels[10 * 64 + x] = TexelStatus::Met;
            maps.numbers_mut(Plane::MaterialId)[10 * 64 + x] = id;
        }
        fill(&mut maps, None);
        assert!(maps.numbers(Plane::MaterialId).iter().all(|id| [2.0, 5.0, 9.0].contains(id)));
    }

    #[test]
    fn missing_values_are_those_around_them() {
        for steps in [None, Some(2)] {
            let mut maps = islands();
            let heights = maps.numbers_mut(Plane::Height);
            (0..4).for_each(|y| heights[(10 + y) * 64 + 8] = f32::NAN);
            fill(&mut maps, steps);
            let heights = maps.numbers(Plane::Height);
            assert!(
                (0..4).all(|y| heights[(10 + y) * 64 + 8] == 1.0) && heights.iter().all(|v| v.is_finite())
            );
            let mut lost = islands();
            lost.numbers_mut(Plane::Height).fill(f32::NAN);
            fill(&mut lost, steps);
            assert!(lost.numbers(Plane::Height).iter().all(|v| *v == 0.0));
        }
    }

    #[test]
    fn padding_is_as_wide_as_asked() {
        let mut maps = islands();
        fill(&mut maps, Some(3));
        let at = |x: usize, y: usize| {
            (maps.numbers(Plane::Height)[y * 64 + x], maps.vectors(Plane::Albedo)[y * 64 + x])
        };
        assert_eq!(at(23, 10), (1.0, [1.0; 3]));
        assert_eq!(at(24, 10), (0.0, [0.0; 3]));
        assert_eq!(at(0, 10), (1.0, [1.0; 3]));
        let mut empty = BakedMaps::new([8, 8], Maps::default().with(MapKind::Height));
        fill(&mut empty, None);
        assert!(empty.numbers(Plane::Height).iter().all(|v| *v == 0.0));
    }
}
