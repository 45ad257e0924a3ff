//! Bakes with rays cast by a GPU and by the CPU: seconds, and the difference of their maps: `make bench-gpu`.
//!
//! ```text
//! cargo run --release -p taotie-gpu --example gpu_bakes -- [--quick] [--adapter NAME] [TRIANGLESxSIZE,...]
//! ```
//!
//! The scan is a sphere with bosses and finer relief, the low-poly mesh a sphere of 3,968 triangles. Both bake the same
//! normals, four samples per texel, then normals and ambient occlusion with 64 rays per texel. Seconds are those of the
//! whole bake, from the sorted scan to filled maps; the upload of the scan is a separate column. Angles are those between
//! the normals of all texels that a triangle covers, occlusion is in 8-bit codes. `--adapter` selects a GPU by a part of
//! its name. By default, scans have 1 and 20 million triangles and maps 4096²; with a software GPU or `--quick`, 1 million
//! and 1024².

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::sync::Arc;
use std::time::Instant;
use taotie_engine::bake::{
    BakeInput, BakeSettings, BakedMaps, Cage, MapKind, Plane, RayCaster, RayDevice, Scan, TexelStatus, bake,
};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, Scene};
use taotie_engine::surface::with_frames;
use taotie_engine::{Error, Progress};
use taotie_gpu::{AdapterChoice, Gpu};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A bake: the triangles of its scan, and the side of its maps, texels.
#[derive(Clone, Copy)]
struct Size {
    triangles: usize,
    side: u32,
}

/// Bakes, and quick ones.
const SIZES: [Size; 2] =
    [Size { triangles: 1_000_000, side: 4096 }, Size { triangles: 20_000_000, side: 4096 }];
const QUICK: [Size; 1] = [Size { triangles: 1_000_000, side: 1024 }];

/// A GPU that reports how long the upload of a scan takes.
struct Timed(Gpu);

impl RayDevice for Timed {
    fn load(&self, scan: &Scan) -> taotie_engine::Result<Box<dyn RayCaster>> {
        let start = Instant::now();
        let loaded = self.0.load(scan)?;
        println!(
            "upload of {} triangles: {:.2} s, with the shaders",
            scan.mesh().triangles().len(),
            seconds(start)
        );
        Ok(loaded)
    }
}

/// The surfaces of a bake.
struct Subject {
    low: Mesh,
    cage: Cage,
    scan: Scan,
}

fn main() -> Result<()> {
    let options = options(std::env::args().skip(1))?;
    let gpu = Gpu::find(&options.choice)?;
    let adapter = gpu.description();
    let software = if adapter.is_software() { ", a software GPU" } else { "" };
    println!("GPU: {} through {}, {}{software}", adapter.name, adapter.backend, adapter.driver);
    println!("CPU: {} threads\n", rayon::current_num_threads());
    let usual = if options.quick || adapter.is_software() { &QUICK[..] } else { &SIZES };
    let mut rows = Vec::new();
    for size in if options.sizes.is_empty() { usual } else { &options.sizes } {
        rows.extend(of_size(&gpu, *size)?);
    }
    println!(
        "\n| triangles | maps | CPU, s | GPU, s | normals: mean, ° | 99.9 %, ° | largest, ° | \
         occlusion: mean, codes | 99.9 %, codes | largest, codes |\n|---:|---|{}",
        "---:|".repeat(8)
    );
    rows.iter().for_each(|row| println!("{row}"));
    Ok(())
}

/// The command-line options.
#[derive(Default)]
struct Options {
    quick: bool,
    choice: AdapterChoice,
    sizes: Vec<Size>,
}

fn options(mut args: impl Iterator<Item = String>) -> Result<Options> {
    let size = |text: &str| {
        let (triangles, side) = text.split_once('x')?;
        Some(Size { triangles: triangles.parse().ok()?, side: side.parse().ok()? })
    };
    let mut options = Options::default();
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--quick" => options.quick = true,
            "--adapter" => options.choice.name = args.next(),
            list => {
                let sizes: Option<Vec<Size>> = list.split(',').map(size).collect();
                let wrong =
                    || Error::invalid(list, "expected [--quick] [--adapter NAME] [TRIANGLESxSIZE,...]");
                options.sizes.extend(sizes.ok_or_else(wrong)?);
            }
        }
    }
    Ok(options)
}

/// Returns the rows of the table for a scan.
fn of_size(gpu: &Gpu, Size { triangles, side }: Size) -> Result<Vec<String>> {
    let scan = Scan::new(Scene::of_mesh(embossed(triangles)?, Material::default())?)?;
    let low = with_frames(&Mesh::sphere(1.0, 64, 32), 0, None)?.0.into_owned();
    let mut subject = Subject { cage: Cage::automatic(&low, &scan), low, scan };
    let maps = [vec![MapKind::Normal], vec![MapKind::Normal, MapKind::Occlusion]];
    let mut baked = Vec::new();
    for maps in &maps {
        baked.push(subject.baked(side, maps)?);
    }
    subject.scan = subject.scan.cast_by(Some(Arc::new(Timed(gpu.clone()))));
    // Uploads the scan and compiles the shaders.
    subject.baked(16, &maps[1])?;
    let mut rows = Vec::new();
    for (maps, (cpu, by_cpu)) in maps.iter().zip(&baked) {
        let (gpu, by_gpu) = subject.baked(side, maps)?;
        let all = subject.scan.mesh().triangles().len();
        let what = if maps.len() == 1 { "normals" } else { "normals, occlusion" };
        rows.push(format!(
            "| {all} | {side}², {what} | {cpu:.2} | {gpu:.2} |{} |{} |",
            angles(by_cpu, &by_gpu),
            codes(by_cpu, &by_gpu)
        ));
    }
    Ok(rows)
}

impl Subject {
    /// Bakes the maps; returns the seconds, too.
    fn baked(&self, side: u32, maps: &[MapKind]) -> Result<(f64, BakedMaps)> {
        let settings =
            BakeSettings { size: [side; 2], maps: maps.iter().copied().collect(), ..BakeSettings::default() };
        let Self { low, cage, scan } = self;
        let start = Instant::now();
        let baked = bake(BakeInput { low, cage, scan }, &settings, Progress::SILENT)?;
        Ok((seconds(start), baked.maps))
    }
}

fn seconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}

/// Returns a sphere with bosses and finer relief of about this number of triangles, without normals.
fn embossed(triangles: usize) -> Result<Mesh> {
    let rows = (triangles as f64 / 4.0).sqrt().round() as usize;
    let data = Mesh::sphere(1.0, 2 * rows, rows).into_data();
    let waves = |n: Vec3<f64>, count: f64| {
        [n.x, n.y, n.z].into_iter().map(|v| scalar::sin(count * v)).product::<f64>()
    };
    let place = |p: &Vec3| {
        let n = p.to_f64();
        (n * (1.0 + 0.05 * waves(n, 9.0) + 0.001 * waves(n, 150.0))).to_f32()
    };
    let positions = data.positions.iter().map(place).collect();
    Ok(Mesh::new(MeshData { positions, triangles: data.triangles, ..MeshData::default() })?)
}

/// Returns the cells of the angles between the normals of two bakes.
fn angles(a: &BakedMaps, b: &BakedMaps) -> String {
    let pairs = a.vectors(Plane::Normal).iter().zip(b.vectors(Plane::Normal)).zip(&a.texels);
    let covered = pairs.filter(|(_, texel)| **texel != TexelStatus::Free);
    let angle = |((a, b), _): ((&[f32; 3], &[f32; 3]), &TexelStatus)| {
        let [a, b] = [a, b].map(|v| Vec3::from_array(*v).to_f64());
        scalar::atan2(a.cross(b).length(), a.dot(b)).to_degrees()
    };
    let mut angles: Vec<f64> = covered.map(angle).collect();
    cells(&mut angles)
}

/// Returns the cells of the differences of the occlusion of two bakes.
fn codes(a: &BakedMaps, b: &BakedMaps) -> String {
    let (a, b) = (a.covered(Plane::Occlusion), b.covered(Plane::Occlusion));
    if a.is_empty() {
        return " – | – | –".into();
    }
    let mut codes: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 255.0 * f64::from((a - b).abs())).collect();
    cells(&mut codes)
}

/// Returns the cells of the mean, the 99.9th percentile and the largest of some numbers, which are sorted.
fn cells(numbers: &mut [f64]) -> String {
    numbers.sort_unstable_by(f64::total_cmp);
    let mean = numbers.iter().sum::<f64>() / numbers.len().max(1) as f64;
    let at = |share: f64| numbers.get((numbers.len().saturating_sub(1) as f64 * share) as usize);
    let [most, largest] = [0.999, 1.0].map(|share| at(share).copied().unwrap_or(f64::NAN));
    format!(" {mean:.1e} | {most:.1e} | {largest:.1e}")
}
