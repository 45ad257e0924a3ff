//! World-space geometry, tangents and the tree of triangles: everything that does not depend on the camera.

use super::draw::Draws;
use super::placed::Placed;
use super::preparation::Preparation;
use super::settings::SurfaceSettings;
use super::tree::SceneTree;
use crate::error::{Error, Result, Warnings};
use crate::scene::{Bounds, Scene};
use crate::trace::Bvh;
use fearless_simd::Level;
use std::sync::{Arc, OnceLock};

/// The height above the surface at which shadow rays start, as a fraction of the scene's size.
const RAY_OFFSET: f64 = 1e-5;

/// A scene prepared for images from any camera. It owns its share of the scene and can be sent between threads.
pub struct Prepared {
    scene: Arc<Scene>,
    parts: Parts,
}

impl Prepared {
    /// Transforms vertices to world space and computes missing normals and tangents. A scene that is already shared
    /// is not copied.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scene has no triangles, a transform is not finite, or tangents of a mesh cannot be
    /// computed; [`Error::Limit`] beyond 2^32 − 2 triangles; [`Error::Unsupported`] for a SIMD level that the CPU
    /// lacks.
    pub fn new(scene: impl Into<Arc<Scene>>, settings: &SurfaceSettings) -> Result<Self> {
        let scene = scene.into();
        let parts = Parts::new(&scene, settings)?;
        Ok(Self { scene, parts })
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The warnings about parts that could not be drawn as requested.
    pub fn warnings(&self) -> &Warnings {
        &self.parts.warnings
    }

    /// All triangles sorted for rays, numbered through all [surfaces](Self::surfaces) in their order; sorted on first
    /// use.
    ///
    /// ```
    /// use taotie::mesh::Mesh;
    /// use taotie::render::{Prepared, SurfaceSettings};
    /// use taotie::scene::{Material, Scene};
    ///
    /// let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default())?;
    /// let prepared = Prepared::new(scene, &SurfaceSettings::default())?;
    /// assert_eq!(prepared.bvh().flat().order.len(), prepared.surfaces()[0].triangles.len());
    /// # Ok::<(), taotie::Error>(())
    /// ```
    pub fn bvh(&self) -> &Bvh {
        &self.ready().tree(0).0
    }

    /// The height above the surface at which shadow rays start, in model units.
    pub fn ray_offset(&self) -> f32 {
        self.ready().ray_offset()
    }

    pub(super) fn ready(&self) -> Ready<'_> {
        Ready { scene: &self.scene, parts: &self.parts }
    }
}

/// Returns the warnings about parts that cannot be drawn as requested, without drawing.
///
/// # Errors
/// As for [`Prepared::new`].
pub fn foreseen_warnings(scene: &Scene, settings: &SurfaceSettings) -> Result<Warnings> {
    Ok(Parts::new(scene, settings)?.warnings)
}

/// The data computed once from a scene.
pub(super) struct Parts {
    placed: Vec<Placed>,
    level: Level,
    tree: OnceLock<SceneTree>,
    bounds: OnceLock<Option<Bounds>>,
    warnings: Warnings,
}

impl Parts {
    /// Places all instances.
    ///
    /// # Errors
    /// As for [`Prepared::new`].
    pub(super) fn new(scene: &Scene, settings: &SurfaceSettings) -> Result<Self> {
        let total = scene.triangle_count();
        if total == 0 {
            return Err(Error::invalid("scene", "there are no triangles to draw"));
        }
        if total >= u32::MAX as usize {
            return Err(Error::limit(format!("a scene of {total} triangles"), "at most 2^32 - 2"));
        }
        let mut preparation = Preparation::new(scene, settings)?;
        let mut placed = Vec::with_capacity(scene.instances().len());
        let mut first_triangle = 0;
        for instance in scene.instances() {
            let one = preparation.place(instance, first_triangle)?;
            first_triangle += one.triangle_count(scene) as u32;
            placed.push(one);
        }
        Ok(Self {
            placed,
            level: settings.simd.dispatch()?,
            tree: OnceLock::new(),
            bounds: OnceLock::new(),
            warnings: preparation.warnings,
        })
    }
}

/// A scene with its prepared data.
#[derive(Clone, Copy)]
pub(super) struct Ready<'p> {
    pub scene: &'p Scene,
    pub parts: &'p Parts,
}

impl<'p> Ready<'p> {
    /// Its instances as seen by the stages.
    pub(super) fn draws(self) -> Draws<'p> {
        let Self { scene, parts } = self;
        Draws { scene, all: parts.placed.iter().map(|one| one.draw(scene)).collect() }
    }

    /// All triangles, sorted for at least `rays` rays; computed on first use.
    pub(super) fn tree(self, rays: u64) -> &'p SceneTree {
        self.parts.tree.get_or_init(|| SceneTree::new(&self.draws(), rays, self.parts.level))
    }

    /// The bounding box of all triangles; computed on first use.
    pub(super) fn bounds(self) -> Option<Bounds> {
        *self.parts.bounds.get_or_init(|| self.scene.bounds())
    }

    /// The height above the surface at which rays start, in model units.
    pub(super) fn ray_offset(self) -> f32 {
        let size = self.bounds().map_or(1.0, |bounds| bounds.diagonal());
        (size * RAY_OFFSET) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_can_be_kept_and_sent_anywhere() {
        fn assert_owned<T: Send + Sync + 'static>() {}
        assert_owned::<Prepared>();
    }
}
