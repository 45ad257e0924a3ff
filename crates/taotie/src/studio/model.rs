//! The model to render.

use super::material::MaterialOptions;
use super::parse::MOST;
use crate::error::{Error, Result};
use crate::io::{self, Limits, Loaded};
use std::path::Path;

/// Reads a model, chooses the requested variant, and applies the material options.
///
/// ```no_run
/// use taotie::studio::{self, MaterialOptions};
///
/// let clay = MaterialOptions { material: Some("clay".into()), ..MaterialOptions::default() };
/// let scene = studio::load("vessel.glb".as_ref(), &clay)?.scene;
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// The reader's, those of the maps and the material, and [`Error::Invalid`] if all triangles are at one point or the
/// size is not between 1e-18 and 1e18 model units.
pub fn load(path: &Path, options: &MaterialOptions) -> Result<Loaded> {
    load_within(path, options, &Limits::default())
}

/// Rejects a size, in model units, that cannot be rendered.
fn check_size(path: &Path, diagonal: f64) -> Result<()> {
    let wrong = |why: String| Err(Error::invalid(path.display().to_string(), why));
    if diagonal == 0.0 {
        return wrong("all its triangles are at one point; there is nothing to see".into());
    }
    if !(1.0 / MOST..=MOST).contains(&diagonal) {
        return wrong(format!("its size is {diagonal:.1e} model units; scale it to between 1e-18 and 1e18"));
    }
    Ok(())
}

/// Reads a model like [`load`], within limits.
///
/// ```no_run
/// use taotie::asset::Limits;
/// use taotie::studio::{self, MaterialOptions};
///
/// let limits = Limits { memory: Some("2G".parse()?), ..Limits::default() };
/// let scene = studio::load_within("vessel.glb".as_ref(), &MaterialOptions::default(), &limits)?.scene;
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// As [`load`] and [`io::load_model_within`].
pub fn load_within(path: &Path, options: &MaterialOptions, limits: &Limits) -> Result<Loaded> {
    let mut loaded = io::load_model_within(path, limits)?;
    if let Some(bounds) = loaded.scene.bounds() {
        check_size(path, bounds.diagonal())?;
    }
    if let Some(variant) = &options.variant {
        let chosen = loaded.variants.apply(variant, &mut loaded.scene);
        chosen.map_err(|error| error.within(path.display()))?;
    }
    options.apply_within(&mut loaded.scene, limits)?;
    Ok(loaded)
}
