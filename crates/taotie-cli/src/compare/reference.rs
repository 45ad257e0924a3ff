//! The truth that methods are measured against: a model with its relief as geometry.

use crate::studio;
use anyhow::Result;
use std::path::Path;
use taotie::scene::{Material, Scene};
use taotie::{Warnings, io};

/// Model and reference should not differ in place or size by more than this fraction of the diagonal.
const TOLERANCE: f64 = 0.05;

/// Reads the reference, made of what `choice` says, else of what it says itself, else of what the model is made of.
///
/// # Errors
/// The reader's, and those of the material.
pub fn load(path: &Path, choice: Option<&str>, model: &Scene, warnings: &mut Warnings) -> Result<Scene> {
    let mut loaded = io::load_model(path)?;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mut scene = loaded.scene;
    check_place(path, model, &scene, warnings);
    match choice {
        Some(choice) => {
            let own = scene.materials().to_vec();
            studio::apply_choice(choice, &mut scene)?;
            // Relief that the material brings along is the model's; this one's is geometry.
            scene.edit(|scene| {
                for (material, own) in scene.materials.iter_mut().zip(own) {
                    (material.normal, material.height) = (own.normal, own.height);
                }
            })?;
        }
        None => take_factors(&mut scene, model)?,
    }
    Ok(scene)
}

/// Materials that say nothing take the factors of the model's first.
fn take_factors(scene: &mut Scene, model: &Scene) -> taotie::Result<()> {
    let Some(first) = model.materials().first() else { return Ok(()) };
    scene.edit(|scene| {
        for material in &mut scene.materials {
            let silent = Material { name: material.name.clone(), ..Material::default() };
            if *material == silent {
                *material = without_textures(first);
            }
        }
    })
}

fn without_textures(material: &Material) -> Material {
    let mut material = material.clone();
    material.retain_textures(|_| false);
    material
}

/// Warns where model and reference do not lie in one place.
fn check_place(path: &Path, model: &Scene, reference: &Scene, warnings: &mut Warnings) {
    let (Some(a), Some(b)) = (model.bounds(), reference.bounds()) else { return };
    let off = (a.center() - b.center()).length().max((a.diagonal() - b.diagonal()).abs());
    if off > TOLERANCE * a.diagonal() {
        let percent = 100.0 * off / a.diagonal();
        let what = "place or size differs from the model's by";
        let advice = "angles between them say little; bring both into one coordinate system";
        warnings.note(format!("{}: {what} {percent:.0} % of its diagonal: {advice}", path.display()), 1);
    }
}
