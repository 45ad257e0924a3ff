//! Bakes whose rays are cast by a GPU, compared with those by the CPU.

use crate::common::data_folder;
use crate::compared::gpu;
use std::sync::Arc;
use taotie_engine::bake::{
    BakeInput, BakeSettings, Baked, BakedMaps, Cage, CageGroups, CastRay, MapKind, Plane, RayDevice, Scan,
    SimplifyOptions, TexelStatus, UnwrapOptions, bake, simplify, unwrap,
};
use taotie_engine::math::{Mat4, Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};
use taotie_engine::surface::with_frames;
use taotie_engine::{Error, Progress};
use taotie_gpu::Gpu;

/// The maximum mean angle between normals, and that of all but one texel in a thousand, degrees. Measured on lavapipe:
/// 1.8e-6 and 1.4e-5.
const MOST_ANGLES: [f64; 2] = [3e-6, 2e-5];

/// The same for bent normals. Measured: 2.5e-5 and 1.3e-5.
const MOST_BENT: [f64; 2] = [1e-4, 5e-5];

/// The same for occlusion, in 8-bit codes. Measured: 7.5e-5 and 6.1e-5.
const MOST_CODES: [f64; 2] = [3e-4, 2e-4];

/// A low-poly mesh to bake for.
struct Subject {
    low: Mesh,
    cage: Cage,
    settings: BakeSettings,
}

/// The differences of two bakes over covered texels: the mean, and the 99.9th percentile.
#[derive(Debug)]
struct Difference {
    /// Angles between normals, degrees.
    normals: [f64; 2],
    /// Angles between bent normals, degrees.
    bent: [f64; 2],
    /// Occlusion, in 8-bit codes.
    occlusion: [f64; 2],
}

impl Subject {
    /// Makes the subject with automatic rays.
    fn new(low: Mesh, scan: &Scan) -> Self {
        let maps = [MapKind::Normal, MapKind::Occlusion, MapKind::Bent].into_iter().collect();
        let settings = BakeSettings { size: [128; 2], maps, ..BakeSettings::default() };
        Self { cage: Cage::automatic(&low, scan), low, settings }
    }

    fn baked(&self, scan: &Scan) -> Baked {
        let Self { low, cage, settings } = self;
        bake(BakeInput { low, cage, scan }, settings, Progress::SILENT).unwrap()
    }

    /// Bakes with both, and fails if they differ too much. Returns the maps by the CPU.
    fn check(&self, gpu: &Gpu, (name, scan): (&str, Scan)) -> Baked {
        let expected = self.baked(&scan);
        assert!(expected.counts.texels > 5_000, "{name}: {:?}", expected.counts);
        let found = self.baked(&by(gpu, scan));
        let difference = Difference::of(&expected.maps, &found.maps);
        println!("{name}: {difference:?} {:?}", found.counts);
        assert_eq!(found.counts, expected.counts, "{name}: other rays hit");
        assert!(difference.is_rounding(), "{name}: {difference:?}");
        expected
    }
}

impl Difference {
    fn of(one: &BakedMaps, other: &BakedMaps) -> Self {
        let is_covered = |i: &usize| one.texels[*i] != TexelStatus::Free;
        let angles = |plane: Plane| {
            let angle = |i: usize| {
                let [a, b] = [one, other].map(|maps| Vec3::from_array(maps.vectors(plane)[i]).to_f64());
                scalar::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
            };
            summary((0..one.texels.len()).filter(is_covered).map(angle).collect())
        };
        let [a, b] = [one, other].map(|maps| maps.covered(Plane::Occlusion));
        let codes = a.iter().zip(&b).map(|(a, b)| 255.0 * f64::from((a - b).abs()));
        Self {
            normals: angles(Plane::Normal),
            bent: angles(Plane::Bent),
            occlusion: summary(codes.collect()),
        }
    }

    /// Returns true if the CPU and the GPU may differ by as much.
    fn is_rounding(&self) -> bool {
        let within = |found: [f64; 2], most: [f64; 2]| found[0] <= most[0] && found[1] <= most[1];
        within(self.normals, MOST_ANGLES)
            && within(self.occlusion, MOST_CODES)
            && within(self.bent, MOST_BENT)
    }
}

/// Returns the mean and the 99.9th percentile.
fn summary(mut numbers: Vec<f64>) -> [f64; 2] {
    numbers.sort_unstable_by(f64::total_cmp);
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    [mean, numbers[(numbers.len() - 1) * 999 / 1000]]
}

/// Returns a scan whose rays are cast by a GPU.
fn by(gpu: &Gpu, scan: Scan) -> Scan {
    scan.cast_by(Some(Arc::new(gpu.clone())))
}

/// Returns a sphere with bosses, whose centre is `away` from the origin.
fn embossed(away: Vec3) -> Mesh {
    let place = |n: Vec3<f64>| {
        let waves = [n.x, n.y, n.z].into_iter().map(|v| scalar::sin(9.0 * v)).product::<f64>();
        (n * (1.0 + 0.08 * waves)).to_f32() + away
    };
    let data = Mesh::sphere(1.0, 256, 128).into_data();
    let positions = data.positions.iter().map(|p| place(p.to_f64())).collect();
    Mesh::new(MeshData { positions, triangles: data.triangles, ..MeshData::default() }).unwrap()
}

fn scan(mesh: Mesh) -> Scan {
    Scan::new(Scene::of_mesh(mesh, Material::default()).unwrap()).unwrap()
}

fn low_sphere() -> Mesh {
    with_frames(&Mesh::sphere(1.0, 24, 12), 0, None).unwrap().0.into_owned()
}

#[test]
fn bakes_by_both_agree_and_those_of_a_moved_scan_do_not() {
    let Some(gpu) = gpu() else { return };
    let still = scan(embossed(Vec3::default()));
    let subject = Subject::new(low_sphere(), &still);
    let expected = subject.check(&gpu, ("bosses", still));
    let open = expected.maps.covered(Plane::Occlusion);
    let is_between = |open: &&f32| (0.05..0.95).contains(*open);
    assert!(open.iter().filter(is_between).count() > open.len() / 10, "hollows are occluded");
    let moved = subject.baked(&by(&gpu, scan(embossed(Vec3::new(0.001, 0.0, 0.0)))));
    let difference = Difference::of(&expected.maps, &moved.maps);
    let rounding = [difference.normals[0] / MOST_ANGLES[0], difference.occlusion[0] / MOST_CODES[0]];
    assert!(rounding.into_iter().all(|times| times > 100.0), "{difference:?}");
}

#[test]
fn bakes_do_not_depend_on_threads() {
    let Some(gpu) = gpu() else { return };
    let scan = by(&gpu, scan(embossed(Vec3::default())));
    let subject = Subject::new(low_sphere(), &scan);
    let with_threads = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| subject.baked(&scan)).maps
    };
    let [one, three] = [1, 3].map(with_threads);
    assert!(one.planes().eq(three.planes()), "the same bits");
}

/// Returns two instances of a sphere inside a larger one that is open below, whose walls have two sides.
fn nested() -> Scene {
    let bowl = {
        let data = Mesh::sphere(1.4, 48, 24).into_data();
        let is_upper = |corner: &u32| data.positions[*corner as usize].y > -0.3;
        let front: Vec<[u32; 3]> =
            data.triangles.iter().filter(|triangle| triangle.iter().all(is_upper)).copied().collect();
        let back = front.iter().map(|[a, b, c]| [*a, *c, *b]);
        let triangles = front.iter().copied().chain(back).collect();
        let positions = data.positions;
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).unwrap()
    };
    let instance =
        |mesh: usize| Instance { mesh, material: 0, world_from_object: Mat4::translation(Vec3::default()) };
    let meshes = vec![embossed(Vec3::default()), bowl];
    let materials = vec![Material::default()];
    let instances = vec![instance(0), instance(1)];
    Scene::new(SceneData { meshes, instances, materials, ..SceneData::default() }).unwrap()
}

#[test]
fn parts_of_other_groups_are_not_seen() {
    let Some(gpu) = gpu() else { return };
    let scan = || Scan::new(nested()).unwrap();
    let low = low_sphere();
    let of_triangle = vec![Some(7); low.triangles().len()];
    let groups = Arc::new(CageGroups { of_triangle, of_object: Arc::from([Some(7), None]) });
    let mut subject = Subject::new(low, &scan());
    subject.cage = Cage::automatic_in(&subject.low, &scan(), Some(groups));
    let all = subject.check(&gpu, ("all parts occlude", scan()));
    subject.settings.isolated = true;
    let isolated = subject.check(&gpu, ("one part occludes", scan()));
    let mean = |baked: &Baked| {
        let open = baked.maps.covered(Plane::Occlusion);
        open.iter().sum::<f32>() / open.len() as f32
    };
    let [all, isolated] = [&all, &isolated].map(mean);
    assert!(all < 0.5 && isolated > 0.8, "the bowl covers the sphere: {all} {isolated}");
}

/// Returns a wavy square of `side` × `side` squares of two triangles on the unit square, with uvs.
fn sheet(side: u32) -> Mesh {
    let at = |i: u32| i as f32 / side as f32;
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for (x, y) in (0..=side).flat_map(|y| (0..=side).map(move |x| (x, y))) {
        let height = if side > 1 { ((x * 7 + y * 5) % 11) as f32 * 1e-3 } else { 0.0 };
        data.positions.push(Vec3::new(at(x), at(y), height));
        data.uvs[0].push(Vec2::new(at(x), 1.0 - at(y)));
    }
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        let a = y * (side + 1) + x;
        let (b, c, d) = (a + 1, a + side + 2, a + side + 1);
        data.triangles.extend([[a, b, c], [a, c, d]]);
    }
    Mesh::new(data).unwrap()
}

#[test]
fn rays_through_edges_and_corners_hit() {
    const SIDE: u32 = 64;
    let Some(gpu) = gpu() else { return };
    let up = Vec3::new(0.0, 0.0, 1.0);
    let made = || scan(sheet(SIDE));
    // Through corners, edges and diagonals of the inner squares; half of the rays are a little oblique.
    let inner = (2..2 * SIDE - 1).flat_map(|y| (2..2 * SIDE - 1).map(move |x| (x, y)));
    let ray = |(x, y): (u32, u32)| CastRay {
        middle: Vec3::new(x as f32, y as f32, 0.0) * (0.5 / SIDE as f32),
        direction: if (x / 2) % 2 == 0 { up } else { Vec3::new(0.01, 0.003, 1.0).normalize_or(up) },
        distance: 0.05,
        group: None,
    };
    let rays: Vec<CastRay> = inner.map(ray).collect();
    let named = gpu.load(&made()).unwrap().nearest(&rays, &[]).unwrap();
    let missed = named.iter().filter(|[nearest, _]| nearest.is_none()).count();
    // A GPU that fuses products and sums may miss a few, which the CPU casts again.
    assert!(rays.len() > 15_000 && missed * 1000 <= rays.len(), "{missed} of {}", rays.len());
    // With one sample per texel and two texels per square, samples are on the squares' diagonals.
    let low = with_frames(&sheet(1), 0, None).unwrap().0.into_owned();
    let mut subject = Subject::new(low, &made());
    (subject.settings.size, subject.settings.side) = ([2 * SIDE; 2], 1);
    let baked = subject.check(&gpu, ("diagonals", made()));
    assert_eq!((baked.counts.missed, baked.counts.texels), (0, 4 * SIDE as usize * SIDE as usize));
}

#[test]
fn a_scan_by_others_is_baked_alike() {
    let (Some(gpu), Some(folder)) = (gpu(), data_folder("odedstein-meshes/nefertiti")) else { return };
    let scene = taotie_io::load_model(folder.join("nefertiti-lowres.obj")).unwrap().scene;
    let scan = Scan::new(scene).unwrap();
    let options = SimplifyOptions { triangles: 500, ..SimplifyOptions::default() };
    let low = simplify(scan.mesh(), &options, Progress::SILENT).unwrap().mesh;
    let low = unwrap(&low, &UnwrapOptions { size: 128, padding: 2 }, Progress::SILENT).unwrap().mesh;
    let low = with_frames(&low, 0, None).unwrap().0.into_owned();
    Subject::new(low, &scan).check(&gpu, ("nefertiti", scan));
}

#[test]
fn a_cancelled_bake_stops() {
    let Some(gpu) = gpu() else { return };
    let scan = by(&gpu, scan(embossed(Vec3::default())));
    let Subject { low, cage, settings } = Subject::new(low_sphere(), &scan);
    let progress = Progress::new(&|_, _| false);
    let cancelled = bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, progress);
    assert!(matches!(cancelled, Err(Error::Cancelled)), "{cancelled:?}");
}
