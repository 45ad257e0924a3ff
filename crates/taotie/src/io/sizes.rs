//! The size of a glTF file by content, and the GPU memory that the content needs.

/// The bytes of a glTF file by content.
///
/// ```
/// use taotie::io::{self, GltfSizes, GltfSource, Limits};
/// use taotie::mesh::Mesh;
/// use taotie::scene::{Material, Scene};
/// use taotie::Warnings;
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let vertices = ball.meshes()[0].positions().len() as u64;
/// let file = io::encode_scene(&ball, &[], &mut Warnings::default())?;
/// let sizes = GltfSizes::read(GltfSource::Glb(&file), &Limits::default())?;
/// let positions = sizes.attributes.iter().find(|size| size.name == "POSITION").expect("every mesh has positions");
/// assert_eq!((positions.bytes, positions.gpu_bytes), (vertices * 12, vertices * 12));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct GltfSizes {
    /// Bytes of the JSON, without the content of data URIs.
    pub json: u64,
    /// Vertex attributes by name, in alphabetical order. Morph targets are one entry, `morph targets`; so are primitives
    /// compressed by Draco, `Draco`.
    pub attributes: Vec<ContentSize>,
    /// Index buffers.
    pub indices: ContentSize,
    /// Images, in the order of the file.
    pub images: Vec<ImageSize>,
    /// Bytes of animations and skins.
    pub animations: u64,
    /// Bytes of buffers that contain none of these: instance transforms, unused data, padding.
    pub other: u64,
    /// GPU memory for vertices, indices and textures, in bytes. A viewer may use more, such as copies of textures
    /// with other samplers.
    pub gpu_bytes: u64,
}

/// The size of one kind of content.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContentSize {
    /// The name of a vertex attribute, such as `POSITION`, or `indices`.
    pub name: String,
    /// Bytes in the file, as compressed.
    pub bytes: u64,
    /// GPU memory in bytes: uncompressed, each element a multiple of four bytes.
    pub gpu_bytes: u64,
}

/// The size of an image.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImageSize {
    /// Its file, else its name, else its index.
    pub name: String,
    /// The media type found in its content, such as `image/png`; empty if unknown.
    pub media_type: String,
    /// Texels across; 0 if unknown.
    pub width: u32,
    /// Texels down; 0 if unknown.
    pub height: u32,
    /// Bytes in the file.
    pub bytes: u64,
    /// GPU memory in bytes with all mip levels: four per texel, one per texel of KTX2 (BC7, ASTC 4×4); 0 if no
    /// texture uses it.
    pub gpu_bytes: u64,
}

impl GltfSizes {
    /// Returns it with the total GPU memory of its parts filled in.
    pub(super) fn summed(self) -> Self {
        let vertices = self.attributes.iter().chain([&self.indices]).map(|size| size.gpu_bytes);
        let all = vertices.chain(self.images.iter().map(|image| image.gpu_bytes));
        Self { gpu_bytes: all.fold(0, u64::saturating_add), ..self }
    }

    /// Returns the sum of the bytes of all content.
    pub fn bytes(&self) -> u64 {
        let vertices = self.attributes.iter().chain([&self.indices]).map(|size| size.bytes);
        let all = vertices.chain(self.images.iter().map(|image| image.bytes));
        all.chain([self.json, self.animations, self.other]).fold(0, u64::saturating_add)
    }
}

impl ImageSize {
    /// Returns the GPU memory in bytes of an image of this size, with all mip levels.
    pub fn on_gpu(size: [u32; 2], is_block_compressed: bool) -> u64 {
        let [mut width, mut height] = size.map(u64::from);
        let mut bytes: u64 = 0;
        while width > 0 && height > 0 {
            let texels = match is_block_compressed {
                // 16 bytes per block of 4×4 texels.
                true => (width.div_ceil(4) * height.div_ceil(4)).saturating_mul(16),
                false => (width * height).saturating_mul(4),
            };
            bytes = bytes.saturating_add(texels);
            if width == 1 && height == 1 {
                break;
            }
            [width, height] = [width, height].map(|side| (side / 2).max(1));
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mip_levels_count() {
        assert_eq!(ImageSize::on_gpu([4, 2], false), (8 + 2 + 1) * 4);
        assert_eq!(ImageSize::on_gpu([1024, 1024], false), 5_592_404);
        assert_eq!(ImageSize::on_gpu([8, 8], true), (4 + 1 + 1 + 1) * 16);
        assert_eq!(ImageSize::on_gpu([0, 8], false), 0);
        assert_eq!([true, false].map(|is| ImageSize::on_gpu([u32::MAX; 2], is)), [u64::MAX; 2]);
    }
}
