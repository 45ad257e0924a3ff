//! The memory that a bake will take, estimated before it begins.

use super::options::BakeOptions;
use crate::bake::{MapKind, Maps};
use crate::error::{Error, Result};
use crate::image::Texture;
use crate::io::{Bytes, Limits};
use crate::math::Mat4;
use crate::mesh::Mesh;
use crate::scene::Scene;

/// The number of triangles and vertices of a scan, and the maps that its materials need.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, ScanSize};
///
/// let baker = Baker::new(BakeOptions::default());
/// let size = |triangles| ScanSize { triangles, vertices: triangles / 2, ..ScanSize::default() };
/// let need = |triangles: u64| baker.need(size(triangles)).bytes();
/// assert!(need(20_000_000) > need(1_000_000));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ScanSize {
    /// Triangles, over all instances.
    pub triangles: u64,
    /// Vertices, over all instances.
    pub vertices: u64,
    /// Bytes of all else: textures with their mip levels; uvs, tangents and colours of vertices; the meshes that several
    /// instances are joined from.
    #[cfg_attr(feature = "serde", serde(default))]
    pub beside: u64,
    /// The maps of what varies in its materials, which a bake carries where it is asked to.
    pub carries: Maps,
}

impl ScanSize {
    /// Measures a scene.
    pub(super) fn of(scene: &Scene, carries: Maps) -> Self {
        let instances = scene.instances().iter().map(|instance| &scene.meshes()[instance.mesh]);
        let textures: u64 = scene.textures().iter().map(texture_bytes).sum();
        Self {
            triangles: scene.triangle_count() as u64,
            vertices: instances.clone().map(|mesh| mesh.positions().len() as u64).sum(),
            beside: textures + instances.map(attribute_bytes).sum::<u64>() + source_bytes(scene),
            carries,
        }
    }

    /// Returns what the scan takes, sorted for rays.
    pub(super) fn bytes(self) -> u64 {
        /// Positions and normals.
        const VERTEX: u64 = 24;
        const TRIANGLE: u64 = 12;
        /// Corners, order and boxes of the tree.
        const TREE: u64 = 41;
        self.triangles * (TRIANGLE + TREE) + self.vertices * VERTEX + self.beside
    }
}

/// Returns the bytes of a texture with its mip levels.
fn texture_bytes(texture: &Texture) -> u64 {
    let level = |level| {
        let (width, height) = texture.level_size(level);
        u64::from(width) * u64::from(height)
    };
    let texels: u64 = (0..texture.levels()).map(level).sum();
    texels * 4 * u64::from(texture.bitmap().bits() / 8)
}

/// Returns the bytes of what vertices have beside position and normal.
fn attribute_bytes(mesh: &Mesh) -> u64 {
    let colors = if mesh.colors().is_empty() { 0 } else { 16 };
    // Tangents are made where there are uvs.
    let uvs = if mesh.uvs().is_empty() { 0 } else { 8 * mesh.uvs().len() as u64 + 16 };
    mesh.positions().len() as u64 * (uvs + colors)
}

/// Returns the bytes of the meshes that several instances, or moved ones, are joined from; 0 where one stays as it is.
fn source_bytes(scene: &Scene) -> u64 {
    let is_moved = scene.instances().iter().any(|instance| instance.world_from_object != Mat4::IDENTITY);
    if scene.instances().len() < 2 && !is_moved {
        return 0;
    }
    let mesh = |mesh: &Mesh| {
        24 * mesh.positions().len() as u64 + attribute_bytes(mesh) + 12 * mesh.triangles().len() as u64
    };
    scene.meshes().iter().map(mesh).sum()
}

/// The memory of a bake at its peak: the scan sorted for rays, simplification, maps.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, Bytes, Limits, ScanSize};
///
/// let baker = Baker::new(BakeOptions::default());
/// let size = ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() };
/// let need = baker.need(size);
/// assert!(need.simplifies && need.bytes() > Bytes(1 << 30));
/// assert!(need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Need {
    /// The size of the scan.
    pub scan: ScanSize,
    /// `true` where the low-poly mesh has to be made.
    pub simplifies: bool,
    /// `true` where the scan is inspected.
    pub inspects: bool,
    /// Texels of a map.
    pub texels: u64,
    /// Bytes a texel over all maps while they are made.
    pub texel_bytes: u64,
}

impl Need {
    pub(super) fn of(options: &BakeOptions, scan: ScanSize) -> Self {
        Self {
            scan,
            simplifies: options.low.is_none(),
            inspects: options.inspect,
            texels: options.map_size().map(u64::from).iter().product(),
            texel_bytes: texel_bytes(options, scan.carries),
        }
    }

    /// Returns the whole, scan included.
    pub fn bytes(&self) -> Bytes {
        /// Keys while the tree is sorted.
        const SORTING: u64 = 8;
        /// The memory of simplification for a triangle: joined vertices, blocks, and the half that is left of them.
        const SIMPLIFYING: u64 = 24;
        /// The scan's edges and triangles as they are sorted to find its faults.
        const INSPECTING: u64 = 40;
        /// The program itself, its threads' bands, and the low-poly mesh.
        const REST: u64 = 96 << 20;
        let simplifying = if self.simplifies { SIMPLIFYING } else { 0 };
        let inspecting = if self.inspects { INSPECTING } else { 0 };
        let beside = self.scan.triangles * SORTING.max(simplifying).max(inspecting);
        Bytes(self.scan.bytes() + beside.max(self.texels * self.texel_bytes) + REST)
    }

    /// Refuses what does not fit.
    ///
    /// # Errors
    /// [`Error::Limit`] where the limit is exceeded.
    pub fn check(&self, limits: Limits) -> Result<()> {
        match limits.memory {
            Some(limit) if self.bytes() > limit => Err(Error::limit(
                format!("a bake of {} triangles", self.scan.triangles),
                format!(
                    "it needs about {} of memory, the limit is {limit}; raise the memory limit, free memory, lower the \
                     maps' size, or bake fewer maps at once",
                    self.bytes()
                ),
            )),
            _ => Ok(()),
        }
    }
}

/// Bytes a texel over all maps: floats while they are baked, codes afterwards, and what filling takes.
fn texel_bytes(options: &BakeOptions, carries: Maps) -> u64 {
    let carried = carries.iter().filter(|_| options.carry);
    let maps: Maps = options.maps.iter().copied().chain(carried).collect();
    let floats = |map: MapKind| match map {
        MapKind::Normal | MapKind::Albedo | MapKind::Bent | MapKind::Emission => 12,
        MapKind::MetallicRoughness => 8,
        _ => 4,
    };
    let codes = 4 * u64::from(options.bits / 8);
    8 + maps.iter().map(|map| floats(map) + codes).sum::<u64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Texels};
    use crate::scene::Material;

    #[test]
    fn textures_and_instances_count() {
        let mesh = Mesh::sphere(1.0, 32, 16);
        let plain = Scene::of_mesh(mesh, Material::default()).unwrap();
        let measured = |scene: &Scene| ScanSize::of(scene, Maps::default());
        let one = measured(&plain);
        let mut textured = plain.clone();
        let bitmap = Bitmap::new(256, 256, 3, Texels::U8(vec![[9; 4]; 1 << 16])).unwrap();
        textured.add_texture(Texture::new(bitmap, Encoding::Srgb));
        let beside = measured(&textured).beside - one.beside;
        assert!((1 << 18..1 << 19).contains(&beside), "{beside}");
        let mut many = plain.clone();
        many.edit(|scene| scene.instances = vec![scene.instances[0]; 10]).unwrap();
        assert_eq!(measured(&many).vertices, 10 * one.vertices);
        assert!(measured(&many).bytes() > 10 * one.bytes());
    }

    #[test]
    fn what_does_not_fit_is_refused_with_both_numbers() {
        let need = Need {
            scan: ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() },
            simplifies: true,
            inspects: true,
            texels: 1 << 22,
            texel_bytes: 20,
        };
        assert!(need.bytes() < Bytes(4 << 30), "{}", need.bytes());
        let error =
            need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).unwrap_err().to_string();
        assert!(error.contains("20000000 triangles") && error.contains("1.0 GiB"), "{error}");
        assert!(need.check(Limits::default()).is_ok());
    }
}
