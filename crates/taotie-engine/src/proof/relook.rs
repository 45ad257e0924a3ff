//! Repeated views of a surface with different images in its textures.

use super::overview::{Picture, overview_samples};
use super::{Sample, Side};
use crate::bake::Retextured;
use crate::compare::{angle_deg, color_difference};
use crate::error::Result;
use crate::image::{Encoding, Texture};
use crate::math::Vec3;
use crate::parallel;

/// The pixels of an overview of one surface. As the triangles stay, changes are found without tracing more rays.
pub struct Relook<'a> {
    side: &'a Side<'a>,
    pixels: Vec<Vec<Sample>>,
}

/// Textures that use one image, by index, and the meaning of their texels.
#[derive(Debug, Clone)]
pub struct Shown {
    /// Indices of the scene's textures.
    pub textures: Vec<usize>,
    /// The meaning of their texels.
    pub encoding: Encoding,
}

/// A pixel's values that textures of one meaning determine.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    /// The sum of normals, or of colours.
    sum: Vec3,
    /// The sum of emission, or of metallic, roughness and occlusion.
    other: Vec3,
    /// The sum of opacities, for colours.
    alpha: f32,
}

impl<'a> Relook<'a> {
    /// Finds the pixels of [`super::overview`].
    pub fn new(side: &'a Side<'a>, picture: Picture) -> Self {
        Self { side, pixels: overview_samples(side, picture) }
    }

    /// Returns the pixels that show the first texture whose texels have this meaning; `None` if there is none.
    ///
    /// # Errors
    /// Those of [`Retextured::new`].
    pub fn first(&'a self, encoding: Encoding) -> Result<Option<ImageLook<'a>>> {
        let textures = self.side.surface.surface().textures();
        let number = textures.iter().position(|texture| texture.encoding() == encoding);
        number.map(|number| self.at(Shown { textures: vec![number], encoding })).transpose()
    }

    /// Returns the pixels that show an image.
    ///
    /// # Errors
    /// Those of [`Retextured::new`].
    pub fn at(&'a self, shown: Shown) -> Result<ImageLook<'a>> {
        let surface = self.side.surface.surface();
        let shows = surface.materials_with(&shown.textures);
        let is_shown = |samples: &&Vec<Sample>| shows[surface.material_number(samples[0].at.point.triangle)];
        let pixels: Vec<&[Sample]> = self.pixels.iter().filter(is_shown).map(Vec::as_slice).collect();
        let own = &surface.textures()[shown.textures[0]];
        let own = Retextured::new(self.side.surface, &shown.textures, own)?;
        let seen = parallel::tasks(pixels.len(), &|i| Seen::of(&own, pixels[i], shown.encoding));
        Ok(ImageLook { side: self.side, shown, pixels, seen })
    }
}

/// The pixels that show one image.
pub struct ImageLook<'a> {
    side: &'a Side<'a>,
    shown: Shown,
    pixels: Vec<&'a [Sample]>,
    /// The original values of each pixel.
    seen: Vec<Seen>,
}

impl ImageLook<'_> {
    /// Returns the differences from the same pixels with another texture replacing the image, in ascending order:
    /// degrees, CIEDE2000, or fractions of the largest number.
    ///
    /// # Errors
    /// Those of [`Retextured::new`].
    pub fn differences(&self, with: &Texture) -> Result<Vec<f32>> {
        let other = Retextured::new(self.side.surface, &self.shown.textures, with)?;
        let encoding = self.shown.encoding;
        let difference = |i: usize| {
            let samples = self.pixels[i];
            self.seen[i].difference(&Seen::of(&other, samples, encoding), encoding, samples.len())
        };
        let mut found = parallel::collect(self.pixels.len(), difference);
        found.retain(|difference| !difference.is_nan());
        found.sort_unstable_by(f32::total_cmp);
        Ok(found)
    }
}

impl Seen {
    fn of(surface: &Retextured<'_>, samples: &[Sample], encoding: Encoding) -> Self {
        let mut seen = Self::default();
        for Sample { at, toward } in samples {
            if encoding == Encoding::Normal {
                seen.sum += surface.seen_normal(*at, *toward);
                continue;
            }
            let material = surface.seen_material(*at);
            if encoding == Encoding::Srgb {
                seen.sum += material.color;
                seen.other += material.emission;
                seen.alpha += material.alpha;
            } else {
                seen.other += Vec3::new(material.metallic, material.roughness, material.occlusion);
            }
        }
        seen
    }

    fn difference(&self, other: &Self, encoding: Encoding, samples: usize) -> f32 {
        let mean = |sum: Vec3| (sum * (1.0 / samples as f32)).to_array();
        let [a, b] = [self, other].map(|seen| [mean(seen.sum), mean(seen.other)]);
        match encoding {
            Encoding::Normal => angle_deg(self.sum.to_f64(), other.sum.to_f64()) as f32,
            Encoding::Srgb => {
                // From black to white counts the same as from transparent to opaque.
                let alpha = (self.alpha - other.alpha).abs() / samples as f32 * 100.0;
                color_difference(a[0], b[0]).max(color_difference(a[1], b[1])).max(alpha.into()) as f32
            }
            Encoding::Linear => a[1].iter().zip(b[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max),
        }
    }
}
