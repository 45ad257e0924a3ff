//! The certificate: the requirements and figures of an asset, the hashes of its files, and how to reproduce it.

use super::figures::Figures;
use super::measurement::VerifyOptions;
use super::outcome::RequirementOutcome;
use crate::asset::ask::{Figure, Requirement, requirement};
use crate::asset::source::{About, ModelFile, Scan, ScanOptions, all_files};
use crate::asset::write::{MapNote, WrittenAsset, name_of};
use std::collections::BTreeSet;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::scene::NormalSpace;
use taotie_io::{Limits, StoredImage, StoredParts};

/// The figures that a certificate states, in order, if they were measured.
const KEY_FIGURES: [Figure; 16] = [
    Figure::MeanAngle,
    Figure::P95Angle,
    Figure::PatchAngle,
    Figure::PatchDetail,
    Figure::MeanColor,
    Figure::PatchColor,
    Figure::MeanMaterial,
    Figure::PatchMaterial,
    Figure::Missed,
    Figure::Completeness,
    Figure::Hausdorff,
    Figure::Silhouette,
    Figure::SurfaceMeanAngle,
    Figure::Flip,
    Figure::Ssim,
    Figure::Bytes,
];

/// A statement about one scan and one asset: the requirements and the measured figures, the hashes of all files, and
/// the command that reproduces it. The same files, options and version give the same certificate on every machine.
///
/// ```
/// use taotie::Result;
/// use taotie::asset::{Certificate, Proof, Signature, VerifyOptions, WrittenAsset};
///
/// /// Certifies an asset without date or operator.
/// fn certify(written: &WrittenAsset, proof: &Proof, options: &VerifyOptions) -> Result<Certificate> {
///     Certificate::of_written(written, &proof.figures, options, &Signature::default())
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Certificate {
    /// The outcome of all requirements.
    pub verdict: Verdict,
    /// The requirements and their outcomes.
    pub required: Vec<RequirementOutcome>,
    /// The key figures of the finest level of detail.
    pub figures: Vec<KeyFigure>,
    /// Contents that no figure and no image compares.
    pub not_compared: Vec<String>,
    /// The scan's files, the model files first; empty for a scan in memory.
    pub scan: Vec<HashedFile>,
    /// The number of model files among them, which are one scan together.
    pub scan_models: usize,
    /// Triangles of the scan.
    pub scan_triangles: usize,
    /// The asset's files, the model file first.
    pub asset: Vec<HashedFile>,
    /// Triangles of each level of detail, the finest first.
    pub triangles: Vec<usize>,
    /// The asset's maps, including those in the model file.
    pub maps: Vec<HashedMap>,
    /// The measuring program, with its version.
    pub program: String,
    /// The options that figures depend on.
    pub options: ProofOptions,
    /// The date, if stated by the operator.
    pub date: Option<String>,
    /// The operator, if stated.
    pub operator: Option<String>,
    /// The command that reproduces this certificate from the files, run in the folder that holds them; `None` if the
    /// model file does not contain everything that was compared, or if files of the scan have the same name.
    pub command: Option<String>,
}

/// The options that the figures of a proof depend on.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct ProofOptions {
    /// How the scan was read.
    pub scan: ScanOptions,
    /// Pixels of the overview, and the initial number of compared points on each surface.
    pub points: usize,
    /// Pixels along a side of the images from all sides.
    pub view: u32,
}

/// The overall outcome of all requirements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// All are met.
    Met,
    /// At least one is not met.
    NotMet,
    /// None is exceeded for certain, but at least one limit lies within the interval of its figure.
    Undecided,
    /// Nothing was required.
    NothingRequired,
}

impl Verdict {
    fn of(required: &[RequirementOutcome]) -> Self {
        let is_failed = |met: &RequirementOutcome| !met.met && !met.is_undecided();
        match required {
            [] => Self::NothingRequired,
            all if all.iter().all(|met| met.met) => Self::Met,
            all if all.iter().any(is_failed) => Self::NotMet,
            _ => Self::Undecided,
        }
    }
}

/// A figure of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct KeyFigure {
    /// The figure.
    pub figure: Figure,
    /// Its value: degrees, ΔE, a fraction, pixels or bytes.
    pub value: f64,
    /// The bounds of the value, with a confidence of 99 % if it is estimated from samples.
    pub interval: [f64; 2],
}

impl KeyFigure {
    /// Collects the key figures that were measured.
    fn all(figures: &Figures) -> Vec<Self> {
        let of = |figure: Figure| {
            let level = figure.is_of_level().then_some(0);
            let met = figures.evaluate(&[Requirement { level, ..Requirement::of(figure, 0.0) }]);
            let RequirementOutcome { value, interval, .. } = *met.first()?;
            Some(Self { figure, value: value?, interval: interval? })
        };
        KEY_FIGURES.into_iter().filter_map(of).collect()
    }
}

/// The date and the operator of a certificate. Neither is taken from the machine, so that the output is reproducible.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Signature {
    /// The date, as printed.
    pub date: Option<String>,
    /// The name of the operator.
    pub operator: Option<String>,
}

impl Signature {
    /// Checks that both fit on the certificate.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an empty text, more than 120 characters, or control characters.
    pub fn check(&self) -> Result<()> {
        const MOST: usize = 120;
        let both = [("date", &self.date), ("operator", &self.operator)];
        for (name, text) in both.into_iter().filter_map(|(name, text)| Some((name, text.as_ref()?))) {
            if text.trim().is_empty() || text.chars().count() > MOST || text.contains(char::is_control) {
                let why = format!("expected one line of 1 to {MOST} characters");
                return Err(Error::invalid(format!("{name} `{}`", text.escape_debug()), why));
            }
        }
        Ok(())
    }
}

/// An asset's file and the scan it was compared with.
#[derive(Debug, Clone, Copy)]
pub struct ProvedFile<'a> {
    /// The asset.
    pub asset: &'a Path,
    /// The scan.
    pub scan: &'a Scan,
}

/// The inputs of a certificate.
struct Subject<'a> {
    scan: &'a About,
    asset: AssetFiles,
    /// `true` if the asset's model file contains everything that was compared.
    is_whole: bool,
    figures: &'a Figures,
}

impl Certificate {
    /// Certifies a written asset by the figures of its proof.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be read for its hash; those of [`Signature::check`].
    pub fn of_written(
        written: &WrittenAsset,
        figures: &Figures,
        options: &VerifyOptions,
        signature: &Signature,
    ) -> Result<Self> {
        let made = &written.asset.made;
        // glTF cannot reference object-space maps: they are compared, but no model file leads to them.
        let is_whole = !written.is_alone() && made.options.space == NormalSpace::Tangent;
        let asset = AssetFiles::of_written(written)?;
        Self::of(Subject { scan: &made.about, asset, is_whole, figures }, options, signature)
    }

    /// Certifies an asset's file, made by any program, by the figures of its proof.
    ///
    /// # Errors
    /// As [`Certificate::of_written`].
    pub fn of_file(
        proved: &ProvedFile<'_>,
        figures: &Figures,
        options: &VerifyOptions,
        signature: &Signature,
    ) -> Result<Self> {
        let ProvedFile { asset, scan } = *proved;
        let asset = AssetFiles::of_model(asset, &scan.limits)?;
        Self::of(Subject { scan: &scan.about, asset, is_whole: true, figures }, options, signature)
    }

    fn of(subject: Subject<'_>, options: &VerifyOptions, signature: &Signature) -> Result<Self> {
        signature.check()?;
        let Subject { scan, asset, is_whole, figures } = subject;
        let required = figures.evaluate(&options.requirements);
        let names: Vec<String> = scan.models.iter().map(ModelFile::name).collect();
        let is_runnable = is_whole && !names.is_empty() && are_distinct(&names);
        let model = asset.files.first().filter(|_| is_runnable);
        let command = model.map(|asset| {
            let names = [std::slice::from_ref(&asset.name), &names[..]].concat();
            command(&names, &scan.options, options, signature)
        });
        Ok(Self {
            verdict: Verdict::of(&required),
            required,
            figures: KeyFigure::all(figures),
            not_compared: figures.unseen.clone(),
            scan: HashedFile::of_scan(scan)?,
            scan_models: scan.models.len(),
            scan_triangles: scan.size.triangles as usize,
            asset: asset.files,
            triangles: figures.levels.iter().map(|level| level.triangles).collect(),
            maps: asset.maps,
            program: concat!("taotie ", env!("CARGO_PKG_VERSION")).into(),
            options: ProofOptions { scan: scan.options, points: options.points, view: options.view },
            date: signature.date.clone(),
            operator: signature.operator.clone(),
            command,
        })
    }
}

/// Returns `true` if no name occurs twice, in any case, so that one folder can hold all these files.
fn are_distinct(names: &[String]) -> bool {
    let known: BTreeSet<String> = names.iter().map(|name| name.to_lowercase()).collect();
    known.len() == names.len()
}

/// Returns the command that reproduces a certificate, given the names of the asset and of its scan's files; options with
/// default values are omitted.
fn command(
    names: &[String],
    reading: &ScanOptions,
    options: &VerifyOptions,
    signature: &Signature,
) -> String {
    let names: Vec<String> = names.iter().map(|name| path_argument(name)).collect();
    let Some((asset, scan)) = names.split_first() else { return String::new() };
    let usual = VerifyOptions::default();
    let mut words = ["taotie", "verify", asset.as_str()].map(str::to_owned).to_vec();
    words.extend(scan.iter().flat_map(|scan| ["--scan".to_owned(), scan.clone()]));
    words.extend(reading.arguments());
    let mut option = |name: &str, value: Option<String>| {
        words.extend(value.into_iter().flat_map(|value| match value.starts_with('-') {
            true => vec![format!("{name}={value}")],
            false => vec![name.to_owned(), value],
        }));
    };
    option("--proof-points", (options.points != usual.points).then(|| options.points.to_string()));
    option("--proof-view", (options.view != usual.view).then(|| options.view.to_string()));
    let required = requirement::argument(&options.requirements);
    option("--require", (!required.is_empty()).then_some(required));
    option("--date", signature.date.clone());
    option("--operator", signature.operator.clone());
    let page = Path::new(asset).with_extension("report.html");
    option("-o", Some(page.to_string_lossy().into_owned()));
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// Returns the name of a file as an argument: with `./` in front of a dash, which would make it an option.
fn path_argument(name: &str) -> String {
    if name.starts_with('-') { format!("./{name}") } else { name.to_owned() }
}

/// Returns a word quoted for shells: bare, in quotes that all shells share, or in POSIX quotes.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-._/=,@%+:".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else if !word.contains(['"', '$', '`', '\\', '!']) {
        format!("\"{word}\"")
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A file with the hash of its bytes.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct HashedFile {
    /// Its name, without folders.
    pub name: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// The SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A map of an asset with the hash of its bytes as stored: those of the PNG, WebP, JPEG or KTX2 file.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct HashedMap {
    /// Its use, such as `normal`.
    pub uses: String,
    /// Its file, without folders; `None` if it is in the model file.
    pub file: Option<String>,
    /// Its length in bytes; `None` if the file was missing.
    pub bytes: Option<u64>,
    /// The SHA-256 of its bytes, hexadecimal; `None` if the file was missing.
    pub sha256: Option<String>,
}

/// An asset's files and maps.
#[derive(Debug, Clone, Default)]
struct AssetFiles {
    /// The model file first; without the maps.
    pub files: Vec<HashedFile>,
    pub maps: Vec<HashedMap>,
}

impl HashedFile {
    fn read(path: &Path) -> Result<Self> {
        Ok(Self { name: name_of(path), bytes: taotie_io::file_size(path)?, sha256: taotie_io::sha256(path)? })
    }

    /// Reads the files of a scan, the model files first; empty for a scan in memory.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`] if one cannot be read.
    fn of_scan(about: &About) -> Result<Vec<Self>> {
        let others = about.files.iter().filter(|_| !about.models.is_empty()).skip(about.models.len());
        let others = others.map(|file| Self::read(file)).collect::<Result<Vec<_>>>()?;
        Ok([Self::of_models(&about.models)?, others].concat())
    }

    /// Returns model files of a scan.
    ///
    /// # Errors
    /// As [`Self::of_scan`].
    pub(super) fn of_models(models: &[ModelFile]) -> Result<Vec<Self>> {
        let of = |model: &ModelFile| {
            Ok(Self {
                name: model.name(),
                bytes: taotie_io::file_size(&model.path)?,
                sha256: model.sha256()?,
            })
        };
        models.iter().map(of).collect()
    }
}

impl HashedMap {
    fn read(uses: String, path: &Path) -> Result<Self> {
        let found = path.is_file().then(|| HashedFile::read(path)).transpose()?;
        let (bytes, sha256) = found.map(|found| (found.bytes, found.sha256)).unzip();
        Ok(Self { uses, file: Some(name_of(path)), bytes, sha256 })
    }
}

impl From<StoredImage> for HashedMap {
    fn from(image: StoredImage) -> Self {
        let (bytes, sha256) = image.bytes.unzip();
        let file = image.file.as_deref().map(name_of);
        Self { uses: image.uses.join(", "), file, bytes, sha256 }
    }
}

impl AssetFiles {
    /// Reads and hashes the files of a model.
    ///
    /// # Errors
    /// Those of reading them.
    pub fn of_model(path: &Path, limits: &Limits) -> Result<Self> {
        if !taotie_io::is_gltf(path)? {
            let mut others = taotie_io::load_model_within(path, limits)?.files;
            let files = all_files(path, &mut others);
            let files = files.iter().map(|file| HashedFile::read(file)).collect::<Result<_>>()?;
            return Ok(Self { files, maps: Vec::new() });
        }
        let StoredParts { mut buffers, images, maps_beside } = StoredParts::read(path, limits)?;
        let files = all_files(path, &mut buffers);
        let separate = maps_beside.into_iter().map(|(uses, file)| HashedMap::read(uses, &file));
        Ok(Self {
            files: files.iter().map(|file| HashedFile::read(file)).collect::<Result<_>>()?,
            maps: images
                .into_iter()
                .map(|image| Ok(HashedMap::from(image)))
                .chain(separate)
                .collect::<Result<_>>()?,
        })
    }

    /// Hashes the files of a written asset, or standalone maps with their low-poly mesh.
    ///
    /// # Errors
    /// Those of reading them.
    pub fn of_written(written: &WrittenAsset) -> Result<Self> {
        if !written.is_alone() {
            return Self::of_model(&written.current(), &Limits::of_own_files());
        }
        let low = written.asset.made.low_files.iter().map(|file| HashedFile::read(file));
        let map = |note: MapNote| {
            let file = note.file.unwrap_or_default();
            let map = HashedMap::read(
                taotie_engine::names::Named::name(note.map).to_owned(),
                &written.set.current(&file),
            )?;
            Ok(HashedMap { file: Some(name_of(&file)), ..map })
        };
        Ok(Self {
            files: low.collect::<Result<_>>()?,
            maps: written.maps().into_iter().map(map).collect::<Result<_>>()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::scene::GreenChannel;

    #[test]
    fn the_command_has_what_differs_from_the_defaults() {
        let (plain, usual) = (ScanOptions::default(), VerifyOptions::default());
        let named = |names: [&str; 2]| names.map(str::to_owned);
        let bare = command(&named(["a.glb", "s.ply"]), &plain, &usual, &Signature::default());
        assert_eq!(bare, "taotie verify a.glb --scan s.ply -o a.report.html");
        let reading = ScanOptions {
            crease_angle_deg: Some(30.0),
            green: Some(GreenChannel::Down),
            ..ScanOptions::default()
        };
        let requirements = Requirement::standard();
        let options = VerifyOptions { points: 500, view: 96, requirements, ..usual };
        let signature =
            Signature { date: Some("1 May 2026".into()), operator: Some("E. O'Neill \"EO\"".into()) };
        let full = command(&named(["big jug.glb", "s.ply"]), &reading, &options, &signature);
        let wanted = "taotie verify \"big jug.glb\" --scan s.ply --crease-angle 30 --scan-green down \
                      --proof-points 500 --proof-view 96 --require standard --date \"1 May 2026\" \
                      --operator 'E. O'\\''Neill \"EO\"' -o \"big jug.report.html\"";
        assert_eq!(full, wanted);
        let two = ["a.glb", "s.ply", "S.obj"].map(str::to_owned);
        let of_two = command(&two, &plain, &VerifyOptions::default(), &Signature::default());
        assert_eq!(of_two, "taotie verify a.glb --scan s.ply --scan S.obj -o a.report.html");
        let dashed = ["-a.glb", "-s b.ply"].map(str::to_owned);
        let signature = Signature { date: None, operator: Some("-".into()) };
        let of_dashed = command(&dashed, &plain, &VerifyOptions::default(), &signature);
        let wanted = "taotie verify ./-a.glb --scan \"./-s b.ply\" --operator=- -o ./-a.report.html";
        assert_eq!(of_dashed, wanted);
        assert!(are_distinct(&two) && !are_distinct(&["s.ply", "S.ply"].map(str::to_owned)));
    }

    #[test]
    fn a_verdict_is_only_as_good_as_its_worst_requirement() {
        let met = |met: bool, interval: [f64; 2]| RequirementOutcome {
            is_length: false,
            figure: Figure::MeanAngle,
            most: 1.0,
            level: Some(0),
            within: None,
            value: Some(interval[0]),
            interval: Some(interval),
            met,
        };
        let (good, open, bad) = (met(true, [0.5; 2]), met(false, [0.9, 1.1]), met(false, [1.5; 2]));
        let cases = [
            (vec![], Verdict::NothingRequired),
            (vec![good], Verdict::Met),
            (vec![good, open], Verdict::Undecided),
            (vec![bad, good, open], Verdict::NotMet),
        ];
        for (required, verdict) in cases {
            assert_eq!(Verdict::of(&required), verdict, "{required:?}");
        }
    }

    #[test]
    fn signatures_are_one_line() {
        let of = |text: &str| Signature { operator: Some(text.into()), ..Signature::default() }.check();
        assert!(of("A. Curator").is_ok() && Signature::default().check().is_ok());
        for wrong in ["", "  ", "a\nb", &"x".repeat(121)] {
            assert!(of(wrong).is_err(), "{wrong}");
        }
    }
}
