//! The proof: the asset as it was written, read back and held against the scan.

use super::stages::Stages;
use super::views::{self, Shots};
use super::work::Source;
use crate::spread::Spread;
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie::bake::{BakeCounts, Cage, Fit, Scan, Verifier, light_mesh};
use taotie::compare::Field;
use taotie::image::{Encoding, Texture};
use taotie::io;
use taotie::mesh::Mesh;
use taotie::scene::{NormalSpace, Scene, SceneData};

/// Points of the light mesh at which normals are compared.
const POINTS: usize = 200_000;
/// Points of each surface from which the distance to the other is measured.
const DEVIATION_POINTS: usize = 100_000;
/// Texels along a side of the map of errors.
const MAP: u32 = 1024;

/// What eight bits cost at least, degrees: the mean and the largest angle between unit vectors and what is stored.
pub const FLOOR_8_BIT: [f64; 2] = [0.17, 0.38];

/// The figures.
#[derive(Serialize, Clone)]
pub struct Proof {
    /// Degrees between the normals shown and the scan's, over points spread evenly; `None` where no point was found.
    pub angles: Option<Spread>,
    /// Their histogram, a fifth of a degree a bin; the last is open.
    pub histogram: Vec<u64>,
    /// What vertex normals alone would give: the same angles without the map.
    pub without_map: Option<Spread>,
    /// Mean and largest angle that 8 bits cost at least.
    pub floor_8_bit: [f64; 2],
    /// The part of the texels with a sample that missed the scan.
    pub missed_texels: f64,
    /// The part of the samples that missed and took the closest point.
    pub fallback: f64,
    /// The part of the samples for which that failed too.
    pub lost: f64,
    /// The largest distance between the surfaces, model units.
    pub hausdorff: f64,
    /// As a part of the diagonal.
    pub hausdorff_of_diagonal: f64,
    /// The root mean square distance, model units.
    pub rms: f64,
    /// As a part of the diagonal.
    pub rms_of_diagonal: f64,
    /// The scan's diagonal, model units.
    pub diagonal: f64,
    /// Texels a model unit over the triangles of the light mesh.
    pub density: Option<Spread>,
    /// The part of the map that charts cover.
    pub uv_use: f64,
    /// Of the pictures from all sides, each against that of the scan.
    pub views: Vec<ViewFigures>,
    /// How well the meshes fit together.
    pub fit: Option<FitFigures>,
    /// Bytes of the scan's file.
    pub bytes_in: u64,
    /// Bytes of the asset, with its files.
    pub bytes_out: u64,
}

/// How a picture of the asset differs from that of the scan.
#[derive(Serialize, Clone, Copy)]
pub struct ViewFigures {
    /// Where from, degrees.
    pub azimuth_deg: f64,
    /// Degrees above the horizon.
    pub elevation_deg: f64,
    /// The mean.
    pub flip: f64,
    /// 1 where equal.
    pub ssim: f64,
}

/// See [`Fit`].
#[derive(Serialize, Clone, Copy)]
pub struct FitFigures {
    /// The part of the light mesh far from the scan.
    pub away: f64,
    /// The part that faces the other way.
    pub turned: f64,
    /// The mean distance as a part of the diagonal.
    pub distance_of_diagonal: f64,
}

impl From<Fit> for FitFigures {
    fn from(fit: Fit) -> Self {
        Self { away: fit.away, turned: fit.turned, distance_of_diagonal: fit.distance }
    }
}

/// What is proved, and with what.
pub struct Subject<'a> {
    /// The asset's file.
    pub output: &'a Path,
    /// All files of the asset.
    pub files: &'a [PathBuf],
    /// The scan's file.
    pub high: &'a Path,
    /// The finest level as it was baked onto.
    pub light: &'a Mesh,
    /// Where the scan is looked for from it.
    pub cage: &'a Cage,
    /// What became of the samples.
    pub counts: &'a BakeCounts,
    /// A normal map in a file beside the asset, in object space.
    pub object_map: Option<&'a Path>,
    /// Texels along a side of the maps.
    pub size: u32,
}

/// Figures and pictures.
pub struct Proved {
    /// The figures.
    pub proof: Proof,
    /// Angles at the texels of a map.
    pub error_map: Field,
    /// Scan and asset from all sides.
    pub shots: Shots,
}

/// Measures. The scan is given up: its memory is needed for pictures of it.
///
/// # Errors
/// Where the asset cannot be read back.
pub fn prove(subject: &Subject<'_>, source: Source, stages: &mut Stages) -> Result<Proved> {
    let scene = stages.run("read back", |_| {
        let loaded = io::load_model(subject.output).context("the asset as written cannot be read")?;
        Ok(loaded.scene)
    })?;
    let object_map = match subject.object_map {
        Some(path) => Some(Texture::new(io::read_bitmap(path)?, Encoding::Normal)),
        None => None,
    };
    let shown = Shown::of(&scene, object_map.as_ref())?;
    // Packing sorts vertices anew.
    let cage = subject.cage.carried_over(subject.light, &shown.mesh);
    let measured = stages.run("measure normals", |_| measure(&shown, subject, (&cage, &source.scan)))?;
    let error_map = stages.run("map errors", |_| {
        let side = subject.size.min(MAP);
        Ok(shown.verifier(&cage, &source.scan, true).error_map([side; 2])?)
    })?;
    let shots =
        stages.run("compare views", |progress| views::take(source.scan.into_mesh(), scene, progress))?;
    let proof = Proof { views: shots.figures.clone(), ..measured };
    Ok(Proved { proof, error_map, shots })
}

/// The finest level of an asset as a viewer shows it.
struct Shown<'a> {
    mesh: Mesh,
    normal: Option<(&'a Texture, NormalSpace)>,
}

impl<'a> Shown<'a> {
    fn of(scene: &'a Scene, object_map: Option<&'a Texture>) -> Result<Self> {
        let first = scene.instances().first().context("the asset as written has no triangles")?;
        let finest = Scene::new(SceneData { instances: vec![*first], ..scene.data().clone() })?;
        let map = scene.materials()[first.material].normal.as_ref();
        let inside = map.map(|map| (&scene.textures()[map.texture.texture], NormalSpace::Tangent));
        let normal = object_map.map(|map| (map, NormalSpace::Object)).or(inside);
        let mesh = taotie::surface::with_frames(&light_mesh(finest)?, 0, None)?.0.into_owned();
        Ok(Self { mesh, normal })
    }

    fn verifier<'v>(&'v self, cage: &'v Cage, scan: &'v Scan, mapped: bool) -> Verifier<'v> {
        Verifier { mesh: &self.mesh, normal: self.normal.filter(|_| mapped), cage, scan }
    }
}

fn measure(shown: &Shown<'_>, subject: &Subject<'_>, (cage, scan): (&Cage, &Scan)) -> Result<Proof> {
    let mapped = shown.verifier(cage, scan, true);
    let verdict = mapped.verdict(POINTS)?;
    let plain = shown.verifier(cage, scan, false).verdict(POINTS / 10)?;
    let deviation = mapped.deviation(DEVIATION_POINTS)?;
    let diagonal = scan.mesh().diagonal();
    let counts = subject.counts;
    let part = |of: usize, all: usize| of as f64 / all.max(1) as f64;
    let bytes = |path: &Path| std::fs::metadata(path).map_or(0, |data| data.len());
    Ok(Proof {
        histogram: verdict.angles.histogram(BINS, (BINS as f64 * BIN_WIDTH) as f32),
        angles: verdict.angles.summary().map(Spread::from),
        without_map: plain.angles.summary().map(Spread::from),
        floor_8_bit: FLOOR_8_BIT,
        missed_texels: part(counts.missed_texels, counts.texels),
        fallback: part(counts.missed, counts.samples),
        lost: part(counts.lost, counts.samples),
        hausdorff: deviation.hausdorff(),
        hausdorff_of_diagonal: deviation.hausdorff() / diagonal,
        rms: deviation.rms(),
        rms_of_diagonal: deviation.rms() / diagonal,
        diagonal,
        density: mapped.density([subject.size; 2])?.summary().map(Spread::from),
        uv_use: part(counts.texels, (subject.size as usize).pow(2)),
        views: Vec::new(),
        fit: mapped.fit(POINTS / 10, diagonal).map(FitFigures::from),
        bytes_in: bytes(subject.high),
        bytes_out: subject.files.iter().map(|path| bytes(path)).sum(),
    })
}

/// Bins of the histogram, and how wide each is, degrees.
const BINS: usize = 50;
pub const BIN_WIDTH: f64 = 0.2;
