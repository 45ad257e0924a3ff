//! The model to be seen.

use super::{MaterialArgs, material};
use anyhow::{Context, Result, bail};
use std::path::Path;
use taotie::io::{self, Loaded};

/// Reads a model, chooses the variant asked for, and gives its materials what the options ask for. `height_scale` is the height of white in model
/// units, where it was asked for.
///
/// # Errors
/// The reader's, those of the maps, and that there is nothing to be seen from anywhere.
pub fn load(path: &Path, args: &MaterialArgs, height_scale: Option<f64>) -> Result<Loaded> {
    let mut loaded = io::load_model(path)?;
    if loaded.scene.bounds().is_some_and(|bounds| bounds.diagonal() == 0.0) {
        bail!("{}: all its triangles lie in one point; there is nothing to see", path.display());
    }
    if let Some(variant) = &args.variant {
        loaded.variants.apply(variant, &mut loaded.scene).with_context(|| path.display().to_string())?;
    }
    material::apply(args, height_scale, &mut loaded.scene)?;
    Ok(loaded)
}
