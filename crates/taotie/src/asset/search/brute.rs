//! Tests the search against brute force, which tries every combination of a grid around the result. It takes minutes
//! per model, so it runs among the slow tests on a ball, and manually on any model: `make brute-force SCANS="a.obj
//! b.glb"`.

use super::ceilings::Ceilings;
use super::goal::Goal;
use super::level::Level;
use super::packed;
use super::smallest::{Smallest, smallest};
use super::trial::Trial;
use super::workshop::{Shape, Subject, Workshop, under_map, uv_bits};
use crate::asset::inputs::Rays;
use crate::asset::low;
use crate::asset::maps::Recipe;
use crate::asset::options::BakeOptions;
use crate::asset::plan::BakePlan;
use crate::asset::requirement::Requirement;
use crate::asset::scan::Scan;
use crate::error::{Result, Warnings};
use crate::io::{ImageCodec, Limits, VertexBits};
use crate::math::{Vec3, scalar::sin};
use crate::mesh::{Mesh, MeshData};
use crate::progress::Progress;
use crate::proof::Side;

/// The maximum ratio of the search's result to the smallest of the grid.
const WITHIN: f64 = 1.05;
/// Factors applied to the resulting triangles, or to the fraction kept.
const FACTORS: [f64; 11] = [0.7, 0.78, 0.84, 0.89, 0.93, 0.965, 1.0, 1.035, 1.08, 1.15, 1.3];
const POSITION_BITS: [u8; 4] = [11, 12, 13, 14];
const NORMAL_BITS: [u8; 5] = [7, 8, 9, 10, 12];
/// Triangles, texels and formats of candidates with a normal map.
const TRIANGLES: [u32; 5] = [1_000, 2_000, 4_000, 8_000, 16_000];
const SIZES: [u32; 4] = [256, 512, 768, 1024];
const CODECS: [ImageCodec; 10] = [
    ImageCodec::Jpeg(55),
    ImageCodec::Jpeg(80),
    ImageCodec::Jpeg(90),
    ImageCodec::Jpeg(96),
    ImageCodec::LossyWebP(35),
    ImageCodec::LossyWebP(65),
    ImageCodec::LossyWebP(82),
    ImageCodec::LossyWebP(93),
    ImageCodec::LossyWebP(97),
    ImageCodec::WebP,
];

#[test]
#[ignore = "takes minutes per model"]
fn the_search_is_near_brute_force() {
    let models = option_env!("SCANS").unwrap_or_default().split_whitespace();
    let read =
        |path: &str| (path.to_owned(), Scan::read(path, &Limits::default(), Progress::SILENT).unwrap());
    let mut scans: Vec<(String, Scan)> = models.map(read).collect();
    if scans.is_empty() {
        scans.push(("a ball with waves".into(), ball()));
    }
    let (lines, ratios): (Vec<String>, Vec<f64>) = scans.iter().map(|(name, scan)| line(name, scan)).unzip();
    assert!(ratios.iter().all(|ratio| *ratio <= WITHIN), "{lines:#?}");
}

/// A ball with waves.
fn ball() -> Scan {
    let data = Mesh::sphere(1.0, 200, 100).into_data();
    let wave = |p: &Vec3| {
        let [x, y, z] = p.to_array().map(|v| sin(9.0 * f64::from(v)));
        *p * (1.0 + 0.02 * x * y * z) as f32
    };
    let mesh = MeshData {
        positions: data.positions.iter().map(wave).collect(),
        triangles: data.triangles,
        ..MeshData::default()
    };
    Scan::from_mesh(Mesh::new(mesh).unwrap(), Progress::SILENT).unwrap()
}

/// Returns the result for a model as a line, and the ratio of bytes.
fn line(name: &str, scan: &Scan) -> (String, f64) {
    let (found, others) = compared(scan).unwrap_or_else(|error| panic!("{name}: {error}"));
    let near = others.iter().filter(|trial| trial.is_near);
    let least = near.min_by_key(|trial| trial.bytes).expect("some are near");
    let (ratio, count) = (found.bytes as f64 / least.bytes as f64, others.len());
    (format!("{name}: {ratio:.3} of the smallest of {count}; found {found:?}; that is {least:?}"), ratio)
}

/// Returns the search's result for 1°, and all assets of a grid.
fn compared(scan: &Scan) -> Result<(Trial, Vec<Trial>)> {
    let goal = vec![Requirement::mean_angle_deg(1.0)];
    let asked = BakeOptions { goal: Some(goal.clone()), ..BakeOptions::default() };
    let options = BakePlan::of(&asked.sized(scan.about.size), &scan.about.carried, &[]).options;
    let recipe = Recipe { options: &options, rays: &Rays::Auto };
    let found = smallest(recipe, (scan, Level::FINEST), Progress::SILENT)?;
    let chosen = *found.trials.iter().find(|trial| trial.is_chosen).expect("one is chosen");
    let side = Side::of(scan.sorted());
    let seen = low::seen(scan, &mut Warnings::default())?;
    let subject = Subject { scan, seen: &seen, side: &side, level: Level::FINEST };
    let mut workshop = Workshop::new(recipe, (Goal::of(&goal, 0), Ceilings::of(&goal)), subject);
    match found.smallest {
        Smallest::Packed(asset) => {
            let kept: Vec<f64> =
                FACTORS.iter().map(|factor| (asset.geometry.kept * factor).min(1.0)).collect();
            packed::all(&mut workshop, (&kept, &[0.8, 0.95]), Progress::SILENT)?;
        }
        Smallest::Made(_) => {
            bare(&mut workshop, &chosen)?;
            mapped(&mut workshop)?;
        }
    }
    Ok((chosen, workshop.trials))
}

fn bare(workshop: &mut Workshop<'_>, chosen: &Trial) -> Result<()> {
    for factor in FACTORS {
        let triangles = (chosen.triangles as f64 * factor) as u32;
        let shape = Shape { triangles, size: chosen.size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, Progress::SILENT)? else { continue };
        for (positions, normals) in POSITION_BITS.iter().flat_map(|p| NORMAL_BITS.map(|n| (*p, n))) {
            let bits = VertexBits { positions, normals, uvs: uv_bits(chosen.size) };
            let rounding = workshop.rounding(bits, workshop.codecs().least_lossy());
            workshop.trial(&draft, rounding)?;
        }
    }
    Ok(())
}

fn mapped(workshop: &mut Workshop<'_>) -> Result<()> {
    for (triangles, size) in TRIANGLES.iter().flat_map(|count| SIZES.map(|size| (*count, size))) {
        let shape = Shape { triangles, size, has_normal_map: true };
        let Some(draft) = workshop.draft(shape, Progress::SILENT)? else { continue };
        for codec in CODECS {
            workshop.trial(&draft, workshop.rounding(under_map(size), codec))?;
        }
    }
    Ok(())
}
