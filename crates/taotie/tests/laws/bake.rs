//! Laws of normal maps made from heights, converted between spaces, and stored in fewer bits.

use crate::files::data_files;
use crate::random::Random;
use std::path::Path;
use taotie_engine::bake::*;
use taotie_engine::compare::{Field, Summary, angle_deg, angular_error};
use taotie_engine::image::{Bitmap, Image, Texels, Wrap};
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::normal_map::*;
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::{TangentMethod, with_tangents};
use taotie_io::{load_model, read_bitmap};

const PLAIN: [Storage; 2] = [Storage { bits: 8, dither: false }, Storage { bits: 16, dither: false }];

fn grid(side: u32, padding: u32) -> TexelGrid {
    TexelGrid { width: side, height: side, uv_set: 0, padding }
}

/// A quarter of a tube of radius 1 and height 2 about y, in two halves side by side on the map; the second half is
/// mirrored. Normals are those of the tube, so that frames are interpolated.
fn mirrored_tube() -> Mesh {
    const COLUMNS: u32 = 4;
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for half in 0..2u32 {
        for column in 0..=COLUMNS {
            let part = f64::from(column) / f64::from(COLUMNS);
            let angle = (f64::from(half) + part) * std::f64::consts::FRAC_PI_4;
            let n = Vec3::new(scalar::sin(angle), 0.0, scalar::cos(angle));
            for row in 0..2u32 {
                data.positions.push((n + Vec3::new(0.0, 2.0 * f64::from(row), 0.0)).to_f32());
                data.normals.push(n.to_f32());
                let across = if half == 0 { 0.05 + 0.4 * part } else { 0.95 - 0.4 * part };
                data.uvs[0].push(Vec2::new(across as f32, 0.9 - 0.8 * row as f32));
            }
        }
        let first = half * 2 * (COLUMNS + 1);
        for a in (0..COLUMNS).map(|column| first + 2 * column) {
            data.triangles.extend([[a, a + 2, a + 3], [a, a + 3, a + 1]]);
        }
    }
    Mesh::new(data).unwrap()
}

fn laid_out(mesh: &Mesh, grid: &TexelGrid) -> TexelSurface {
    let tangented = with_tangents(mesh, 0, TangentMethod::MikkTSpace).unwrap();
    TexelSurface::new(tangented.mesh, grid).unwrap()
}

/// A tangent-space map of steep random normals.
fn rough(side: u32) -> Image {
    let mut random = Random(3);
    let mut map = Image::new(side, side, [0.0; 4]).unwrap();
    for pixel in map.pixels_mut() {
        let v =
            Vec3::new(random.next() * 2.0 - 1.0, random.next() * 2.0 - 1.0, 0.3 + random.next()).normalize();
        *pixel = [v.x as f32, v.y as f32, v.z as f32, 1.0];
    }
    map
}

/// Returns the angles between two object-space maps: the original, and one converted to tangent space and back, each
/// stored in this number of bits.
fn round_trip(surface: &TexelSurface, tangent: &Image, storage: Storage) -> Field {
    let stored = |normals: &Image, space| {
        let stored = store_normals(normals, space, GreenChannel::Up, storage).unwrap();
        decoded_normals(&stored.bitmap, space, GreenChannel::Up).unwrap()
    };
    let object = stored(&object_from_tangent(surface, tangent).unwrap(), NormalSpace::Object);
    let back = stored(&tangent_from_object(surface, &object).unwrap(), NormalSpace::Tangent);
    let again = stored(&object_from_tangent(surface, &back).unwrap(), NormalSpace::Object);
    angular_error(&object, &again).unwrap().within(&surface.coverage().mask()).unwrap()
}

fn summary(field: &Field) -> Summary {
    field.summary().expect("normals exist")
}

#[test]
fn object_space_and_back_on_mirrored_uvs() {
    let surface = laid_out(&mirrored_tube(), &grid(256, 4));
    let handedness: Vec<f32> = surface.mesh().tangents().iter().map(|t| t[3]).collect();
    assert!(handedness.contains(&1.0) && handedness.contains(&-1.0));
    assert_eq!((surface.coverage().shared(), surface.coverage().skipped()), (0, 0));
    let map = rough(256);
    for (storage, bound) in PLAIN.into_iter().zip([0.6, 0.003]) {
        let error = summary(&round_trip(&surface, &map, storage));
        println!("{} bits: mean {:.4}°, max {:.4}°", storage.bits, error.mean, error.max);
        assert!(error.count > 256 * 256 / 2 && error.mean < bound, "{error:?}");
    }
    // Without storing, only rounding to single precision remains.
    let object = object_from_tangent(&surface, &map).unwrap();
    let back = tangent_from_object(&surface, &object).unwrap();
    let exact = summary(&angular_error(&map, &back).unwrap());
    assert!(exact.max < 2e-4, "{exact:?}");
}

#[test]
fn object_space_normals_are_those_of_the_tube() {
    let surface = laid_out(&mirrored_tube(), &grid(128, 4));
    let flat = Image::new(128, 128, [0.0, 0.0, 1.0, 1.0]).unwrap();
    let object = object_from_tangent(&surface, &flat).unwrap();
    // Towards the right of the picture: along the tube in the first half, in the opposite direction in the mirrored
    // one.
    let tilted = Image::new(128, 128, [0.6, 0.0, 0.8, 1.0]).unwrap();
    let turned = object_from_tangent(&surface, &tilted).unwrap();
    for (x, sign) in [(30, 1.0), (100, -1.0)] {
        let [n, m] = [&object, &turned].map(|map| {
            let [x, y, z, _] = map.pixel(x, 64);
            Vec3::new(x, y, z).to_f64()
        });
        let point = surface.point(x, 64).unwrap().position;
        assert!(angle_deg(n, Vec3::new(point.x, 0.0, point.z)) < 0.5, "outward");
        let along = Vec3::new(n.z, 0.0, -n.x) * sign;
        assert!((m.dot(along) - 0.6).abs() < 0.01, "{m:?} along {along:?}");
    }
}

/// The law, on the maps that xNormal baked.
#[test]
fn object_space_and_back_on_every_statue() {
    for model in data_files("threedscans-keijiro", &["obj"]) {
        let statue = Statue::read(&model);
        let error = summary(&round_trip(&statue.surface, &statue.tangent, PLAIN[1]));
        let coverage = statue.surface.coverage();
        println!(
            "{}: {} texels, {} shared, mean {:.5}°, p95 {:.5}°, max {:.4}°",
            model.display(),
            error.count,
            coverage.shared(),
            error.mean,
            error.p95,
            error.max
        );
        assert!(error.count > 1_000_000, "most of the map is used");
        assert!(error.mean < 0.2, "{}: {error:?}", model.display());
    }
}

struct Statue {
    surface: TexelSurface,
    tangent: Image,
}

impl Statue {
    fn read(model: &Path) -> Self {
        let stem = model.file_stem().unwrap().to_string_lossy().into_owned();
        let map = read_bitmap(&model.with_file_name(format!("{stem}_normals.png"))).unwrap();
        let mesh = load_model(model).unwrap().scene.meshes()[0].clone();
        let size = TexelGrid { width: map.width(), height: map.height(), uv_set: 0, padding: 4 };
        let tangent = decoded_normals(&map, NormalSpace::Tangent, GreenChannel::Up).unwrap();
        Self { surface: laid_out(&mesh, &size), tangent }
    }
}

/// A unit square with uvs over the whole map.
fn square() -> Mesh {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    Mesh::new(MeshData {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).into(),
        normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
        uvs: vec![corners.map(|(x, y)| Vec2::new(x, 1.0 - y)).into()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
    .unwrap()
}

/// Returns h = 0.2 sin(2πx) cos(2πy), y up, and its slopes per unit.
fn waves(side: u32) -> (Heights, impl Fn(u32, u32) -> [f64; 2]) {
    let turn = move |i: u32| (f64::from(i) + 0.5) / f64::from(side) * std::f64::consts::TAU;
    let height = move |i: u32| 0.2 * scalar::sin(turn(i % side)) * scalar::cos(-turn(i / side));
    let values = (0..side * side).map(|i| height(i) as f32).collect();
    let slope = std::f64::consts::TAU * 0.2;
    let slopes = move |x: u32, y: u32| {
        let (a, b) = (turn(x), -turn(y));
        [slope * scalar::cos(a) * scalar::cos(b), -slope * scalar::sin(a) * scalar::sin(b)]
    };
    (Heights::new([side; 2], values, [Wrap::Repeat; 2]).unwrap(), slopes)
}

#[test]
fn heights_become_the_normals_of_their_surface() {
    let (heights, slopes) = waves(128);
    // The square is one unit wide, and so is the map: the height of 1 is 128 texels.
    let flat = tangent_from_height(&heights, 128.0).unwrap();
    let on_mesh = tangent_from_height_on(&laid_out(&square(), &grid(128, 0)), &heights, 1.0).unwrap();
    let mut expected = flat.clone();
    for (i, pixel) in expected.pixels_mut().iter_mut().enumerate() {
        let [p, q] = slopes(i as u32 % 128, i as u32 / 128);
        let n = Vec3::new(-p, -q, 1.0).normalize().to_f32();
        *pixel = [n.x, n.y, n.z, 1.0];
    }
    let error = summary(&angular_error(&flat, &expected).unwrap());
    assert!(error.max < 0.01, "{error:?}");
    let same = summary(&angular_error(&flat, &on_mesh).unwrap());
    assert!(same.max < 1e-4 && same.count == 128 * 128, "{same:?}");
}

#[test]
fn relief_on_a_mesh_does_not_depend_on_its_layout() {
    // The same relief on a mirrored half and on a plain one: in object space both are the mirror image of the other.
    let surface = laid_out(&mirrored_tube(), &grid(200, 2));
    let values = (0..40_000u32).map(|i| {
        let x = if i % 200 < 100 { i % 200 } else { 199 - i % 200 };
        scalar::sin(f64::from(x) * 0.3 + f64::from(i / 200) * 0.2) as f32
    });
    let heights = Heights::new([200; 2], values.collect(), [Wrap::Clamp; 2]).unwrap();
    let tangent = tangent_from_height_on(&surface, &heights, 0.02).unwrap();
    for (x, y) in [(20, 50), (60, 100), (80, 170)] {
        let ([ax, ay, az, am], [bx, by, bz, bm]) = (tangent.pixel(x, y), tangent.pixel(199 - x, y));
        assert_eq!((am, bm), (1.0, 1.0));
        assert!((ax + bx).abs() < 1e-4 && (ay - by).abs() < 1e-4 && (az - bz).abs() < 1e-4);
        assert!(ax.abs() > 0.01 || ay.abs() > 0.01, "there is relief");
    }
}

/// All normals of the upper half ball, evenly spread.
fn half_ball(side: u32) -> Image {
    let mut random = Random(11);
    let mut map = Image::new(side, side, [0.0; 4]).unwrap();
    for pixel in map.pixels_mut() {
        let (z, turn) = (random.next(), random.next() * std::f64::consts::TAU);
        let r = (1.0 - z * z).sqrt();
        *pixel = [(r * scalar::cos(turn)) as f32, (r * scalar::sin(turn)) as f32, z as f32, 1.0];
    }
    map
}

#[test]
fn eight_bits_cost_a_sixth_of_a_degree() {
    let map = half_ball(300);
    let error = |storage| {
        let stored = store_normals(&map, NormalSpace::Tangent, GreenChannel::Down, storage).unwrap();
        summary(&stored.error)
    };
    let [eight, sixteen] = PLAIN.map(error);
    println!("8 bits: mean {:.4}°, max {:.3}°; 16 bits: mean {:.6}°", eight.mean, eight.max, sixteen.mean);
    assert!((eight.mean - 0.17).abs() < 0.002 && eight.max < 0.4);
    assert!((sixteen.mean * 257.0 - 0.17).abs() < 0.002);
    assert!(
        store_normals(&map, NormalSpace::Tangent, GreenChannel::Up, Storage { bits: 12, dither: false })
            .is_err()
    );
}

#[test]
fn dithering_keeps_the_mean_of_neighbors() {
    // A curve gentle enough that eight bits make steps 20 texels wide.
    const SIDE: u32 = 256;
    let mut map = Image::new(SIDE, SIDE, [0.0; 4]).unwrap();
    for (i, pixel) in map.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % SIDE, i as u32 / SIDE);
        let v = Vec3::new(f64::from(x) * 4e-4, f64::from(y) * 3e-4, 1.0).normalize().to_f32();
        *pixel = [v.x, v.y, v.z, 1.0];
    }
    let off = |dither| {
        let storage = Storage { bits: 8, dither };
        let stored = store_normals(&map, NormalSpace::Tangent, GreenChannel::Up, storage).unwrap();
        let back = decoded_normals(&stored.bitmap, NormalSpace::Tangent, GreenChannel::Up).unwrap();
        let blocks = (0..SIDE / 8).flat_map(|y| (0..SIDE / 8).map(move |x| [8 * x, 8 * y]));
        let angles: Vec<f64> =
            blocks.map(|at| angle_deg(block_sum(&map, at), block_sum(&back, at))).collect();
        (angles.iter().sum::<f64>() / angles.len() as f64, summary(&stored.error).mean)
    };
    let ((plain, plain_texel), (dithered, dithered_texel)) = (off(false), off(true));
    println!(
        "means of 8×8 off by {plain:.4}°, dithered {dithered:.4}°; texels {plain_texel:.3}°, {dithered_texel:.3}°"
    );
    assert!(dithered < plain / 4.0, "{dithered} against {plain}");
    assert!(dithered_texel < 2.5 * plain_texel);
}

/// The sum of the vectors of 8×8 texels.
fn block_sum(map: &Image, [x, y]: [u32; 2]) -> Vec3<f64> {
    let texels = (0..64).map(|i| map.pixel(x + i % 8, y + i / 8));
    texels.fold(Vec3::splat(0.0), |sum, [x, y, z, _]| sum + Vec3::new(x, y, z).to_f64())
}

/// Random codes, including the first and the last.
fn codes() -> Bitmap {
    let mut random = Random(1);
    let mut texels: Vec<[u8; 4]> =
        (0..64).map(|_| [0; 4].map(|_: u8| (random.next() * 256.0) as u8)).collect();
    texels[0] = [0, 255, 0, 255];
    Bitmap::new(8, 8, 4, Texels::U8(texels)).unwrap()
}

#[test]
fn more_bits_and_back_change_nothing() {
    for dither in [false, true] {
        let wide = requantised(&codes(), Storage { bits: 16, dither }).unwrap();
        assert_eq!(wide.bits(), 16);
        assert_eq!(requantised(&wide, Storage { bits: 8, dither }).unwrap(), codes());
    }
}

#[test]
fn dithering_changes_no_code() {
    let texels = (0..=u16::MAX).map(|c| [c, u16::MAX - c, c ^ 0x5555, u16::MAX]).collect();
    let all = Bitmap::new(256, 256, 3, Texels::U16(texels)).unwrap();
    assert_eq!(requantised(&all, Storage { bits: 16, dither: true }).unwrap(), all);
}

#[test]
fn green_turned_twice_is_as_it_was() {
    let turned = green_turned(&codes());
    assert_eq!(green_turned(&turned), codes());
    let up = decoded_normals(&codes(), NormalSpace::Tangent, GreenChannel::Up).unwrap();
    let down = decoded_normals(&turned, NormalSpace::Tangent, GreenChannel::Down).unwrap();
    let error = summary(&angular_error(&up, &down).unwrap());
    assert!(error.max < 1e-4, "{error:?}");
}

#[test]
fn maps_do_not_depend_on_the_number_of_threads() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let surface = laid_out(&mirrored_tube(), &grid(100, 5));
            let object = object_from_tangent(&surface, &rough(100)).unwrap();
            let storage = Storage { bits: 8, dither: true };
            store_normals(&object, NormalSpace::Object, GreenChannel::Up, storage).unwrap().bitmap
        })
    };
    assert_eq!(made(1), made(3));
}

#[test]
fn what_does_not_fit_is_refused() {
    let surface = laid_out(&square(), &grid(8, 0));
    let other = Image::new(4, 4, [0.0, 0.0, 1.0, 1.0]).unwrap();
    let why = object_from_tangent(&surface, &other).unwrap_err().to_string();
    assert!(why.contains("4x4") && why.contains("8x8"), "{why}");
    assert!(TexelSurface::new(square(), &grid(8, 0)).unwrap_err().to_string().contains("no tangents"));
    // Padding is not a normal, and stays padding.
    let grey = Image::new(8, 8, [0.0; 4]).unwrap();
    assert!(object_from_tangent(&surface, &grey).unwrap().pixels().iter().all(|p| *p == [0.0; 4]));
}
