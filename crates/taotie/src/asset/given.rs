//! The low-poly mesh that is given: read, with what stays of its material.

use super::kept_textures::{KeptTextures, note_samplers};
use super::options::{BakeOptions, MeshSource};
use super::plan::LowLook;
use super::scan::check_extent;
use super::stripped::Stripped;
use crate::bake::{self, MapKind};
use crate::error::{Error, Result, Warnings};
use crate::io::{self, Limits};
use crate::mesh::{Mesh, MeshData};
use crate::scene::{AlphaMode, Material, Scene};
use std::path::Path;

/// A low-poly mesh as its file says.
pub(super) struct GivenMesh {
    scene: Scene,
    /// The first material, without what cannot stay.
    pub material: Material,
    stripped: Stripped,
}

/// The parts of a mesh that is given which go into the asset.
pub(super) struct Taken {
    pub mesh: Mesh,
    pub material: Material,
    pub kept: KeptTextures,
}

impl GivenMesh {
    /// Reads a mesh, at rest.
    ///
    /// # Errors
    /// Those of reading; [`Error::Unsupported`] for a mesh that moves, since no asset keeps that.
    pub fn read(source: &MeshSource, limits: &Limits, warnings: &mut Warnings) -> Result<Self> {
        let Read { scene, moving } = read(source, limits, warnings)?;
        if let (MeshSource::File(path), Some(moving)) = (source, moving) {
            return Err(moves(path, moving));
        }
        let used: Vec<usize> = scene.instances().iter().map(|instance| instance.material).collect();
        if used.iter().any(|material| *material != used[0]) {
            warnings.note("materials of the low-poly mesh made one, the first", 1);
        }
        let mut material = used.first().and_then(|m| scene.materials().get(*m)).cloned().unwrap_or_default();
        let stripped = Stripped::off(&mut material, &scene);
        Ok(Self { scene, material, stripped })
    }

    /// Returns its looks.
    pub fn look(&self) -> LowLook<'_> {
        let has_colors = self.scene.meshes().iter().any(|mesh| !mesh.colors().is_empty());
        LowLook { material: &self.material, has_colors }
    }

    /// Takes what stays: one mesh in world space, and the material without what is baked in its place. That and what
    /// cannot stay is noted.
    ///
    /// # Errors
    /// Those of [`bake::low_poly_mesh`].
    pub fn taken(self, options: &BakeOptions, warnings: &mut Warnings) -> Result<Taken> {
        let Self { scene, mut material, stripped } = self;
        let kept = KeptTextures::of(&material, &scene);
        stripped.note(options, warnings);
        note_samplers(&material, &scene, options, warnings);
        leave_relief(&material, options, warnings);
        leave_alpha(&mut material, options, warnings);
        let mesh = uncolored(bake::low_poly_mesh(scene)?, options, warnings)?;
        Ok(Taken { mesh, material, kept })
    }
}

/// The content of a file with a mesh.
pub(super) struct Read {
    pub scene: Scene,
    /// The way in which it moves, where it does.
    pub moving: Option<&'static str>,
}

/// Reads a mesh that is given.
pub(super) fn read(source: &MeshSource, limits: &Limits, warnings: &mut Warnings) -> Result<Read> {
    match source {
        MeshSource::Mesh(mesh) => {
            let scene = Scene::of_mesh(Mesh::clone(mesh), Material::default())?;
            check_extent(&scene, "the low-poly mesh").map(|()| Read { scene, moving: None })
        }
        MeshSource::File(path) => {
            let loaded = io::load_model_within(path, limits)?;
            warnings.absorb(loaded.warnings);
            check_extent(&loaded.scene, &path.display().to_string())?;
            Ok(Read { scene: loaded.scene, moving: loaded.moving })
        }
    }
}

fn moves(path: &Path, moving: &str) -> Error {
    Error::unsupported(
        format!("{}: a low-poly mesh with {moving}", path.display()),
        "an asset keeps no motion; save the mesh at rest without it, bake onto that, and give the maps to the moving one",
    )
}

/// Leaves out the normal map, which is of other tangents.
fn leave_relief(material: &Material, options: &BakeOptions, warnings: &mut Warnings) {
    let has_relief = material.normal.is_some() && !options.bakes(&[MapKind::Normal]);
    warnings.note(
        "the low-poly mesh's normal map is left out; bake normal in its place",
        usize::from(has_relief),
    );
}

/// Leaves out alpha that stands in a texture in whose place colours without alpha are baked.
fn leave_alpha(material: &mut Material, options: &BakeOptions, warnings: &mut Warnings) {
    let is_textured = material.alpha != AlphaMode::Opaque && material.base_color_texture.is_some();
    if is_textured && options.bakes(&[MapKind::Albedo]) && !options.bakes(&[MapKind::Alpha]) {
        warnings.note("the low-poly mesh's alpha is left out: albedo is baked without", 1);
        material.alpha = AlphaMode::Opaque;
    }
}

/// Leaves out colours of vertices that would be multiplied with the baked ones.
fn uncolored(mesh: Mesh, options: &BakeOptions, warnings: &mut Warnings) -> Result<Mesh> {
    if mesh.colors().is_empty() || !options.bakes(&[MapKind::Albedo]) {
        return Ok(mesh);
    }
    warnings.note("the low-poly mesh's vertex colours are left out: albedo is baked in their place", 1);
    Mesh::new(MeshData { colors: Vec::new(), ..mesh.into_data() })
}
