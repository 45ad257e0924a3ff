//! Laws of coverage: every sample of a shared edge belongs to exactly one triangle, at every SIMD level.

use crate::random::Random;
use taotie_engine::math::SimdLevel;
use taotie_engine::raster::{
    Bins, Faces, Geometry, SamplePattern, TILE_PIXELS, Tile, TilePlane, TileSample, Viewport, bin,
    rasterize_layers, rasterize_opaque,
};

const SIDE: u32 = 128;

fn viewport(samples: u32) -> Viewport {
    Viewport { width: SIDE, height: SIDE, pattern: SamplePattern::new(samples).unwrap() }
}

/// Returns how often each pixel of the picture is covered at a sample.
fn coverage(bins: &Bins, viewport: &Viewport, sample: usize, simd: SimdLevel) -> Vec<u32> {
    let (across, down) = viewport.tiles();
    let mut counts = vec![0; (across * down) as usize * TILE_PIXELS];
    let offset = viewport.pattern.offsets()[sample];
    for index in 0..(across * down) as usize {
        let tile = Tile::new(viewport, index);
        let at = TileSample { tile: &tile, offset };
        for layer in rasterize_layers(bins, at, simd, &TilePlane::default()).unwrap() {
            counts[index * TILE_PIXELS + layer.pixel as usize] += 1;
        }
    }
    counts
}

/// Returns a sheet of jittered cells that covers more than the picture, each cell cut into two triangles, with
/// corners at subpixel positions, about half of them on sample points.
fn sheet(cells: usize, random: &mut Random) -> (Vec<[f32; 4]>, Vec<[u32; 3]>) {
    let mut clip = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let jitter = |r: f32| (r * 16.0).floor() / 16.0 - 0.5;
            let place = |k: usize, r: f32| ((k as f32 + 0.4 * jitter(r)) / cells as f32) * 2.6 - 1.3;
            let w = 0.5 + (random.next() as f32);
            let (x, y) = (place(i, random.next() as f32), place(j, random.next() as f32));
            // Rounded to half pixels in every other cell, so that edges pass through sample points.
            let snap = |v: f32| if (i + j) % 2 == 0 { (v * SIDE as f32).round() / SIDE as f32 } else { v };
            clip.push([snap(x) * w, snap(y) * w, 0.25 * w, w]);
        }
    }
    let mut triangles = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let at = |di: usize, dj: usize| ((j + dj) * (cells + 1) + i + di) as u32;
            let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
            if (i + j) % 2 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    (clip, triangles)
}

#[test]
fn every_sample_of_a_sheet_is_covered_exactly_once() {
    let mut random = Random(7);
    for (cells, samples) in [(4, 1), (7, 1), (40, 1), (150, 1), (23, 4), (23, 16)] {
        let (clip, triangles) = sheet(cells, &mut random);
        let viewport = viewport(samples);
        let geometry = Geometry { clip: &clip, triangles: &triangles, faces: Faces::Both, first_id: 0 };
        let bins = bin(&[geometry], &viewport);
        for sample in 0..samples as usize {
            let counts = coverage(&bins, &viewport, sample, SimdLevel::Auto);
            let wrong = counts.iter().filter(|count| **count != 1).count();
            assert_eq!(wrong, 0, "{cells} cells, sample {sample} of {samples}");
        }
    }
}

#[test]
fn a_fan_about_a_sample_point_covers_it_once() {
    // The hub lies exactly on the centre of pixel (64, 64).
    let hub = [(64.5 / 64.0) - 1.0, 1.0 - (64.5 / 64.0)];
    for spokes in [3, 4, 5, 8, 16, 33] {
        let mut clip = vec![[hub[0], hub[1], 0.5, 1.0]];
        let mut random = Random(spokes);
        for i in 0..spokes {
            let angle = (i as f64 + random.next() * 0.5) / spokes as f64 * std::f64::consts::TAU;
            let (x, y) = (
                taotie_engine::math::scalar::cos(angle) as f32,
                taotie_engine::math::scalar::sin(angle) as f32,
            );
            clip.push([hub[0] + 0.5 * x, hub[1] + 0.5 * y, 0.5, 1.0]);
        }
        let triangles: Vec<[u32; 3]> =
            (0..spokes as u32).map(|i| [0, 1 + i, 1 + (i + 1) % spokes as u32]).collect();
        let viewport = viewport(1);
        let geometry = Geometry { clip: &clip, triangles: &triangles, faces: Faces::Both, first_id: 0 };
        let counts = coverage(&bin(&[geometry], &viewport), &viewport, 0, SimdLevel::Auto);
        assert!(counts.iter().all(|count| *count <= 1), "{spokes} spokes cover a pixel twice");
        let (across, _) = viewport.tiles();
        // The hub is the first pixel of the tile (1, 1).
        let tile = across as usize + 1;
        assert_eq!(counts[tile * TILE_PIXELS], 1, "{spokes} spokes leave the hub open");
    }
}

#[test]
fn near_clipping_keeps_what_is_in_front() {
    // A floor that runs from behind the eye to the horizon covers exactly the lower half of the picture.
    let near = 0.1;
    let corner = |x: f32, z: f32| [x, -1.0, near, -z];
    let clip = [corner(-1e4, 10.0), corner(1e4, 10.0), corner(1e4, -1e4), corner(-1e4, -1e4)];
    let geometry =
        Geometry { clip: &clip, triangles: &[[0, 1, 2], [0, 2, 3]], faces: Faces::Both, first_id: 0 };
    let viewport = viewport(1);
    let bins = bin(&[geometry], &viewport);
    let counts = coverage(&bins, &viewport, 0, SimdLevel::Auto);
    let (across, down) = viewport.tiles();
    for index in 0..(across * down) as usize {
        let tile = Tile::new(&viewport, index);
        for pixel in 0..TILE_PIXELS as u32 {
            let y = tile.y + pixel / 64;
            let expected = u32::from(y >= SIDE / 2);
            assert_eq!(counts[index * TILE_PIXELS + pixel as usize], expected, "row {y}");
        }
    }
}

#[test]
fn faces_are_culled_by_their_turn() {
    let clip = [[-1.0, -1.0, 0.5, 1.0], [1.0, -1.0, 0.5, 1.0], [0.0, 1.0, 0.5, 1.0]];
    let seen = |triangle: [u32; 3], faces: Faces| {
        let geometry = Geometry { clip: &clip, triangles: &[triangle], faces, first_id: 0 };
        bin(&[geometry], &viewport(1)).triangle_count()
    };
    assert_eq!([seen([0, 1, 2], Faces::CounterClockwise), seen([0, 2, 1], Faces::CounterClockwise)], [1, 0]);
    assert_eq!([seen([0, 1, 2], Faces::Clockwise), seen([0, 2, 1], Faces::Clockwise)], [0, 1]);
    assert_eq!([seen([0, 1, 2], Faces::Both), seen([0, 2, 1], Faces::Both)], [1, 1]);
}

#[test]
fn the_nearest_triangle_wins_and_levels_agree_to_the_bit() {
    let mut random = Random(3);
    let mut clip = Vec::new();
    for _ in 0..3 * 400 {
        let w = 0.2 + 3.0 * (random.next() as f32);
        let (x, y, z) =
            ((random.next() as f32) * 3.0 - 1.5, (random.next() as f32) * 3.0 - 1.5, random.next() as f32);
        clip.push([x * w, y * w, z * w, w]);
    }
    let triangles: Vec<[u32; 3]> = (0..400).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let viewport = viewport(1);
    let geometry = Geometry { clip: &clip, triangles: &triangles, faces: Faces::Both, first_id: 0 };
    let bins = bin(&[geometry], &viewport);
    let offset = viewport.pattern.offsets()[0];
    let tile = Tile::new(&viewport, 0);
    let at = TileSample { tile: &tile, offset };
    let mut planes = Vec::new();
    for simd in SimdLevel::available() {
        let mut plane = TilePlane::default();
        rasterize_opaque(&bins, at, simd, &mut plane).unwrap();
        let layers = rasterize_layers(&bins, at, simd, &TilePlane::default()).unwrap();
        for layer in &layers {
            assert!(layer.depth <= plane.depths[layer.pixel as usize]);
        }
        assert!(layers.len() > 4 * TILE_PIXELS, "the test must see overlap, saw {}", layers.len());
        let bits: Vec<u32> = plane.depths.iter().map(|d| d.to_bits()).collect();
        planes.push((simd, plane.ids, bits));
    }
    assert!(planes.windows(2).all(|pair| (&pair[0].1, &pair[0].2) == (&pair[1].1, &pair[1].2)));
}

/// Returns the position of a corner, in 1/256 pixel.
fn snapped([x, y, _, w]: [f32; 4], viewport: &Viewport) -> [i64; 2] {
    let [x, y, w] = [x, y, w].map(f64::from);
    let snap = |v: f64, side: u32| (v * 0.5 * f64::from(side) * 256.0 + 0.5).floor() as i64;
    [snap(x / w + 1.0, viewport.width), snap(1.0 - y / w, viewport.height)]
}

/// Returns true if a triangle of snapped corners covers a point by the top-left rule, in exact arithmetic.
fn covers(mut corners: [[i64; 2]; 3], [x, y]: [i64; 2], faces: Faces) -> bool {
    let [a, b, c] = corners;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    let drawn = match faces {
        Faces::CounterClockwise => area < 0,
        Faces::Clockwise => area > 0,
        Faces::Both => area != 0,
    };
    if area < 0 {
        corners.swap(1, 2);
    }
    drawn
        && (0..3).all(|i| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % 3]);
            let (dx, dy) = (bx - ax, by - ay);
            let value = dx * (y - ay) - dy * (x - ax);
            value > 0 || value == 0 && (dy < 0 || dy == 0 && dx > 0)
        })
}

/// Returns triangles whose corners are within `reach` (half pictures) of a random point, some of them on half pixels.
fn scattered(count: u32, reach: f32, random: &mut Random) -> (Vec<[f32; 4]>, Vec<[u32; 3]>) {
    let mut clip = Vec::new();
    for i in 0..count {
        let center = [random.next() as f32 * 2.2 - 1.1, random.next() as f32 * 2.2 - 1.1];
        for _ in 0..3 {
            let place = |c: f32, r: f64| c + (r as f32 - 0.5) * reach;
            let snap = |v: f32| if i % 3 == 0 { (v * 100.0).round() / 100.0 } else { v };
            let (x, y) = (snap(place(center[0], random.next())), snap(place(center[1], random.next())));
            let w = 0.5 + random.next() as f32;
            clip.push([x * w, y * w, random.next() as f32 * w, w]);
        }
    }
    (clip, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

#[test]
fn triangles_of_all_sizes_cover_what_exact_arithmetic_says() {
    let mut random = Random(11);
    let mut bins = Bins::default();
    let small = [(0.01, 1), (0.03, 1), (0.08, 4), (0.15, 16), (0.4, 1), (2.0, 4), (300.0, 1)];
    let small = small.map(|(reach, samples)| (reach, samples, [100, 75], 301));
    // Sides of 64 and 128 pixels, where the arithmetic changes its width, and far beyond.
    let large = [0.2, 0.4, 1.0, 2.0, 20.0].map(|reach| (reach, 1, [700, 500], 20));
    for (reach, samples, [width, height], count) in small.into_iter().chain(large) {
        let viewport = Viewport { width, height, pattern: SamplePattern::new(samples).unwrap() };
        let (clip, triangles) = scattered(count, reach, &mut random);
        for faces in [Faces::CounterClockwise, Faces::Clockwise, Faces::Both] {
            let geometry = Geometry { clip: &clip, triangles: &triangles, faces, first_id: 5 };
            let expected = expected(&geometry, &viewport);
            assert!(!expected.is_empty());
            for simd in SimdLevel::available() {
                bins.rebuild(&[geometry], &viewport, simd).unwrap();
                let found = seen(&bins, &viewport, simd);
                assert_eq!(found, expected, "{reach} {width} {faces:?} {simd:?}");
            }
        }
    }
}

/// Returns sample, column, row and triangle of everything covered.
fn seen(bins: &Bins, viewport: &Viewport, simd: SimdLevel) -> Vec<[u32; 4]> {
    let (across, down) = viewport.tiles();
    let mut seen = Vec::new();
    for index in 0..(across * down) as usize {
        let tile = Tile::new(viewport, index);
        for (sample, offset) in viewport.pattern.offsets().iter().enumerate() {
            let at = TileSample { tile: &tile, offset: *offset };
            let layers = rasterize_layers(bins, at, simd, &TilePlane::default()).unwrap();
            let place = |pixel: u32| [tile.x + pixel % 64, tile.y + pixel / 64];
            seen.extend(layers.iter().map(|layer| {
                let [x, y] = place(layer.pixel);
                [sample as u32, x, y, layer.id]
            }));
        }
    }
    seen.sort_unstable();
    seen
}

/// Returns the same, triangle by triangle and sample by sample.
fn expected(geometry: &Geometry<'_>, viewport: &Viewport) -> Vec<[u32; 4]> {
    let mut expected = Vec::new();
    for (i, triangle) in geometry.triangles.iter().enumerate() {
        let corners = triangle.map(|v| snapped(geometry.clip[v as usize], viewport));
        let near = |k: usize, side: u32| {
            let [a, b, c] = corners.map(|corner| corner[k].clamp(0, i64::from(side) * 256) / 256);
            let last = a.max(b).max(c).min(i64::from(side) - 1);
            a.min(b).min(c) as u32..last as u32 + 1
        };
        for (sample, [sx, sy]) in viewport.pattern.offsets().iter().enumerate() {
            let rows = near(1, viewport.height);
            for (x, y) in rows.flat_map(|y| near(0, viewport.width).map(move |x| (x, y))) {
                let place = [i64::from(x) * 256 + i64::from(*sx), i64::from(y) * 256 + i64::from(*sy)];
                if covers(corners, place, geometry.faces) {
                    expected.push([sample as u32, x, y, geometry.first_id + i as u32]);
                }
            }
        }
    }
    expected.sort_unstable();
    expected
}
