//! The size of a scan, and the memory that its triangles and textures take.

use super::{detail, look};
use crate::bake::{Maps, lacks_tangents};
use crate::image::Texture;
use crate::mesh::Mesh;
use crate::scene::Scene;
use crate::surface::tangent_bytes;

/// The number of triangles and vertices of a scan, their attributes, and the maps that its materials need.
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct ScanSize {
    /// Triangles, over all instances.
    pub triangles: u64,
    /// Vertices, over all instances.
    pub vertices: u64,
    /// Bytes of vertex attributes other than positions and normals: uvs, tangents and colours.
    pub attribute_bytes: u64,
    /// Bytes of its textures with their mip chains.
    pub texture_bytes: u64,
    /// Triangles of the largest mesh that gets tangents, because a normal map needs them and its file has none.
    pub framed_triangles: u64,
    /// Vertices of that mesh.
    pub framed_vertices: u64,
    /// The maps of properties that vary in its materials, which a bake carries over if requested.
    pub carries: Maps,
    /// The side of the smallest square map, a power of two, that preserves its detail; see
    /// [`AUTO_SIZE`](super::AUTO_SIZE).
    pub detail_side: u32,
    /// `true` if it specifies a material, so that images in full material are compared too.
    pub has_material: bool,
}

impl ScanSize {
    /// Counts the contents of a scene.
    pub(super) fn of(scene: &Scene, carries: Maps) -> Self {
        let (meshes, lacks) = (scene.meshes(), lacks_tangents(scene));
        let framed = meshes.iter().zip(&lacks).filter(|(_, lacks)| **lacks).map(|(mesh, _)| mesh);
        let largest = framed.max_by_key(|mesh| mesh.triangles().len());
        let shown = || scene.instances().iter().map(|instance| instance.mesh);
        let made = |mesh: usize| if lacks[mesh] { vertices(&meshes[mesh]) * TANGENT } else { 0 };
        Self {
            triangles: scene.triangle_count() as u64,
            vertices: shown().map(|mesh| vertices(&meshes[mesh])).sum(),
            attribute_bytes: shown().map(|mesh| attribute_bytes(&meshes[mesh]) + made(mesh)).sum(),
            texture_bytes: scene.textures().iter().map(Texture::bytes).sum(),
            framed_triangles: largest.map_or(0, |mesh| mesh.triangles().len() as u64),
            framed_vertices: largest.map_or(0, vertices),
            carries,
            detail_side: detail::map_side(scene),
            has_material: !look::is_plain(scene),
        }
    }

    /// Returns the size with additional vertices, which have normals and positions, and may have uvs and colours.
    pub(super) fn with_vertices_added(self, added: u64) -> Self {
        let attributes = self.attribute_bytes.div_ceil(self.vertices.max(1));
        Self {
            vertices: self.vertices + added,
            attribute_bytes: self.attribute_bytes + added * attributes,
            ..self
        }
    }

    /// Returns the bytes of the scan, sorted for rays.
    pub(super) fn bytes(self) -> u64 {
        /// The corners, order and boxes of the tree.
        const TREE: u64 = 41;
        self.mesh_bytes() + self.triangles * TREE
    }

    /// Returns the peak bytes of the scan while its tangents are computed, which is before it is merged; 0 if none
    /// are.
    pub(super) fn framing_bytes(self) -> u64 {
        match self.framed_triangles {
            0 => 0,
            triangles => self.mesh_bytes() + tangent_bytes(triangles, self.framed_vertices),
        }
    }

    /// Returns the bytes of the scan while it is rendered: its tree is freed, and its triangles are placed.
    pub(super) fn viewing_bytes(self) -> u64 {
        const PLACED_VERTEX: u64 = 72;
        const PLACED_TRIANGLE: u64 = 60;
        self.mesh_bytes() + self.vertices * PLACED_VERTEX + self.triangles * PLACED_TRIANGLE
    }

    /// Returns the size without the cost of computing tangents: they exist once it is merged.
    pub(super) fn joined(self) -> Self {
        Self { framed_triangles: 0, framed_vertices: 0, ..self }
    }

    /// Returns the bytes of the scan as one mesh, before it is sorted for rays.
    pub(super) fn mesh_bytes(self) -> u64 {
        /// Position and normal.
        const VERTEX: u64 = 24;
        const TRIANGLE: u64 = 12;
        self.triangles * TRIANGLE + self.vertices * VERTEX + self.attribute_bytes + self.texture_bytes
    }
}

/// Bytes of a tangent.
const TANGENT: u64 = 16;

fn vertices(mesh: &Mesh) -> u64 {
    mesh.positions().len() as u64
}

/// Returns the bytes of a mesh's uvs, tangents and colours.
fn attribute_bytes(mesh: &Mesh) -> u64 {
    const UV: u64 = 8;
    const COLOR: u64 = 16;
    let [uvs, tangents, colors] =
        [mesh.uvs().iter().map(Vec::len).sum(), mesh.tangents().len(), mesh.colors().len()];
    uvs as u64 * UV + tangents as u64 * TANGENT + colors as u64 * COLOR
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Sampler, Texels};
    use crate::math::Mat4;
    use crate::scene::{
        GreenChannel, Instance, Material, NormalMap, NormalSpace, SceneData, TextureRef, UvTransform,
    };

    /// Two instances of a ball without tangents under a normal map of 4×2 texels.
    fn scene(space: NormalSpace, tangents: bool) -> Scene {
        let mut data = Mesh::sphere(1.0, 8, 4).into_data();
        let count = data.positions.len();
        data.tangents = if tangents { vec![[1.0, 0.0, 0.0, 1.0]; count] } else { Vec::new() };
        data.colors.clear();
        let texture = TextureRef {
            texture: 0,
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        };
        let normal = NormalMap { texture, scale: 1.0, space, green: GreenChannel::Up };
        let bitmap = Bitmap::new(4, 2, 3, Texels::U8(vec![[128, 128, 255, 255]; 8])).unwrap();
        let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
        Scene::new(SceneData {
            meshes: vec![Mesh::new(data).unwrap()],
            materials: vec![Material { normal: Some(normal), ..Material::default() }],
            textures: vec![Texture::new(bitmap, Encoding::Linear)],
            instances: vec![instance; 2],
            ..SceneData::default()
        })
        .unwrap()
    }

    #[test]
    fn tangents_count_where_they_are_made() {
        let of = |space, tangents| ScanSize::of(&scene(space, tangents), Maps::default());
        let made = of(NormalSpace::Tangent, false);
        assert_eq!((made.triangles, made.framed_triangles), (2 * made.framed_triangles, 48));
        assert_eq!(made.vertices, 2 * made.framed_vertices, "each instance gets its own vertices");
        assert_eq!(made.attribute_bytes, made.vertices * (8 + 16), "uvs and tangents");
        let framing = made.framing_bytes();
        assert!(framing > 300 * made.framed_triangles + made.mesh_bytes(), "{framing}");
        assert_eq!(made.joined().framing_bytes(), 0);
        assert_eq!(made.joined().bytes(), made.bytes());
        let there = of(NormalSpace::Tangent, true);
        assert_eq!((there.framing_bytes(), there.attribute_bytes), (0, made.attribute_bytes));
        let object = of(NormalSpace::Object, false);
        assert_eq!((object.framing_bytes(), object.attribute_bytes), (0, object.vertices * 8));
    }

    #[test]
    fn textures_count_with_their_levels() {
        let size = ScanSize::of(&scene(NormalSpace::Object, false), Maps::default());
        assert_eq!(size.texture_bytes, (4 * 2 + 2 + 1) * 4);
        assert_eq!(size.bytes() - ScanSize { texture_bytes: 0, ..size }.bytes(), size.texture_bytes);
    }
}
