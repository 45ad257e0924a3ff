//! Baked assets under a raking light, compared with the scans that they were baked from:
//! `docs/decisions/shading.md#grazing-normals`, and the table of poses in `docs/errors.md`.

use crate::hostile::{bare, sheet};
use crate::scenes;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::sync::LazyLock;
use taotie::asset::{BakeOptions, Baker, MeshSource, Packing, Scan, VerifyOptions, WrittenAsset};
use taotie_engine::Progress;
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{Frame, GrazingNormals, Lighting, RenderSettings, Renderer, Shot};
use taotie_engine::scene::{Camera, Material, Orbit, Outline, Scene};
use taotie_engine::surface::vertex_normals;
use taotie_io::load_model;

type V = Vec3<f64>;

const SIDE: u32 = 96;
const POSES: u32 = 20;

fn waves(p: V, frequency: f64) -> f64 {
    let wave = |v: f64, phase: f64| scalar::sin(frequency * v + phase);
    wave(p.x, 0.0) * wave(p.y, 0.5) * wave(p.z, 1.0)
}

/// Returns a unit sphere with moved vertices, closed to the bit.
fn ball(place: impl Fn(V) -> V) -> Mesh {
    let ball = Mesh::sphere(1.0, 160, 80);
    let moved = |p: &Vec3| place(p.to_f64().map(|v| (v * 1e6).round() * 1e-6)).to_f32();
    bare(ball.positions().iter().map(moved).collect(), ball.triangles().to_vec())
}

/// Returns bumpy surfaces of about 26,000 triangles.
fn models() -> [(&'static str, Mesh); 5] {
    let cube = |d: V| {
        let eighth = |v: f64| v * v * v * v * v * v * v * v;
        let length = (eighth(d.x) + eighth(d.y) + eighth(d.z)).sqrt().sqrt().sqrt();
        d * ((1.0 + 0.01 * waves(d, 12.0)) / length)
    };
    let bumpy = |d: V| d * (1.0 + 0.03 * waves(d, 14.0));
    let statue = |d: V| {
        let body = 1.0 + 0.25 * scalar::sin(2.0 * d.y + d.x) + 0.15 * scalar::sin(4.0 * d.x + 2.0 * d.z);
        d * (body * (1.0 + 0.012 * waves(d * body, 22.0))) + Vec3::new(0.0, 0.4 * d.y, 0.0)
    };
    let ring = |u: f64, v: f64| {
        let (a, b) = (TAU * (u % 1.0), TAU * (v % 1.0));
        let r = 0.4 + 0.01 * scalar::sin(16.0 * a) + 0.01 * scalar::sin(8.0 * b);
        let from_axis = 1.0 + r * scalar::cos(b);
        Vec3::new(from_axis * scalar::cos(a), from_axis * scalar::sin(a), r * scalar::sin(b))
    };
    let plaque = |u: f64, v: f64| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let ridges = 0.012 * scalar::sin(12.0 * (x * x + y * y)) + 0.008 * scalar::sin(20.0 * x);
        Vec3::new(x, y, 0.3 * scalar::cos(x * FRAC_PI_2) * scalar::cos(y * FRAC_PI_2) + ridges)
    };
    [
        ("cube", ball(cube)),
        ("ball", ball(bumpy)),
        ("statue", ball(statue)),
        ("ring", sheet(180, 72, ring)),
        ("plaque", sheet(114, 114, plaque)),
    ]
}

/// Returns the scene in plain grey, with its relief kept.
fn grey(mut scene: Scene) -> Scene {
    scene
        .edit(|data| {
            data.lights.clear();
            for material in &mut data.materials {
                let normal = material.normal;
                let color = [0.8, 0.8, 0.8, 1.0];
                *material = Material {
                    base_color: color,
                    roughness: 0.6,
                    normal,
                    double_sided: true,
                    ..Material::default()
                };
            }
        })
        .unwrap();
    scene
}

fn written(scan: &Scan, options: BakeOptions, path: &Path) -> WrittenAsset {
    let asset = Baker::new(BakeOptions { size: 512, ..options }).bake(scan, Progress::SILENT).unwrap();
    asset.write(path, &Packing::default(), Progress::SILENT).unwrap()
}

/// A scan, and the asset of about 300 triangles that was baked from it.
struct Pair {
    name: &'static str,
    scan: Scene,
    asset: Scene,
}

static PAIRS: LazyLock<Vec<Pair>> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    let baked = |(name, mesh): (&'static str, Mesh)| {
        let scan = Scan::from_mesh(mesh.clone(), Progress::SILENT).unwrap();
        written(&scan, BakeOptions { triangles: 300, ..BakeOptions::default() }, &path);
        let scan = grey(Scene::of_mesh(mesh, Material::default()).unwrap());
        Pair { name, scan, asset: grey(load_model(&path).unwrap().scene) }
    };
    models().into_iter().map(baked).collect()
});

/// Returns a camera and a light of strength π, 15° above the plane of the image.
fn pose(pair: &Pair, number: u32) -> (Camera, Lighting) {
    let at = f64::from(number) + 0.5;
    let up = at / f64::from(POSES) * 2.0 - 1.0;
    // Only the front of a plaque is modelled.
    let [azimuth, elevation] =
        if pair.name == "plaque" { [0.8 * scalar::sin(at * 2.4), 0.7 * up] } else { [at * 2.4, 1.2 * up] };
    let outline = Outline::new(&pair.scan);
    let bounds = outline.bounds().unwrap();
    let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: bounds.center(), fov_y: 0.5 };
    orbit.distance = outline.fitting_distance(&orbit, 1.0, 0.92);
    let camera = orbit.camera(bounds.diagonal() / 2.0);
    let (height, roll) = (15f64.to_radians(), at * 1.7);
    let [x, y] = [scalar::cos(roll), scalar::sin(roll)].map(|v| v * scalar::cos(height));
    let to_light = camera.world_from_view.transform_vector(Vec3::new(x, y, scalar::sin(height)));
    let lights = vec![scenes::directional(-to_light.to_f32(), PI as f32)];
    (camera, Lighting { lights, ..Lighting::default() })
}

/// Sums over the poses of a model.
#[derive(Default)]
struct Sums {
    /// Pixels that show both surfaces.
    shared: u32,
    /// Pixels away from silhouettes that are above 0.2 in the scan.
    lit: u32,
    /// Those of them that are below 0.05 in the asset.
    dark: u32,
    /// The absolute differences of light over all shared pixels, by default and with kept normals.
    apart: [f64; 2],
}

impl Sums {
    /// Returns the row of a model in the table of `docs/errors.md`: lit and dark pixels, and the mean differences.
    fn row(&self, name: &str) -> String {
        let [bent, kept] = self.apart.map(|sum| sum / f64::from(self.shared));
        format!("| {name} | {} | {} | {bent:.4} | {kept:.4} |", self.lit, self.dark)
    }
}

/// Returns `true` if nothing within two pixels is a silhouette, or slanted by more than 63°.
fn is_inner(frame: &Frame, camera: &Camera, [x, y]: [u32; 2]) -> bool {
    if [x, y].iter().any(|v| !(2..SIDE - 2).contains(v)) {
        return false;
    }
    let depth = &frame.aovs.as_ref().unwrap().depth;
    let middle = f64::from(depth.pixel(x, y)[0]);
    let most = 4.0 * camera.pixel_size(middle, SIDE, SIDE);
    (y - 2..=y + 2).all(|y| {
        let near = |x: u32| (f64::from(depth.pixel(x, y)[0]) - middle).abs() <= most;
        (x - 2..=x + 2).all(|x| frame.color.pixel(x, y)[3] == 1.0 && near(x))
    })
}

fn sums(pair: &Pair, shadows: bool) -> Sums {
    let settings =
        RenderSettings { width: SIDE, height: SIDE, shadows, aovs: true, ..RenderSettings::default() };
    let kept = RenderSettings { grazing_normals: GrazingNormals::Keep, ..settings.clone() };
    let renderer = |scene: &Scene| Renderer::new(scene.clone(), &settings.surface).unwrap();
    let (mut of_scan, mut of_asset) = (renderer(&pair.scan), renderer(&pair.asset));
    let mut sums = Sums::default();
    for (camera, lighting) in (0..POSES).map(|number| pose(pair, number)) {
        let take = |renderer: &mut Renderer, settings: &RenderSettings| {
            let shot = Shot { camera: &camera, lighting: &lighting, settings };
            renderer.render(&shot, Progress::SILENT).unwrap()
        };
        let scan = take(&mut of_scan, &settings);
        let [asset, keeping] = [&settings, &kept].map(|settings| take(&mut of_asset, settings));
        for at in (0..SIDE * SIDE).map(|i| [i % SIDE, i / SIDE]) {
            let [truth, ours, kept] = [&scan, &asset, &keeping].map(|frame| frame.color.pixel(at[0], at[1]));
            if truth[3].min(ours[3]) < 1.0 {
                continue;
            }
            sums.shared += 1;
            sums.apart[0] += f64::from((truth[1] - ours[1]).abs());
            sums.apart[1] += f64::from((truth[1] - kept[1]).abs());
            if [&scan, &asset].iter().all(|frame| is_inner(frame, &camera, at)) {
                sums.lit += u32::from(truth[1] > 0.2);
                sums.dark += u32::from(truth[1] > 0.2 && ours[1] < 0.05);
            }
        }
    }
    sums
}

#[test]
fn no_lit_relief_is_dark_in_the_asset() {
    for pair in &*PAIRS {
        let sums = sums(pair, false);
        eprintln!("{}", sums.row(pair.name));
        assert!(sums.lit > 10_000, "{}: the case shows nothing", pair.name);
        assert_eq!(sums.dark, 0, "{}", pair.name);
        // Bending normals towards the viewer moves the asset no farther from its scan; for the plaque 0.32 %, a tie.
        let most = if pair.name == "plaque" { 1.004 } else { 1.001 };
        assert!(sums.apart[0] <= most * sums.apart[1], "{}: {:?}", pair.name, sums.apart);
    }
}

/// Shadows of a coarse mesh have other edges: those darken at most a thousandth of the lit pixels.
#[test]
fn the_coarse_mesh_casts_no_shadow_on_its_own_relief() {
    for pair in &*PAIRS {
        let sums = sums(pair, true);
        eprintln!("{}", sums.row(&format!("{}, with shadows", pair.name)));
        assert!(sums.lit > 10_000, "{}: the case shows nothing", pair.name);
        assert!(sums.dark * 1000 <= sums.lit, "{}: {} of {}", pair.name, sums.dark, sums.lit);
    }
}

/// A cube of flat sides, each of `cells`² squares.
fn cube(cells: u32) -> MeshData {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for side in 0..6 {
        let (axis, sign) = (side / 2, if side % 2 == 0 { -1.0 } else { 1.0 });
        let face = sheet(cells, cells, |u, v| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, (2.0 * u - 1.0) * sign, 2.0 * v - 1.0);
            Vec3::new(p[0], p[1], p[2])
        });
        let first = data.positions.len() as u32;
        for (i, position) in face.positions().iter().enumerate() {
            let (u, v) = (i as u32 % (cells + 1), i as u32 / (cells + 1));
            let place = |at: u32, column: usize, columns: f64| {
                ((column as f64 + 0.05 + 0.9 * f64::from(at) / f64::from(cells)) / columns) as f32
            };
            data.uvs[0].push(Vec2::new(place(u, side % 3, 3.0), place(v, side / 3, 2.0)));
            data.positions.push(*position);
            data.normals
                .push(Vec3::from_array(std::array::from_fn(|i| if i == axis { sign as f32 } else { 0.0 })));
        }
        data.triangles.extend(face.triangles().iter().map(|triangle| triangle.map(|v| v + first)));
    }
    data
}

/// The normals of the low-poly mesh lean by up to 55°, while its map is right. 16 bits, since on flat sides the steps
/// of 8 bits are all that would be visible.
#[test]
fn a_cube_with_smooth_corners_looks_like_its_scan() {
    let folder = tempfile::tempdir().unwrap();
    let scan = Scan::from_mesh(Mesh::new(cube(40)).unwrap(), Progress::SILENT).unwrap();
    for cells in [1, 4] {
        let mut low = cube(cells);
        low.normals = vertex_normals(&Mesh::new(low.clone()).unwrap());
        let low = Some(MeshSource::Mesh(Mesh::new(low).unwrap().into()));
        let options = BakeOptions { low, bits: 16, ..BakeOptions::default() };
        let written = written(&scan, options, &folder.path().join("cube.glb"));
        let options = VerifyOptions { points: 10, map: 16, view: 256, ..VerifyOptions::default() };
        let views = written.verify(&scan, &options, Progress::SILENT).unwrap().views.figures;
        let mean = views.iter().map(|view| view.flip).sum::<f64>() / views.len() as f64;
        eprintln!("{cells}² squares a side: FLIP {mean:.5}");
        assert!(mean <= 0.003, "{cells}² squares a side: FLIP {mean}");
    }
}
