//! Properties of the low mesh, its atlas and its maps.

use super::*;
use std::collections::HashMap;
use taotie_engine::compare::angle_deg;
use taotie_engine::math::Vec3;
use taotie_engine::surface::{decode_normal, tangent_normal};

/// Returns the index of the first vertex at the position of each vertex.
fn welded(mesh: &Mesh) -> Vec<usize> {
    let key = |p: &Vec3| p.to_array().map(f32::to_bits);
    let mut first = HashMap::new();
    mesh.positions().iter().enumerate().map(|(i, p)| *first.entry(key(p)).or_insert(i)).collect()
}

#[test]
fn has_exactly_251_vertices_and_all_are_used() {
    let mesh = low_mesh();
    assert_eq!(mesh.positions().len(), 251);
    let used: std::collections::BTreeSet<u32> = mesh.triangles().iter().flatten().copied().collect();
    assert_eq!(used.len(), 251);
    assert!(mesh.tangents().is_empty());
}

#[test]
fn every_edge_is_shared_by_two_triangles_in_opposite_directions() {
    let mesh = low_mesh();
    let welded = welded(&mesh);
    let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
    for triangle in mesh.triangles() {
        let t = triangle.map(|i| welded[i as usize]);
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for ((a, b), count) in &edges {
        let (p, q) = (mesh.positions()[*a], mesh.positions()[*b]);
        assert_eq!(*count, 1, "edge {p:?} {q:?} is used twice in the same direction");
        assert!(edges.contains_key(&(*b, *a)), "edge {p:?} {q:?} is open");
    }
}

/// Returns the component of each vertex: the smallest welded index to which triangles connect it.
fn components(mesh: &Mesh) -> Vec<usize> {
    let welded = welded(mesh);
    let mut component = welded.clone();
    loop {
        let mut changed = false;
        for triangle in mesh.triangles() {
            let t = triangle.map(|i| welded[i as usize]);
            let least = t.iter().map(|i| component[*i]).min().unwrap();
            for i in t {
                changed |= component[i] != least;
                component[i] = least;
            }
        }
        if !changed {
            return welded.iter().map(|i| component[*i]).collect();
        }
    }
}

#[test]
fn every_part_encloses_a_positive_volume() {
    let mesh = low_mesh();
    let components = components(&mesh);
    let mut volumes: HashMap<usize, f64> = HashMap::new();
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
        *volumes.entry(components[triangle[0] as usize]).or_default() += a.dot(b.cross(c)) / 6.0;
    }
    assert_eq!(volumes.len(), 7, "vessel, three legs, two posts, handle");
    assert!(volumes.values().all(|v| *v > 1e-7), "{volumes:?}");
}

#[test]
fn has_no_sliver_and_stands_on_the_ground() {
    let mesh = low_mesh();
    assert_eq!(mesh.degenerate_triangles(), 0);
    for i in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(i).map(Vec3::to_f64);
        assert!((b - a).cross(c - a).length() > 1e-6, "triangle {i} is a sliver: {a:?} {b:?} {c:?}");
    }
    let lowest = mesh.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    assert_eq!(lowest, 0.0);
}

#[test]
fn normals_are_unit_and_on_the_side_of_their_faces() {
    let mesh = low_mesh();
    assert!(mesh.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    let against = (0..mesh.triangles().len()).filter(|i| {
        let [a, b, c] = mesh.corners(*i);
        let face = (b - a).cross(c - a).normalize();
        mesh.triangles()[*i].iter().any(|k| mesh.normals()[*k as usize].dot(face) < -0.2)
    });
    // The lids of the limbs' hidden ends do not affect normals: one per leg, two per post, four on the handle.
    assert!(against.count() <= 11);
}

#[test]
fn proportions_are_those_of_a_shang_jue() {
    let bounds = scene(16).bounds().unwrap();
    let size = bounds.max - bounds.min;
    assert!((0.195..0.215).contains(&size.y), "height {}", size.y);
    assert!((0.165..0.185).contains(&size.x), "length {}", size.x);
    assert!(bounds.max.x > -bounds.min.x, "the spout is longer than the tail");
}

/// Returns the indices of the triangles that cover the centre of each texel.
fn coverage(mesh: &Mesh, size: usize) -> Vec<Vec<usize>> {
    let mut texels = vec![Vec::new(); size * size];
    for (i, triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = triangle.map(|k| {
            let uv = mesh.uvs()[0][k as usize];
            [uv.x, uv.y].map(|c| f64::from(c) * size as f64)
        });
        let side = |p: [f64; 2], q: [f64; 2], x: f64, y: f64| {
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
        };
        for (k, texel) in texels.iter_mut().enumerate() {
            let (x, y) = ((k % size) as f64 + 0.5, (k / size) as f64 + 0.5);
            if side(a, b, x, y) < -1e-6 && side(b, c, x, y) < -1e-6 && side(c, a, x, y) < -1e-6 {
                texel.push(i);
            }
        }
    }
    texels
}

/// Returns the UV island of each triangle: triangles connected by shared vertices, but not across uv seams.
fn islands(mesh: &Mesh) -> Vec<u32> {
    let mut island: Vec<u32> = (0..mesh.positions().len() as u32).collect();
    for _ in 0..mesh.positions().len() {
        for triangle in mesh.triangles() {
            let least = triangle.iter().map(|i| island[*i as usize]).min().unwrap();
            triangle.iter().for_each(|i| island[*i as usize] = least);
        }
    }
    mesh.triangles().iter().map(|t| island[t[0] as usize]).collect()
}

#[test]
fn islands_lie_apart_in_the_unit_square() {
    const SIZE: usize = 512;
    let mesh = low_mesh();
    assert_eq!(mesh.uvs().len(), 1);
    assert!(mesh.uvs()[0].iter().all(|uv| uv.x > 0.0 && uv.x < 1.0 && uv.y > 0.0 && uv.y < 1.0));
    let coverage = coverage(&mesh, SIZE);
    let double = coverage.iter().position(|texel| texel.len() > 1);
    assert!(double.is_none(), "triangles overlap in uv: {:?}", double.map(|i| (i % SIZE, i / SIZE)));
    let islands = islands(&mesh);
    let at = |x: usize, y: usize| coverage[y * SIZE + x].first().map(|t| islands[*t]);
    // 3 texels here are 12 at 2048.
    for y in 0..SIZE - 3 {
        for x in 3..SIZE - 3 {
            let Some(here) = at(x, y) else { continue };
            for (dx, dy) in [(3, 0), (0, 3), (3, 3), (2, 3), (3, 2)] {
                assert!(at(x + dx, y + dy).is_none_or(|there| there == here), "UV islands touch at {x} {y}");
                assert!(at(x - dx, y + dy).is_none_or(|there| there == here), "UV islands touch at {x} {y}");
            }
        }
    }
    let covered = coverage.iter().filter(|texel| !texel.is_empty()).count() as f64 / (SIZE * SIZE) as f64;
    assert!(covered > 0.5, "only {covered} of the atlas is used");
}

#[test]
fn relief_is_flat_at_the_borders_of_islands() {
    let mesh = low_mesh();
    let mut count: HashMap<(u32, u32), u32> = HashMap::new();
    let edges = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    for (a, b) in mesh.triangles().iter().flat_map(edges) {
        *count.entry((a.min(b), a.max(b))).or_default() += 1;
    }
    let uv = |i: u32| mesh.uvs()[0][i as usize];
    for ((a, b), _) in count.iter().filter(|(_, count)| **count == 1) {
        for k in 0..=200 {
            let t = k as f32 / 200.0;
            let p = uv(*a) + (uv(*b) - uv(*a)) * t;
            assert_eq!(height(p.x, p.y), 0.0, "at uv {p:?}");
        }
    }
}

#[test]
fn relief_is_continuous_and_within_its_range() {
    let mut highest = 0.0_f32;
    for i in 0..400_000_u32 {
        let (u, v) = ((i % 1000) as f32 / 1000.0 + 3e-4, (i / 1000) as f32 / 400.0 + 2e-4);
        let h = height(u, v);
        assert!((0.0..=1.0).contains(&h));
        // No bevel is steeper than 1 per 0.15 mm; 2e-5 in u is 4 micrometres on the belly.
        assert!((height(u + 2e-5, v) - h).abs() < 0.1, "a step at {u} {v}");
        highest = highest.max(h);
    }
    assert!(highest > 0.9);
}

#[test]
fn both_faces_bear_the_same_mask_mirrored_about_its_nose() {
    let [front, back] = [4, 12].map(atlas::strip_u);
    let mut lit = 0;
    for i in 0..2000 {
        let x = (i % 50) as f64 * 0.0043;
        let v = atlas::strip_v(0.016 + (i / 50) as f64 * 0.0008);
        let at = |u: f64| height(u as f32, v as f32);
        let h = at(front + x);
        // Bevels are slightly offset by f32 uvs.
        assert!((at(front - x) - h).abs() < 0.02 || x > 0.215, "left and right differ at {x} {v}");
        assert!((at(back - x) - h).abs() < 0.02, "front and back differ at {x} {v}");
        lit += usize::from(h > 0.5);
    }
    assert!((500..1500).contains(&lit), "{lit} of 2000 samples are raised");
}

/// Returns just the front of the belly, which can be split finely.
fn front_of_the_belly() -> Mesh {
    let mesh = low_mesh();
    let mut data = mesh.clone().into_data();
    let [left, right] = [3, 5].map(|j| atlas::strip_u(j) as f32);
    let [low, high] = [1, 3].map(|i| atlas::strip_v(atlas::STRIP_ROWS[i]) as f32);
    let inside = |i: &u32| {
        let uv = mesh.uvs()[0][*i as usize];
        uv.x > left - 1e-4 && uv.x < right + 1e-4 && uv.y < low + 1e-4 && uv.y > high - 1e-4
    };
    data.triangles.retain(|t| t.iter().all(inside));
    assert_eq!(data.triangles.len(), 8);
    Mesh::new(data).unwrap()
}

#[test]
fn normal_map_agrees_with_the_displaced_surface() {
    // The finest lines are half a millimetre wide; both sides need to resolve them.
    const SIZE: u32 = 4096;
    let low = low_mesh();
    let surface = bake::laid_out(&low, SIZE);
    let map = normal_map(SIZE);
    let taotie_engine::image::Texels::U16(map) = map.texels() else { panic!("expected 16 bits") };
    let fine = displaced::mesh(&front_of_the_belly(), 0.00006, height);
    let (mut sum, mut count) = (0.0, 0.0);
    for (uv, n) in fine.uvs()[0].iter().zip(fine.normals()) {
        let [x, y] = [uv.x, uv.y].map(|c| c * SIZE as f32);
        // Only near the centre of a texel, where filtering is not needed.
        if [x, y].iter().any(|c| (c - c.floor() - 0.5).abs() > 0.08) {
            continue;
        }
        let (x, y) = (x as u32, y as u32);
        let point = surface.point(x, y).unwrap();
        let [r, g, b, _] = map[(y * SIZE + x) as usize].map(|c| f64::from(c) / 65535.0);
        let stored = decode_normal(Vec3::new(r, g, b), 1.0, 1.0);
        let decoded = tangent_normal(point.normal, point.tangent, point.handedness, stored);
        sum += angle_deg(decoded, n.to_f64());
        count += 1.0;
    }
    assert!(count > 1000.0);
    let mean = sum / count;
    assert!(mean < 1.8, "mean {mean}°");
}

#[test]
fn no_island_is_mirrored() {
    assert!(bake::with_frames(&low_mesh()).tangents().iter().all(|t| t[3] == 1.0));
}

#[test]
fn normal_map_is_unit_and_flat_away_from_relief() {
    let map = normal_map(256);
    let taotie_engine::image::Texels::U16(texels) = map.texels() else { panic!("expected 16 bits") };
    let decode = |t: &[u16; 4]| Vec3::new(t[0], t[1], t[2]).map(|c| f32::from(c) / 65535.0 * 2.0 - 1.0);
    assert!(texels.iter().all(|t| (decode(t).length() - 1.0).abs() < 1e-3 && decode(t).z > 0.0));
    assert!(decode(&texels[0]).z > 0.9999);
}

#[test]
fn displaced_mesh_closes_without_cracks() {
    let mesh = displaced_mesh(0.001);
    assert!(mesh.triangles().len() > 256 * low_mesh().triangles().len());
    let key = |i: u32| mesh.positions()[i as usize].to_array().map(|c| (c + 0.0).to_bits());
    let mut edges = HashMap::new();
    for t in mesh.triangles() {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((key(a), key(b))).or_insert(0) += 1;
        }
    }
    let open = edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).count();
    assert_eq!(open, 0, "of {} edges", edges.len());
}

#[test]
fn more_than_a_million_triangles_on_demand() {
    let mesh = displaced_mesh(FINEST);
    assert!(mesh.triangles().len() > 1_000_000);
    assert!(mesh.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
}

#[test]
fn maps_do_not_depend_on_the_number_of_threads() {
    let maps = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (height_map(200), normal_map(200), base_color_map(200), orm_map(200)))
    };
    assert!(maps(1) == maps(3));
}

#[test]
fn patina_is_green_and_dull_in_recesses_and_metal_on_edges() {
    let (color, orm, height) = (base_color_map(1024), orm_map(1024), height_map(1024));
    let (taotie_engine::image::Texels::U8(color), taotie_engine::image::Texels::U8(orm)) =
        (color.texels(), orm.texels())
    else {
        panic!("expected 8 bits")
    };
    let taotie_engine::image::Texels::U16(height) = height.texels() else { panic!("expected 16 bits") };
    // Rows of the mask's panel.
    let rows = 1024 * 750..1024 * 900;
    let mean = |of: &dyn Fn(usize) -> f64, high: bool| {
        let chosen: Vec<usize> = rows.clone().filter(|i| (height[*i][0] > 40_000) == high).collect();
        chosen.iter().map(|i| of(*i)).sum::<f64>() / chosen.len() as f64
    };
    let green = |i: usize| f64::from(color[i][1]) - f64::from(color[i][0]);
    let metallic = |i: usize| f64::from(orm[i][2]);
    let occlusion = |i: usize| f64::from(orm[i][0]);
    assert!(mean(&green, false) > mean(&green, true) + 10.0);
    assert!(mean(&metallic, true) > mean(&metallic, false) + 20.0);
    assert!(mean(&occlusion, true) > mean(&occlusion, false) + 10.0);
}
