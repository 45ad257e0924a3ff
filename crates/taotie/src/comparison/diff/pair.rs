//! The content of two images, colours or normals; their metrics, and a map of the places where they differ.

use super::{DiffOptions, Encoding, Metric};
use taotie_engine::compare::{
    self, ColorMap, DisplayImage, Field, NormalEncoding, SSIM_WINDOW, StoredNormals, Summary, stored_normals,
    stored_picture,
};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::progress::Progress;
use taotie_engine::surface::{NormalMapKind, is_normal_map};

/// An image with the name used for it in errors and warnings, such as its file's.
///
/// ```no_run
/// use taotie::comparison::diff::NamedBitmap;
///
/// let bitmap = taotie_io::read_bitmap("render.png".as_ref())?;
/// let image = NamedBitmap { name: "render.png", bitmap: &bitmap };
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct NamedBitmap<'a> {
    /// The name.
    pub name: &'a str,
    /// The texels as stored.
    pub bitmap: &'a Bitmap,
}

/// Two images of the same size, ready to compare. The first is the reference.
///
/// ```
/// use taotie::comparison::diff::{DiffOptions, ImagePair, NamedBitmap};
///
/// # use taotie::Bitmap;
/// # use taotie_engine::image::Texels;
/// # let grey = |code: u8| Bitmap::new(16, 16, 1, Texels::U8(vec![[code, code, code, 255]; 256]));
/// # let (black, white) = (grey(0)?, grey(255)?);
/// # let a = NamedBitmap { name: "black.png", bitmap: &black };
/// # let b = NamedBitmap { name: "white.png", bitmap: &white };
/// // `a` is black and `b` is white: colours, not normals.
/// let pair = ImagePair::new([a, b], &DiffOptions::default())?;
/// assert_eq!((pair.shared_normals(), pair.warnings.is_empty()), (None, true));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ImagePair {
    /// The colours or normals.
    pub content: ImageContent,
    /// Counts of faults that were corrected.
    pub warnings: Warnings,
}

/// The content of two images.
///
/// ```
/// use taotie::comparison::diff::{ImageContent, ImagePair};
///
/// /// Returns the word for the content of two images.
/// fn content(pair: &ImagePair) -> &'static str {
///     match pair.content {
///         ImageContent::Pictures(_) => "colours",
///         ImageContent::Normals(_) => "normals",
///     }
/// }
/// ```
#[derive(Debug, Clone)]
pub enum ImageContent {
    /// Colours.
    Pictures([DisplayImage; 2]),
    /// Normals, and how each image stores them.
    Normals([(StoredNormals, NormalEncoding); 2]),
}

/// The memory in bytes per texel of two normal maps: their normals, their angle, and a sorted copy of it.
const NORMALS: u64 = 2 * 16 + 8;

impl ImagePair {
    /// Determines the content of two images, and reads it.
    ///
    /// # Errors
    /// [`Error::Invalid`] if they differ in size, and if [`Metric::Angle`] is requested and one of them does not look
    /// like a normal map.
    pub fn new(images: [NamedBitmap<'_>; 2], options: &DiffOptions) -> Result<Self> {
        check_sizes(&images)?;
        let mut warnings = Warnings::default();
        let content = match normal_encodings(&images, options, &mut warnings)? {
            Some([a, b]) => ImageContent::Normals([normals(images[0], a)?, normals(images[1], b)?]),
            None => {
                let mut picture = |image| picture(image, options, &mut warnings);
                ImageContent::Pictures([picture(images[0])?, picture(images[1])?])
            }
        };
        Ok(Self { content, warnings })
    }

    /// Returns the memory in bytes needed to compare two images, including their texels.
    ///
    /// ```
    /// use taotie::comparison::diff::{DiffOptions, ImagePair, NamedBitmap};
    ///
    /// # use taotie::Bitmap;
    /// # use taotie_engine::image::Texels;
    /// # let bitmap = Bitmap::new(16, 16, 1, Texels::U8(vec![[0, 0, 0, 255]; 256]))?;
    /// let image = NamedBitmap { name: "black.png", bitmap: &bitmap };
    /// let need = ImagePair::bytes([image, image], &DiffOptions::default())?;
    /// assert!(need > 256 * 100);
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`ImagePair::new`], except for those about sizes.
    pub fn bytes(images: [NamedBitmap<'_>; 2], options: &DiffOptions) -> Result<u64> {
        /// Colours of both, and FLIP's data for each in double precision: colours, blurred colours, features, and the
        /// differences.
        const COLORS: u64 = 2 * (12 + 24 + 24 + 16 + 8) + 32;
        let are_normals = normal_encodings(&images, options, &mut Warnings::default())?.is_some();
        let texel = if are_normals { NORMALS } else { COLORS };
        let of = |image: &NamedBitmap<'_>| image.bitmap.texels().bytes();
        let texels = images.map(|image| image.bitmap.texels().len() as u64);
        Ok(images.iter().map(of).sum::<u64>() + texels[0].max(texels[1]) * texel)
    }

    /// Returns the minimum memory in bytes to compare an image with another of its size and depth, whatever their
    /// content.
    ///
    /// ```
    /// use taotie::comparison::diff::ImagePair;
    ///
    /// # use taotie::Bitmap;
    /// # use taotie_engine::image::Texels;
    /// let bitmap = Bitmap::new(16, 16, 1, Texels::U8(vec![[0, 0, 0, 255]; 256]))?;
    /// assert_eq!(ImagePair::least_bytes(&bitmap), 256 * (4 + 4 + 40));
    /// # Ok::<(), taotie::Error>(())
    /// ```
    pub fn least_bytes(image: &Bitmap) -> u64 {
        2 * image.texels().bytes() + image.texels().len() as u64 * NORMALS
    }

    /// Returns the number of texels that hold a normal in both; `None` for colours.
    pub fn shared_normals(&self) -> Option<usize> {
        let ImageContent::Normals([(a, _), (b, _)]) = &self.content else { return None };
        let pairs = a.normals.pixels().iter().zip(b.normals.pixels());
        Some(pairs.filter(|(a, b)| a[3] > 0.0 && b[3] > 0.0).count())
    }
}

fn check_sizes(images: &[NamedBitmap<'_>; 2]) -> Result<()> {
    let [a, b] = images.map(|image| [image.bitmap.width(), image.bitmap.height()]);
    if a == b {
        return Ok(());
    }
    let size = |image: &NamedBitmap<'_>| {
        format!("{} is {}x{}", image.name, image.bitmap.width(), image.bitmap.height())
    };
    Err(Error::invalid(
        images.each_ref().map(size).join(", "),
        "images must have the same size; resample one of them",
    ))
}

/// Returns the encodings in which the images store normals; `None` to compare colours.
fn normal_encodings(
    images: &[NamedBitmap<'_>; 2],
    options: &DiffOptions,
    warnings: &mut Warnings,
) -> Result<Option<[NormalEncoding; 2]>> {
    let looks_at_colors = options.metric.is_some_and(|metric| metric != Metric::Angle);
    match options.encoding {
        Encoding::Color => return Ok(None),
        Encoding::Normals(encoding) => return Ok(Some([encoding; 2])),
        Encoding::Auto if looks_at_colors => return Ok(None),
        Encoding::Auto => {}
    }
    let [a, b] = [guessed_encoding(images[0].bitmap)?, guessed_encoding(images[1].bitmap)?];
    if let (Some(a), Some(b)) = (a, b) {
        return Ok(Some([a, b]));
    }
    let [a_name, b_name] = images.map(|image| image.name);
    let [is, other] = if a.is_some() { [a_name, b_name] } else { [b_name, a_name] };
    if options.metric == Some(Metric::Angle) {
        let why = "it does not look like a normal map; if it is one, specify how it stores normals";
        return Err(Error::invalid(other, why));
    }
    if a.is_some() || b.is_some() {
        let what =
            format!("{is} looks like a normal map and {other} does not; they are compared as pictures");
        warnings.note(what, 1);
    }
    Ok(None)
}

/// Guesses how an image stores normals, by their length; `None` if it does not look like a normal map.
///
/// ```
/// use taotie::Bitmap;
/// use taotie::comparison::diff::guessed_encoding;
/// use taotie_engine::compare::NormalEncoding;
/// use taotie_engine::image::Texels;
///
/// let codes = Bitmap::new(2, 2, 3, Texels::U8(vec![[128, 128, 255, 255]; 4]))?;
/// let vectors = Bitmap::new(2, 2, 3, Texels::F32(vec![[0.0, 0.0, 1.0, 1.0]; 4]))?;
/// assert_eq!(guessed_encoding(&codes)?, Some(NormalEncoding::Unit));
/// assert_eq!(guessed_encoding(&vectors)?, Some(NormalEncoding::Signed));
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// [`Error::Limit`] if a side is above [`Image::MAX_SIDE`](taotie_engine::image::Image::MAX_SIDE).
pub fn guessed_encoding(bitmap: &Bitmap) -> Result<Option<NormalEncoding>> {
    if matches!(bitmap.texels(), Texels::F32(_)) {
        let signed = stored_normals(bitmap, NormalEncoding::Signed)?;
        let opaque = bitmap.texels().len() - signed.transparent;
        if opaque > 0 && signed.not_unit * 10 < opaque {
            return Ok(Some(NormalEncoding::Signed));
        }
    }
    Ok((is_normal_map(bitmap) != NormalMapKind::No).then_some(NormalEncoding::Unit))
}

fn normals(image: NamedBitmap<'_>, encoding: NormalEncoding) -> Result<(StoredNormals, NormalEncoding)> {
    Ok((stored_normals(image.bitmap, encoding)?, encoding))
}

fn picture(image: NamedBitmap<'_>, options: &DiffOptions, warnings: &mut Warnings) -> Result<DisplayImage> {
    let (picture, clipped) = stored_picture(image.bitmap, options.background)?;
    warnings.note(format!("{}: pixels beyond black or white are clipped", image.name), clipped);
    Ok(picture)
}

/// The metrics of two images; `None` if one does not apply or was not requested.
///
/// ```
/// use taotie::comparison::diff::{DiffFigures, Metric};
///
/// let mut figures = DiffFigures::default();
/// figures.rmse = Some(0.25);
/// assert_eq!(figures.value(Metric::Rmse), Some(0.25));
/// assert_eq!(figures.value(Metric::Angle), None);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct DiffFigures {
    /// Degrees.
    pub angle: Option<Summary>,
    /// [0, 1].
    pub flip: Option<Summary>,
    /// 1 if equal.
    pub ssim: Option<f64>,
    /// Decibels; infinite if the images are equal, which JSON writes as `null`.
    pub psnr: Option<f64>,
    /// [0, 1].
    pub rmse: Option<f64>,
}

impl DiffFigures {
    /// Returns the single value of a metric to compare with a threshold.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        match metric {
            Metric::Angle => self.angle.map(|angle| angle.mean),
            Metric::Flip => self.flip.map(|flip| flip.mean),
            Metric::Ssim => self.ssim,
            Metric::Psnr => self.psnr,
            Metric::Rmse => self.rmse,
        }
    }
}

impl ImagePair {
    /// Measures every requested metric that applies. `progress` has one stage, `diff`.
    ///
    /// # Errors
    /// [`Error::Invalid`] if no texel holds a normal in both images, and if only SSIM is requested and the images are
    /// smaller than its window; [`Error::Cancelled`].
    pub fn figures(&self, options: &DiffOptions, progress: Progress<'_>) -> Result<DiffFigures> {
        match &self.content {
            ImageContent::Normals([(a, _), (b, _)]) => {
                let angle = Some(summary(&compare::angular_error(&a.normals, &b.normals)?)?);
                Ok(DiffFigures { angle, ..DiffFigures::default() })
            }
            ImageContent::Pictures([a, b]) => picture_figures([a, b], options, progress.stage("diff")),
        }
    }
}

fn picture_figures(
    [a, b]: [&DisplayImage; 2],
    options: &DiffOptions,
    progress: Progress<'_>,
) -> Result<DiffFigures> {
    let mut figures = DiffFigures::default();
    let asked = |metric| options.metric.is_none_or(|asked| asked == metric);
    if asked(Metric::Rmse) {
        figures.rmse = Some(compare::rmse(a, b)?);
    }
    if asked(Metric::Psnr) {
        figures.psnr = Some(compare::psnr(a, b)?);
    }
    progress.at(0.1)?;
    let large_enough = a.width().min(a.height()) >= SSIM_WINDOW;
    if asked(Metric::Ssim) && (large_enough || options.metric.is_some()) {
        figures.ssim = Some(compare::ssim(a, b)?);
    }
    progress.at(0.4)?;
    if asked(Metric::Flip) {
        figures.flip = Some(summary(&compare::flip(a, b, options.pixels_per_degree as f32)?)?);
    }
    Ok(figures)
}

fn summary(field: &Field) -> Result<Summary> {
    let why = "there is nothing to compare";
    field.summary().ok_or_else(|| Error::invalid("no texel holds a normal in both images", why))
}

/// The difference at each pixel, and how to show it.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DifferenceMap {
    /// The numbers.
    pub field: Field,
    /// The quantity.
    pub title: &'static str,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// The colours.
    pub map: ColorMap,
    /// The number that maps to the last colour; the first is 0.
    pub top: f32,
}

impl ImagePair {
    /// Returns the difference at each pixel by the requested metric, else by FLIP or by the angle.
    ///
    /// # Errors
    /// As [`ImagePair::figures`].
    pub fn difference_map(&self, options: &DiffOptions) -> Result<DifferenceMap> {
        match &self.content {
            ImageContent::Normals([(a, _), (b, _)]) => {
                Ok(angle_map(compare::angular_error(&a.normals, &b.normals)?))
            }
            ImageContent::Pictures([a, b]) => picture_map([a, b], options),
        }
    }
}

fn angle_map(field: Field) -> DifferenceMap {
    let top = scale(&field);
    DifferenceMap { field, title: "angle between normals", unit: "°", map: ColorMap::Viridis, top }
}

fn picture_map([a, b]: [&DisplayImage; 2], options: &DiffOptions) -> Result<DifferenceMap> {
    let shown = |field, title, map, top| DifferenceMap { field, title, unit: "", map, top };
    Ok(match options.metric.unwrap_or(Metric::Flip) {
        Metric::Ssim => {
            let map = compare::ssim_map(a, b)?;
            let unlike = map.values().iter().map(|v| 1.0 - v).collect();
            shown(Field::new(map.width(), map.height(), unlike)?, "1 - SSIM", ColorMap::Viridis, 1.0)
        }
        Metric::Psnr | Metric::Rmse => {
            let field = compare::difference(a, b)?;
            let top = scale(&field);
            shown(field, "mean absolute difference", ColorMap::Viridis, top)
        }
        Metric::Flip | Metric::Angle => {
            let field = compare::flip(a, b, options.pixels_per_degree as f32)?;
            shown(field, "FLIP", ColorMap::Magma, 1.0)
        }
    })
}

/// Returns a scale robust against a few outliers: the 95 % quantile, else the largest number, else 1.
fn scale(field: &Field) -> f32 {
    let summary = field.summary();
    let tops = summary.map_or([0.0; 2], |summary| [summary.p95, summary.max]);
    tops.into_iter().map(|top| top as f32).find(|top| *top > 0.0).unwrap_or(1.0)
}
