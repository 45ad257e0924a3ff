//! Prepares a scene's instances for images: the method of their shading normals, and the data that their meshes lack.

use super::placed::{Body, Placed, Placement};
use super::settings::SurfaceSettings;
use crate::error::{Error, Result, Warnings};
use crate::names::Named;
use crate::pixel::NormalSource;
use crate::scene::{Instance, Material, NormalSpace, Scene};
use crate::surface::{self, SurfaceMethod};
use fearless_simd::Level;
use std::collections::HashMap;

/// The default factor of `bump-printed`: the smaller one of Guo and Wang 2025.
pub const PRINTED_BUMP: f32 = 5.0;

/// The state kept from one instance to the next during preparation.
pub(super) struct Preparation<'a> {
    scene: &'a Scene,
    settings: &'a SurfaceSettings,
    level: Level,
    /// Meshes with the missing data added, by mesh and the uv set of the tangents.
    bodies: HashMap<(usize, Option<usize>), Body>,
    pub warnings: Warnings,
}

impl<'a> Preparation<'a> {
    /// Starts without instances.
    ///
    /// # Errors
    /// If the SIMD level is not available on this machine.
    pub(super) fn new(scene: &'a Scene, settings: &'a SurfaceSettings) -> Result<Self> {
        let level = settings.simd.dispatch()?;
        Ok(Self { scene, settings, level, bodies: HashMap::new(), warnings: Warnings::default() })
    }

    /// Transforms an instance to world space and computes the data that it lacks.
    pub(super) fn place(&mut self, instance: &Instance, first_triangle: u32) -> Result<Placed> {
        let m = instance.world_from_object;
        if !m.is_finite() {
            return Err(Error::invalid("an instance's transform", "it is infinite or NaN; fix the file"));
        }
        let material = &self.scene.materials()[instance.material];
        let mut normal_source = self.normal_source(material);
        if self.lacks_uvs(instance.mesh, &normal_source) {
            normal_source = NormalSource::Smooth;
        }
        let tangent_set = normal_source.tangent_set().or_else(|| self.layers_set(instance.mesh, material));
        let body = self.body(instance.mesh, tangent_set)?;
        let placement = Placement {
            material: instance.material,
            first_triangle,
            normal_source,
            world_from_object: m,
            takes_tangents: tangent_set.is_some(),
        };
        Ok(Placed::new(self.scene, body, &placement))
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
