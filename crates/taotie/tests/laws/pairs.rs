//! Scans and assets for the tests of a proof's findings, and the verdicts of `standard`.

use std::path::Path;
use std::sync::{Arc, OnceLock};
use taotie::asset::{
    Asset, BakeOptions, Baker, MeshSource, Packing, Proof, Requirement, RequirementOutcome, Scan,
    VerifyOptions, verify,
};
use taotie_engine::Progress;
use taotie_engine::bake::{SimplifyOptions, simplify};
use taotie_engine::image::{Bitmap, Sampler, Texels, Texture};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Instance, Material, Scene, SceneData, TextureRef, UvTransform};
use taotie_io::{GltfFormat, load_model, write_scene};

/// A grid of quadrilaterals, `closed` around if its last column is its first: positions of (u, v) in [0, 1]².
pub fn grid([columns, rows]: [usize; 2], closed: bool, at: impl Fn(f64, f64) -> Vec3<f64>) -> MeshData {
    let across = if closed { columns } else { columns + 1 };
    let mut data = MeshData::default();
    for row in 0..=rows {
        for column in 0..across {
            let (u, v) = (column as f64 / columns as f64, row as f64 / rows as f64);
            data.positions.push(at(u, v).to_f32());
        }
    }
    let vertex = |column: usize, row: usize| (row * across + column % across) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [vertex(column, row), vertex(column + 1, row)];
            let [c, d] = [vertex(column + 1, row + 1), vertex(column, row + 1)];
            data.triangles.extend([[a, d, c], [a, c, b]]);
        }
    }
    let MeshData { positions, triangles, .. } = &mut data;
    triangles.retain(|[a, b, c]| {
        let [a, b, c] = [a, b, c].map(|v| positions[*v as usize]);
        (b - a).cross(c - a).length() > 0.0
    });
    data
}

pub fn direction(u: f64, v: f64) -> Vec3<f64> {
    let (around, down) = (u * std::f64::consts::TAU, v * std::f64::consts::PI);
    Vec3::new(libm::sin(down) * libm::cos(around), libm::cos(down), -libm::sin(down) * libm::sin(around))
}

/// A ball whose radius is 1 plus `height` at (u, v).
pub fn ball(size: [usize; 2], height: impl Fn(f64, f64) -> f64) -> MeshData {
    // Exactly one point at each pole.
    grid(size, true, |u, v| {
        let pole = if v == 0.0 || v == 1.0 { 0.0 } else { u };
        direction(pole, v) * (1.0 + height(pole, v))
    })
}

/// Soft letters of a fiftieth of the radius, in a band around the middle.
pub fn lettering(u: f64, v: f64) -> f64 {
    if (v - 0.5).abs() > 0.15 {
        return 0.0;
    }
    let wave = |x: f64| libm::sin(x * std::f64::consts::TAU);
    let soft = |x: f64| 0.5 + 0.5 * libm::tanh(x * 3.0);
    let x = ((v - 0.5) / 0.15) * ((v - 0.5) / 0.15);
    let fade = 1.0 - x * x;
    0.02 * soft(wave(u * 12.0) * wave(v * 9.0) * 2.0) * fade
}

pub const FINE: [usize; 2] = [240, 120];

pub fn lettered() -> MeshData {
    ball(FINE, lettering)
}

/// A lettered ball of fewer triangles, and an asset of it with a normal map. They are made only once.
pub fn lettered_pair() -> &'static (Scan, Scene) {
    static PAIR: OnceLock<(Scan, Scene)> = OnceLock::new();
    PAIR.get_or_init(|| {
        let scan = scan_of(ball([160, 80], lettering));
        let asset = scene_of(&onto(&scan, simple(ball([160, 80], lettering), 3_000), 512));
        (scan, asset)
    })
}

pub fn joined(parts: impl IntoIterator<Item = MeshData>) -> MeshData {
    let mut all = MeshData::default();
    for part in parts {
        let first = all.positions.len() as u32;
        all.positions.extend(part.positions);
        all.colors.extend(part.colors);
        all.triangles.extend(part.triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
    all
}

pub fn moved(data: MeshData, change: impl Fn(Vec3) -> Vec3) -> MeshData {
    MeshData { positions: data.positions.into_iter().map(change).collect(), ..data }
}

pub fn turned(data: MeshData, is: impl Fn(Vec3) -> bool) -> MeshData {
    let turn = |[a, b, c]: [u32; 3]| {
        let middle =
            [a, b, c].iter().fold(Vec3::splat(0.0), |sum, v| sum + data.positions[*v as usize]) * (1.0 / 3.0);
        if is(middle) { [a, c, b] } else { [a, b, c] }
    };
    let triangles = data.triangles.iter().copied().map(turn).collect();
    MeshData { triangles, ..data }
}

pub fn mesh(data: MeshData) -> Mesh {
    Mesh::new(data).unwrap()
}

pub fn scan_of(data: MeshData) -> Scan {
    Scan::from_mesh(mesh(data), Progress::SILENT).unwrap()
}

/// An asset of this number of triangles and texels, made from a scan.
pub fn made(scan: &Scan, triangles: u32, size: u32) -> Asset {
    let options = BakeOptions { triangles, size, ..BakeOptions::default() };
    Baker::new(options).bake(scan, Progress::SILENT).unwrap()
}

/// An asset baked onto a mesh.
pub fn onto(scan: &Scan, low: MeshData, size: u32) -> Asset {
    let low = Some(MeshSource::Mesh(Arc::new(mesh(low))));
    Baker::new(BakeOptions { low, size, ..BakeOptions::default() }).bake(scan, Progress::SILENT).unwrap()
}

/// The shape of a mesh in fewer triangles.
pub fn simple(data: MeshData, triangles: usize) -> MeshData {
    let options = SimplifyOptions { triangles, ..SimplifyOptions::default() };
    simplify(&mesh(data), &options, Progress::SILENT).unwrap().mesh.into_data()
}

/// A model that can be written as an asset.
pub trait Written {
    fn write_to(&self, path: &Path);
}

impl Written for Asset {
    fn write_to(&self, path: &Path) {
        self.write(path, &Packing::default(), Progress::SILENT).unwrap();
    }
}

impl Written for Scene {
    fn write_to(&self, path: &Path) {
        write_scene(path, self, &GltfFormat::default()).unwrap();
    }
}

/// Writes an asset and compares it with a scan, using only the file. Points are added until the requirements are
/// decided.
pub fn proof(asset: &impl Written, scan: &Scan, requirements: Vec<Requirement>) -> Proof {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    asset.write_to(&path);
    let options = VerifyOptions { map: 16, view: 16, requirements, ..VerifyOptions::default() };
    verify(path, scan, &options, Progress::SILENT).unwrap()
}

pub fn failures(proof: &Proof) -> Vec<String> {
    let met = proof.evaluate(&Requirement::standard());
    let name = |met: &RequirementOutcome| {
        format!("{}{}", met.name(), met.level.map_or(String::new(), |l| format!("@{l}")))
    };
    met.iter().filter(|met| !met.met).map(|met| format!("{} {}", name(met), met.text())).collect()
}

/// Asserts that the proof meets all figures; returns the proof.
#[track_caller]
pub fn is_sound(asset: &impl Written, scan: &Scan) -> Proof {
    let proof = proof(asset, scan, Vec::new());
    assert!(failures(&proof).is_empty(), "{:?} {:?}", failures(&proof), proof.figures.levels[0].coverage);
    proof
}

/// Asserts that the proof fails these figures, and reports it in a warning that contains `words` and a place, the
/// only one about that place; returns the proof.
#[track_caller]
pub fn is_bad(asset: &impl Written, scan: &Scan, (figures, words): (&[&str], &str)) -> Proof {
    let asked = |required: &Requirement| figures.iter().any(|figure| figure.starts_with(&*required.name()));
    let proof = proof(asset, scan, Requirement::standard().into_iter().filter(asked).collect());
    let failures = failures(&proof);
    println!("{}: {}", std::panic::Location::caller().line(), failures.join("; "));
    for figure in figures {
        assert!(failures.iter().any(|failure| failure.starts_with(figure)), "{figure} is met: {failures:?}");
    }
    let warnings: Vec<&str> = proof.warnings.iter().map(|(what, _)| what).collect();
    let names = |what: &&str| what.contains(words) && what.contains("around (");
    assert!(warnings.iter().any(names), "{warnings:?}");
    let mut places: Vec<&str> = warnings.iter().filter_map(|what| place(what)).collect();
    let count = places.len();
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len(), count, "a place has two warnings: {warnings:?}");
    proof
}

/// Returns the place that a warning names.
fn place(warning: &str) -> Option<&str> {
    warning.split_once("around (")?.1.split_once(')').map(|(place, _)| place)
}

/// Returns an asset as shown from its file.
pub fn scene_of(asset: &Asset) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("asset.glb");
    asset.write(&path, &Packing::default(), Progress::SILENT).unwrap();
    load_model(&path).unwrap().scene
}

/// Returns a modified scene.
pub fn changed(scene: &Scene, change: impl FnOnce(&mut SceneData)) -> Scene {
    let mut scene = scene.clone();
    scene.edit(change).unwrap();
    scene
}

/// Returns the modified data of a mesh.
pub fn remade(mesh: &Mesh, change: impl FnOnce(&mut MeshData)) -> Mesh {
    let mut data = mesh.clone().into_data();
    change(&mut data);
    Mesh::new(data).unwrap()
}

/// Returns a scene whose only mesh is modified.
pub fn reshaped(scene: &Scene, change: impl FnOnce(&mut MeshData)) -> Scene {
    changed(scene, |data| data.meshes[0] = remade(&data.meshes[0], change))
}

/// Returns a texture with other texels: `texel` takes all old ones, the number of texels along a side, and a
/// position.
pub fn repainted(texture: &Texture, texel: impl Fn(&[[u8; 4]], u32, [u32; 2]) -> [u8; 4]) -> Texture {
    let bitmap = texture.bitmap();
    let Texels::U8(old) = bitmap.texels() else { panic!("8 bits") };
    let side = bitmap.width();
    let new = (0..old.len() as u32).map(|i| texel(old, side, [i % side, i / side])).collect();
    let bitmap = Bitmap::new(side, bitmap.height(), bitmap.channels(), Texels::U8(new)).unwrap();
    Texture::new(bitmap, texture.encoding())
}

/// Returns a reference to the first texture, on the first uv set.
pub fn first_texture() -> TextureRef {
    TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
}

/// Returns the triangles of a scan as an asset.
pub fn copy_of(scan: &Scan) -> Scene {
    Scene::of_mesh(scan.mesh().clone(), Material::default()).unwrap()
}

/// The fate of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    Kept,
    Reversed,
    Removed,
}

/// Returns a scene whose triangles each have a fate, by their index and centroid.
pub fn with_fates(scene: &Scene, fate: impl Fn(usize, Vec3) -> Fate) -> Scene {
    let middle = |data: &MeshData, t: [u32; 3]| {
        t.iter().fold(Vec3::splat(0.0), |sum, v| sum + data.positions[*v as usize]) * (1.0 / 3.0)
    };
    reshaped(scene, |data| {
        let all = data.triangles.iter().enumerate().map(|(i, t)| (fate(i, middle(data, *t)), *t));
        let kept = all.filter(|(fate, _)| *fate != Fate::Removed);
        data.triangles =
            kept.map(|(fate, [a, b, c])| if fate == Fate::Kept { [a, b, c] } else { [a, c, b] }).collect();
    })
}

/// Returns a scene with another part, without a map.
pub fn with_part(scene: &Scene, part: Mesh) -> Scene {
    changed(scene, |data| {
        data.meshes.push(part);
        data.materials.push(Material::default());
        let [mesh, material] = [data.meshes.len() - 1, data.materials.len() - 1];
        data.instances.push(Instance { mesh, material, world_from_object: Mat4::IDENTITY });
    })
}
