//! A model in memory, measured against its scan without rendering pictures.

use super::figures::Figures;
use super::findings;
use super::judgement;
use super::measurement::Measurement;
use super::scan::Scan;
use super::shown::ShownLevel;
use super::verify_options::{VerifyOptions, check};
use crate::error::{Result, Warnings};
use crate::progress::Progress;
use crate::scene::Scene;
use std::path::Path;

/// Measures a loaded model against its scan: returns the figures that [`verify`](super::verify) finds for the same
/// model, except those of images and files, and the warnings. `options.map` and the sizes of pictures are ignored.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{Limits, Scan, VerifyOptions, measure};
///
/// let scan = Scan::read("scan.ply", &Limits::default(), Progress::SILENT)?;
/// let model = taotie::io::load_model("packed.glb".as_ref())?.scene;
/// let (figures, _) = measure(&model, &scan, &VerifyOptions::default(), Progress::SILENT)?;
/// println!("{:?}", figures.finest().map(|finest| finest.hausdorff));
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if the meshes do not overlap, or an option is out of range;
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub fn measure(
    model: &Scene,
    scan: &Scan,
    options: &VerifyOptions,
    progress: Progress<'_>,
) -> Result<(Figures, Warnings)> {
    check(options)?;
    scan.sort(progress)?;
    progress.begin("measure normals")?;
    let level = |scene: &Scene| ShownLevel::of(scene, scan, (Path::new("the model"), true));
    let finest = level(model)?;
    let mut warnings = Warnings::default();
    let fit = finest.whole().fit((options.points / 2).max(1), scan.mesh().diagonal());
    if let Some(fit) = fit {
        let cause = || findings::mismatch(&finest, (Some(fit.into()), false), scan.unit());
        judgement::refuse_misfit(&fit, cause, &mut warnings)?;
    }
    let (mut figures, parts) =
        Measurement { scan, unit: scan.unit(), options, across: &[] }.all(&finest, &[], &level, progress)?;
    figures.parts = parts;
    findings::note_whole(&figures, &finest, &mut warnings);
    findings::note(&figures, &[], &mut warnings);
    Ok((figures, warnings))
}
