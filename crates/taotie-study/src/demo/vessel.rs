//! The vessel shown in all files of the demo.

use crate::jue;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::Scene;

/// The jue with its relief as a tangent-space map, and the same with an object-space map.
pub struct Vessel {
    mesh: Mesh,
    scene: Scene,
    object_scene: Scene,
}

impl Vessel {
    /// Creates the vessel with maps of `size` × `size` texels; see [`jue::height_map`] for the range.
    pub fn new(size: u32) -> Self {
        let scene = jue::scene(size);
        Self { mesh: jue::low_mesh(), object_scene: jue::with_object_map(&scene, size), scene }
    }

    /// Returns the low mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the scene made by [`jue::scene`].
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the scene with its relief as an object-space map.
    pub fn object_scene(&self) -> &Scene {
        &self.object_scene
    }
}
