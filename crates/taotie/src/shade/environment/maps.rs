//! The images of an environment, for GPUs that look it up themselves.

use super::Environment;
use super::texels::HalfTexels;

/// The images in which an environment is looked up.
#[derive(Debug, Clone)]
pub struct EnvironmentMaps<'e> {
    /// Its light filtered for rough mirrors, from the smoothest to the roughest: unfolded octahedra with a border of
    /// one texel on each side.
    pub levels: Vec<HalfPicture<'e>>,
    /// Roughness² of the smoothest level, (0, 1].
    pub smoothest_alpha: f32,
    /// The equirectangular image itself.
    pub picture: HalfPicture<'e>,
}

/// An image of linear RGB in half floats, row by row from the top.
#[derive(Debug, Clone, Copy)]
pub struct HalfPicture<'e> {
    /// Width in texels, with the border.
    pub width: usize,
    /// Height in texels, with the border.
    pub height: usize,
    /// The half floats of each texel.
    pub texels: &'e [[u16; 3]],
    /// The factor of the half floats: a power of two.
    pub factor: f32,
}

impl Environment {
    /// Returns the images in which this environment is looked up.
    pub fn maps(&self) -> EnvironmentMaps<'_> {
        let levels = self.levels.0.iter().map(|level| {
            let map = &level.map;
            HalfPicture::new([map.side() + 2; 2], map.texels())
        });
        EnvironmentMaps {
            levels: levels.collect(),
            smoothest_alpha: self.levels.0[0].alpha,
            picture: HalfPicture::new([self.picture.width(), self.picture.height()], self.picture.texels()),
        }
    }
}

impl<'e> HalfPicture<'e> {
    fn new([width, height]: [usize; 2], texels: &'e HalfTexels) -> Self {
        Self { width, height, texels: texels.texels(), factor: texels.half_factor() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use half::f16;

    #[test]
    fn pictures_hold_the_light_that_is_looked_up() {
        let light = [0.25, 0.5, 2.0];
        let image = Image::new(32, 16, [light[0], light[1], light[2], 1.0]).unwrap();
        let environment = Environment::new(image).unwrap();
        let maps = environment.maps();
        let texel = |picture: &HalfPicture<'_>, i: usize| {
            picture.texels[i].map(|bits| f16::from_bits(bits).to_f32() * picture.factor)
        };
        assert_eq!([maps.picture.width, maps.picture.height], [32, 16]);
        assert_eq!(texel(&maps.picture, 100), light);
        assert!((2..32).contains(&maps.levels.len()) && maps.smoothest_alpha < 0.01);
        for level in &maps.levels {
            assert_eq!(level.texels.len(), level.width * level.height);
            // The border's corner, and the middle.
            for i in [0, level.texels.len() / 2] {
                let found = texel(level, i);
                let near = found.iter().zip(light).all(|(a, b)| (a / b - 1.0).abs() < 0.01);
                assert!(near, "{found:?} for {light:?}");
            }
        }
    }
}
