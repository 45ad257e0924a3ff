//! Storing normals in few bits, the error this causes, and banding: gentle curves that become steps.

use crate::compare::{Field, angle_deg, angular_error};
use crate::error::{Error, Result};
use crate::image::{Bitmap, Image, Texels};
use crate::math::Vec3;
use crate::parallel;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{decode_object_normal, encode_normal};

/// How numbers are stored.
///
/// ```
/// use taotie_engine::image::Bitmap;
/// use taotie_engine::normal_map::{Storage, store_unit_vectors};
///
/// let tilted = |dither| store_unit_vectors([8, 8], &[[0.3, 0.2, 0.9]; 64], Storage { bits: 8, dither });
/// let is_even = |map: &Bitmap| (1..64).all(|i| map.stored(i) == map.stored(0));
/// assert!(is_even(&tilted(false)?) && !is_even(&tilted(true)?));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Storage {
    /// Bits per channel: 8 or 16, or 32 for floats, which are neither rounded nor dithered.
    pub bits: u8,
    /// `true` to add a pattern of less than one code before rounding.
    ///
    /// Rounding without dithering turns gentle curves into steps, which show in highlights; with dithering the mean
    /// over neighbours is right, at the price of a larger error per texel. The pattern is the additive recurrence R2
    /// (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"): fract(x · 0.7549 + y · 0.5698),
    /// offset by the golden ratio from channel to channel, in integers. Neighbours get numbers far apart, so the
    /// error is high in frequency, as with blue noise, and the same on every machine. Values that are already codes
    /// do not change.
    pub dither: bool,
}

/// A normal map and its storage error.
///
/// ```
/// use taotie_engine::normal_map::Stored;
///
/// /// Returns the mean angular error of storage, in degrees.
/// fn cost(stored: &Stored) -> Option<f64> {
///     Some(stored.error.summary()?.mean)
/// }
/// ```
#[derive(Debug, Clone)]
pub struct Stored {
    /// Red, green and blue at the requested bit depth.
    pub bitmap: Bitmap,
    /// The angle between the input and the values read back, in degrees, where there is a normal.
    pub error: Field,
}

/// Stores vectors, green up in memory, with the requested green. The fourth channel masks only `error`: vectors are
/// also stored where it is 0.
///
/// ```
/// use taotie_engine::image::{Image, Texels};
/// use taotie_engine::normal_map::{Storage, store_normals};
/// use taotie_engine::scene::{GreenChannel, NormalSpace};
///
/// let flat = Image::new(1, 1, [0.0, 0.0, 1.0, 1.0])?;
/// let storage = Storage { bits: 8, dither: false };
/// let stored = store_normals(&flat, NormalSpace::Tangent, GreenChannel::Up, storage)?;
/// assert_eq!(stored.bitmap.texels(), &Texels::U8(vec![[128, 128, 255, 255]]));
/// let degrees = stored.error.values()[0];
/// assert!((degrees - 0.318).abs() < 0.001, "no code is 0: {degrees}");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if the bits are not 8, 16 or 32.
pub fn store_normals(
    normals: &Image,
    space: NormalSpace,
    green: GreenChannel,
    storage: Storage,
) -> Result<Stored> {
    let sign = if space == NormalSpace::Tangent && green == GreenChannel::Down { -1.0 } else { 1.0 };
    let number = |i: usize| {
        let [x, y, z, _] = normals.pixels()[i];
        let [r, g, b] = encode_normal(Vec3::new(x, y * sign, z)).to_array();
        [r, g, b, 1.0]
    };
    let bitmap = stored([normals.width(), normals.height()], 3, storage, number)?;
    let mut read = normals.clone();
    parallel::change(read.pixels_mut(), |i, pixel| {
        let [r, g, b, _] = bitmap.stored(i);
        let v = decode_object_normal(Vec3::new(r, g, b));
        *pixel = [v.x, v.y * sign, v.z, pixel[3]];
    });
    Ok(Stored { error: angular_error(normals, &read)?, bitmap })
}

/// Stores vectors as normals, (n + 1)/2, each normalised first; row by row from the top.
///
/// ```
/// use taotie_engine::image::Texels;
/// use taotie_engine::normal_map::{Storage, store_unit_vectors};
///
/// let storage = Storage { bits: 16, dither: false };
/// let map = store_unit_vectors([1, 1], &[[0.0, 0.0, 2.0]], storage)?;
/// assert_eq!(map.texels(), &Texels::U16(vec![[32768, 32768, 65535, 65535]]));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if the bits are not 8, 16 or 32.
pub fn store_unit_vectors(size: [u32; 2], vectors: &[[f32; 3]], storage: Storage) -> Result<Bitmap> {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let code = |i: usize| encode_normal(Vec3::from_array(vectors[i]).normalize_or(up)).to_array();
    store_codes(size, code, 3, storage)
}

/// Stores a map of one or three `channels`, with values in [0, 1] given by `code` for each texel.
///
/// # Errors
/// [`Error::Invalid`] if the bits are not 8, 16 or 32.
pub fn store_codes(
    size: [u32; 2],
    code: impl Fn(usize) -> [f32; 3] + Sync,
    channels: u8,
    storage: Storage,
) -> Result<Bitmap> {
    let number = |i: usize| {
        let [r, g, b] = code(i);
        [r, g, b, 1.0]
    };
    stored(size, channels, storage, number)
}

/// Stores numbers in [0, 1] with alpha: those of texel i, row by row from the top, are `code(i)`. Alpha is not
/// dithered, so opaque texels stay opaque.
///
/// # Errors
/// [`Error::Invalid`] if the bits are not 8, 16 or 32.
pub fn store_rgba(
    size: [u32; 2],
    code: impl Fn(usize) -> [f32; 4] + Sync,
    storage: Storage,
) -> Result<Bitmap> {
    stored(size, 4, storage, code)
}

/// Returns the numbers of a bitmap at another bit depth; alpha is kept. Increasing the depth and reducing it again is
/// lossless.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::{Storage, requantised};
///
/// let map = Bitmap::new(1, 1, 3, Texels::U8(vec![[10, 20, 30, 255]]))?;
/// let fine = requantised(&map, Storage { bits: 16, dither: false })?;
/// assert_eq!(requantised(&fine, Storage { bits: 8, dither: false })?, map);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`store_normals`].
pub fn requantised(bitmap: &Bitmap, storage: Storage) -> Result<Bitmap> {
    stored([bitmap.width(), bitmap.height()], bitmap.channels(), storage, |i| bitmap.stored(i))
}

/// Returns the bitmap with each green value g replaced by 1 − g: converts green up to green down and back,
/// bit-exactly.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::green_turned;
///
/// let up = Bitmap::new(1, 1, 3, Texels::U8(vec![[10, 20, 30, 255]]))?;
/// let down = green_turned(&up);
/// assert_eq!(down.texels(), &Texels::U8(vec![[10, 235, 30, 255]]));
/// assert_eq!(green_turned(&down), up);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn green_turned(bitmap: &Bitmap) -> Bitmap {
    let texels = match bitmap.texels() {
        Texels::U8(texels) => Texels::U8(with_green(texels, |g| 255 - g)),
        Texels::U16(texels) => Texels::U16(with_green(texels, |g| 65535 - g)),
        Texels::F32(texels) => Texels::F32(with_green(texels, |g| 1.0 - g)),
    };
    // One channel would become three equal ones.
    let channels = bitmap.channels().max(3);
    Bitmap::new(bitmap.width(), bitmap.height(), channels, texels).expect("the size is that of a bitmap")
}

/// Returns the texels with each green value changed.
fn with_green<T: Copy + Default + Send + Sync>(
    texels: &[[T; 4]],
    change: impl Fn(T) -> T + Sync,
) -> Vec<[T; 4]> {
    parallel::collect(texels.len(), |i| {
        let [r, g, b, a] = texels[i];
        [r, change(g), b, a]
    })
}

fn stored(
    [width, height]: [u32; 2],
    channels: u8,
    storage: Storage,
    number: impl Fn(usize) -> [f32; 4] + Sync,
) -> Result<Bitmap> {
    let count = width as usize * height as usize;
    let codes = |i: usize, top: f64| {
        let at = [i as u32 % width, i as u32 / width];
        let offset = |channel: u32| if storage.dither { dither(at, channel) } else { 0.0 };
        // Truncation, which rounds down since the value is not below 0.
        let code = |channel: usize, v: f32| {
            (f64::from(v) * top + 0.5 + offset(channel as u32)).clamp(0.0, top) as u16
        };
        let [r, g, b, a] = number(i);
        // Alpha is not dithered: opaque texels stay opaque.
        [code(0, r), code(1, g), code(2, b), (f64::from(a) * top + 0.5).clamp(0.0, top) as u16]
    };
    let texels = match storage.bits {
        8 => Texels::U8(parallel::collect(count, |i| codes(i, 255.0).map(|c| c as u8))),
        16 => Texels::U16(parallel::collect(count, |i| codes(i, 65535.0))),
        32 => Texels::F32(parallel::collect(count, number)),
        bits => {
            return Err(Error::invalid(format!("{bits} bits per channel"), "use 8, 16 or 32"));
        }
    };
    Bitmap::new(width, height, channels, texels)
}

/// Returns the pattern at a texel, within ±0.49: a value that is a code up to single precision stays that code.
fn dither([x, y]: [u32; 2], channel: u32) -> f64 {
    // 2³² divided by the plastic number and by its square, and 2³² divided by the golden ratio.
    const STEPS: [u32; 3] = [0xC13F_A9A9, 0x91E1_0DA5, 0x9E37_79B9];
    let phase =
        [x, y, channel].iter().zip(STEPS).fold(0u32, |sum, (v, step)| sum.wrapping_add(v.wrapping_mul(step)));
    (f64::from(phase) / 4_294_967_296.0 - 0.5) * 0.98
}

/// The minimum length, in texels, of a run of equal codes along a row or column that is visible as a band.
const LEAST_RUN: usize = 8;
/// The turn over a run, in degrees, below which the surface is flat and its constant colour is not a band.
const LEAST_TURN: f64 = 0.05;

/// Unit vectors of a map, row by row from the top, and which of its texels a surface covers.
///
/// Its bands are the places where a gentle curve is stored as a single code and shows steps in highlights.
pub struct CoveredNormals<'a> {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// A unit vector per texel.
    pub normals: &'a [[f32; 3]],
    /// Returns true if the surface covers the texel of an index.
    pub is_covered: &'a (dyn Fn(usize) -> bool + Sync),
}

impl CoveredNormals<'_> {
    /// Returns the share of covered texels that are banded if vectors are rounded to 8 bits: in runs of one code
    /// along their row and their column, over at least one of which the vectors turn.
    pub fn banded_share(&self) -> f64 {
        let [width, height] = self.size.map(|side| side as usize);
        let covered = parallel::count(self.normals.len(), |i| (self.is_covered)(i));
        let banded = parallel::tasks(height, &|row| {
            (row * width..(row + 1) * width).filter(|i| self.is_banded(*i)).count()
        });
        banded.into_iter().sum::<usize>() as f64 / covered.max(1) as f64
    }

    fn is_banded(&self, texel: usize) -> bool {
        if !(self.is_covered)(texel) {
            return false;
        }
        let [width, height] = self.size.map(|side| side as usize);
        let (column, row) = (texel % width, texel / width);
        let runs = [
            self.run(texel, 1, (column, width - 1 - column)),
            self.run(texel, width, (row, height - 1 - row)),
        ];
        runs.iter().all(|[first, last, step]| (last - first) / step + 1 >= LEAST_RUN)
            && runs.iter().any(|[first, last, _]| self.turn(*first, *last) >= LEAST_TURN)
    }

    /// Returns the first and the last texel of the run of equal codes around a texel, at most [`LEAST_RUN`] to either
    /// side, and the step from one to the next; `before` and `after` are the number of texels on each side.
    fn run(&self, texel: usize, step: usize, (before, after): (usize, usize)) -> [usize; 3] {
        let code = self.code(texel);
        let is_same = |other: &usize| (self.is_covered)(*other) && self.code(*other) == code;
        let down = (1..=before.min(LEAST_RUN)).map(|i| texel - i * step).take_while(is_same).count();
        let up = (1..=after.min(LEAST_RUN)).map(|i| texel + i * step).take_while(is_same).count();
        [texel - down * step, texel + up * step, step]
    }

    fn code(&self, texel: usize) -> [u8; 3] {
        let number = encode_normal(Vec3::from_array(self.normals[texel])).to_array();
        number.map(|v| (v * 255.0 + 0.5) as u8)
    }

    /// Returns the angle between two vectors, in degrees.
    fn turn(&self, a: usize, b: usize) -> f64 {
        let [a, b] = [a, b].map(|i| Vec3::from_array(self.normals[i]).to_f64());
        angle_deg(a, b)
    }
}

/// Returns a normal map of floats as codes in [0, 1], (n + 1) / 2, if it stores unit vectors as they are; others unchanged.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::unsigned;
///
/// let vectors = Bitmap::new(1, 1, 3, Texels::F32(vec![[0.6, 0.0, 0.8, 1.0]]))?;
/// let codes = unsigned(vectors)?;
/// assert_eq!(codes.stored(0), [0.8, 0.5, 0.9, 1.0]);
/// assert_eq!(unsigned(codes.clone())?.stored(0), codes.stored(0));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// Those of [`Bitmap::new`], none of which can occur.
pub fn unsigned(bitmap: Bitmap) -> Result<Bitmap> {
    let Texels::F32(texels) = bitmap.texels() else { return Ok(bitmap) };
    if bitmap.channels() < 3 || !is_signed(texels) {
        return Ok(bitmap);
    }
    let code = |[x, y, z, alpha]: &[f32; 4]| [0.5 * x + 0.5, 0.5 * y + 0.5, 0.5 * z + 0.5, *alpha];
    let codes = Texels::F32(texels.iter().map(code).collect());
    Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), codes)
}

/// Returns `true` for vectors whose lengths are closer to 1 as they are than as codes. Empty texels are zero.
fn is_signed(texels: &[[f32; 4]]) -> bool {
    let off = |decode: fn(f32) -> f32| {
        let is_filled = |[x, y, z, alpha]: &&[f32; 4]| [x, y, z] != [&0.0; 3] && *alpha > 0.0;
        let off = |[x, y, z, _]: &[f32; 4]| {
            let length = Vec3::new(decode(*x), decode(*y), decode(*z)).length();
            if length.is_finite() { f64::from((length - 1.0).abs()) } else { 0.0 }
        };
        texels.iter().filter(is_filled).map(off).sum::<f64>()
    };
    off(|v| v) < off(|v| 2.0 * v - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STORAGE: Storage = Storage { bits: 8, dither: false };

    #[test]
    fn one_channel_is_stored_as_grey() {
        let map = store_codes([2, 1], |i| [i as f32; 3], 1, STORAGE).unwrap();
        assert_eq!(map.texels(), &Texels::U8(vec![[0, 0, 0, 255], [255; 4]]));
    }

    #[test]
    fn alpha_is_stored() {
        let map = store_rgba([1, 1], |_| [1.0, 0.5, 0.0, 0.2], STORAGE).unwrap();
        assert_eq!(map.texels(), &Texels::U8(vec![[255, 128, 0, 51]]));
        assert_eq!(map.channels(), 4);
    }

    /// Returns the share of banded texels on a map of 64² texels whose normals turn by this many degrees per texel
    /// along x.
    fn share(degrees_a_texel: f64) -> f64 {
        let lean = |i: usize| (degrees_a_texel * (i % 64) as f64).to_radians();
        let normal = |i: usize| {
            [crate::math::scalar::sin(lean(i)) as f32, 0.0, crate::math::scalar::cos(lean(i)) as f32]
        };
        let normals: Vec<[f32; 3]> = (0..64 * 64).map(normal).collect();
        CoveredNormals { size: [64; 2], normals: &normals, is_covered: &|_| true }.banded_share()
    }

    #[test]
    fn gentle_curves_have_bands_and_flat_or_rough_surfaces_have_none() {
        assert_eq!([share(0.0), share(0.2)], [0.0; 2]);
        assert!(share(0.02) > 0.9, "{}", share(0.02));
    }

    #[test]
    fn texels_that_nothing_covers_do_not_count() {
        let normals = vec![[0.0, 0.0, 1.0]; 64];
        let map = CoveredNormals { size: [8; 2], normals: &normals, is_covered: &|_| false };
        assert_eq!(map.banded_share(), 0.0);
    }
}
