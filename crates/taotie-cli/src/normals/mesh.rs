//! The mesh that a map is for, laid out on it.

use super::args::NormalsArgs;
use crate::choice;
use anyhow::{Context, Result, anyhow, bail};
use std::path::Path;
use taotie_engine::Warnings;
use taotie_engine::bake::{TexelGrid, TexelSurface};
use taotie_engine::normal_map::lay_out;
use taotie_io::{FileSet, Loaded};

/// Lays out the requested mesh on a map of `size`, with the tangent frames of the renderer; `None` without a model.
/// Protects its files from being overwritten.
pub fn laid_out(
    args: &NormalsArgs,
    files: &FileSet,
    [width, height]: [u32; 2],
    warnings: &mut Warnings,
) -> Result<Option<TexelSurface>> {
    let Some(path) = &args.mesh else { return Ok(None) };
    let mut loaded = taotie_io::load_model_within(path, &args.limits.limits())?;
    files.protect(&loaded.files)?;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mesh = &loaded.scene.meshes()[part(args, path, &loaded)?];
    let grid = TexelGrid { width, height, uv_set: args.uv_set, padding: args.dilation };
    let (surface, found) = lay_out(mesh, &grid, args.tangents).with_context(|| path.display().to_string())?;
    if surface.coverage().covered() == 0 {
        bail!("{}: its uvs cover no texel of the map", path.display());
    }
    warnings.absorb(found);
    Ok(Some(surface))
}

/// Returns the number of the requested mesh, or of the only one.
fn part(args: &NormalsArgs, path: &Path, loaded: &Loaded) -> Result<usize> {
    let count = loaded.scene.meshes().len();
    let names: Vec<&str> = (0..count).map(|i| loaded.mesh_names.get(i).map_or("", String::as_str)).collect();
    let path = path.display();
    match &args.part {
        Some(asked) => {
            choice::chosen(asked, ["mesh", "meshes"], &names).map_err(|why| anyhow!("{path}: {why}"))
        }
        None if count == 1 => Ok(0),
        None => {
            bail!("{path}: it has {count} meshes; choose one with --part: {}", choice::listed(&names))
        }
    }
}
