//! Filtered lookup with the wrap and filter modes of glTF.

use super::Texture;
use crate::math::Vec2;

/// How a texture continues outside [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The image repeats.
    #[default]
    Repeat,
    /// Every second copy is mirrored.
    Mirror,
    /// The border texel is extended.
    Clamp,
}

/// How texels of one level are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TexelFilter {
    /// The texel that contains the point.
    Nearest,
    /// Bilinear between four texel centres.
    #[default]
    Linear,
}

/// How mip levels are combined under minification.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MipFilter {
    /// Only the finest level.
    None,
    /// The nearest level.
    Nearest,
    /// Linear between two levels.
    #[default]
    Linear,
}

/// The wrap and filter modes of one use of a texture. The default is trilinear with repetition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sampler {
    /// How the texture continues along u.
    pub wrap_u: Wrap,
    /// How the texture continues along v.
    pub wrap_v: Wrap,
    /// The filter when a texel is larger than a pixel.
    pub magnify: TexelFilter,
    /// The filter when a texel is smaller than a pixel.
    pub minify: TexelFilter,
    /// The filter between levels, under minification.
    pub mip: MipFilter,
}

impl Wrap {
    /// The texel index in [0, size) for the integral coordinate `i` in [-1, period]; the period is `size`, or twice
    /// that for mirroring. Comparisons replace a slow division.
    #[inline]
    fn apply(self, i: i32, size: i32) -> usize {
        let within = |period: i32| match i {
            i if i < 0 => i + period,
            i if i >= period => i - period,
            i => i,
        };
        let wrapped = match self {
            Self::Repeat => within(size),
            Self::Clamp => i.clamp(0, size - 1),
            Self::Mirror => {
                let j = within(2 * size);
                if j < size { j } else { 2 * size - 1 - j }
            }
        };
        wrapped as usize
    }

    /// A coordinate near [0, 2] that looks up the same texel, so that scaling keeps its fraction exact.
    #[inline]
    fn reduce(self, u: f32) -> f32 {
        match self {
            Self::Repeat => u - u.floor(),
            Self::Mirror => u - 2.0 * (u * 0.5).floor(),
            Self::Clamp => u.clamp(-1.0, 2.0),
        }
    }
}

impl Sampler {
    /// Bilinear, without levels.
    pub const BILINEAR: Self = Self {
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        magnify: TexelFilter::Linear,
        minify: TexelFilter::Linear,
        mip: MipFilter::None,
    };

    /// The linear RGBA value of `texture` at `uv` (origin top left); `lod` is log2 of texels per pixel on the finest
    /// level.
    pub fn sample(&self, texture: &Texture, uv: Vec2, lod: f32) -> [f32; 4] {
        let switch = self.switch();
        if lod <= switch || lod.is_nan() {
            return self.level(texture, 0, uv, self.magnify);
        }
        let last = (texture.levels() - 1) as f32;
        match self.mip {
            MipFilter::None => self.level(texture, 0, uv, self.minify),
            MipFilter::Nearest => {
                let level = (lod + 0.5).floor().min(last);
                self.level(texture, level as usize, uv, self.minify)
            }
            MipFilter::Linear => {
                let lod = lod.min(last);
                let fine = lod.floor();
                let fraction = lod - fine;
                let a = self.level(texture, fine as usize, uv, self.minify);
                if fraction == 0.0 {
                    return a;
                }
                let b = self.level(texture, fine as usize + 1, uv, self.minify);
                mix(a, b, fraction)
            }
        }
    }

    /// A texture is magnified up to this log2 of texels per pixel: OpenGL 4.6, 8.14.1 shifts it if only minification
    /// uses levels coarsely.
    pub(super) fn switch(&self) -> f32 {
        let coarse = self.minify == TexelFilter::Nearest && self.mip != MipFilter::None;
        if self.magnify == TexelFilter::Linear && coarse { 0.5 } else { 0.0 }
    }

    #[inline]
    fn level(&self, texture: &Texture, level: usize, uv: Vec2, filter: TexelFilter) -> [f32; 4] {
        let (width, height) = texture.level_size(level);
        let (w, h) = (width as i32, height as i32);
        let x = self.wrap_u.reduce(uv.x) * width as f32;
        let y = self.wrap_v.reduce(uv.y) * height as f32;
        let mean = match filter {
            TexelFilter::Nearest => {
                let (i, j) = (x.floor() as i32, y.floor() as i32);
                texture.unscaled(level, self.wrap_u.apply(i, w), self.wrap_v.apply(j, h))
            }
            TexelFilter::Linear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (i, j) = (x.floor() as i32, y.floor() as i32);
                let (fx, fy) = (x - x.floor(), y - y.floor());
                let (i0, i1) = (self.wrap_u.apply(i, w), self.wrap_u.apply(i + 1, w));
                let (j0, j1) = (self.wrap_v.apply(j, h), self.wrap_v.apply(j + 1, h));
                let top = mix(texture.unscaled(level, i0, j0), texture.unscaled(level, i1, j0), fx);
                let bottom = mix(texture.unscaled(level, i0, j1), texture.unscaled(level, i1, j1), fx);
                mix(top, bottom, fy)
            }
        };
        let scale = texture.scale(level);
        std::array::from_fn(|c| mean[c] * scale[c])
    }
}

#[inline]
fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Texels};

    fn ramp() -> Texture {
        let texels = (0..4).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        Texture::new(Bitmap::new(4, 1, 4, Texels::F32(texels)).unwrap(), Encoding::Linear)
    }

    #[test]
    fn wraps_as_gltf_says() {
        let indices = |wrap: Wrap, last: i32| (-1..=last).map(|i| wrap.apply(i, 4)).collect::<Vec<_>>();
        assert_eq!(indices(Wrap::Repeat, 4), [3, 0, 1, 2, 3, 0]);
        assert_eq!(indices(Wrap::Mirror, 8), [0, 0, 1, 2, 3, 3, 2, 1, 0, 0]);
        assert_eq!(indices(Wrap::Clamp, 8), [0, 0, 1, 2, 3, 3, 3, 3, 3, 3]);
    }

    #[test]
    fn far_coordinates_repeat_and_mirror() {
        for (wrap, period) in [(Wrap::Repeat, 1.0), (Wrap::Mirror, 2.0)] {
            let sampler = Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() };
            for i in 0..40 {
                let u = i as f32 / 16.0 - 1.25;
                let at = |u: f32| sampler.sample(&ramp(), Vec2::new(u, 0.5), 0.0);
                assert_eq!(at(u), at(u + 8.0 * period), "{wrap:?} {u}");
                assert_eq!(at(u), at(u - 6.0 * period), "{wrap:?} {u}");
                if wrap == Wrap::Mirror {
                    assert_eq!(at(u), at(-u), "{u}");
                }
            }
        }
    }

    #[test]
    fn bilinear_between_centres_and_mean_at_the_last_level() {
        let clamp = Sampler { wrap_u: Wrap::Clamp, ..Sampler::default() };
        assert_eq!(clamp.sample(&ramp(), Vec2::new(0.5, 0.5), 0.0)[0], 1.5);
        assert_eq!(clamp.sample(&ramp(), Vec2::new(-3.0, 0.5), 0.0)[0], 0.0);
        assert_eq!(clamp.sample(&ramp(), Vec2::new(0.1, 0.5), 9.0)[0], 1.5);
        assert_eq!(Sampler::default().sample(&ramp(), Vec2::new(1.0, 0.5), 0.0)[0], 1.5);
    }

    #[test]
    fn survives_nonsense_coordinates() {
        for u in [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30] {
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                let sampler = Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() };
                sampler.sample(&ramp(), Vec2::new(u, u), u);
            }
        }
    }
}
