//! The parts of a scene and their validation.

use super::{Camera, Light, Material};
use crate::error::{Error, Result};
use crate::image::Texture;
use crate::math::Mat4;
use crate::mesh::Mesh;

/// The parts of a [`super::Scene`].
#[derive(Debug, Clone, Default)]
pub struct SceneData {
    /// The meshes, object space.
    pub meshes: Vec<Mesh>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The textures that materials refer to by index.
    pub textures: Vec<Texture>,
    /// Meshes placed in the world.
    pub instances: Vec<Instance>,
    /// The lights of the file, world space.
    pub lights: Vec<Light>,
    /// The cameras of the file, world space.
    pub cameras: Vec<Camera>,
}

/// A mesh placed in the world with a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into [`SceneData::meshes`].
    pub mesh: usize,
    /// Index into [`SceneData::materials`].
    pub material: usize,
    /// The transform from object space to world space; finite.
    pub world_from_object: Mat4,
}

impl SceneData {
    /// Checks that it forms a valid scene. Takes time for instances, materials and cameras, but not for the arrays of
    /// meshes, which are already validated.
    ///
    /// # Errors
    /// As [`super::Scene::new`].
    pub fn check(&self) -> Result<()> {
        for (i, instance) in self.instances.iter().enumerate() {
            self.check_instance(&format_args!("instance {i}"), instance)?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            material
                .check(self.textures.len())
                .map_err(|why| Error::invalid(format!("material {i} '{}'", material.name), why))?;
        }
        let unplaced = self.cameras.iter().position(|camera| !camera.world_from_view.is_finite());
        unplaced.map_or(Ok(()), |i| Err(Error::invalid(format!("the transform of camera {i}"), NOT_FINITE)))
    }

    fn check_instance(&self, at: &dyn std::fmt::Display, instance: &Instance) -> Result<()> {
        in_range(at, "mesh", instance.mesh, self.meshes.len())?;
        in_range(at, "material", instance.material, self.materials.len())?;
        match instance.world_from_object.is_finite() {
            true => Ok(()),
            false => Err(Error::invalid(format!("the transform of {at}"), NOT_FINITE)),
        }
    }
}

const NOT_FINITE: &str = "it is infinite or NaN; fix the file";

fn in_range(at: &dyn std::fmt::Display, what: &str, index: usize, count: usize) -> Result<()> {
    match index < count {
        true => Ok(()),
        false => {
            Err(Error::invalid(at.to_string(), format!("it refers to {what} {index}, but there are {count}")))
        }
    }
}
