//! The high-poly reference that methods are measured against.

use super::CompareArgs;
use crate::studio;
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::comparison::dress_reference;
use taotie_engine::Warnings;
use taotie_engine::scene::Scene;

/// A reference, and the other files that it was read from.
pub struct Reference {
    /// The reference.
    pub scene: Scene,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Reads the reference with the requested material, otherwise its own, otherwise the model's; applies the requested
/// factors.
///
/// # Errors
/// Those of the reader and of the material.
pub fn load(path: &Path, args: &CompareArgs, model: &Scene, warnings: &mut Warnings) -> Result<Reference> {
    let mut loaded = taotie_io::load_model_within(path, &args.running.limits.limits())?;
    let args = &args.material;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mut scene = loaded.scene;
    match &args.material {
        Some(choice) => dress_as_chosen(&mut scene, choice)?,
        None => dress_reference(&mut scene, model)?,
    }
    args.factors().apply(&mut scene)?;
    Ok(Reference { scene, files: loaded.files })
}

fn dress_as_chosen(scene: &mut Scene, choice: &str) -> Result<()> {
    let own = scene.materials().to_vec();
    studio::apply_choice(choice, scene)?;
    // Relief in the material belongs to the model; the reference has its relief as geometry.
    Ok(scene.edit(|scene| {
        for (material, own) in scene.materials.iter_mut().zip(own) {
            (material.normal, material.height) = (own.normal, own.height);
        }
    })?)
}
