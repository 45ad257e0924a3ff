//! `--error`: the smallest mesh and map whose normals are near enough.

use super::args::BakeArgs;
use super::report::Trial;
use super::stages::Stages;
use super::work::{self, Light, Made, Source};
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use taotie::Warnings;
use taotie::bake::{Simplified, Verifier};
use taotie::image::{Encoding, Texture};
use taotie::scene::NormalSpace;

/// What is tried: triangles, and texels along a side.
const TRIANGLES: [u32; 9] = [1_000, 2_500, 5_000, 10_000, 20_000, 40_000, 80_000, 150_000, 300_000];
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// Bytes of a triangle with half a vertex, and of a texel of a PNG normal map.
const TRIANGLE: u64 = 36;
const TEXEL: u64 = 2;
/// Points at which a trial is judged.
const POINTS: usize = 40_000;

/// What was found.
pub struct Found {
    /// The light mesh.
    pub light: Light,
    /// What was baked onto it.
    pub made: Made,
    /// Texels along a side.
    pub size: u32,
    /// What was tried.
    pub trials: Vec<Trial>,
    /// What was noted on the way to it.
    pub warnings: Warnings,
}

/// Tries meshes and maps from the smallest file up, passing over those that are coarser both ways than one that failed.
///
/// # Errors
/// Where none is near enough, with the nearest that was found.
pub fn smallest(args: &BakeArgs, source: &Source, most: f64, stages: &mut Stages) -> Result<Found> {
    let scan = source.scan.mesh().triangles().len() as u32;
    let mut candidates: Vec<[u32; 2]> = TRIANGLES
        .into_iter()
        .filter(|triangles| *triangles < scan)
        .flat_map(|triangles| SIZES.map(|size| [triangles, size]))
        .collect();
    candidates.sort_by_key(|[t, s]| u64::from(*t) * TRIANGLE + u64::from(*s) * u64::from(*s) * TEXEL);
    let mut trials: Vec<Trial> = Vec::new();
    // Maps of several sizes are tried on the same triangles.
    let mut lighter: BTreeMap<u32, Simplified> = BTreeMap::new();
    for [triangles, size] in candidates {
        let fails = |trial: &Trial| triangles as usize <= trial.triangles && size <= trial.size;
        if trials.iter().any(fails) {
            continue;
        }
        let simplified = match lighter.entry(triangles) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(work::simplified(source, triangles, stages)?),
        };
        let light = Light::made(source, simplified, size, stages)?;
        let made = work::bake_maps(args, size, (source, &light), stages)?;
        let mean_angle = mean_angle(source, &light, &made)?;
        trials.push(Trial { triangles: triangles as usize, size, mean_angle });
        if mean_angle <= most {
            let mut warnings = Warnings::default();
            work::note_simplified(simplified, triangles, &mut warnings);
            return Ok(Found { light, made, size, trials, warnings });
        }
    }
    let best = trials.iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle));
    match best {
        Some(best) => bail!(
            "--error {most}: no mesh and map come so near; the nearest are {} triangles and {}×{} texels with {:.3}°",
            best.triangles,
            best.size,
            best.size,
            best.mean_angle
        ),
        None => bail!(
            "--error {most}: the scan has {scan} triangles, too few to be made lighter; name --triangles"
        ),
    }
}

fn mean_angle(source: &Source, light: &Light, made: &Made) -> Result<f64> {
    let bitmap = made.textures.normal.clone();
    let texture = Texture::new(bitmap.context("--error needs a normal map")?, Encoding::Normal);
    let verifier = Verifier {
        mesh: &light.mesh,
        normal: Some((&texture, NormalSpace::Tangent)),
        cage: &made.cage,
        scan: &source.scan,
    };
    let angles = verifier.verdict(POINTS)?.angles;
    Ok(angles.summary().map_or(f64::INFINITY, |summary| summary.mean))
}
