//! An asset as a viewer shows it, part by part, and the means to measure it.

use super::level_figures::{LevelSurface, PartSurface};
use super::scan::Scan;
use crate::bake::{Cage, ShownNormals, TexturedMesh, Verifier, framed_low_poly_mesh, low_poly_mesh};
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::scene::{NormalSpace, Scene};
use crate::surface::with_frames;
use std::path::Path;

/// The triangles of one material at a level of detail.
pub(super) struct Shown<'a> {
    pub mesh: Mesh,
    pub normal: Option<ShownNormals<'a>>,
    /// The same triangles with all that the file says of their material.
    pub material: TexturedMesh,
}

impl<'a> Shown<'a> {
    /// Takes all of a scene that was read from `path`, which shows one normal map.
    pub fn of(scene: &'a Scene, object_map: Option<ShownNormals<'a>>, path: &Path) -> Result<Self> {
        let Some(first) = scene.instances().first() else { return Err(empty(path)) };
        let normal = object_map.or(normal_map(scene, first.material));
        let material = TexturedMesh::new(scene.clone())?;
        // Triangles of several alpha modes are several meshes, whose order is that of the material's.
        let joined = match scene.instances() {
            [_] => low_poly_mesh(scene.clone())?,
            _ => material.mesh().clone(),
        };
        let mesh = with_frames(&joined, 0, None)?.0.into_owned();
        Ok(Self { mesh, normal, material })
    }

    /// Takes the triangles that show a material, without its normal map.
    pub fn of_material(scene: &'a Scene, material: usize, path: &Path) -> Result<Self> {
        let mut own = scene.clone();
        own.edit(|scene| scene.instances.retain(|instance| instance.material == material))?;
        if own.instances().is_empty() {
            return Err(empty(path));
        }
        let mesh = framed_low_poly_mesh(own.clone())?;
        Ok(Self { mesh, normal: None, material: TexturedMesh::new(own)? })
    }
}

fn empty(path: &Path) -> Error {
    Error::invalid(path.display().to_string(), "read back, it has no triangles")
}

/// Returns the normal map of a material.
pub(super) fn normal_map(scene: &Scene, material: usize) -> Option<ShownNormals<'_>> {
    let map = scene.materials().get(material)?.normal.as_ref()?;
    Some(ShownNormals {
        texture: &scene.textures()[map.texture.texture],
        space: NormalSpace::Tangent,
        sampler: map.texture.sampler,
    })
}

/// The triangles of one material, and the cage from which they are projected onto the scan.
pub(super) struct ShownPart<'a> {
    pub shown: Shown<'a>,
    pub cage: Cage,
}

/// The surfaces that are measured, and the means.
pub(super) struct Subject<'a> {
    /// At least one.
    pub parts: Vec<ShownPart<'a>>,
    /// The triangles of all of them; `None` where there is but one.
    pub whole: Option<Mesh>,
    pub scan: &'a Scan,
    /// `true` where the files say what their material is.
    pub has_material: bool,
}

impl Subject<'_> {
    /// Returns the surfaces of all parts.
    pub fn surface(&self) -> LevelSurface<'_> {
        LevelSurface {
            parts: self.parts.iter().map(|part| self.of_part(part)).collect(),
            whole: self.whole(),
        }
    }

    fn of_part<'s>(&'s self, part: &'s ShownPart<'_>) -> PartSurface<'s> {
        let Shown { mesh, normal, material } = &part.shown;
        let plain = Verifier { mesh, normal: None, cage: &part.cage, scan: self.scan.sorted() };
        let mapped = Verifier { normal: *normal, ..plain };
        let is_compared = self.has_material && !self.scan.about.is_plain;
        PartSurface { mapped, plain, material: is_compared.then_some(material) }
    }

    /// Returns all triangles, for distances alone.
    pub fn whole(&self) -> Verifier<'_> {
        let first = &self.parts[0];
        let mesh = self.whole.as_ref().unwrap_or(&first.shown.mesh);
        Verifier { mesh, normal: None, cage: &first.cage, scan: self.scan.sorted() }
    }
}
