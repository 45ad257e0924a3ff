//! The high-poly reference that methods are measured against.

use crate::studio;
use anyhow::Result;
use std::path::Path;
use taotie::comparison::dress_reference;
use taotie::scene::Scene;
use taotie::{Warnings, io};

/// Reads the reference, made of what `choice` says, else of what it says itself, else of what the model is made of.
///
/// # Errors
/// The reader's, and those of the material.
pub fn load(path: &Path, choice: Option<&str>, model: &Scene, warnings: &mut Warnings) -> Result<Scene> {
    let mut loaded = io::load_model(path)?;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mut scene = loaded.scene;
    let Some(choice) = choice else {
        dress_reference(&mut scene, model);
        return Ok(scene);
    };
    let own = scene.materials.clone();
    studio::apply_choice(choice, &mut scene)?;
    // Relief that the material brings along is the model's; this one's is geometry.
    for (material, own) in scene.materials.iter_mut().zip(own) {
        (material.normal, material.height) = (own.normal, own.height);
    }
    Ok(scene)
}
