//! Coarser levels of detail: each as light as possible within the limits of the finest while the object is small on
//! the screen.

use super::coarser::{Coarser, Finest};
use super::level::Level;
use super::level_maker::LevelMaker;
use crate::asset::lod::Lod;
use crate::asset::maps::Recipe;
use crate::asset::scan::Scan;
use crate::error::{Error, Result, Warnings};
use crate::progress::Progress;
use crate::proof::Side;

/// The maximum ratio of a level's triangles to those of the one before, for levels by pixels.
const LIGHTER: f64 = 0.8;
/// The factor by which a level that is good at as many pixels as the one before takes over later.
const STEP: f64 = std::f64::consts::SQRT_2;
/// The factor up to which a count is accepted as the requested one.
const NEAR_COUNT: f64 = 1.02;

/// Makes the requested coarser levels. One that cannot be made, or is hardly lighter than the one before, is omitted
/// with one of the returned warnings.
///
/// # Errors
/// [`Error::Cancelled`]; those of reading candidates.
pub(in crate::asset) fn make_levels(
    recipe: Recipe<'_>,
    (scan, finest): (&Scan, Finest<'_>),
    progress: Progress<'_>,
) -> Result<(Vec<Coarser>, Warnings)> {
    let (mut found, mut warnings) = (Vec::new(), Warnings::default());
    let lods = &recipe.options.lods;
    if lods.is_empty() {
        return Ok((found, warnings));
    }
    scan.sort(progress)?;
    let stage = progress.begin("levels of detail")?;
    let side = Side::of(scan.sorted());
    if !side.visibility.places().is_empty() {
        warnings.note("left out: the levels of detail: the scan is an interior, which is always close", 1);
        return Ok((found, warnings));
    }
    let maker = LevelMaker::new(recipe, (scan, &side), finest)?;
    for (i, wanted) in lods.iter().enumerate() {
        // All inner stages are reported as this one.
        let listener = |_: &'static str, _: f64| stage.at(i as f64 / lods.len() as f64).is_ok();
        let progress = Progress::new(&listener);
        let number = found.len() + 1;
        let made = match *wanted {
            Lod::Triangles(count) => maker.of_triangles((number, count), progress),
            Lod::Pixels(across) => maker.for_pixels(Level { number, across }, progress),
        };
        let before = found.last().map_or(maker.triangles(), |level: &Coarser| level.mesh.triangles().len());
        let checked = made.and_then(|level| light(*wanted, level, (before, maker.is_named())));
        match checked {
            Ok(level) => {
                note(*wanted, &level, &mut warnings);
                push(&mut found, (*wanted, level), &mut warnings);
            }
            Err(error @ (Error::Invalid { .. } | Error::Limit { .. })) => {
                warnings.note(format!("left out: {error}"), 1);
            }
            Err(error) => return Err(error),
        }
    }
    Ok((found, warnings))
}

/// Returns a level if it is lighter than the one before; much lighter, if no requirement names levels.
fn light(wanted: Lod, level: Coarser, (before, is_named): (usize, bool)) -> Result<Coarser> {
    let triangles = level.mesh.triangles().len();
    let is_light = match wanted {
        Lod::Pixels(_) if !is_named => triangles as f64 <= LIGHTER * before as f64,
        _ => triangles < before,
    };
    match is_light {
        true => Ok(level),
        false => Err(Error::invalid(
            format!("the level of detail {wanted}"),
            format!("it would have {triangles} triangles, and the one before has {before}"),
        )),
    }
}

/// Notes how a level differs from the requested one.
fn note(wanted: Lod, level: &Coarser, warnings: &mut Warnings) {
    let triangles = level.mesh.triangles().len();
    if let Lod::Triangles(count) = wanted
        && triangles as f64 > NEAR_COUNT * f64::from(count)
    {
        let what = format!(
            "a level of {count} triangles was requested; could not go below {triangles}: seams must be kept"
        );
        warnings.note(what, 1);
    }
    if !level.is_near {
        let least = Lod::LEAST;
        let what = format!(
            "the level of detail {wanted} does not meet the limits of the finest level even when the object fills {least} \
             pixels; it is shown below that size"
        );
        warnings.note(what, 1);
    }
}

/// Adds a level, which takes over from the one before. Earlier ones that would never be shown because of it are
/// removed.
fn push(found: &mut Vec<Coarser>, (wanted, level): (Lod, Coarser), warnings: &mut Warnings) {
    let is_for_pixels = matches!(wanted, Lod::Pixels(_));
    while let Some(last) = found.pop_if(|last| is_for_pixels && last.across <= level.across) {
        let (triangles, across) = (last.mesh.triangles().len(), level.across);
        let what = format!(
            "left out: a level of {triangles} triangles: a lighter one is good enough up to {across} pixels"
        );
        warnings.note(what, 1);
    }
    let before = found.last().map(|last| last.across).filter(|before| *before <= level.across);
    let across = before.map_or(level.across, |before| (f64::from(before) / STEP) as u32).max(1);
    found.push(Coarser { across, ..level });
}
