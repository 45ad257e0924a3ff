//! How a model is seen, as options of the command: its material, its light, where it is seen from, and how that becomes
//! a picture. The subcommands that take pictures of a user's model have them in common; the work is done by
//! [`taotie::studio`].

mod args;
mod surface_args;
mod unread;
mod viewpoint;

pub use args::{CameraArgs, FilmArgs, LightArgs, RunningArgs};
pub use surface_args::{Green, MaterialArgs, ReflectionArgs, Space, SurfaceArgs};
pub use taotie::studio::{Framing, Motion};
pub use viewpoint::Viewpoint;

use anyhow::{Result, anyhow};
use std::path::{Path, PathBuf};
use taotie::asset::Limits;
use taotie::io::Loaded;
use taotie::render::{EnvironmentLight, Lighting};
use taotie::scene::Scene;
use taotie::studio::{MaterialFile, View};

/// Reads a model, chooses the variant asked for, and gives its materials what the options ask for. `height_scale` is
/// the height of white in model units, where it was asked for.
pub fn load(path: &Path, args: &MaterialArgs, height_scale: Option<f64>, limits: &Limits) -> Result<Loaded> {
    let loaded = taotie::studio::load_within(path, &args.options(height_scale), limits);
    let mut loaded = loaded.map_err(|error| of_material(args.material.as_deref(), error))?;
    let Loaded { scene, warnings, .. } = &mut loaded;
    unread::note(args, height_scale, scene, warnings);
    Ok(loaded)
}

/// Returns the files that are read for the materials asked for.
pub fn material_files(args: &MaterialArgs) -> Result<Vec<PathBuf>> {
    args.options(None).files().map_err(|error| of_material(args.material.as_deref(), error))
}

/// Puts a preset or what a TOML file asks for into every material of the scene.
pub fn apply_choice(choice: &str, scene: &mut Scene) -> Result<()> {
    let applied = MaterialFile::choose(choice).and_then(|file| file.apply(scene));
    applied.map_err(|error| of_material(Some(choice), error))
}

/// An unknown material by the option that named it.
fn of_material(choice: Option<&str>, error: taotie::Error) -> anyhow::Error {
    match (choice, error) {
        (Some(choice), taotie::Error::Invalid { what, why }) if what == format!("material {choice}") => {
            anyhow!("--material {choice}: {why}")
        }
        (_, error) => error.into(),
    }
}

/// The light on a scene in this view.
pub fn lighting(
    args: &LightArgs,
    environment: Option<&EnvironmentLight>,
    scene: &Scene,
    view: View<'_>,
) -> Result<Lighting> {
    Ok(args.options()?.lighting(environment, scene, view))
}
