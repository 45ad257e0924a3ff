//! The interface between a host and a pixel shader: the layout of buffers, textures and vertex values, and the values
//! of a frame with its lights and its environment.

use serde::Serialize;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{Cone, Falloff, LightSource, Place, Turn};
use taotie_engine::shade::environment::{EnvironmentMaps, HalfPicture};

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

/// The maximum number of lights in a GLSL ES shader.
pub const MOST_LIGHTS: usize = 16;

/// The maximum number of environment levels in a shader; no environment has that many.
pub const MOST_LEVELS: usize = 32;

/// The values of a frame's uniform buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameFactors {
    /// The columns of the matrix that transforms world space to clip space.
    pub clip_from_world: [[f32; 4]; 4],
    /// The viewer's position and 1, or the unit direction to the viewer and 0, in world space.
    pub eye: [f32; 4],
    /// Ambient radiance from all directions, linear RGB.
    pub ambient: Vec3,
    /// The distance between two samples in pixels: 1 with one sample per pixel, 1/2 with four.
    pub spacing: f32,
    /// The rotation of the environment.
    pub turn: Turn<f32>,
    /// The factor of the environment's radiance, at least 0.
    pub intensity: f32,
    /// The number of environment levels.
    pub levels: usize,
    /// The α of the environment's smoothest level, (0, 1].
    pub smoothest_alpha: f32,
    /// The number of lights.
    pub lights: usize,
}

/// The names, types and meanings of the fields.
const FIELDS: [(&str, ValueKind, &str); 10] = [
    ("clip_from_world", ValueKind::Mat4, "Transforms world space to the host's clip space."),
    (
        "eye",
        ValueKind::Vec4,
        "The viewer's position and 1, or the unit direction to the viewer and 0; world space.",
    ),
    ("ambient", ValueKind::Vec3, "Ambient radiance from all directions, linear RGB."),
    (
        "spacing",
        ValueKind::Number,
        "The distance between two samples in pixels: 1/2 with four samples per pixel.",
    ),
    ("environment_sin", ValueKind::Number, "The sine of the environment's rotation about +y."),
    ("environment_cos", ValueKind::Number, "The cosine of the environment's rotation about +y."),
    ("environment_intensity", ValueKind::Number, "The factor of the environment's radiance, at least 0."),
    ("environment_levels", ValueKind::Number, "The number of environment levels."),
    ("smoothest_alpha", ValueKind::Number, "The α of the environment's smoothest level, (0, 1]."),
    ("light_count", ValueKind::Number, "The number of lights."),
];

/// The fields of a frame's uniform buffer.
pub(crate) fn frame_fields() -> Vec<UniformField> {
    let fields = FIELDS.map(|(name, kind, meaning)| Unplaced { name: name.into(), kind, meaning });
    laid_out(&fields)
}

impl FrameFactors {
    /// Returns the bytes of group 0, binding 0.
    pub fn bytes(&self) -> Vec<u8> {
        let fields = frame_fields();
        let mut bytes = vec![0; buffer_size(&fields)];
        fields.iter().zip(self.values()).for_each(|(field, value)| field.write(&value, &mut bytes));
        bytes
    }

    fn values(&self) -> [Vec<f32>; 10] {
        [
            self.clip_from_world.as_flattened().to_vec(),
            self.eye.to_vec(),
            self.ambient.to_array().to_vec(),
            vec![self.spacing],
            vec![self.turn.sin],
            vec![self.turn.cos],
            vec![self.intensity],
            vec![self.levels as f32],
            vec![self.smoothest_alpha],
            vec![self.lights as f32],
        ]
    }
}

/// The range that means infinite: no window reaches that far, and its square is finite.
const NO_RANGE: f32 = 1e18;

/// Returns a light as shaders read it: 16 numbers, the stride of the lights' buffer in `f32`.
///
/// `place` (the position, or the unit direction to a light infinitely far away), `kind` (0 infinitely far, 1 without
/// falloff, 2 inverse-square falloff), `color`, `range`, `axis`, `cos_inner`, `cos_outer`, and three unused.
pub fn light_numbers(light: &LightSource<f32>) -> [f32; 16] {
    let (place, far) = match light.place {
        Place::At(position) => (position, false),
        Place::Towards(direction) => (direction, true),
    };
    let (falloff, range) = match light.falloff {
        Falloff::None => (1.0, NO_RANGE),
        Falloff::InverseSquare => (2.0, NO_RANGE),
        Falloff::Windowed(range) => (2.0, range),
    };
    // A cone that extends beyond the opposite direction contains every direction.
    let everywhere = Cone { axis: Vec3::new(0.0, 0.0, 1.0), cos_inner: -2.0, cos_outer: -3.0 };
    let Cone { axis, cos_inner, cos_outer } = light.cone.unwrap_or(everywhere);
    let kind = if far { 0.0 } else { falloff };
    let (p, c) = (place, light.color);
    [p.x, p.y, p.z, kind, c.x, c.y, c.z, range, axis.x, axis.y, axis.z, cos_inner, cos_outer, 0.0, 0.0, 0.0]
}

/// Alpha as a half float.
const ONE: u16 = 0x3c00;

/// The levels of an environment packed into one image: `environment_maps` and `environment_levels` of a shader.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentAtlas {
    /// Width and height in texels.
    pub size: [usize; 2],
    /// Half floats, linear RGB and 1, row by row from the top.
    pub texels: Vec<[u16; 4]>,
    /// Column and row of each level's first texel, its side length without the border, and its factor. The last row
    /// ends with the factor of the environment's image.
    pub table: [[f32; 4]; MOST_LEVELS],
}

impl EnvironmentAtlas {
    /// Packs the levels into shelves, roughly square overall. Levels beyond the first [`MOST_LEVELS`] − 1 are
    /// dropped: no environment has that many.
    pub fn new(maps: &EnvironmentMaps<'_>) -> Self {
        let levels = &maps.levels[..maps.levels.len().min(MOST_LEVELS - 1)];
        let (size, places) = shelves(levels);
        let mut atlas =
            Self { size, texels: vec![[0, 0, 0, ONE]; size[0] * size[1]], table: [[0.0; 4]; MOST_LEVELS] };
        for (number, (level, place)) in levels.iter().zip(places).enumerate() {
            atlas.put(level, place);
            let [x, y] = place.map(|texels| texels as f32);
            atlas.table[number] = [x, y, level.width.saturating_sub(2) as f32, level.factor];
        }
        atlas.table[MOST_LEVELS - 1][3] = maps.picture.factor;
        atlas
    }

    fn put(&mut self, level: &HalfPicture<'_>, [left, top]: [usize; 2]) {
        let rows = self.texels.chunks_exact_mut(self.size[0]).skip(top);
        for (row, from) in rows.zip(level.texels.chunks_exact(level.width)) {
            row[left..].iter_mut().zip(from).for_each(|(to, from)| *to = opaque(from));
        }
    }
}

/// A texel of half floats with alpha 1.
pub fn opaque([r, g, b]: &[u16; 3]) -> [u16; 4] {
    [*r, *g, *b, ONE]
}

/// The size that holds all levels (at least one texel), and the column and row where each begins.
fn shelves(levels: &[HalfPicture<'_>]) -> ([usize; 2], Vec<[usize; 2]>) {
    let area: usize = levels.iter().map(|level| level.width * level.height).sum();
    let widest = levels.iter().map(|level| level.width).max().unwrap_or(1);
    let width = widest.max(area.isqrt());
    let (mut left, mut top, mut below) = (0, 0, 0);
    let mut places = Vec::with_capacity(levels.len());
    for level in levels {
        if left + level.width > width {
            (left, top) = (0, below);
        }
        places.push([left, top]);
        left += level.width;
        below = below.max(top + level.height);
    }
    ([width, below.max(1)], places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use half::f16;
    use taotie_engine::image::Image;
    use taotie_engine::shade::environment::Environment;

    #[test]
    fn every_level_is_found_by_the_table() {
        let environment = Environment::new(Image::new(16, 8, [0.5, 0.25, 2.0, 1.0]).unwrap()).unwrap();
        let maps = environment.maps();
        assert!(maps.levels.len() < MOST_LEVELS, "{} levels", maps.levels.len());
        let atlas = EnvironmentAtlas::new(&maps);
        assert_eq!(atlas.texels.len(), atlas.size[0] * atlas.size[1]);
        assert_eq!(atlas.table[MOST_LEVELS - 1], [0.0, 0.0, 0.0, maps.picture.factor]);
        let mut taken = vec![false; atlas.texels.len()];
        for (level, [x, y, side, factor]) in maps.levels.iter().zip(atlas.table) {
            assert_eq!((side as usize + 2, factor), (level.width, level.factor));
            let [_, green, blue] = level.texels[0].map(|half| f16::from_bits(half).to_f32() * factor);
            assert!((green - 0.25).abs() < 1e-3 && (blue - 2.0).abs() < 1e-2, "{green} {blue}");
            for (i, texel) in level.texels.iter().enumerate() {
                let at = (y as usize + i / level.width) * atlas.size[0] + x as usize + i % level.width;
                assert_eq!(atlas.texels[at], opaque(texel));
                assert!(!std::mem::replace(&mut taken[at], true), "levels overlap");
            }
        }
    }

    #[test]
    fn levels_lie_apart_and_inside() {
        let sides = [514, 514, 258, 258, 130, 66, 66, 34, 18, 300];
        let level = |side| HalfPicture { width: side, height: side, texels: &[], factor: 1.0 };
        let (size, places) = shelves(&sides.map(level));
        assert!(size[0] >= 514 && size[0] < 1200 && size[1] < 1700, "{size:?}");
        for (i, ([x, y], side)) in places.iter().zip(sides).enumerate() {
            assert!(x + side <= size[0] && y + side <= size[1], "{i}");
            for ([other_x, other_y], other) in places[..i].iter().zip(sides) {
                let apart = x + side <= *other_x
                    || other_x + other <= *x
                    || y + side <= *other_y
                    || other_y + other <= *y;
                assert!(apart, "{i}");
            }
        }
        assert_eq!(shelves(&[]), ([1, 1], vec![]));
    }
}
