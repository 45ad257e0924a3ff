//! World-space geometry, tangents and shadows: what does not change with the camera.

use super::SurfaceSettings;
use super::reference::Surfaces;
use super::shadows::ShadowCasters;
use crate::error::{Error, Result, Warnings};
use crate::math::{Mat4, Vec3, scalar};
use crate::mesh::Mesh;
use crate::names::Named;
use crate::scene::{AlphaMode, Bounds, HeightMap, Instance, Material, NormalMap, NormalSpace, Scene};
use crate::surface::{self, SurfaceMethod};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

/// A scene made ready for pictures from any camera.
pub struct Prepared<'a> {
    pub(super) scene: &'a Scene,
    pub(super) draws: Vec<Draw<'a>>,
    casters: OnceLock<ShadowCasters>,
    surfaces: OnceLock<Surfaces>,
    bounds: OnceLock<Option<Bounds>>,
    warnings: Warnings,
}

/// A mesh in the world with one material.
pub(super) struct Draw<'a> {
    /// The scene's own where it lacks nothing.
    pub mesh: Arc<Cow<'a, Mesh>>,
    pub material: &'a Material,
    /// The number of its first triangle over all draws.
    pub first_triangle: u32,
    pub normal_source: NormalSource<'a>,
    /// World space; the mesh's own where nothing moves it.
    pub positions: Cow<'a, [Vec3]>,
    /// Unit, world space.
    pub normals: Vec<Vec3>,
    /// Unit, world space, with handedness; empty unless a tangent-space map or a direction is read.
    pub tangents: Vec<[f32; 4]>,
    /// Takes object-space normals to world space, keeping the length of uniformly scaled ones.
    pub normal_matrix: [Vec3; 3],
    /// Whether the transform turns counter-clockwise triangles into clockwise ones.
    pub mirrored: bool,
}

/// Where the shading normals of a draw come from.
#[derive(Debug, Clone, Copy)]
pub(super) enum NormalSource<'a> {
    Facet,
    Smooth,
    /// With the height of 1 in model units.
    Bump(&'a HeightMap, f32),
    /// With the paper's factor.
    BumpPrinted(&'a HeightMap, f32),
    ObjectMap(&'a NormalMap),
    TangentMap(&'a NormalMap),
}

/// The paper's smaller bump factor.
const PRINTED_BUMP: f32 = 5.0;

impl<'a> Prepared<'a> {
    /// Transforms vertices to world space and makes the normals and tangents that are lacking.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the scene draws no triangle or a mesh cannot be given tangents; [`Error::Limit`] beyond 2^32 − 2 triangles.
    pub fn new(scene: &'a Scene, settings: &SurfaceSettings) -> Result<Self> {
        let total = scene.triangle_count();
        if total == 0 {
            return Err(Error::invalid("scene", "there is no triangle to draw"));
        }
        if total >= u32::MAX as usize {
            return Err(Error::limit(format!("{total} triangles"), "at most 2^32 - 2"));
        }
        let mut preparation =
            Preparation { scene, settings, meshes: HashMap::new(), warnings: Warnings::default() };
        let mut draws: Vec<Draw<'a>> = Vec::with_capacity(scene.instances().len());
        let mut first_triangle = 0;
        for instance in scene.instances() {
            let draw = preparation.draw(instance, first_triangle)?;
            first_triangle += draw.mesh.triangles().len() as u32;
            draws.push(draw);
        }
        Ok(Self {
            scene,
            draws,
            casters: OnceLock::new(),
            surfaces: OnceLock::new(),
            bounds: OnceLock::new(),
            warnings: preparation.warnings,
        })
    }

    /// What could not be drawn as asked.
    pub fn warnings(&self) -> &Warnings {
        &self.warnings
    }

    /// The draw that a triangle belongs to.
    pub(super) fn draw_of(&self, triangle: u32) -> usize {
        self.draws.partition_point(|draw| draw.first_triangle <= triangle) - 1
    }

    /// All triangles that cast shadows, sorted for rays; made when first asked for. Blended surfaces cast none.
    pub(super) fn casters(&self) -> &ShadowCasters {
        self.casters.get_or_init(|| ShadowCasters::new(&self.draws))
    }

    /// The box around all triangles; measured when first asked for.
    pub(super) fn bounds(&self) -> Option<Bounds> {
        *self.bounds.get_or_init(|| self.scene.bounds())
    }

    /// All triangles, sorted for rays; made when first asked for.
    pub(super) fn surfaces(&self) -> &Surfaces {
        self.surfaces.get_or_init(|| Surfaces::new(&self.draws))
    }
}

/// What preparing needs to remember from one instance to the next.
struct Preparation<'a, 'b> {
    scene: &'a Scene,
    settings: &'b SurfaceSettings,
    /// Meshes with what was lacking, by mesh and the uv set that tangents follow.
    meshes: HashMap<(usize, Option<usize>), Arc<Cow<'a, Mesh>>>,
    warnings: Warnings,
}

impl<'a> Preparation<'a, '_> {
    fn draw(&mut self, instance: &Instance, first_triangle: u32) -> Result<Draw<'a>> {
        let m = instance.world_from_object;
        let material = &self.scene.materials()[instance.material];
        let mut normal_source = self.normal_source(material);
        if self.lacks_uvs(instance.mesh, &normal_source) {
            normal_source = NormalSource::Smooth;
        }
        let tangent_set = match normal_source {
            NormalSource::TangentMap(map) => Some(map.texture.uv_set),
            _ => self.layers_set(instance.mesh, material),
        };
        let mesh = self.mesh(instance.mesh, tangent_set)?;
        let mut draw = Draw::new(mesh, material, first_triangle, normal_source, m);
        if tangent_set.is_some() {
            draw.tangents = world_tangents(&draw.mesh, &m, draw.mirrored);
        }
        Ok(draw)
    }

    /// The method asked for, as far as the material has what it needs.
    fn normal_source(&mut self, material: &'a Material) -> NormalSource<'a> {
        let best = match (&material.normal, &material.height) {
            (Some(map), _) if map.space == NormalSpace::Object => SurfaceMethod::ObjectNormal,
            (Some(_), _) => SurfaceMethod::TangentNormal,
            (None, Some(_)) => SurfaceMethod::Bump,
            (None, None) => SurfaceMethod::Smooth,
        };
        let method = self.settings.method.unwrap_or(best);
        let map = |space| material.normal.as_ref().filter(|map| map.space == space);
        let found = match method {
            SurfaceMethod::Facet => Some(NormalSource::Facet),
            SurfaceMethod::Smooth => Some(NormalSource::Smooth),
            SurfaceMethod::Bump => material
                .height
                .as_ref()
                .map(|height| NormalSource::Bump(height, self.settings.bump_scale.unwrap_or(height.scale))),
            SurfaceMethod::BumpPrinted => material.height.as_ref().map(|height| {
                NormalSource::BumpPrinted(height, self.settings.bump_scale.unwrap_or(PRINTED_BUMP))
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

    /// The uv set that the layers' tangents follow, where a layer has a direction and the mesh that uv set.
    fn layers_set(&mut self, mesh: usize, material: &Material) -> Option<usize> {
        let coat = material.clearcoat.as_ref().and_then(|coat| coat.normal.as_ref());
        let stretch = material.anisotropy.as_ref();
        let set = match (coat, stretch) {
            (Some(map), _) => map.texture.uv_set,
            (None, Some(stretch)) => stretch.texture.as_ref().map_or(0, |texture| texture.uv_set),
            (None, None) => return None,
        };
        let lacks = set >= self.scene.meshes()[mesh].uvs().len();
        let what = "meshes without the uv set of their lacquer's normals or of their anisotropy: drawn without direction";
        self.warnings.note(what, usize::from(lacks));
        (!lacks).then_some(set)
    }

    fn lacks_uvs(&mut self, mesh: usize, source: &NormalSource<'_>) -> bool {
        let texture = match source {
            NormalSource::Facet | NormalSource::Smooth => return false,
            NormalSource::Bump(map, _) | NormalSource::BumpPrinted(map, _) => &map.texture,
            NormalSource::ObjectMap(map) | NormalSource::TangentMap(map) => &map.texture,
        };
        let lacks = texture.uv_set >= self.scene.meshes()[mesh].uvs().len();
        self.warnings.note(
            "meshes without the uv set of their normal or height map: drawn smooth",
            usize::from(lacks),
        );
        lacks
    }

    /// The mesh with normals, and with tangents along `tangent_set` where that is asked for.
    fn mesh(&mut self, index: usize, tangent_set: Option<usize>) -> Result<Arc<Cow<'a, Mesh>>> {
        if let Some(mesh) = self.meshes.get(&(index, tangent_set)) {
            return Ok(mesh.clone());
        }
        let mesh = &self.scene.meshes()[index];
        let mesh = match tangent_set {
            None => surface::with_normals(mesh)?,
            Some(uv_set) => {
                let (mesh, without_area) = surface::with_frames(mesh, uv_set, self.settings.tangents)?;
                self.warnings.note(surface::NO_UV_AREA, without_area);
                mesh
            }
        };
        let mesh = Arc::new(mesh);
        self.meshes.insert((index, tangent_set), mesh.clone());
        Ok(mesh)
    }
}

impl<'a> Draw<'a> {
    fn new(
        mesh: Arc<Cow<'a, Mesh>>,
        material: &'a Material,
        first_triangle: u32,
        normal_source: NormalSource<'a>,
        m: Mat4,
    ) -> Self {
        let normal_matrix = uniform_normal_matrix(&m);
        let mirrored = m.determinant3() < 0.0;
        let positions = match &*mesh {
            Cow::Borrowed(mesh) if m == Mat4::IDENTITY => Cow::Borrowed(mesh.positions()),
            _ => mesh.positions().iter().map(|p| m.transform_point(p.to_f64()).to_f32()).collect(),
        };
        let normals: Vec<Vec3> = mesh.normals().iter().map(|n| unit(apply(&normal_matrix, *n))).collect();
        Self {
            mesh,
            material,
            first_triangle,
            normal_source,
            positions,
            normals,
            tangents: Vec::new(),
            normal_matrix,
            mirrored,
        }
    }

    /// The numbers of its triangles over all draws.
    pub(super) fn numbers(&self) -> std::ops::Range<u32> {
        self.first_triangle..self.first_triangle + self.mesh.triangles().len() as u32
    }

    /// Whether parts of the surface may be missing, so that visibility must ask the material.
    pub(super) fn layered(&self) -> bool {
        self.material.alpha != AlphaMode::Opaque
    }
}

/// Mirroring turns the cross product of normal and tangent round, so handedness turns with it.
fn world_tangents(mesh: &Mesh, m: &Mat4, mirrored: bool) -> Vec<[f32; 4]> {
    let sign = if mirrored { -1.0 } else { 1.0 };
    let turn = |[x, y, z, w]: &[f32; 4]| {
        let t = unit(m.transform_vector(Vec3::new(*x, *y, *z).to_f64()).to_f32());
        [t.x, t.y, t.z, w * sign]
    };
    mesh.tangents().iter().map(turn).collect()
}

fn uniform_normal_matrix(m: &Mat4) -> [Vec3; 3] {
    let cofactors = m.normal_matrix();
    let size = scalar::pow(cofactors.determinant3().abs(), 1.0 / 3.0);
    let scale = if size > 0.0 { 1.0 / size } else { 1.0 };
    [0, 1, 2].map(|j| (cofactors.axis(j) * scale).to_f32())
}

fn apply([x, y, z]: &[Vec3; 3], v: Vec3) -> Vec3 {
    *x * v.x + *y * v.y + *z * v.z
}

fn unit(v: Vec3) -> Vec3 {
    v.normalize_or(Vec3::new(0.0, 0.0, 1.0))
}
