//! Everything of a scene that does not depend on the camera: world-space geometry, the method of each surface's
//! shading normals, the normals and tangents that meshes lack, and the tree of triangles.

use super::draw::{Body, Draws, Placed, Placement, Surface};
use super::settings::SurfaceSettings;
use super::tree::SceneTree;
use crate::error::{Error, Result, Warnings};
use crate::names::Named;
use crate::pixel::NormalSource;
use crate::scene::{Bounds, Instance, Material, NormalSpace, Scene};
use crate::surface::{self, SurfaceMethod};
use crate::trace::Bvh;
use fearless_simd::Level;
use std::collections::HashMap;
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

    /// The surfaces, one for each instance of the scene, in the same order.
    ///
    /// ```
    /// use taotie_engine::mesh::Mesh;
    /// use taotie_engine::render::{Prepared, SurfaceSettings};
    /// use taotie_engine::scene::{Material, Scene};
    ///
    /// let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default())?;
    /// let prepared = Prepared::new(scene, &SurfaceSettings::default())?;
    /// let [sphere] = prepared.surfaces()[..] else { panic!("there is one instance") };
    /// assert_eq!(sphere.positions.len(), sphere.normals.len());
    /// # Ok::<(), taotie_engine::Error>(())
    /// ```
    pub fn surfaces(&self) -> Vec<Surface<'_>> {
        self.ready().draws().all.iter().map(Surface::of).collect()
    }

    /// All triangles sorted for rays, numbered through all [surfaces](Self::surfaces) in their order; sorted on first
    /// use.
    ///
    /// ```
    /// use taotie_engine::mesh::Mesh;
    /// use taotie_engine::render::{Prepared, SurfaceSettings};
    /// use taotie_engine::scene::{Material, Scene};
    ///
    /// let scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default())?;
    /// let prepared = Prepared::new(scene, &SurfaceSettings::default())?;
    /// assert_eq!(prepared.bvh().flat().order.len(), prepared.surfaces()[0].triangles.len());
    /// # Ok::<(), taotie_engine::Error>(())
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

/// Returns the warnings about parts that cannot be drawn as requested, without drawing or placing them.
///
/// # Errors
/// As for [`Prepared::new`].
pub fn foreseen_warnings(scene: &Scene, settings: &SurfaceSettings) -> Result<Warnings> {
    let mut preparation = Preparation::new(scene, settings)?;
    scene.instances().iter().try_for_each(|instance| preparation.look(instance).map(drop))?;
    Ok(preparation.warnings)
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

/// The default factor of `bump-printed`: the smaller one of Guo and Wang 2025.
pub const PRINTED_BUMP: f32 = 5.0;

/// The state kept from one instance to the next during preparation.
struct Preparation<'a> {
    scene: &'a Scene,
    settings: &'a SurfaceSettings,
    level: Level,
    /// Meshes with the missing data added, by mesh and the uv set of the tangents.
    bodies: HashMap<(usize, Option<usize>), Body>,
    warnings: Warnings,
}

/// The appearance of an instance, regardless of its place.
struct Look {
    body: Body,
    normal_source: NormalSource,
    takes_tangents: bool,
}

impl<'a> Preparation<'a> {
    /// Starts without instances.
    ///
    /// # Errors
    /// If the scene has no triangles or too many, or the SIMD level is not available on this machine.
    fn new(scene: &'a Scene, settings: &'a SurfaceSettings) -> Result<Self> {
        let total = scene.triangle_count();
        if total == 0 {
            return Err(Error::invalid("scene", "there are no triangles to draw"));
        }
        if total >= u32::MAX as usize {
            return Err(Error::limit(format!("a scene of {total} triangles"), "at most 2^32 - 2"));
        }
        let level = settings.simd.dispatch()?;
        Ok(Self { scene, settings, level, bodies: HashMap::new(), warnings: Warnings::default() })
    }

    /// Transforms an instance to world space and computes the data that it lacks.
    fn place(&mut self, instance: &Instance, first_triangle: u32) -> Result<Placed> {
        let Look { body, normal_source, takes_tangents } = self.look(instance)?;
        let placement = Placement {
            material: instance.material,
            first_triangle,
            normal_source,
            world_from_object: instance.world_from_object,
            takes_tangents,
        };
        Ok(Placed::new(self.scene, body, &placement))
    }

    /// Returns what an instance shows, with the data that its mesh lacks.
    fn look(&mut self, instance: &Instance) -> Result<Look> {
        if !instance.world_from_object.is_finite() {
            return Err(Error::invalid("an instance's transform", "it is infinite or NaN; fix the file"));
        }
        let material = &self.scene.materials()[instance.material];
        let mut normal_source = self.normal_source(material);
        if self.lacks_uvs(instance.mesh, &normal_source) {
            normal_source = NormalSource::Smooth;
        }
        let tangent_set = normal_source.tangent_set().or_else(|| self.layers_set(instance.mesh, material));
        let body = self.body(instance.mesh, tangent_set)?;
        Ok(Look { body, normal_source, takes_tangents: tangent_set.is_some() })
    }

    /// The requested method, if the material has the map that it needs.
    fn normal_source(&mut self, material: &Material) -> NormalSource {
        let method = self.settings.method.unwrap_or(NormalSource::best(material).method());
        let map = |space| material.normal.filter(|map| map.space == space);
        let found = match method {
            SurfaceMethod::Facet => Some(NormalSource::Facet),
            SurfaceMethod::Smooth => Some(NormalSource::Smooth),
            SurfaceMethod::Bump => material
                .height
                .as_ref()
                .map(|height| NormalSource::Bump(*height, self.settings.bump_scale.unwrap_or(height.scale))),
            SurfaceMethod::BumpPrinted => material.height.as_ref().map(|height| {
                NormalSource::BumpPrinted(*height, self.settings.bump_scale.unwrap_or(PRINTED_BUMP))
            }),
            SurfaceMethod::ObjectNormal => map(NormalSpace::Object).map(NormalSource::ObjectMap),
            SurfaceMethod::TangentNormal => map(NormalSpace::Tangent).map(NormalSource::TangentMap),
        };
        found.unwrap_or_else(|| {
            let what = format!("materials without the map that `{}` needs: drawn smooth", method.name());
            self.warnings.note(what, 1);
            NormalSource::Smooth
        })
    }

    /// The uv set that the layers' tangents follow, if a layer has a direction and the mesh has that uv set.
    fn layers_set(&mut self, mesh: usize, material: &Material) -> Option<usize> {
        let coat = material.clearcoat.as_ref().and_then(|coat| coat.normal.as_ref());
        let anisotropy = material.anisotropy.as_ref();
        let set = match (coat, anisotropy) {
            (Some(map), _) => map.texture.uv_set,
            (None, Some(anisotropy)) => anisotropy.texture.as_ref().map_or(0, |texture| texture.uv_set),
            (None, None) => return None,
        };
        let lacks = set >= self.scene.meshes()[mesh].uvs().len();
        let what =
            "meshes without the uv set of their clearcoat normals or anisotropy: drawn without direction";
        self.warnings.note(what, usize::from(lacks));
        (!lacks).then_some(set)
    }

    fn lacks_uvs(&mut self, mesh: usize, source: &NormalSource) -> bool {
        let lacks = source.uv_set().is_some_and(|set| set >= self.scene.meshes()[mesh].uvs().len());
        self.warnings.note(
            "meshes without the uv set of their normal or height map: drawn smooth",
            usize::from(lacks),
        );
        lacks
    }

    /// The mesh with normals, and with tangents along `tangent_set` if requested.
    fn body(&mut self, index: usize, tangent_set: Option<usize>) -> Result<Body> {
        if let Some(body) = self.bodies.get(&(index, tangent_set)) {
            return Ok(body.clone());
        }
        let mesh = &self.scene.meshes()[index];
        let made = match tangent_set {
            None => surface::with_normals_at(self.level, mesh)?,
            Some(uv_set) => {
                let (mesh, without_area) =
                    surface::with_frames_at(self.level, mesh, uv_set, self.settings.tangents)?;
                self.warnings.note(surface::NO_UV_AREA, without_area);
                mesh
            }
        };
        let body = Body::new(index, made);
        self.bodies.insert((index, tangent_set), body.clone());
        Ok(body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Mat4, Vec3};
    use crate::mesh::Mesh;

    #[test]
    fn it_can_be_kept_and_sent_anywhere() {
        fn assert_owned<T: Send + Sync + 'static>() {}
        assert_owned::<Prepared>();
    }

    #[test]
    fn every_instance_is_a_surface_in_the_world() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let mut mirror = Mat4::translation(Vec3::new(5.0, 0.0, 0.0));
        mirror.columns[1][1] = -1.0;
        let mirrored = Instance { mesh: 0, material: 0, world_from_object: mirror };
        scene.edit(|data| data.instances.push(mirrored)).unwrap();
        let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
        let surfaces = prepared.surfaces();
        assert_eq!(surfaces.iter().map(|s| s.mirrored).collect::<Vec<_>>(), [false, true]);
        for (i, p) in surfaces[0].positions.iter().enumerate() {
            let image = surfaces[1].positions[i];
            assert!((image - Vec3::new(p.x + 5.0, -p.y, p.z)).length() < 1e-6, "{p:?} {image:?}");
            let (n, turned) = (surfaces[0].normals[i], surfaces[1].normals[i]);
            assert!((turned - Vec3::new(n.x, -n.y, n.z)).length() < 1e-5, "{n:?} {turned:?}");
        }
    }
}
