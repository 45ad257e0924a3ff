//! Laws of scanner noise: known noise is measured on any shape, and its removal keeps relief and creases.

use crate::angle::angle;
use crate::random::Random;
use taotie_engine::Error;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::progress::Progress;
use taotie_engine::surface::{Noise, by_position, vertex_normals};

type V = Vec3<f64>;

/// A surface over a grid of `n`² squares of [−1, 1]², irregular: vertices off the border are moved by up to 0.3 of a
/// square, and each square has a random diagonal. Vertices of several grids coincide at equal positions.
fn grid(data: &mut MeshData, n: u32, random: &mut Random, surface: &dyn Fn(f64, f64) -> V) {
    let first = data.positions.len() as u32;
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        let is_inside = [i, j].iter().all(|k| (1..n).contains(k));
        let mut along = |k: u32| {
            let jitter = if is_inside { 0.6 * (random.next() - 0.5) } else { 0.0 };
            (2.0 * (f64::from(k) + jitter) - f64::from(n)) / f64::from(n)
        };
        let (u, v) = (along(i), along(j));
        data.positions.push(surface(u, v).to_f32());
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [a, b] = [j, j + 1].map(|row| first + row * (n + 1) + i);
        let halves = match random.next() < 0.5 {
            true => [[a, a + 1, b + 1], [a, b + 1, b]],
            false => [[a, a + 1, b], [a + 1, b + 1, b]],
        };
        data.triangles.extend(halves);
    }
}

/// A closed surface made of the six sides of a cube, each a grid of `n`² squares; `shape` maps the surface of the cube
/// [−1, 1]³.
fn closed(n: u32, shape: &dyn Fn(V) -> V) -> Mesh {
    let (mut data, mut random) = (MeshData::default(), Random(7));
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        grid(&mut data, n, &mut random, &|u, v| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, u, sign * v);
            shape(Vec3::from_array(p))
        });
    }
    Mesh::new(data).unwrap()
}

fn sphere(n: u32) -> Mesh {
    closed(n, &|p| p.normalize())
}

/// A ball whose radius varies by 3 %, in waves of a sixth to a fifth of its circumference.
fn bumpy(n: u32) -> Mesh {
    closed(n, &|p| {
        let d = p.normalize();
        let wave = |x: f64, frequency: f64| scalar::sin(frequency * x + frequency);
        d * (1.0 + 0.03 * wave(d.x, 6.0) * wave(d.y, 5.0) * wave(d.z, 5.5))
    })
}

/// A cube with edges rounded by 0.15 of half its side.
fn rounded(n: u32) -> Mesh {
    closed(n, &|p| {
        let core = p.map(|x: f64| x.clamp(-0.85, 0.85));
        core + (p - core).normalize_or(p) * 0.15
    })
}

fn cube(n: u32) -> Mesh {
    closed(n, &|p| p)
}

/// The median length of its edges.
fn edge(mesh: &Mesh) -> f64 {
    let corners = (0..mesh.triangles().len()).map(|t| mesh.corners(t).map(Vec3::to_f64));
    let mut lengths: Vec<f64> =
        corners.flat_map(|[a, b, c]| [(b - a).length(), (c - b).length(), (a - c).length()]).collect();
    lengths.sort_unstable_by(f64::total_cmp);
    lengths[lengths.len() / 2]
}

/// A sample of the standard normal distribution, by the sum of twelve uniform ones.
fn gauss(random: &mut Random) -> f64 {
    (0..12).map(|_| random.next() - 0.5).sum()
}

/// The mesh with noise of this standard deviation along its normals, one sample for each position.
fn noisy(mesh: &Mesh, sigma: f64, seed: u64) -> Mesh {
    let (places, normals, mut random) = (by_position(mesh.positions()), vertex_normals(mesh), Random(seed));
    let samples: Vec<f64> = places.firsts.iter().map(|_| sigma * gauss(&mut random)).collect();
    let moved = |v: usize| {
        let p = mesh.positions()[v].to_f64() + normals[v].to_f64() * samples[places.of[v] as usize];
        p.to_f32()
    };
    let positions = (0..normals.len()).map(moved).collect();
    Mesh::new(MeshData { positions, ..mesh.clone().into_data() }).unwrap()
}

fn denoised(mesh: &Mesh) -> Mesh {
    Noise::of(mesh).unwrap().remove(mesh, Progress::SILENT).unwrap().mesh
}

/// The root mean square difference of some vertices along the normals of `clean`.
fn rms(clean: &Mesh, other: &Mesh, is_counted: impl Fn(V) -> bool) -> f64 {
    let normals = vertex_normals(clean);
    let (mut sum, mut count) = (0.0, 0);
    for (v, p) in clean.positions().iter().enumerate().filter(|(_, p)| is_counted(p.to_f64())) {
        let off = (other.positions()[v] - *p).to_f64().dot(normals[v].to_f64());
        (sum, count) = (sum + off * off, count + 1);
    }
    (sum / f64::from(count)).sqrt()
}

/// The mean angle between the normals of vertices, degrees.
fn mean_angle(a: &Mesh, b: &Mesh) -> f64 {
    let (a, b) = (vertex_normals(a), vertex_normals(b));
    a.iter().zip(&b).map(|(a, b)| angle(a.to_f64(), b.to_f64()).to_degrees()).sum::<f64>() / a.len() as f64
}

#[test]
fn known_noise_is_measured_and_its_removal_halves_it() {
    type Shape = fn(u32) -> Mesh;
    let shapes: [(&str, Shape, [u32; 2]); 4] = [
        ("sphere", sphere, [16, 48]),
        ("bumpy ball", bumpy, [28, 56]),
        ("rounded cube", rounded, [32, 64]),
        ("cube", cube, [24, 56]),
    ];
    for (name, shape, sizes) in shapes {
        for n in sizes {
            let clean = shape(n);
            let edge = edge(&clean);
            for (seed, part) in [(1, 0.05), (2, 0.1), (3, 0.25)] {
                let sigma = part * edge;
                let given = noisy(&clean, sigma, seed);
                let noise = Noise::of(&given).unwrap();
                let ratio = noise.sigma / sigma;
                let denoised = denoised(&given);
                let gain = rms(&clean, &given, |_| true) / rms(&clean, &denoised, |_| true);
                let angles = [&given, &denoised].map(|mesh| mean_angle(&clean, mesh));
                println!(
                    "{name} {n}: σ {part} edges, measured × {ratio:.3}, removal: rms ÷ {gain:.2}, normals {angles:.2?}°"
                );
                assert!((ratio - 1.0).abs() < 0.2, "{name} {n} {part}: {ratio}");
                assert!((noise.scale / (2.0 * edge) - 1.0).abs() < 0.1, "{name}: {}", noise.scale / edge);
                assert!(gain > 1.7 && angles[1] < 0.65 * angles[0], "{name} {n} {part}: {gain}, {angles:?}");
            }
        }
    }
}

#[test]
fn relief_is_not_noise() {
    for (name, clean, most) in
        [("bumpy ball", bumpy(28), 0.01), ("rounded cube", rounded(32), 0.001), ("cube", cube(24), 1e-6)]
    {
        let part = Noise::of(&clean).unwrap().sigma / edge(&clean);
        println!("{name}: without noise {part:.6} edges are measured");
        assert!(part < most, "{name}: {part}");
    }
}

/// Waves of twice the noise's scale and three times its deviation keep 90 % of their amplitude.
#[test]
fn relief_above_the_noise_is_kept() {
    const N: u32 = 96;
    const HALF: f64 = N as f64 / 2.0;
    let mut data = MeshData::default();
    grid(&mut data, N, &mut Random(5), &|u, v| Vec3::new(u, v, 0.0) * HALF);
    let flat = Mesh::new(data).unwrap();
    let edge = edge(&flat);

    for part in [0.05, 0.1, 0.25] {
        for (scales, heights) in [(2.0, 3.0), (2.0, 5.0), (4.0, 3.0), (4.0, 1.0)] {
            let (sigma, length) = (part * edge, scales * 2.0 * edge);
            let wave = |p: V| scalar::sin(std::f64::consts::TAU / length * (0.8 * p.x + 0.6 * p.y));
            let mut data = flat.clone().into_data();
            data.positions.iter_mut().for_each(|p| p.z = (heights * sigma * wave(p.to_f64())) as f32);
            let mut random = Random(9);
            data.positions.iter_mut().for_each(|p| p.z += (sigma * gauss(&mut random)) as f32);
            let given = Mesh::new(data).unwrap();
            let noise = Noise { sigma, scale: 2.0 * edge, removed: None };
            let denoised = noise.remove(&given, Progress::SILENT).unwrap().mesh;
            let amplitude = |mesh: &Mesh| {
                let is_inside = |p: &&Vec3| [p.x, p.y].iter().all(|x| f64::from(x.abs()) < HALF - 6.0);
                let inside = || mesh.positions().iter().filter(is_inside).map(|p| p.to_f64());
                inside().map(|p| p.z * wave(p)).sum::<f64>()
                    / inside().map(|p| wave(p) * wave(p)).sum::<f64>()
            };
            let kept = amplitude(&denoised) / amplitude(&given);
            println!("σ {part} edges, wave of {scales} scales and {heights} σ: {:.1} % kept", 100.0 * kept);
            assert!(kept > 0.9, "{part} {scales} {heights}: {kept}");
        }
    }
}

/// The removal does not round the edges of a cube, and no vertex of an open border leaves it.
#[test]
fn creases_and_borders_stay() {
    let clean = cube(32);
    let edge = edge(&clean);
    let is_at_edge = |p: V| p.to_array().iter().filter(|x| x.abs() > 1.0 - 1e-3).count() >= 2;
    for part in [0.05, 0.1, 0.25] {
        let given = noisy(&clean, part * edge, 4);
        let [before, after] = [&given, &denoised(&given)].map(|mesh| rms(&clean, mesh, is_at_edge));
        println!(
            "σ {part} edges: edges of the cube are off by {:.2} σ, then {:.2} σ",
            before / part / edge,
            after / part / edge
        );
        assert!(after < 1.1 * before, "{before} {after}");
    }
    let mut data = MeshData::default();
    grid(&mut data, 32, &mut Random(3), &|u, v| Vec3::new(u, v, 0.0));
    let given = noisy(&Mesh::new(data).unwrap(), 0.1 / 16.0, 6);
    let after = denoised(&given);
    let moved = (0..given.positions().len()).map(|v| after.positions()[v] - given.positions()[v]);
    let sideways = moved.map(|d| f64::from(d.x).hypot(f64::from(d.y))).fold(0.0, f64::max);
    assert!(sideways < 0.1 / 16.0, "{sideways}");
}

#[test]
fn normals_turn_with_the_surface_and_meshes_without_noise_stay() {
    let flat = cube(24);
    let noise = Noise { sigma: 0.0, scale: 1.0, removed: None };
    let same = noise.remove(&flat, Progress::SILENT).unwrap();
    assert_eq!((same.mesh.positions(), same.change.rms), (flat.positions(), 0.0));

    let rough = noisy(&sphere(24), 0.01, 1);
    let given = Mesh::new(MeshData { normals: vertex_normals(&rough), ..rough.into_data() }).unwrap();
    let after = denoised(&given);
    let most = |(a, b): (&Vec3, &Vec3)| (*a - *b).length();
    let off = after.normals().iter().zip(&vertex_normals(&after)).map(most).fold(0.0, f32::max);
    assert!(off < 1e-5, "{off}");
    assert!(Noise::of(&Mesh::sphere(1.0, 4, 3)).is_none(), "too few vertices");
    assert!(Noise::of(&Mesh::default()).is_none());
}

#[test]
fn threads_change_no_bit_and_the_caller_can_stop() {
    let given = noisy(&bumpy(40), 0.003, 2);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| (Noise::of(&given).unwrap(), denoised(&given)))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.0, three.0);
    assert!(one.1.positions() == three.1.positions());
    let noise = one.0;
    let stop = |_: &'static str, _: f64| false;
    assert!(matches!(noise.remove(&given, Progress::new(&stop)), Err(Error::Cancelled)));
}
