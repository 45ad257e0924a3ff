//! `taotie bake` on every third-party glTF model: each property that a scan's materials specify is in its asset, or
//! the report lists it as left out.

use crate::files::data_files;
use crate::material_looks::{Look, PROPERTIES, is_double_sided};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use taotie_engine::scene::Scene;
use taotie_io::{Loaded, load_model};

const FOLDERS: [&str; 4] =
    ["khronos-gltf-sample-assets", "polyhaven-models", "materialx", "gltf-asset-generator"];

/// Scans of more triangles are left to `make asset-table`, which bakes them all.
const MOST_TRIANGLES: usize = 100_000;

#[test]
fn every_property_of_a_scan_is_in_its_asset_or_told_as_left_out() {
    let models: Vec<PathBuf> =
        FOLDERS.iter().flat_map(|folder| data_files(folder, &["gltf", "glb"])).collect();
    let outcomes: Vec<Outcome> = models.iter().map(|model| Outcome::of(model)).collect();
    let faults: Vec<&String> = outcomes.iter().flat_map(|outcome| &outcome.faults).collect();
    assert!(faults.is_empty(), "{} faults:\n{faults:#?}", faults.len());
    let said: usize = outcomes.iter().map(|outcome| outcome.said).sum();
    let baked = outcomes.iter().filter(|outcome| outcome.said > 0).count();
    println!(
        "{} models, {baked} of them with {said} properties that are not a default material's",
        models.len()
    );
    // Most of the samples specify material properties; if none did, nothing would be tested.
    assert!(models.is_empty() || baked * 2 > models.len(), "{baked} of {} models", models.len());
}

/// The outcome of a model.
#[derive(Default)]
struct Outcome {
    /// The number of properties that its materials specify.
    said: usize,
    faults: Vec<String>,
}

impl Outcome {
    fn of(model: &Path) -> Self {
        // Unreadable models cannot be compared; the error is tested with all commands.
        let Ok(scan) = load_model(model) else { return refused(model) };
        let triangles = scan.scene.triangle_count();
        if triangles > MOST_TRIANGLES {
            println!("left out: {}: {triangles} triangles, more than {MOST_TRIANGLES}", model.display());
            return Self::default();
        }
        let folder = tempfile::tempdir().expect("temporary folders can be made");
        let asset = folder.path().join("out.glb");
        let run = bake(model, &asset, triangles);
        if !run.status.success() {
            return Self { faults: no_sentence(model, &run).into_iter().collect(), said: 0 };
        }
        let report = serde_json::from_slice(&run.stdout).expect("stdout is one JSON document");
        let asset = load_model(&asset).expect("the asset can be read").scene;
        Bake { model, scan: &scan, asset: &asset, report: &report }.outcome()
    }
}

/// A bake of a model that cannot be read must be refused.
fn refused(model: &Path) -> Outcome {
    let folder = tempfile::tempdir().expect("temporary folders can be made");
    let run = bake(model, &folder.path().join("out.glb"), 0);
    let fault = match run.status.success() {
        true => Some(format!("{}: baked, and cannot be read", model.display())),
        false => no_sentence(model, &run),
    };
    Outcome { said: 0, faults: fault.into_iter().collect() }
}

/// Bakes to a tenth of the triangles and the smallest maps; nothing is measured.
fn bake(model: &Path, asset: &Path, triangles: usize) -> Output {
    let wanted = (triangles / 10).clamp(4, 1000).to_string();
    Command::new(env!("CARGO_BIN_EXE_taotie"))
        .arg("bake")
        .arg(model)
        .arg("-o")
        .arg(asset)
        .args(["--triangles", &wanted, "--size", "64", "--samples", "1", "--no-verify", "--json"])
        .output()
        .expect("the command runs")
}

/// Returns the fault of a bake that failed without a last line that names the file.
fn no_sentence(model: &Path, run: &Output) -> Option<String> {
    let said = String::from_utf8_lossy(&run.stderr);
    let is_told = said.lines().last().is_some_and(|line| line.starts_with("taotie: error: "));
    println!("refused: {}: {}", model.display(), said.lines().last().unwrap_or_default());
    let is_fine = run.status.code() == Some(2) && is_told;
    (!is_fine).then(|| format!("{}: exit code {:?}\n{said}", model.display(), run.status.code()))
}

/// A scan, its asset, and the report.
struct Bake<'a> {
    model: &'a Path,
    scan: &'a Loaded,
    asset: &'a Scene,
    report: &'a Value,
}

impl Bake<'_> {
    fn outcome(&self) -> Outcome {
        let mut outcome = Outcome::default();
        for (name, look) in PROPERTIES {
            let [scan, asset] = [&self.scan.scene, self.asset].map(|scene| Look::over(scene, look));
            outcome.said += usize::from(scan != Look::Unsaid);
            outcome.faults.extend(self.fault(name, [&scan, &asset]));
        }
        if is_double_sided(&self.scan.scene) && !is_double_sided(self.asset) {
            outcome.faults.push(format!("{}: no longer double-sided", self.model.display()));
        }
        outcome.faults.extend(self.silent_warnings());
        outcome
    }

    /// Returns the fault of a property that is neither kept nor reported, or reported as carried and missing.
    fn fault(&self, name: &str, [scan, asset]: [&Look; 2]) -> Option<String> {
        let (is_kept, is_left) = (asset.keeps(scan), self.is_left(name));
        let is_carried = self.names("carried", None).any(|carried| carried == name);
        let is_honest = is_kept || (is_left && !is_carried);
        (!is_honest).then(|| {
            let status = format!("carried: {is_carried}, left: {is_left}");
            format!("{}: {name} of the scan {scan:?}, of the asset {asset:?}; {status}", self.model.display())
        })
    }

    /// Returns true if the report lists the property as left out, both as data and as a warning.
    fn is_left(&self, name: &str) -> bool {
        let warned = format!("left out: the scan's {name},");
        self.names("left", Some("what")).any(|left| left == name)
            && self.names("warnings", Some("what")).any(|warning| warning.starts_with(&warned))
    }

    /// Returns the warnings about unknown extensions of the scan's file that the report lacks.
    fn silent_warnings(&self) -> Vec<String> {
        let is_told = |what: &str| self.names("warnings", Some("what")).any(|warning| warning == what);
        let extensions = self.scan.warnings.iter().filter(|(what, _)| what.starts_with("the extension "));
        let silent = extensions.filter(|(what, _)| !is_told(what));
        silent.map(|(what, _)| format!("{}: not in the report: {what}", self.model.display())).collect()
    }

    /// Returns the texts of a list in the report, or those of a field of its items.
    fn names(&self, list: &str, field: Option<&'static str>) -> impl Iterator<Item = &str> {
        let items = self.report[list].as_array().expect("a list");
        items.iter().map(move |item| field.map_or(item, |field| &item[field]).as_str().expect("a text"))
    }
}
