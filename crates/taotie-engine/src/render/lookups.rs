//! The textures of a batch: lookup positions and values.

use crate::image::{Lookup, LookupPoints, Sampler, Texture};
use crate::math::{Column, Pack, dispatch_pack};
use crate::pixel::{log2_texels, turned_uv};
use crate::scene::{Scene, TextureRef, UvTransform};
use fearless_simd::Level;

/// Reads textures at all points of a batch; the texels are located once for all textures with the same placement.
#[derive(Debug, Clone)]
pub(super) struct Lookups {
    lookup: Box<Lookup>,
    /// The placement for which `lookup` was computed.
    placed: Option<Placement>,
    pub uv: [Column; 2],
    pub lod: Column,
}

/// Texture coordinates, and their changes one sample to the right and one down.
#[derive(Debug, Clone)]
pub(super) struct UvSet {
    pub uv: [Column; 2],
    pub d_x: [Column; 2],
    pub d_y: [Column; 2],
}

impl Default for UvSet {
    fn default() -> Self {
        Self { uv: [Column::ZERO; 2], d_x: [Column::ZERO; 2], d_y: [Column::ZERO; 2] }
    }
}

/// The points' positions in texture space: the texture coordinates of the first `len`, set by set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinates<'b> {
    pub sets: &'b [UvSet],
    pub len: usize,
}

/// A texture as a material uses it, to be read at a SIMD level.
#[derive(Clone, Copy)]
pub(super) struct TextureUse<'t> {
    level: Level,
    image: &'t Texture,
    texture: &'t TextureRef,
}

impl<'t> TextureUse<'t> {
    pub(super) fn new(level: Level, scene: &'t Scene, texture: &'t TextureRef) -> Self {
        Self { level, image: &scene.textures()[texture.texture], texture }
    }
}

/// The choices that decide which texels are read.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Placement {
    uv_set: usize,
    transform: UvTransform,
    sampler: Sampler,
    size: [u32; 2],
}

impl Default for Lookups {
    fn default() -> Self {
        let zero = Column::ZERO;
        Self { lookup: Box::default(), placed: None, uv: [zero; 2], lod: zero }
    }
}

impl Lookups {
    /// Forgets the positions of the previous batch.
    pub(super) fn forget(&mut self) {
        self.placed = None;
    }

    /// The linear RGBA values of a texture at the points. If the mesh lacks the uv set, this is the texel at the
    /// origin.
    pub(super) fn read(&mut self, used: TextureUse<'_>, at: Coordinates<'_>, out: [&mut Column; 4]) {
        let TextureUse { level, image, texture } = used;
        let placement = Placement {
            uv_set: texture.uv_set,
            transform: texture.transform,
            sampler: texture.sampler,
            size: [image.width(), image.height()],
        };
        if self.placed != Some(placement) {
            self.locate(used, at);
            let points = LookupPoints { uv: self.uv.each_ref(), lod: &self.lod, len: at.len };
            self.lookup.place(level, image, &texture.sampler, points);
            self.placed = Some(placement);
        }
        self.lookup.read(level, image, out);
    }

    /// Reads a texture like [`Self::read`] at the first `len` points, offset by uv: `shift(i)` for entry `i`.
    pub(super) fn read_shifted(
        &mut self,
        TextureUse { level, image, texture }: TextureUse<'_>,
        len: usize,
        shift: impl Fn(usize) -> [f32; 2],
        out: [&mut Column; 4],
    ) {
        let mut moved = self.uv;
        let [moved_u, moved_v] = &mut moved;
        for (i, (u, v)) in moved_u.iter_mut().zip(moved_v.iter_mut()).enumerate().take(len) {
            let [du, dv] = shift(i);
            (*u, *v) = (*u + du, *v + dv);
        }
        let points = LookupPoints { uv: moved.each_ref(), lod: &self.lod, len };
        self.lookup.place(level, image, &texture.sampler, points);
        self.lookup.read(level, image, out);
        self.placed = None;
    }

    /// Fills `uv`, the positions in a texture, and `lod`, log2 of the number of finest-level texels that a pixel
    /// covers.
    pub(super) fn locate(&mut self, used: TextureUse<'_>, at: Coordinates<'_>) {
        let nowhere;
        let set = match at.sets.get(used.texture.uv_set) {
            Some(set) => set,
            None => {
                nowhere = UvSet::default();
                &nowhere
            }
        };
        dispatch_pack!(used.level, P, token => self.transform::<P>(token, set, used, at.len));
    }

    #[inline(always)]
    fn transform<P: Pack>(&mut self, token: P::Token, set: &UvSet, used: TextureUse<'_>, len: usize) {
        let transform = &used.texture.transform;
        let width = P::splat(token, used.image.width() as f32);
        let height = P::splat(token, used.image.height() as f32);
        let [offset_u, offset_v] = transform.offset.map(|offset| P::splat(token, offset));
        let linear = transform.linear.map(|row| row.map(|value| P::splat(token, value)));
        let load = |columns: &[Column; 2], i| columns.each_ref().map(|column| P::load(token, &column[i..]));
        for i in (0..len).step_by(P::LANES) {
            let [u, v] = turned_uv(linear, load(&set.uv, i));
            (u + offset_u).store(&mut self.uv[0][i..]);
            (v + offset_v).store(&mut self.uv[1][i..]);
            let d_x = turned_uv(linear, load(&set.d_x, i));
            let d_y = turned_uv(linear, load(&set.d_y, i));
            log2_texels(d_x, d_y, [width, height]).store(&mut self.lod[i..]);
        }
    }
}
