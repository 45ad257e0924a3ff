//! Every parameter and every figure of a bake, as data.

use super::certificate::{Certificate, HashedFile};
use super::figures::Figures;
use super::findings::{OCCLUSION, unproved_maps};
use super::outcome::RequirementOutcome;
use super::verification::Proof;
use crate::asset::ask::MeshSource;
use crate::asset::bake::{DroppedProperty, Part, Trial};
use crate::asset::source::{ModelFile, Origin, Scan};
use crate::asset::write::{MapNote, Parameters, WrittenAsset, maps_alone, name_of};
use std::path::{Path, PathBuf};
use taotie_engine::bake::MapKind;
use taotie_engine::error::{Result, Warning, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::surface::Noise;
use taotie_io::CodecKind;

/// The version of the report: of its layout and of the meaning of its figures.
const SCHEMA: u32 = 11;

/// The complete report of a bake. The caller fills in what it knows, such as figures and times.
///
/// ```
/// use taotie::Result;
/// use taotie::asset::{Certificate, Proof, Report, Signature, VerifyOptions, WrittenAsset};
///
/// /// Collects all that is known about an asset.
/// fn report(written: &WrittenAsset, proof: &Proof, wanted: &VerifyOptions) -> Result<Report> {
///     let mut report = Report::of(written)?;
///     report.prove(proof.figures.clone(), proof.maps.clone());
///     report.certificate = Some(Certificate::of_written(written, &proof.figures, wanted, &Signature::default())?);
///     Ok(report)
/// }
/// ```
#[derive(Debug, Clone, serde::Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The version of this layout.
    pub schema: u32,
    /// The kind of this report.
    pub kind: &'static str,
    /// The version of the program.
    pub version: &'static str,
    /// The statement that opens the page; `None` if nothing was measured.
    pub certificate: Option<Certificate>,
    /// The name of the scan's file, without folders; the first if there are several.
    pub high: String,
    /// The SHA-256 of its bytes.
    pub high_sha256: String,
    /// The other files that are one scan together with it, in the order given; JSON has the list only if there are any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub high_others: Vec<HashedFile>,
    /// Its triangles.
    pub high_triangles: usize,
    /// The name of the low-poly mesh's file; `None` if the mesh was generated.
    pub low: Option<String>,
    /// The origin of the low-poly mesh.
    pub origin: Origin,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// Texels across and down, of the largest maps; 0 if the asset was not baked here.
    pub size: [u32; 2],
    /// The different sizes of the maps of all materials, the largest first. JSON has them only as requested, among the
    /// parameters.
    #[serde(skip)]
    pub sizes: Vec<[u32; 2]>,
    /// All other options; `None` if the asset was not baked here.
    pub parameters: Option<Parameters>,
    /// The written files; JSON has their names without folders.
    #[serde(serialize_with = "crate::asset::write::without_folders::list")]
    pub files: Vec<PathBuf>,
    /// The kind and location of each map.
    pub maps: Vec<MapNote>,
    /// The properties of the scan's material that the asset has, in words.
    pub carried: Vec<String>,
    /// The properties that it does not have.
    pub left: Vec<DroppedProperty>,
    /// The measured figures, which a proof of the same files reproduces; `None` if nothing was measured.
    pub proof: Option<Figures>,
    /// The outcomes of the bake's rays, which only the bake knows; `None` if the asset was not baked here.
    pub bake: Option<BakeFigures>,
    /// The unit of the scan's coordinates; `None` if unknown. JSON has it in the figures of the proof.
    #[serde(skip)]
    pub unit: Option<Unit>,
    /// The scan's noise, and the change by its removal; `None` unless it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// The candidates of a search, if an error was requested.
    pub trials: Vec<Trial>,
    /// The duration of each stage.
    pub stages: Vec<StageTime>,
    /// Problems and corrections.
    pub warnings: Vec<Warning>,
}

/// Facts about an asset that only the bake knows, and no proof can recompute.
///
/// ```
/// use taotie::asset::Report;
///
/// /// Returns the fraction of the map that is wasted.
/// fn wasted(report: &Report) -> f64 {
///     report.bake.as_ref().map_or(0.0, |bake| 1.0 - bake.uv_use)
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct BakeFigures {
    /// The share of the texels with a projection ray that missed the scan, [0, 1].
    pub missed_texels: f64,
    /// The share of the samples that missed and used the closest point.
    pub missed_samples: f64,
    /// The share of the samples for which that failed too.
    pub lost_samples: f64,
    /// The share of the map that UV islands cover.
    pub uv_use: f64,
    /// The mean and maximum angle lost to 8 bits, degrees; `None` if no normals are stored that way.
    pub floor_8_bit: Option<[f64; 2]>,
    /// Maps and packed channels that are not compared with anything.
    pub unproved_maps: Vec<String>,
}

impl BakeFigures {
    fn of(written: &WrittenAsset) -> Self {
        let asset = written.asset();
        let (counts, made) = (asset.counts(), &asset.made);
        let share = |of: usize, all: usize| of as f64 / all.max(1) as f64;
        let texels_of = |part: &Part| part.maps.size.map(|side| side as usize).iter().product::<usize>();
        let texels = made.parts.iter().map(texels_of).sum();
        Self {
            missed_texels: share(counts.missed_texels, counts.texels),
            missed_samples: share(counts.missed, counts.samples),
            lost_samples: share(counts.lost, counts.samples),
            uv_use: share(counts.texels, texels),
            floor_8_bit: stores_8_bits(written).then_some(Proof::FLOOR_8_BIT),
            unproved_maps: unproved_maps(&written.maps()),
        }
    }
}

/// Returns `true` if the file stores normals in 8 bits. KTX2 packs them smaller still, and WebP has no more.
fn stores_8_bits(written: &WrittenAsset) -> bool {
    let Some(note) = written.maps().into_iter().find(|note| note.map == MapKind::Normal) else {
        return false;
    };
    match (note.file.is_some(), written.packing.images.normals.kind()) {
        (false, CodecKind::Ktx2) => false,
        (false, CodecKind::WebP | CodecKind::Jpeg | CodecKind::Avif) => true,
        _ => note.bits == 8,
    }
}

/// A completed stage and its duration.
///
/// ```
/// use taotie::asset::StageTime;
///
/// let stages = [("bake", 1500.0), ("store", 250.0)];
/// let stages = stages.map(|(stage, milliseconds)| StageTime { stage, milliseconds });
/// assert_eq!(stages.iter().map(|stage| stage.milliseconds).sum::<f64>(), 1750.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct StageTime {
    /// The stage's name.
    pub stage: &'static str,
    /// Its duration.
    pub milliseconds: f64,
}

impl Report {
    /// Describes a written asset before its proof.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) if the scan's file can no longer be read for its hash.
    pub fn of(written: &WrittenAsset) -> Result<Self> {
        let asset = written.asset();
        let made = &asset.made;
        let warnings = [&made.warnings, &written.warnings].map(Warnings::list).concat();
        Ok(Self {
            schema: SCHEMA,
            kind: "taotie bake",
            version: env!("CARGO_PKG_VERSION"),
            certificate: None,
            high: name_of(made.about.path()),
            high_sha256: made.about.models.first().map_or(Ok(String::new()), ModelFile::sha256)?,
            high_others: HashedFile::of_models(made.about.models.get(1..).unwrap_or_default())?,
            high_triangles: made.about.size.triangles as usize,
            low: made.options.low.as_ref().and_then(MeshSource::name),
            origin: asset.origin().clone(),
            triangles: asset.levels().map(|mesh| mesh.triangles().len()).collect(),
            size: made.size,
            sizes: sizes(&made.parts),
            parameters: Some(Parameters::new(&made.options, &made.about.options, &written.packing)),
            files: written.files.clone(),
            maps: written.maps(),
            carried: carried(written),
            left: made.left.clone(),
            proof: None,
            bake: Some(BakeFigures::of(written)),
            unit: asset.unit(),
            noise: made.noise.as_ref().map(|found| found.noise),
            trials: made.trials.clone(),
            stages: Vec::new(),
            warnings,
        })
    }

    /// Describes the proof of an asset made by any program.
    ///
    /// # Errors
    /// [`Error::Io`](crate::Error::Io) if the scan's file cannot be read for its hash.
    pub fn of_proof(asset: &Path, scan: &Scan, proof: &Proof) -> Result<Self> {
        Ok(Self {
            schema: SCHEMA,
            kind: "taotie verify",
            version: env!("CARGO_PKG_VERSION"),
            certificate: None,
            high: name_of(scan.path()),
            high_sha256: scan.sha256()?,
            high_others: HashedFile::of_models(scan.about.models.get(1..).unwrap_or_default())?,
            high_triangles: scan.about.size.triangles as usize,
            low: Some(name_of(asset)),
            origin: Origin::default(),
            triangles: proof.figures.levels.iter().map(|level| level.triangles).collect(),
            size: [0; 2],
            sizes: Vec::new(),
            parameters: None,
            files: Vec::new(),
            maps: Vec::new(),
            carried: Vec::new(),
            left: Vec::new(),
            proof: Some(proof.figures.clone()),
            bake: None,
            unit: proof.figures.unit,
            noise: None,
            trials: Vec::new(),
            stages: Vec::new(),
            warnings: [scan.warnings(), &proof.warnings].map(Warnings::list).concat(),
        })
    }

    /// Adds the figures of a proof, and its maps with their errors.
    pub fn prove(&mut self, figures: Figures, maps: Vec<MapNote>) {
        self.proof = Some(figures);
        // A proof of an asset that was not baked here has no maps.
        if !maps.is_empty() {
            self.maps = maps;
        }
        if let Some(bake) = &mut self.bake {
            bake.unproved_maps = unproved_maps(&self.maps);
        }
    }

    /// Returns the contents of the asset or its scan that no figure of the report compares. `figures.unseen` also has
    /// occlusion that the bake measured, since a proof of the files alone cannot.
    pub fn not_compared(&self) -> Vec<&str> {
        let is_measured = |note: &MapNote| note.is_occlusion() && note.error.is_some();
        let has_occlusion = self.maps.iter().any(is_measured);
        let unseen = self.proof.iter().flat_map(|figures| &figures.unseen);
        let unproved = self.bake.iter().flat_map(|bake| &bake.unproved_maps);
        let all = unseen.filter(|what| !has_occlusion || *what != OCCLUSION).chain(unproved);
        all.map(String::as_str).collect()
    }

    /// Returns the requirements and their outcomes.
    pub fn required(&self) -> &[RequirementOutcome] {
        self.certificate.as_ref().map_or(&[], |certificate| &certificate.required)
    }

    /// Returns `true` if all requirements are met.
    pub fn is_met(&self) -> bool {
        self.required().iter().all(|met| met.met)
    }
}

/// Returns the different sizes of the maps of all parts that have any, the largest first.
fn sizes(parts: &[Part]) -> Vec<[u32; 2]> {
    let mut sizes: Vec<[u32; 2]> =
        parts.iter().map(|part| part.maps.size).filter(|size| *size != [0; 2]).collect();
    sizes.sort_unstable_by_key(|[width, height]| {
        std::cmp::Reverse((u64::from(*width) * u64::from(*height), *width))
    });
    sizes.dedup();
    sizes
}

/// Returns the properties of the scan's material that the files store.
fn carried(written: &WrittenAsset) -> Vec<String> {
    let made = &written.asset().made;
    let all: Vec<_> = match written.is_alone() {
        true => maps_alone::carried(made).collect(),
        false => made.carried.clone(),
    };
    all.iter().map(|property| property.name().to_owned()).collect()
}
