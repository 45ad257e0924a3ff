//! Laws of baking any scan: shapes whose normals, heights and openness are known in closed form.

use taotie_engine::Progress;
use taotie_engine::bake::{
    BakeInput, BakeSettings, Baked, BakedMaps, Cage, MapKind, Maps, Plane, Scan, TexelStatus, TexturedMesh,
    UnwrapOptions, Verifier, bake, unwrap,
};
use taotie_engine::image::{Encoding, Sampler, Texture};
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{Storage, store_unit_vectors};
use taotie_engine::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};
use taotie_engine::surface::{vertex_normals, with_frames};

fn scene(mesh: Mesh) -> Scene {
    Scene::of_mesh(mesh, Material::default()).unwrap()
}

pub fn scan(mesh: Mesh) -> Scan {
    Scan::new(scene(mesh)).expect("the mesh is sound")
}

/// A sphere with smooth normals and nothing else, like a scanner's output.
pub fn bare_sphere(radius: f64, columns: usize, rows: usize) -> Mesh {
    let data = Mesh::sphere(radius, columns, rows).into_data();
    // The first and the last column differ by rounding; a scan is closed.
    let round = |v: f32| (v * 65536.0).round() / 65536.0;
    let positions = data.positions.iter().map(|p| p.map(round)).collect();
    let bare = MeshData { positions, triangles: data.triangles, ..MeshData::default() };
    let mesh = Mesh::new(bare).unwrap();
    let normals = vertex_normals(&mesh);
    Mesh::new(MeshData { normals, ..mesh.into_data() }).unwrap()
}

/// Unwraps a mesh, with tangents.
fn low_poly(mesh: &Mesh, size: u32) -> Mesh {
    let unwrapped = unwrap(mesh, &UnwrapOptions { size, padding: 2 }, Progress::SILENT).unwrap();
    with_frames(&unwrapped.mesh, 0, None).unwrap().0.into_owned()
}

fn baked(low: &Mesh, scan: &Scan, settings: &BakeSettings) -> (Baked, Cage) {
    let cage = Cage::automatic(low, scan);
    let baked = bake(BakeInput { low, cage: &cage, scan }, settings, Progress::SILENT).unwrap();
    (baked, cage)
}

fn settings(size: u32, maps: &[MapKind]) -> BakeSettings {
    BakeSettings { size: [size; 2], maps: maps.iter().copied().collect(), ..BakeSettings::default() }
}

fn covered(maps: &BakedMaps) -> impl Iterator<Item = usize> + '_ {
    (0..maps.texels.len()).filter(|i| maps.texels[*i] != TexelStatus::Free)
}

/// A low-poly mesh that shows a normal map.
pub fn shown(low: &Mesh, texture: &Texture, (space, sampler): (NormalSpace, Sampler)) -> TexturedMesh {
    let texture_0 = TextureRef { texture: 0, uv_set: 0, sampler, transform: UvTransform::default() };
    let map = NormalMap { texture: texture_0, scale: 1.0, space, green: GreenChannel::Up };
    let mut scene = Scene::of_mesh(low.clone(), Material::default()).unwrap();
    let material = Material { normal: Some(map), ..Material::default() };
    scene.edit(|scene| (scene.textures, scene.materials) = (vec![texture.clone()], vec![material])).unwrap();
    TexturedMesh::new(scene).unwrap()
}

/// Returns angles over the surface as a viewer shows it, in degrees: mean and largest.
fn shown_angles(low: &Mesh, maps: &BakedMaps, storage: Storage, (cage, scan): (&Cage, &Scan)) -> [f64; 2] {
    let bitmap = store_unit_vectors(maps.size(), maps.vectors(Plane::Normal), storage).unwrap();
    let texture = Texture::new(bitmap, Encoding::Normal);
    let sampler = Sampler::BILINEAR;
    let shown = shown(low, &texture, (NormalSpace::Tangent, sampler));
    let verifier = Verifier { mesh: low, shown: Some(&shown), cage, scan };
    let normal_error = verifier.normal_error(20_000).unwrap();
    assert_eq!(normal_error.lost, 0.0);
    let summary = normal_error.angles.summary().unwrap();
    [summary.mean, summary.max]
}

#[test]
fn a_coarse_sphere_looks_like_a_fine_one() {
    let scan = scan(bare_sphere(2.0, 512, 256));
    let low = low_poly(&bare_sphere(2.0, 24, 12), 512);
    let (baked, cage) = baked(&low, &scan, &settings(512, &[MapKind::Normal]));
    assert_eq!((baked.counts.missed, baked.counts.lost, baked.counts.shared), (0, 0, 0));
    let fine = Storage { bits: 16, dither: false };
    let [mean, max] = shown_angles(&low, &baked.maps, fine, (&cage, &scan));
    // Bilinear lookups at the borders of UV islands include texels of the padding.
    assert!(mean < 0.01 && max < 2.0, "16 bits: {mean}° {max}°");
    let exact = mean;
    let coarse = Storage { bits: 8, dither: false };
    let [mean, _] = shown_angles(&low, &baked.maps, coarse, (&cage, &scan));
    assert!(mean > 0.05 && mean < 0.25, "8 bits: {mean}°");
    let verifier = Verifier { mesh: &low, shown: None, cage: &cage, scan: &scan };
    let plain = verifier.normal_error(20_000).unwrap().angles.summary().unwrap().mean;
    assert!(plain > 20.0 * exact, "without the map: {plain}°");
}

/// Returns the same triangles with their vertices in the opposite order.
fn turned_round(mesh: &Mesh) -> Mesh {
    let data = mesh.clone().into_data();
    let last = data.positions.len() as u32 - 1;
    let reversed = |v: Vec<Vec3>| v.into_iter().rev().collect();
    Mesh::new(MeshData {
        positions: reversed(data.positions),
        normals: reversed(data.normals),
        tangents: data.tangents.into_iter().rev().collect(),
        uvs: data.uvs.into_iter().map(|uvs| uvs.into_iter().rev().collect()).collect(),
        triangles: data.triangles.into_iter().map(|t| t.map(|v| last - v)).collect(),
        ..MeshData::default()
    })
    .unwrap()
}

#[test]
fn the_order_of_vertices_does_not_matter_to_the_proof() {
    // An ellipsoid, so that ray distance and direction differ from vertex to vertex.
    let stretched = |columns, rows| {
        let data = bare_sphere(1.0, columns, rows).into_data();
        let positions = data.positions.iter().map(|p| Vec3::new(p.x, p.y * 2.0, p.z)).collect();
        let mesh = Mesh::new(MeshData { positions, normals: Vec::new(), ..data }).unwrap();
        let normals = vertex_normals(&mesh);
        Mesh::new(MeshData { normals, ..mesh.into_data() }).unwrap()
    };
    let scan = scan(stretched(256, 128));
    let low = low_poly(&stretched(24, 12), 256);
    let (baked, cage) = baked(&low, &scan, &settings(256, &[MapKind::Normal]));
    let fine = Storage { bits: 16, dither: false };
    let copy = turned_round(&low);
    let carried = cage.carried_over(&low, &copy);
    let [mean, max] = shown_angles(&low, &baked.maps, fine, (&cage, &scan));
    let [again, largest] = shown_angles(&copy, &baked.maps, fine, (&carried, &scan));
    assert!(
        (mean - again).abs() < 1e-4 && (max - largest).abs() < 0.1,
        "{mean}° {max}°, {again}° {largest}°"
    );
    let strange =
        Verifier { mesh: &copy, shown: None, cage: &cage, scan: &scan }.normal_error(20_000).unwrap();
    assert!(strange.missed > 0.5, "a cage that is not carried over does not fit: {}", strange.missed);
}

#[test]
fn object_space_holds_the_directions_of_a_sphere() {
    let scan = scan(bare_sphere(1.0, 256, 128));
    let low = low_poly(&bare_sphere(1.0, 32, 16), 256);
    let settings = BakeSettings { space: NormalSpace::Object, ..settings(256, &[MapKind::Normal]) };
    let cage = Cage::automatic(&low, &scan);
    let maps =
        bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, Progress::SILENT).unwrap().maps;
    // Every direction occurs, and neighbouring texels are nearly equal.
    let mut seen = [false; 6];
    for i in covered(&maps) {
        let n = Vec3::from_array(maps.vectors(Plane::Normal)[i]);
        assert!((n.length() - 1.0).abs() < 1e-5);
        let axes = [n.x, -n.x, n.y, -n.y, n.z, -n.z];
        axes.iter().zip(&mut seen).for_each(|(c, seen)| *seen |= *c > 0.95);
    }
    assert_eq!(seen, [true; 6]);
}

#[test]
fn heights_are_distances_to_the_scan() {
    // A sphere of radius 1.05 around a low-poly one inscribed in radius 1.
    let scan = scan(bare_sphere(1.05, 256, 128));
    let low = low_poly(&bare_sphere(1.0, 64, 32), 256);
    let (baked, _) =
        baked(&low, &scan, &settings(256, &[MapKind::Height, MapKind::Curvature, MapKind::Position]));
    assert_eq!(baked.counts.missed, 0);
    let mut worst = [0.0f32; 2];
    for i in covered(&baked.maps) {
        // The low-poly sphere's facets are up to 1 − cos(π/64) inside it.
        assert!(
            (0.0495..0.0565).contains(&baked.maps.numbers(Plane::Height)[i]),
            "{}",
            baked.maps.numbers(Plane::Height)[i]
        );
        // At the poles, the scan's normals are means over fans of triangles, which lean too far.
        let [x, _, z] = baked.maps.vectors(Plane::Position)[i];
        let is_pole = x.hypot(z) < 0.06;
        let off = (baked.maps.numbers(Plane::Curvature)[i] * 1.05 - 1.0).abs();
        worst[usize::from(is_pole)] = worst[usize::from(is_pole)].max(off);
    }
    assert!(worst[0] < 0.035 && worst[1] < 0.18, "{worst:?}");
    let curvatures: Vec<f32> =
        covered(&baked.maps).map(|i| baked.maps.numbers(Plane::Curvature)[i]).collect();
    let mean = curvatures.iter().sum::<f32>() / curvatures.len() as f32;
    assert!((mean * 1.05 - 1.0).abs() < 2e-3, "{mean}");
}

/// A square of side 2 in the plane z = `height`, facing up, with uvs over the whole map.
fn square(height: f32, side: f32) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x * side, y * side, height);
    Mesh::new(MeshData {
        positions: vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)],
        normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
        uvs: vec![
            [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]
                .map(|[u, v]| taotie_engine::math::Vec2::new(u, v))
                .to_vec(),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
    .unwrap()
}

/// A floor with a wall along x = 0 that is practically infinitely high.
fn floor_with_wall(height: f32) -> Mesh {
    let mut data = square(0.0, 2.0).into_data();
    let first = data.positions.len() as u32;
    for [y, z] in [[-50.0, 0.0], [50.0, 0.0], [50.0, height], [-50.0, height]] {
        data.positions.push(Vec3::new(0.0, y, z));
    }
    data.normals.extend([Vec3::new(1.0, 0.0, 0.0); 4]);
    data.uvs.clear();
    data.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    Mesh::new(data).unwrap()
}

#[test]
fn half_of_the_sky_is_open_at_the_foot_of_a_wall() {
    let scan = scan(floor_with_wall(1.0));
    let low = with_frames(&square(0.0, 2.0), 0, None).unwrap().0.into_owned();
    let settings =
        BakeSettings { sky_rays: 256, ..settings(32, &[MapKind::Occlusion, MapKind::Bent, MapKind::Normal]) };
    let cage = Cage::uniform(&low, 0.01).unwrap();
    let maps =
        bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, Progress::SILENT).unwrap().maps;
    for (i, open) in maps.numbers(Plane::Occlusion).iter().enumerate() {
        let x = f64::from((i % 32) as u32) / 32.0 * 2.0 - 1.0 + 1.0 / 32.0;
        // A long wall of height 1 at distance d hides (1 − sin of its elevation's complement)/2 of the
        // cosine-weighted sky: view factor (1 − d/√(d² + 1))/2.
        let hidden = (1.0 - x.abs() / (x * x + 1.0).sqrt()) / 2.0;
        assert!((f64::from(*open) - (1.0 - hidden)).abs() < 0.06, "{open} at {x}: {}", 1.0 - hidden);
        let bent = maps.vectors(Plane::Bent)[i];
        assert!(f64::from(bent[0]) * x.signum() > 0.0, "open directions lean away from the wall");
    }
    let mean = maps.numbers(Plane::Occlusion).iter().map(|v| f64::from(*v)).sum::<f64>() / 1024.0;
    let truth = (0..1024).map(|i| {
        let x = (i as f64 + 0.5) / 1024.0;
        1.0 - (1.0 - x / (x * x + 1.0).sqrt()) / 2.0
    });
    let truth = truth.sum::<f64>() / 1024.0;
    assert!((mean - truth).abs() < 0.01, "{mean} against {truth}");
}

#[test]
fn a_nearer_sheet_goes_before_one_behind_it_and_backs_do_not_count() {
    // Below the low-poly square: a floor slightly below, and the back of a ceiling slightly above.
    let mut data = square(-0.02, 2.0).into_data();
    let ceiling = square(0.01, 2.0).into_data();
    let first = data.positions.len() as u32;
    data.positions.extend(ceiling.positions);
    data.normals.extend([Vec3::new(0.0, 0.0, -1.0); 4]);
    data.uvs.clear();
    data.triangles.extend(ceiling.triangles.iter().map(|[a, b, c]| [a + first, c + first, b + first]));
    let scan = scan(Mesh::new(data).unwrap());
    let low = with_frames(&square(0.0, 2.0), 0, None).unwrap().0.into_owned();
    let (baked, _) = baked(&low, &scan, &settings(16, &[MapKind::Height]));
    assert_eq!(baked.counts.missed, 0);
    assert!(
        baked.maps.numbers(Plane::Height).iter().all(|h| (h + 0.02).abs() < 1e-6),
        "{:?}",
        baked.maps.numbers(Plane::Height)[0]
    );
}

#[test]
fn what_is_not_there_is_counted_and_never_made_up() {
    // The scan covers only the left half of the low-poly square.
    let mut data = square(0.0, 2.0).into_data();
    data.positions.iter_mut().filter(|p| p.x > 0.0).for_each(|p| p.x = 0.0);
    data.uvs.clear();
    let scan = scan(Mesh::new(data).unwrap());
    let low = with_frames(&square(0.0, 2.0), 0, None).unwrap().0.into_owned();
    let cage = Cage::uniform(&low, 0.02).unwrap();
    let input = BakeInput { low: &low, cage: &cage, scan: &scan };
    let kinds = [MapKind::Normal, MapKind::Position, MapKind::ObjectId];
    let baked = bake(input, &settings(64, &kinds), Progress::SILENT).unwrap();
    // Texels without a point of the scan have those of texels around them.
    assert!(
        baked.maps.vectors(Plane::Position).iter().all(|p| p[0] <= 0.0 && p.iter().all(|v| v.is_finite()))
    );
    assert!(baked.maps.numbers(Plane::ObjectId).iter().all(|id| *id == 0.0));
    let counts = baked.counts;
    assert_eq!(counts.samples, 64 * 64 * 4);
    assert_eq!(counts.missed, counts.samples / 2, "the right half");
    // Closest points are used up to four times as far away as the rays reach.
    let within = (0.08f64 / 2.0 * 128.0).floor() as usize * 128;
    assert!(counts.missed - counts.lost <= within + 128 && counts.missed - counts.lost > within / 2);
    for (i, texel) in baked.maps.texels.iter().enumerate() {
        match i % 64 {
            0..32 => assert_eq!(*texel, TexelStatus::Met),
            36.. => assert_eq!(*texel, TexelStatus::Lost),
            _ => {}
        }
    }
}

/// Returns every plane of two bakes, and the largest difference of a number.
fn differences(a: &BakedMaps, b: &BakedMaps) -> Vec<(Plane, f32)> {
    let most = |(plane, a): (Plane, &[f32])| {
        let b = b.numbers(plane);
        assert_eq!(a.len(), b.len());
        (plane, a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max))
    };
    a.planes().map(most).collect()
}

/// Returns the same mesh with its last triangle first.
fn backwards(mesh: &Mesh) -> Mesh {
    let mut data = mesh.clone().into_data();
    data.triangles.reverse();
    Mesh::new(data).unwrap()
}

#[test]
fn maps_depend_on_neither_threads_nor_order() {
    let fine = bare_sphere(1.0, 128, 64);
    let low = low_poly(&bare_sphere(1.02, 20, 10), 128);
    let maps: Maps = MapKind::NAMES.iter().map(|(_, kind)| *kind).collect();
    let of = |low: &Mesh, fine: &Mesh, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = BakeSettings { maps, sky_rays: 8, ..settings(128, &[]) };
        pool.install(|| baked(low, &scan(fine.clone()), &settings).0.maps)
    };
    let one = of(&low, &fine, 1);
    assert_eq!(one.planes().count(), 19);
    // Sums over the triangles around a vertex are rounded depending on their order: in the scan those of its
    // curvature, in the low-poly mesh those of the cage. Measured: 3.6e-7 and 7.5e-7.
    const ROUNDING: f32 = 1e-6;
    // Rays that graze the opposite side move further. Measured: 3.05e-6.
    const OF_RAYS: f32 = 4e-6;
    const ROUNDED: [Plane; 10] = [
        Plane::Normal,
        Plane::Height,
        Plane::Bent,
        Plane::Curvature,
        Plane::Roughness,
        Plane::Position,
        Plane::WorldNormal,
        Plane::Thickness,
        Plane::Bevel,
        Plane::VectorDisplacement,
    ];
    let cases = [
        ("three threads", of(&low, &fine, 3), None),
        ("the scan's vertices", of(&low, &turned_round(&fine), 2), None),
        ("the scan's triangles", of(&low, &backwards(&fine), 2), Some(&[Plane::Curvature][..])),
        ("the low-poly mesh's vertices", of(&turned_round(&low), &fine, 2), None),
        ("the low-poly mesh's triangles", of(&backwards(&low), &fine, 2), Some(&ROUNDED[..])),
    ];
    for (what, other, rounded) in cases {
        assert!(one.texels == other.texels, "{what}");
        for (map, most) in differences(&one, &other) {
            let rounding = if map == Plane::Thickness { OF_RAYS } else { ROUNDING };
            let allowed = if rounded.is_some_and(|r| r.contains(&map)) { rounding } else { 0.0 };
            assert!(most <= allowed, "{what}: {map:?} differs by {most}");
        }
    }
}

/// A chord of a sphere of radius r at an angle θ to the normal is 2r cos θ long; its cosine-weighted mean over the
/// hemisphere is 4r/3.
#[test]
fn points_of_a_sphere_are_where_they_are_and_as_thick_as_it() {
    let (radius, center) = (2.0f32, Vec3::new(30.0, -4.0, 7.0));
    let moved = |mesh: &Mesh| {
        let mut data = mesh.clone().into_data();
        data.positions.iter_mut().for_each(|p| *p += center);
        Mesh::new(data).unwrap()
    };
    let fine = scan(moved(&bare_sphere(f64::from(radius), 256, 128)));
    let low = low_poly(&moved(&bare_sphere(f64::from(radius) * 1.01, 24, 12)), 64);
    let kinds = [MapKind::Position, MapKind::WorldNormal, MapKind::Thickness, MapKind::ObjectId];
    let settings = BakeSettings { sky_rays: 256, ..settings(64, &kinds) };
    let maps = baked(&low, &fine, &settings).0.maps;
    let (positions, normals) = (maps.vectors(Plane::Position), maps.vectors(Plane::WorldNormal));
    let diagonal = 2.0 * radius * 3.0f32.sqrt();
    let thickness = maps.numbers(Plane::Thickness);
    for i in covered(&maps) {
        let way = Vec3::from_array(positions[i]) - center;
        // A texel shows the mean of four points of a curved surface.
        assert!((way.length() - radius).abs() < 2e-3 * diagonal, "{way:?}");
        assert!(way.normalize().dot(Vec3::from_array(normals[i])) > 0.9999);
        assert!((thickness[i] / radius - 4.0 / 3.0).abs() < 0.02, "{}", thickness[i]);
        assert_eq!(maps.numbers(Plane::ObjectId)[i], 0.0);
    }
}

#[test]
fn a_sheet_without_a_back_has_no_thickness() {
    let mut data = square(0.0, 2.0).into_data();
    data.uvs.clear();
    let low = with_frames(&square(0.0, 2.0), 0, None).unwrap().0.into_owned();
    let kinds = [MapKind::Thickness, MapKind::Wireframe];
    let maps = baked(&low, &scan(Mesh::new(data).unwrap()), &settings(32, &kinds)).0.maps;
    assert!(maps.numbers(Plane::Thickness).iter().all(|v| *v == 0.0));
    // The border and the diagonal of a square, each one texel wide on either side.
    let drawn = maps.numbers(Plane::Wireframe);
    let at = |x: usize, y: usize| drawn[y * 32 + x];
    assert_eq!([at(0, 9), at(31, 9), at(9, 0), at(9, 31)], [1.0; 4]);
    assert_eq!([at(1, 9), at(20, 9), at(9, 30)], [0.0; 3]);
    assert!(at(16, 16) + at(16, 15) > 0.9, "the diagonal");
}

#[test]
fn relief_finer_than_a_texel_becomes_roughness() {
    // Grooves of 45° slopes, far narrower than a texel of the coarse map.
    // Enough of them that no grid of samples aliases with them.
    let ridges = 181;
    let mut data = MeshData::default();
    for k in 0..ridges {
        let x = |step: f32| (k as f32 + step) / ridges as f32 * 2.0 - 1.0;
        let height = 0.5 / ridges as f32 * 2.0;
        let first = data.positions.len() as u32;
        for [step, z] in [[0.0, 0.0], [0.5, height], [0.5, height], [1.0, 0.0]] {
            for y in [-1.0, 1.0] {
                data.positions.push(Vec3::new(x(step), y, z));
            }
        }
        let slope = 0.5f32.sqrt();
        data.normals.extend([Vec3::new(-slope, 0.0, slope); 4]);
        data.normals.extend([Vec3::new(slope, 0.0, slope); 4]);
        for base in [first, first + 4] {
            data.triangles.push([base, base + 2, base + 3]);
            data.triangles.push([base, base + 3, base + 1]);
        }
    }
    let scan = scan(Mesh::new(data).unwrap());
    let low = with_frames(&square(0.0, 2.0), 0, None).unwrap().0.into_owned();
    let bake_at = |size: u32, side: u32| {
        let settings = BakeSettings {
            roughness: Some(0.3),
            side,
            ..settings(size, &[MapKind::Roughness, MapKind::Normal])
        };
        baked(&low, &scan, &settings).0.maps
    };
    let coarse = bake_at(16, 8);
    let middle = coarse.numbers(Plane::Roughness)[8 * 16 + 8];
    assert!(middle > 0.6, "{middle}");
    assert!(
        Vec3::from_array(coarse.vectors(Plane::Normal)[8 * 16 + 8]).z > 0.9,
        "the mean normal is upright"
    );
    // On a map that resolves the grooves no roughness is added within a slope; 362 of 1024 columns contain an edge.
    let fine = bake_at(1024, 2);
    let plain = fine.numbers(Plane::Roughness).iter().filter(|v| (**v - 0.3).abs() < 1e-3).count() as f64;
    let part = plain / fine.numbers(Plane::Roughness).len() as f64;
    assert!((0.62..0.85).contains(&part), "{part}");
}

/// A step with an edge of 90° along y, 2 wide, and a low-poly mesh that is its upper face.
fn step() -> (Mesh, Scan) {
    let quad = |corners: [[f32; 3]; 4], normal: [f32; 3]| MeshData {
        positions: corners.map(Vec3::from_array).to_vec(),
        normals: vec![Vec3::from_array(normal); 4],
        uvs: vec![corners.map(|[x, y, _]| Vec2::new((x + 1.0) / 2.0, y)).to_vec()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    };
    let top = [[-1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let low = Mesh::new(quad(top, [0.0, 0.0, 1.0])).unwrap();
    let mut data = quad(top, [0.0, 0.0, 1.0]);
    let side = quad([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 1.0, 0.0]], [1.0, 0.0, 0.0]);
    data.positions.extend(side.positions);
    data.normals.extend(side.normals);
    data.triangles.extend(side.triangles.iter().map(|t| t.map(|v| v + 4)));
    data.uvs.clear();
    (with_frames(&low, 0, None).unwrap().0.into_owned(), scan(Mesh::new(data).unwrap()))
}

/// The angle in degrees by which an edge of 90° turns the mean normal at a distance from it, in radii: the integral of
/// (1 − distance)³ over the half plane behind the edge and the part of this one within the radius.
fn rounded(at: f64) -> f64 {
    const STEPS: i32 = 400;
    let weight = |x: f64, y: f64, z: f64| {
        let away = (1.0 - (x * x + y * y + z * z).sqrt()).max(0.0);
        away * away * away
    };
    let (mut own, mut other) = (0.0, 0.0);
    for i in -STEPS..STEPS {
        for k in -STEPS..STEPS {
            let [u, v] = [i, k].map(|i| (f64::from(i) + 0.5) / f64::from(STEPS));
            own += if u <= at { weight(u, v, 0.0) } else { 0.0 };
            other += if u >= 0.0 { weight(at, v, u) } else { 0.0 };
        }
    }
    scalar::atan2(other, own).to_degrees()
}

#[test]
fn bevelled_edges_are_rounded_as_the_integral_is() {
    let (low, scan) = step();
    let settings = BakeSettings {
        size: [128, 64],
        bevel_radius: Some(0.25),
        sky_rays: 1024,
        space: NormalSpace::Object,
        ..settings(64, &[MapKind::Bevel])
    };
    let (baked, _) = baked(&low, &scan, &settings);
    let normals = baked.maps.vectors(Plane::Bevel);
    let texel = 2.0 / 128.0;
    let mut worst: f64 = 0.0;
    for column in 0..64 {
        // The middle of the step, far from its open ends.
        let [x, _, z] = normals[32 * 128 + column].map(f64::from);
        let found = scalar::atan2(x, z).to_degrees();
        let expected = rounded(texel * (63.5 - column as f64) / 0.25);
        worst = worst.max((found - expected).abs());
    }
    assert!(worst < 0.8, "{worst}°");
    assert!((rounded(0.0) - 45.0).abs() < 1e-6 && rounded(1.0) == 0.0);
}

#[test]
fn vector_displacement_leads_from_the_low_poly_mesh_to_the_scan() {
    let low = low_poly(&bare_sphere(1.0, 24, 12), 64);
    let scan = scan(bare_sphere(1.05, 256, 128));
    let of = |space: NormalSpace| {
        let maps = [MapKind::VectorDisplacement, MapKind::Position, MapKind::Height];
        baked(&low, &scan, &BakeSettings { space, ..settings(64, &maps) }).0.maps
    };
    let [object, tangent] = [NormalSpace::Object, NormalSpace::Tangent].map(of);
    for i in covered(&object).filter(|i| object.texels[*i] == TexelStatus::Met) {
        let [way, position] = [Plane::VectorDisplacement, Plane::Position]
            .map(|plane| Vec3::from_array(object.vectors(plane)[i]));
        // Subtracting it leads back to the low-poly mesh, between its faces and its vertices.
        let start = (position - way).length();
        assert!((0.95..1.001).contains(&start), "{start}");
        let turned = Vec3::from_array(tangent.vectors(Plane::VectorDisplacement)[i]);
        let height = tangent.numbers(Plane::Height)[i];
        assert!((turned.length() - way.length()).abs() < 1e-3 * way.length());
        assert!((turned.z - height).abs() < 0.02 * height, "{turned:?} {height}");
    }
}
