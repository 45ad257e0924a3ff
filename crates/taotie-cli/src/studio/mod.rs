//! How a model is shown, as options of the command: its material, its light, the viewpoint, and the development of
//! the picture. Shared by the subcommands that render a user's model; [`taotie::studio`] does the work.

mod camera;
mod light;
mod surface;

pub use camera::{CameraArgs, FilmArgs, Viewpoint};
pub use light::{EnvironmentReport, LightArgs, lighting};
pub use surface::{
    Green, MaterialArgs, MaterialReport, ReflectionArgs, ReflectionReport, Space, SurfaceArgs,
};
pub use taotie::studio::{Framing, Motion};

use anyhow::{Result, anyhow};
use std::path::{Path, PathBuf};
use taotie::Limits;
use taotie::studio::MaterialFile;
use taotie_engine::scene::Scene;
use taotie_io::Loaded;

/// Reads a model, selects the requested variant, and applies the options to its materials. `height_scale` is the
/// height of white in model units, if given.
pub fn load(path: &Path, args: &MaterialArgs, height_scale: Option<f64>, limits: &Limits) -> Result<Loaded> {
    let loaded = taotie::studio::load(path, &args.options(height_scale), limits);
    let mut loaded = loaded.map_err(|error| of_material(args.material.as_deref(), error))?;
    let Loaded { scene, warnings, .. } = &mut loaded;
    surface::note_unread(args, height_scale, scene, warnings);
    Ok(loaded)
}

/// Returns the files that are read for the requested materials.
pub fn material_files(args: &MaterialArgs) -> Result<Vec<PathBuf>> {
    args.options(None).files().map_err(|error| of_material(args.material.as_deref(), error))
}

/// Applies a preset or a TOML file to every material of the scene.
pub fn apply_choice(choice: &str, scene: &mut Scene) -> Result<()> {
    let applied = MaterialFile::choose(choice).and_then(|file| file.apply(scene));
    applied.map_err(|error| of_material(Some(choice), error))
}

/// Returns the error of an unknown material, naming the option.
fn of_material(choice: Option<&str>, error: taotie_engine::Error) -> anyhow::Error {
    match (choice, error) {
        (Some(choice), taotie_engine::Error::Invalid { what, why })
            if what == format!("material {choice}") =>
        {
            anyhow!("--material {choice}: {why}")
        }
        (_, error) => error.into(),
    }
}
