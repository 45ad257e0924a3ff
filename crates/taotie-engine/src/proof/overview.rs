//! Compares scan and asset as seen: the same pixels of both, from all sides; and repeats views of a surface with
//! different images in its textures.

use super::close_up::OUTLINE;
use super::statistics::Estimate;
use super::{Difference, Look, NOTICEABLE, Pair, Properties, Sample, Shade, Side};
use crate::bake::{LookupPoint, Retextured, sphere_directions};
use crate::compare::angle_deg;
use crate::error::Result;
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::math::{Vec3, integration::Sequence, scalar};
use crate::parallel;
use crate::trace::Ray;

/// Number of fixed directions from which the object is seen.
pub(super) const VIEWS: usize = 32;
/// Pixels across an object that is seen as a whole.
pub(super) const SIDE: usize = 512;
/// Samples along each side of a pixel of an object seen as a whole. Larger pixels have more of them, equally spaced,
/// up to a maximum.
const SAMPLES: f32 = 4.0;
const MOST_SAMPLES: f32 = 16.0;
/// Depths within a pixel that differ by more than this many pixels belong to an outline, or to a surface that slants
/// by more than 76°.
const STEEPEST: f32 = 4.0;

/// Differences at the same pixels, the object seen as a whole.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Overview {
    /// Degrees between the mean normals of a pixel, excluding outlines; 90 if the asset is unlit and the scan is not.
    pub angles: Option<Estimate>,
    /// Colour differences, CIEDE2000: between the mean base colours of a pixel, or between its emission, relative to its
    /// brightest channel if that exceeds 1, or 100 times the difference of opacity of blended materials, whichever is largest;
    /// `None` if colours are not compared.
    pub color: Option<Estimate>,
    /// Differences of metallic, of roughness, or of the occlusion that the scan has, whichever is largest, [0, 1]; `None` as
    /// for colours.
    #[serde(default)]
    pub material: Option<Estimate>,
    /// Number of pixels compared.
    pub pixels: usize,
    /// Pixels across the object: 512, or fewer for a level of detail that is only shown at that size; 4,096 or 32,768 if
    /// the object is so thin, such as wires, that it fills hardly any pixel otherwise.
    pub across: f32,
}

impl Default for Overview {
    /// No pixels of a whole object.
    fn default() -> Self {
        Self { angles: None, color: None, material: None, pixels: 0, across: SIDE as f32 }
    }
}

/// The pixels to compare in an overview.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picture {
    /// Pixels across the object.
    pub across: f32,
    /// The number of random pixels.
    pub count: usize,
}

impl Picture {
    /// Returns the picture of an object that fills 512² pixels.
    pub fn whole(count: usize) -> Self {
        Self::of(SIDE as f32, count)
    }

    /// Returns the picture of an object that is fewer pixels across, with about as many samples as `whole` pixels of
    /// the whole have.
    pub fn of(across: f32, whole: usize) -> Self {
        Self { across, count: (whole as f32 * (across / SIDE as f32).min(1.0)).ceil() as usize }
    }

    /// Returns a picture from closer if hardly any pixel of a whole object shows a surface throughout, as of thin parts. Levels of
    /// detail for fewer pixels are judged at their size.
    fn closer(self, filled: usize) -> Option<Self> {
        /// The share of the pixels that must be filled.
        const LEAST: f64 = 1e-3;
        /// The most pixels across an object.
        const MOST: f32 = 32_768.0;
        let closer = Self { across: self.across * 8.0, ..self };
        let is_whole = self.across >= SIDE as f32;
        (is_whole && closer.across <= MOST && (filled as f64) < LEAST * self.count as f64).then_some(closer)
    }

    /// Returns the number of samples along each side of a pixel.
    fn samples(self) -> u32 {
        (SAMPLES * SIDE as f32 / self.across).round().clamp(SAMPLES, MOST_SAMPLES) as u32
    }
}

/// Compares random pixels, half of which see through glass and the like, with 16 samples each, up to 256 for smaller pictures: of 32 fixed views in which the
/// object just fills the picture; of an interior, of views in all directions from viewpoints in its free space, with
/// as many pixels per right angle. Textures are read at the sample spacing.
///
/// # Errors
/// As [`Estimate::of`].
pub fn overview(pair: &Pair<'_>, picture: Picture) -> Result<Overview> {
    let PixelDifferences { angles, colors, materials, across, .. } = pixel_differences(pair, picture);
    Ok(Overview {
        angles: Estimate::of(&angles)?,
        color: Estimate::of(&colors)?,
        material: Estimate::of(&materials)?,
        pixels: angles.len(),
        across,
    })
}

/// Differences at the same pixels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PixelDifferences {
    /// Degrees between the mean normals; 90 if the asset is unlit and the scan is not.
    pub angles: Vec<f32>,
    /// Colour differences, CIEDE2000, of the pixels that have colours; empty if colours are not compared.
    pub colors: Vec<f32>,
    /// Differences of metallic, roughness or occlusion, whichever is largest, [0, 1]; empty if colours are not compared.
    pub materials: Vec<f32>,
    /// The share of the pixels with the scan in which nothing of the asset is seen or near, [0, 1].
    pub missing: f64,
    /// Pixels across the object: more than in the picture asked for if it is thin.
    pub across: f32,
}

impl PixelDifferences {
    /// Returns the same in ascending order.
    pub fn sorted(mut self) -> Self {
        for differences in [&mut self.angles, &mut self.colors, &mut self.materials] {
            differences.sort_unstable_by(f32::total_cmp);
        }
        self
    }
}

/// Compares random pixels as [`overview`] does.
pub fn pixel_differences(pair: &Pair<'_>, picture: Picture) -> PixelDifferences {
    let pixels = Pixels::of(pair, picture);
    let probe = |i: usize| difference(pair, &pixels.number(i));
    let found: Vec<Compared> = parallel::collect(picture.count, probe);
    let missing = found.iter().filter(|pixel| matches!(pixel, Compared::Missing)).count();
    let both: Vec<Difference> = found.into_iter().filter_map(Compared::difference).collect();
    if let Some(closer) = picture.closer(missing + both.len()) {
        return pixel_differences(pair, closer);
    }
    let all = |of: fn(&Difference) -> f32| both.iter().map(of).filter(|v| !v.is_nan()).collect();
    let missing = missing as f64 / (missing + both.len()).max(1) as f64;
    PixelDifferences {
        angles: all(|one| one.angle_deg),
        colors: all(|one| one.color),
        materials: all(|one| one.material),
        missing,
        across: picture.across,
    }
}

/// The comparison of a pixel.
#[derive(Clone, Default)]
enum Compared {
    /// One of its samples sees nothing, or it shows an outline.
    #[default]
    Outline,
    /// The scan, and nothing of the asset is seen or near.
    Missing,
    Both(Difference),
}

impl Compared {
    fn difference(self) -> Option<Difference> {
        if let Self::Both(difference) = self { Some(difference) } else { None }
    }
}

/// Returns the samples of those random pixels that see a surface throughout, away from outlines.
fn overview_samples(side: &Side<'_>, picture: Picture) -> Vec<Vec<Sample>> {
    let diagonal = side.surface.mesh().diagonal() as f32;
    let pair = Pair { scan: side, asset: side, diagonal, properties: Properties::None };
    let pixels = Pixels::of(&pair, picture);
    let seen: Vec<Vec<Sample>> =
        parallel::collect(picture.count, |i| pixels.number(i).samples(side)).into_iter().flatten().collect();
    match picture.closer(seen.len()) {
        Some(closer) => overview_samples(side, closer),
        None => seen,
    }
}

/// The random pixels of an overview.
struct Pixels {
    eyes: Vec<Eye>,
    numbers: Sequence,
    /// The distance up to which surfaces are seen.
    far: f32,
    picture: Picture,
}

impl Pixels {
    fn of(pair: &Pair<'_>, picture: Picture) -> Self {
        let directions = sphere_directions(VIEWS);
        let eyes = match pair.scan.visibility.places() {
            [] => parallel::tasks(VIEWS, &|i| {
                Eye::Outside(View::fitting(pair, (directions[i], picture.across)))
            }),
            places => places.iter().map(|place| Eye::Within(*place)).collect(),
        };
        Self { eyes, numbers: Sequence::new(11), far: pair.diagonal * 4.0, picture }
    }

    fn number(&self, i: usize) -> Pixel {
        let eyes = self.eyes.len();
        let round = (i / eyes) as u32;
        let set = 1 + (i % eyes) as u32 + round / Sequence::MOST * eyes as u32;
        let [x, y, ..] = self.numbers.four(round % Sequence::MOST, set);
        let pixel = self.eyes[i % eyes].pixel([x, y], (self.picture, self.far));
        Pixel { sees_through: round % 2 == 1, ..pixel }
    }
}

/// Compares a pixel. It shows both surfaces if all of its samples see both, away from outlines.
fn difference(pair: &Pair<'_>, pixel: &Pixel) -> Compared {
    let Some(samples) = pixel.samples(pair.scan) else { return Compared::Outline };
    match pixel.samples(pair.asset) {
        Some(of_asset) => {
            let scan = Look::of(pair.scan.surface, samples, pair.properties);
            let asset = Look::of(pair.asset.surface, of_asset, pair.properties);
            Compared::Both(Difference::between(&scan, &asset, pair.properties))
        }
        None => {
            let Sample { at, toward } = samples[0];
            let position = at.point.position(pair.scan.surface.mesh());
            match pair.asset.is_near(position, (toward, pair.diagonal * OUTLINE)) {
                true => Compared::Outline,
                false => Compared::Missing,
            }
        }
    }
}

/// The position of a viewer.
enum Eye {
    /// Far away, so that all lines of sight are parallel.
    Outside(View),
    /// At a point within, looking around.
    Within(Vec3),
}

impl Eye {
    /// Returns the pixel at a position of the picture, [0, 1)², or of the sphere around the viewer. Surfaces are seen
    /// as far as `far`.
    fn pixel(&self, [x, y]: [f32; 2], (picture, far): (Picture, f32)) -> Pixel {
        let (across, samples) = (picture.across, picture.samples());
        match self {
            Self::Outside(view) => {
                let [column, row] = [x, y].map(|v| (v * across).floor() * view.pixel);
                let corner = view.corner + view.axes[0] * column + view.axes[1] * row;
                Pixel {
                    origin: corner + view.toward * view.away,
                    direction: -view.toward,
                    steps: view.axes.map(|axis| axis * view.pixel),
                    size: view.pixel,
                    samples,
                    is_central: false,
                    limit: view.away * 2.0 + view.pixel,
                    sees_through: false,
                }
            }
            Self::Within(place) => {
                let direction = on_sphere([x, y]);
                let right = direction.any_perpendicular();
                let size = std::f32::consts::FRAC_PI_2 / across;
                let steps = [right * size, direction.cross(right) * size];
                let (is_central, sees_through) = (true, false);
                Pixel {
                    origin: *place,
                    direction,
                    steps,
                    size,
                    samples,
                    is_central,
                    limit: far,
                    sees_through,
                }
            }
        }
    }
}

/// Returns a direction, uniform over the sphere for positions uniform over [0, 1)².
fn on_sphere([x, y]: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * f64::from(x);
    let (r, angle) = ((1.0 - z * z).max(0.0).sqrt(), 2.0 * std::f64::consts::PI * f64::from(y));
    Vec3::new(scalar::cos(angle) * r, scalar::sin(angle) * r, z).to_f32()
}

/// A pixel of a parallel or central view.
struct Pixel {
    /// The viewer, or the pixel's corner at the viewer's depth.
    origin: Vec3,
    direction: Vec3,
    /// Along the pixel's sides: for a parallel view added to the origin, for a central one to the direction.
    steps: [Vec3; 2],
    /// The side of the pixel, in model units; for a central view at the distance 1.
    size: f32,
    /// Samples along each side.
    samples: u32,
    is_central: bool,
    limit: f32,
    /// `true` if it shows what is behind everything that can be seen through.
    sees_through: bool,
}

impl Pixel {
    /// Returns the points that its samples see; `None` if one sees nothing, or if the pixel shows an outline.
    fn samples(&self, side: &Side<'_>) -> Option<Vec<Sample>> {
        let count = self.samples;
        let mut samples = Vec::with_capacity((count * count) as usize);
        let [mut nearest, mut farthest] = [f32::INFINITY, f32::NEG_INFINITY];
        for i in 0..count * count {
            let [x, y] = [i % count, i / count].map(|k| (k as f32 + 0.5) / count as f32);
            let step = self.steps[0] * x + self.steps[1] * y;
            let ray = match self.is_central {
                true => Ray::new(self.origin, (self.direction + step).normalize()),
                false => Ray::new(self.origin + step, self.direction),
            };
            let from = if self.sees_through { self.limit } else { 0.0 };
            let hit = side.surface.first_seen_beyond(&ray, (from, self.limit))?;
            (nearest, farthest) = (nearest.min(hit.distance), farthest.max(hit.distance));
            let at = LookupPoint { point: hit.point(), width: self.size_at(hit.distance) / count as f32 };
            samples.push(Sample { at, toward: -ray.direction() });
        }
        (farthest - nearest <= STEEPEST * self.size_at(nearest)).then_some(samples)
    }

    fn size_at(&self, distance: f32) -> f32 {
        if self.is_central { self.size * distance } else { self.size }
    }
}

/// A parallel view of an object that fills the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// From the object to the viewer, unit.
    pub toward: Vec3,
    /// Across and down the picture, unit.
    pub axes: [Vec3; 2],
    /// The point at the picture's corner, at the depth of the object's centre.
    pub corner: Vec3,
    /// The side of a pixel, in model units.
    pub pixel: f32,
    /// From the object's centre to the viewer, in model units.
    away: f32,
}

impl View {
    /// Returns the view along a direction into which both surfaces of a pair just fit, with this number of pixels
    /// across.
    pub fn fitting(pair: &Pair<'_>, (toward, pixels): (Vec3, f32)) -> Self {
        let across = toward.any_perpendicular();
        let axes = [across, toward.cross(across)];
        let extent = |direction: Vec3| {
            let of = |side: &Side<'_>| side.surface.bvh().extent_along(direction);
            of(pair.scan).max(of(pair.asset))
        };
        let [low, high] =
            [-1.0, 1.0].map(|sign| [axes[0], axes[1], toward].map(|axis| sign * extent(axis * sign)));
        let middle: [f32; 3] = std::array::from_fn(|k| (low[k] + high[k]) * 0.5);
        let width = (high[0] - low[0]).max(high[1] - low[1]).max(f32::MIN_POSITIVE);
        let center = axes[0] * middle[0] + axes[1] * middle[1] + toward * middle[2];
        let corner = center - axes[0] * (width * 0.5) - axes[1] * (width * 0.5);
        let pixel = width / pixels;
        Self { toward, axes, corner, pixel, away: (high[2] - low[2]) * 0.5 + pixel }
    }
}

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
    /// Finds the pixels of [`overview`].
    pub fn new(side: &'a Side<'a>, picture: Picture) -> Self {
        Self { side, pixels: overview_samples(side, picture) }
    }

    /// Returns the pixels that show the first texture whose texels have this meaning; `None` if there is none.
    ///
    /// # Errors
    /// As [`Bitmap::new`](crate::image::Bitmap::new).
    pub fn first(&'a self, encoding: Encoding) -> Result<Option<ImageLook<'a>>> {
        let textures = self.side.surface.surface().textures();
        let number = textures.iter().position(|texture| texture.encoding() == encoding);
        number.map(|number| self.at(Shown { textures: vec![number], encoding })).transpose()
    }

    /// Returns the pixels that show an image: of one that only emits light, those where it does.
    ///
    /// # Errors
    /// As [`Bitmap::new`](crate::image::Bitmap::new).
    pub fn at(&'a self, shown: Shown) -> Result<ImageLook<'a>> {
        let surface = self.side.surface.surface();
        let shows = surface.materials_with(&shown.textures);
        let is_shown = |samples: &&Vec<Sample>| shows[surface.material_number(samples[0].at.point.triangle)];
        let mut pixels: Vec<&[Sample]> = self.pixels.iter().filter(is_shown).map(Vec::as_slice).collect();
        let seen_with = |texture: &Texture| -> Result<Vec<Seen>> {
            let surface = Retextured::new(self.side.surface, &shown.textures, texture)?;
            Ok(parallel::tasks(pixels.len(), &|i| Seen::of(&surface, pixels[i], shown.encoding)))
        };
        let mut seen = seen_with(&surface.textures()[shown.textures[0]])?;
        if shown.encoding == Encoding::Srgb {
            let black = Bitmap::new(1, 1, 3, Texels::U8(vec![[0, 0, 0, u8::MAX]]))?;
            let black = seen_with(&Texture::new(black, Encoding::Srgb))?;
            if let Some(emitting) = emitting(&seen, &black, &pixels) {
                pixels = emitting.iter().map(|i| pixels[*i]).collect();
                seen = emitting.iter().map(|i| seen[*i]).collect();
            }
        }
        Ok(ImageLook { side: self.side, shown, pixels, seen })
    }
}

/// Returns the pixels at which an image shows light, if it shows nothing else: a display in a black image is so small a
/// part of the surface that statistics of all pixels would not see it. `black` are the pixels without the image.
fn emitting(seen: &[Seen], black: &[Seen], pixels: &[&[Sample]]) -> Option<Vec<usize>> {
    let is_same = |(a, b): (&Seen, &Seen)| a.sum == b.sum && a.alpha == b.alpha;
    let emits =
        |i: &usize| seen[*i].difference(&black[*i], Encoding::Srgb, pixels[*i].len()) > NOTICEABLE as f32;
    let emitting: Vec<usize> = (0..seen.len()).filter(emits).collect();
    (!emitting.is_empty() && seen.iter().zip(black).all(is_same)).then_some(emitting)
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
    /// As [`Bitmap::new`](crate::image::Bitmap::new).
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
        let shade = |seen: &Self| Shade {
            color: mean(seen.sum),
            light: mean(seen.other),
            opacity: seen.alpha / samples as f32,
        };
        match encoding {
            Encoding::Normal => angle_deg(self.sum.to_f64(), other.sum.to_f64()) as f32,
            Encoding::Srgb => shade(self).difference(shade(other)) as f32,
            Encoding::Linear => {
                let numbers = mean(self.other).into_iter().zip(mean(other.other));
                numbers.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
            }
        }
    }
}
