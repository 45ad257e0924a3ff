//! The buffers, textures and vertex values that a host binds to a pixel shader.

use serde::Serialize;

/// The inputs of a [`PixelShader`](crate::PixelShader): what its host binds.
///
/// Group 0 belongs to the frame, group 1 to the surface. In GLSL ES, which has no groups, buffers are uniform blocks
/// named [`BufferSlot::block`], and a texture with its sampler is one `sampler2D` with the texture's name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Interface {
    /// The values of each vertex.
    pub vertex: Vec<VertexInput>,
    /// The fields of group 0, binding 0: the same for every shader.
    pub frame: Vec<UniformField>,
    /// The fields of group 1, binding 0: those read by this shader.
    pub material: Vec<UniformField>,
    /// The buffers read by this shader.
    pub buffers: Vec<BufferSlot>,
    /// The textures read by this shader.
    pub textures: Vec<TextureSlot>,
}

/// The type of a value that a host passes; its numbers are `f32`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ValueKind {
    /// One number.
    Number,
    /// Two numbers.
    Vec2,
    /// Three numbers.
    Vec3,
    /// Four numbers.
    Vec4,
    /// Four columns of four numbers.
    Mat4,
}

/// A vertex attribute.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct VertexInput {
    /// Its name.
    pub name: String,
    /// Its location.
    pub location: u32,
    /// Its type.
    pub kind: ValueKind,
    /// Its meaning, with space and unit.
    pub meaning: &'static str,
}

/// A field of a uniform buffer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UniformField {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: ValueKind,
    /// The byte offset: std140, which is also the layout of WGSL.
    pub offset: usize,
    /// Its meaning, with range and unit.
    pub meaning: &'static str,
}

/// A buffer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BufferSlot {
    /// The name of the variable.
    pub name: &'static str,
    /// The name of the uniform block in GLSL ES.
    pub block: &'static str,
    /// Its group.
    pub group: u32,
    /// Its binding.
    pub binding: u32,
    /// `true` for read-only storage, which is also a uniform block in GLSL ES.
    pub storage: bool,
    /// Its content.
    pub meaning: &'static str,
}

/// A texture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TextureSlot {
    /// The name of the variable; that of its sampler is `NAME_sampler`.
    pub name: &'static str,
    /// Its group.
    pub group: u32,
    /// Its binding.
    pub binding: u32,
    /// The binding of its sampler in the same group; `None` if texels are read without filtering.
    pub sampler: Option<u32>,
    /// The uv set of its coordinates; `None` if it has none.
    pub uv_set: Option<usize>,
    /// The meaning of its channels.
    pub meaning: &'static str,
}

impl ValueKind {
    /// The number of scalars in a value.
    pub fn numbers(self) -> usize {
        match self {
            Self::Number => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 => 4,
            Self::Mat4 => 16,
        }
    }

    /// The alignment of offsets, in bytes.
    fn alignment(self) -> usize {
        match self {
            Self::Number => 4,
            Self::Vec2 => 8,
            Self::Vec3 | Self::Vec4 | Self::Mat4 => 16,
        }
    }
}

/// A field without an offset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unplaced {
    pub name: String,
    pub kind: ValueKind,
    pub meaning: &'static str,
}

/// Lays out fields one after the other.
pub(crate) fn laid_out(fields: &[Unplaced]) -> Vec<UniformField> {
    let mut end = 0;
    let place = |field: &Unplaced| {
        let offset = usize::next_multiple_of(end, field.kind.alignment());
        end = offset + 4 * field.kind.numbers();
        UniformField { name: field.name.clone(), kind: field.kind, offset, meaning: field.meaning }
    };
    fields.iter().map(place).collect()
}

/// The size in bytes of a uniform buffer of these fields, a multiple of 16.
pub fn buffer_size(fields: &[UniformField]) -> usize {
    let end = fields.last().map_or(0, |field| field.offset + 4 * field.kind.numbers());
    end.next_multiple_of(16)
}

impl UniformField {
    /// Writes the numbers of a value at the field's offset. Numbers that do not fit in the field or the buffer are
    /// dropped.
    pub fn write(&self, numbers: &[f32], buffer: &mut [u8]) {
        let room = buffer.get_mut(self.offset..).unwrap_or_default();
        let numbers = &numbers[..numbers.len().min(self.kind.numbers())];
        for (bytes, number) in room.chunks_exact_mut(4).zip(numbers) {
            bytes.copy_from_slice(&number.to_le_bytes());
        }
    }
}
