//! The setting of a model: its materials, its lighting, its camera, and the images to take.
//!
//! Options are plain structs: `Default` with fields set by hand. Angles are radians and lengths model units.
//!
//! ```no_run
//! use taotie::studio::{self, MaterialOptions};
//! use taotie::{Limits, Picture, RenderSettings};
//!
//! let bronze = MaterialOptions { material: Some("bronze".into()), ..MaterialOptions::default() };
//! let scene = studio::load("vessel.glb".as_ref(), &bronze, &Limits::default())?.scene;
//! let settings = RenderSettings { width: 800, height: 600, ..RenderSettings::default() };
//! Picture { settings, ..Picture::default() }.write(&scene, "vessel.png")?;
//! # Ok::<(), taotie::Error>(())
//! ```

mod environment;
mod lights;
mod material;
mod motion;
mod overrides;
mod parameters;
mod viewpoint;

pub use environment::{EnvironmentOptions, EnvironmentSource};
pub use lights::{LightForm, LightOptions, LightSpec};
pub use material::{MaterialFile, MaterialOptions};
pub use motion::{Motion, Sequence, SequenceFrame};
pub use overrides::{MapOptions, MaterialFactors};
pub use parameters::{CameraParameters, LightParameters};
pub use viewpoint::{CameraOptions, Framing, View, Viewpoint};

use std::collections::BTreeSet;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::scene::Scene;
use taotie_engine::surface::with_hard_edges;
use taotie_io::{Limits, Loaded, parse};

/// Reads a model within limits, chooses the requested variant, and applies the material options. Modelled meshes without
/// normals keep their hard edges, as in a bake.
///
/// ```no_run
/// use taotie::Limits;
/// use taotie::studio::{self, MaterialOptions};
///
/// let clay = MaterialOptions { material: Some("clay".into()), ..MaterialOptions::default() };
/// let limits = Limits { memory: Some("2G".parse()?), ..Limits::default() };
/// let scene = studio::load("vessel.glb".as_ref(), &clay, &limits)?.scene;
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// The reader's, those of the maps and the material, and [`Error::Invalid`] if all triangles are at one point or the
/// size is not between 1e-18 and 1e18 model units.
pub fn load(path: &Path, options: &MaterialOptions, limits: &Limits) -> Result<Loaded> {
    let mut loaded = taotie_io::load_model_within(path, limits)?;
    keep_hard_edges(&mut loaded.scene)?;
    if let Some(bounds) = loaded.scene.bounds() {
        check_size(path, bounds.diagonal())?;
    }
    if let Some(variant) = &options.variant {
        let chosen = loaded.variants.apply(variant, &mut loaded.scene);
        chosen.map_err(|error| error.within(path.display()))?;
    }
    options.apply_within(&mut loaded.scene, limits)?;
    loaded.is_edited |= *options != MaterialOptions::default();
    Ok(loaded)
}

/// Splits the normals of modelled meshes that have none at hard edges, as a bake does, except below normal maps.
fn keep_hard_edges(scene: &mut Scene) -> Result<()> {
    if scene.meshes().iter().all(|mesh| !mesh.normals().is_empty()) {
        return Ok(());
    }
    let mut data = std::mem::take(scene).into_data();
    let is_mapped = data.instances.iter().filter(|own| data.materials[own.material].normal.is_some());
    let mapped: BTreeSet<usize> = is_mapped.map(|own| own.mesh).collect();
    for (_, mesh) in data.meshes.iter_mut().enumerate().filter(|(i, _)| !mapped.contains(i)) {
        *mesh = with_hard_edges(std::mem::take(mesh))?;
    }
    *scene = Scene::new(data)?;
    Ok(())
}

/// Rejects a size, in model units, that cannot be rendered.
fn check_size(path: &Path, diagonal: f64) -> Result<()> {
    let wrong = |why: String| Err(Error::invalid(path.display().to_string(), why));
    if diagonal == 0.0 {
        return wrong("all its triangles are at one point; there is nothing to see".into());
    }
    if !(1.0 / parse::MOST..=parse::MOST).contains(&diagonal) {
        return wrong(format!("its size is {diagonal:.1e} model units; scale it to between 1e-18 and 1e18"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_modelled_file_without_normals_stay_hard() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cube.obj");
        let corners =
            (0..8).map(|i| format!("v {} {} {}\n", i & 1, (i >> 1) & 1, i >> 2)).collect::<String>();
        let faces = ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"];
        let faces = faces.map(|face| format!("f {face}\n")).concat();
        taotie_io::write_text(&path, &(corners + &faces)).expect("it is written");
        let scene = load(&path, &MaterialOptions::default(), &Limits::default()).expect("it is read").scene;
        let is_along = |n: &taotie_engine::math::Vec3| n.to_array().iter().any(|v| v.abs() > 0.999);
        let normals = scene.meshes()[0].normals();
        assert!(normals.len() == 24 && normals.iter().all(is_along), "{normals:?}");
    }
}
