//! The smallest encodings of a texture within a permitted loss.

use super::goal::{Codecs, Goal};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Encoding, Texture};
use taotie_engine::proof::ImageLook;
use taotie_io::{ImageCodec, LossyTexture, decode_bitmap};

/// The smallest candidate side, texels.
const LEAST_SIDE: u32 = 32;
/// Up to this side, a lossless texture is tried in addition to lossy ones: those with few colours are small.
const LOSSLESS_SIDE: u32 = 1024;
/// The ratios of angles for which normal maps are encoded.
pub(super) const NORMAL_RATIOS: [f64; 7] = [0.2, 0.35, 0.5, 0.65, 0.78, 0.88, 0.96];
/// Sides tried for a format that not all of them fit.
const SIDES: usize = 256;
/// Sides are tried until this many in a row took more bytes.
const WORSE: usize = 2;

/// A texture in one encoding.
#[derive(Debug, Clone)]
pub(super) struct EncodedTexture {
    /// The longer side, texels.
    pub side: u32,
    pub codec: ImageCodec,
    pub bytes: Arc<Vec<u8>>,
    /// The largest ratio of a difference to its limit.
    pub ratio: f64,
}

/// The encodings of a texture, each made once.
pub(super) struct Encodings<'a> {
    texture: &'a LossyTexture,
    /// The longest candidate side, texels.
    most_side: u32,
    codecs: Codecs,
    goal: Goal,
    look: ImageLook<'a>,
    known: Mutex<BTreeMap<(u32, ImageCodec), EncodedTexture>>,
    /// The ratio of each size.
    sizes: Mutex<BTreeMap<u32, f64>>,
}

impl<'a> Encodings<'a> {
    /// Takes a texture that a surface shows, the goal with the limits on its differences, and the permitted formats.
    pub fn new(texture: &'a LossyTexture, look: ImageLook<'a>, (goal, codecs): (&Goal, &Codecs)) -> Self {
        let (goal, codecs, most_side) = (goal.clone(), codecs.clone(), texture.side());
        Self { texture, most_side, codecs, goal, look, known: Mutex::default(), sizes: Mutex::default() }
    }

    /// Limits the longer side to a fraction of the texture's own, (0, 1].
    #[must_use]
    pub fn within(self, part: f64) -> Self {
        let most_side = (f64::from(self.texture.side()) * part) as u32;
        let most_side = if part < 1.0 { (most_side & !3).max(4) } else { self.texture.side() };
        Self { most_side: most_side.min(self.texture.side()), ..self }
    }

    /// Returns `true` if the texture itself has more texels than permitted.
    pub fn must_shrink(&self) -> bool {
        self.most_side < self.texture.side()
    }

    /// Returns the encoding with the least loss, at a slightly smaller size if a format requires it.
    pub fn nearest(&self) -> Result<EncodedTexture> {
        let ladders = self.codecs.ladders().filter_map(|ladder| ladder.last().copied());
        let codecs: Vec<ImageCodec> = self.codecs.lossless().into_iter().chain(ladders).collect();
        let sides =
            std::iter::once(self.most_side).chain((1..=self.most_side & !3).rev().step_by(4).take(SIDES));
        let fitting = sides.flat_map(|side| codecs.iter().map(move |codec| (side, *codec)));
        let mut fitting = fitting.filter(|(side, codec)| self.texture.fits(*codec, *side));
        // PNG can store everything.
        let (side, codec) = fitting.next().unwrap_or((self.most_side, ImageCodec::Png));
        self.encoded(side, codec)
    }

    /// Returns the meaning of its texels.
    pub fn encoding(&self) -> Encoding {
        self.texture.encoding()
    }

    /// Returns the smallest encoding of any size whose ratio is at most `most`; `None` if there is none.
    pub fn smallest(&self, most: f64) -> Result<Option<EncodedTexture>> {
        let (mut best, mut worse): (Option<EncodedTexture>, usize) = (None, 0);
        for side in sides(self.most_side) {
            let Some(of_side) = self.smallest_of(side, most)? else { continue };
            if best.as_ref().is_some_and(|best| best.bytes.len() <= of_side.bytes.len()) {
                worse += 1;
                if worse == WORSE {
                    break;
                }
            } else {
                (best, worse) = (Some(of_side), 0);
            }
        }
        let between = best.as_ref().and_then(|best| self.side_below(best.side));
        let shorter = between.map(|side| self.smallest_of(side, most)).transpose()?.flatten();
        Ok(best.into_iter().chain(shorter).min_by_key(|encoded| encoded.bytes.len()))
    }

    /// Returns the multiple of four halfway between a side and the next shorter one of the initial candidates.
    fn side_below(&self, side: u32) -> Option<u32> {
        let shorter = sides(self.most_side).filter(|other| *other < side).last()?;
        Some(((shorter + side) / 2) & !3).filter(|between| (shorter + 1..side).contains(between))
    }

    /// Returns the smallest encoding of a size whose ratio is at most `most`.
    pub fn smallest_of(&self, side: u32, most: f64) -> Result<Option<EncodedTexture>> {
        if self.resized(side)? > most {
            return Ok(None);
        }
        let mut found = Vec::new();
        for ladder in self.codecs.ladders().filter(|ladder| self.texture.fits(ladder[0], side)) {
            found.extend(self.lowest(side, &ladder, most)?);
        }
        if let Some(lossless) = self.codecs.lossless().filter(|_| side <= LOSSLESS_SIDE || found.is_empty()) {
            found.push(self.encoded(side, lossless)?);
        }
        let near = found.into_iter().filter(|encoded| encoded.ratio <= most);
        Ok(near.min_by_key(|encoded| encoded.bytes.len()))
    }

    /// Returns the most lossy format of the ladder whose ratio is at most `most`.
    fn lowest(&self, side: u32, ladder: &[ImageCodec], most: f64) -> Result<Option<EncodedTexture>> {
        let Some(highest) = ladder.last() else { return Ok(None) };
        let mut lowest = self.encoded(side, *highest)?;
        if lowest.ratio > most {
            return Ok(None);
        }
        let (mut low, mut high) = (0, ladder.len() - 1);
        while low < high {
            let middle = (low + high) / 2;
            let encoded = self.encoded(side, ladder[middle])?;
            if encoded.ratio <= most {
                (lowest, high) = (encoded, middle);
            } else {
                low = middle + 1;
            }
        }
        Ok(Some(lowest))
    }

    /// Returns the ratio of a size with lossless texels.
    fn resized(&self, side: u32) -> Result<f64> {
        let known = || self.sizes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(ratio) = known().get(&side) {
            return Ok(*ratio);
        }
        let ratio = match side < self.texture.side() {
            true => self.ratio(self.texture.resized(side)?.into_owned())?,
            false => 0.0,
        };
        known().insert(side, ratio);
        Ok(ratio)
    }

    fn ratio(&self, bitmap: Bitmap) -> Result<f64> {
        let differences = self.look.differences(&Texture::new(bitmap, self.encoding()))?;
        Ok(self.goal.image_ratio(self.encoding(), &differences))
    }

    fn encoded(&self, side: u32, codec: ImageCodec) -> Result<EncodedTexture> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(encoded) = known().get(&(side, codec)) {
            return Ok(encoded.clone());
        }
        let bytes = Arc::new(self.texture.encoded(side, codec)?);
        let ratio = self.ratio(decode_bitmap(&bytes, "a packed image", Path::new(""))?)?;
        let encoded = EncodedTexture { side, codec, bytes, ratio };
        known().insert((side, codec), encoded.clone());
        Ok(encoded)
    }
}

/// Returns the candidate sides of a texture, in ascending order up to its own: powers of two, and halfway between
/// them.
fn sides(own: u32) -> impl Iterator<Item = u32> {
    let powers = std::iter::successors(Some(LEAST_SIDE), |side| side.checked_mul(2));
    let all = powers.flat_map(|side| [side, side / 2 * 3]);
    all.take_while(move |side| *side < own).chain(std::iter::once(own))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::bake::Scan;
    use taotie_engine::image::{Sampler, Texels};
    use taotie_engine::math::Mat4;
    use taotie_engine::math::scalar::sin;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::proof::{Picture, Relook, Side};
    use taotie_engine::scene::{Instance, Material, Scene, SceneData, TextureRef, UvTransform};
    use taotie_io::CodecSet;

    const SIDE: u32 = 256;

    /// Smooth waves of colour.
    fn waves() -> Bitmap {
        let code = |v: f64| (sin(v) * 127.0 + 128.0) as u8;
        let texel = |i: u32| {
            let [x, y] = [i % SIDE, i / SIDE].map(|k| f64::from(k) * 0.1);
            [code(x), code(x + y), code(y), 255]
        };
        let texels = (0..SIDE * SIDE).map(texel).collect();
        Bitmap::new(SIDE, SIDE, 3, Texels::U8(texels)).unwrap()
    }

    /// A ball that shows them.
    fn ball() -> Scan {
        let material = Material { base_color_texture: Some(texture_ref()), ..Material::default() };
        ball_of(material, waves())
    }

    fn texture_ref() -> TextureRef {
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        TextureRef { texture: 0, uv_set: 0, sampler, transform }
    }

    fn ball_of(material: Material, image: Bitmap) -> Scan {
        let scene = SceneData {
            meshes: vec![Mesh::sphere(1.0, 48, 24)],
            materials: vec![material],
            textures: vec![Texture::new(image, Encoding::Srgb)],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        };
        Scan::new(Scene::new(scene).unwrap()).unwrap()
    }

    #[cfg(feature = "webp")]
    #[test]
    fn less_may_be_lost_for_more_bytes() {
        let (ball, texture, goal) = (ball(), LossyTexture::new(waves(), Encoding::Srgb), Goal::of(&[], 0));
        let side = Side::of(&ball);
        let look = Relook::new(&side, Picture::whole(2_000));
        let of_waves = look.first(Encoding::Srgb).unwrap().unwrap();
        let encodings = Encodings::new(&texture, of_waves, (&goal, &Codecs::new(&[], CodecSet::Portable)));
        let found = [0.3, 1.0, 4.0].map(|most| encodings.smallest(most).unwrap().unwrap());
        assert!(found.windows(2).all(|pair| pair[0].bytes.len() > pair[1].bytes.len()), "{found:?}");
        assert!(found.iter().zip([0.3, 1.0, 4.0]).all(|(found, most)| found.ratio <= most));
        let whole = encodings.encoded(SIDE, ImageCodec::WebP).unwrap();
        assert_eq!(whole.ratio, 0.0, "a lossless one looks the same");
        assert!(look.first(Encoding::Normal).unwrap().is_none());
    }

    /// Of all pixels, the display is less than a percent.
    #[test]
    fn a_display_in_a_black_image_is_measured_by_itself() {
        let is_lit = |i: u32| (100..116).contains(&(i % SIDE)) && (120..126).contains(&(i / SIDE));
        let texel = |i: u32| if is_lit(i) { [90, 200, 255, 255] } else { [0, 0, 0, 255] };
        let display = Bitmap::new(SIDE, SIDE, 3, Texels::U8((0..SIDE * SIDE).map(texel).collect())).unwrap();
        let material =
            Material { emissive: [1.0; 3], emissive_texture: Some(texture_ref()), ..Material::default() };
        let (ball, texture) =
            (ball_of(material, display.clone()), LossyTexture::new(display, Encoding::Srgb));
        let side = Side::of(&ball);
        let look = Relook::new(&side, Picture::whole(20_000));
        let look = look.first(Encoding::Srgb).unwrap().unwrap();
        let small = Texture::new(texture.resized(32).unwrap().into_owned(), Encoding::Srgb);
        let found = look.differences(&small).unwrap();
        let mean = found.iter().sum::<f32>() / found.len() as f32;
        assert!((10..200).contains(&found.len()) && mean > 10.0, "{mean} of {}", found.len());
    }

    #[test]
    fn sides_lead_to_the_own_one() {
        assert_eq!(sides(200).collect::<Vec<_>>(), [32, 48, 64, 96, 128, 192, 200]);
        assert_eq!(sides(16).collect::<Vec<_>>(), [16]);
    }
}
