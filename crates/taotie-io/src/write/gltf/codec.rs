//! Image formats in glTF and their settings for lossy compression.

use std::fmt;
use std::str::FromStr;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Encoding;
use taotie_engine::names::Named;

/// An image format in glTF, with its quality.
///
/// ```
/// use taotie_io::ImageCodec;
///
/// assert_eq!("webp:85".parse::<ImageCodec>()?, ImageCodec::LossyWebP(85));
/// assert_eq!(ImageCodec::Jpeg(90).to_string(), "jpeg:90");
/// assert!("jpeg".parse::<ImageCodec>().is_err(), "JPEG requires a quality");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, serde::Serialize, serde::Deserialize,
)]
#[serde(into = "String", try_from = "String")]
pub enum ImageCodec {
    /// PNG: lossless, with the bitmap's precision; supported by every program.
    #[default]
    Png,
    /// JPEG 4:4:4 of a quality from 1 to 100; supported by every program. It has no alpha: images whose alpha is read
    /// become PNG.
    Jpeg(u8),
    /// Lossless WebP (EXT_texture_webp); 16 bits are rounded to 8. Programs without the extension cannot read the
    /// file.
    WebP,
    /// WebP of a quality from 1 to 100, with chroma at half resolution along each axis; alpha is lossless.
    LossyWebP(u8),
    /// AVIF of a quality from 1 to 100, stored as RGB (EXT_texture_avif); 16 bits are rounded to 8. Browsers read it,
    /// but few other programs do. It has no alpha: images whose alpha is read become PNG.
    Avif(u8),
    /// KTX2 with UASTC blocks and mip levels (KHR_texture_basisu), each compressed with Zstandard: less than one byte
    /// per texel in the file, one byte in GPU memory. 16 bits are rounded to 8, and sides must be multiples of 4. It
    /// has no alpha: images whose alpha is read become PNG.
    ///
    /// The number is λ of the rate–distortion optimisation, from 0 (off) to 64: blocks repeat earlier ones if that
    /// saves Zstandard enough, and the mean square error of a block rises by at most λ² of 255².
    Ktx2(u8),
}

/// A kind of [`ImageCodec`], regardless of its quality.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CodecKind {
    /// PNG.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP, lossless and lossy.
    WebP,
    /// AVIF.
    Avif,
    /// KTX2.
    Ktx2,
}

impl Named for CodecKind {
    const WHAT: &'static str = "image format";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("png", Self::Png),
        ("jpeg", Self::Jpeg),
        ("webp", Self::WebP),
        ("avif", Self::Avif),
        ("ktx2", Self::Ktx2),
    ];
}

impl CodecKind {
    /// Returns the least lossy codec of this kind; `None` for JPEG and AVIF, which require a quality.
    pub fn least_lossy(self) -> Option<ImageCodec> {
        match self {
            Self::Png => Some(ImageCodec::Png),
            Self::Jpeg | Self::Avif => None,
            Self::WebP => Some(ImageCodec::WebP),
            Self::Ktx2 => Some(ImageCodec::Ktx2(0)),
        }
    }

    /// Returns the kind of an encoded image; `None` if it is none of these.
    pub(super) fn detect(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f', ..] => Some(Self::Avif),
            [0xab, b'K', b'T', b'X', b' ', b'2', b'0', ..] => Some(Self::Ktx2),
            _ => None,
        }
    }

    /// Returns the file extension.
    pub(super) fn file_extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
            Self::WebP => "webp",
            Self::Avif => "avif",
            Self::Ktx2 => "ktx2",
        }
    }

    /// Returns its media type.
    pub(super) fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Jpeg => "image/jpeg",
            Self::WebP => "image/webp",
            Self::Avif => "image/avif",
            Self::Ktx2 => "image/ktx2",
        }
    }

    /// Returns the glTF extension that a texture needs to use such an image.
    pub(super) fn extension(self) -> Option<&'static str> {
        match self {
            Self::Png | Self::Jpeg => None,
            Self::WebP => Some("EXT_texture_webp"),
            Self::Avif => Some("EXT_texture_avif"),
            Self::Ktx2 => Some("KHR_texture_basisu"),
        }
    }
}

impl fmt::Display for CodecKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
            Self::Avif => "AVIF",
            Self::Ktx2 => "KTX2",
        })
    }
}

impl ImageCodec {
    /// Returns its kind.
    pub fn kind(self) -> CodecKind {
        match self {
            Self::Png => CodecKind::Png,
            Self::Jpeg(_) => CodecKind::Jpeg,
            Self::WebP | Self::LossyWebP(_) => CodecKind::WebP,
            Self::Avif(_) => CodecKind::Avif,
            Self::Ktx2(_) => CodecKind::Ktx2,
        }
    }

    /// Returns the quality of JPEG, AVIF and lossy WebP, or λ of KTX2; `None` for lossless formats and without λ.
    pub fn number(self) -> Option<u8> {
        match self {
            Self::Png | Self::WebP | Self::Ktx2(0) => None,
            Self::Jpeg(number) | Self::LossyWebP(number) | Self::Avif(number) | Self::Ktx2(number) => {
                Some(number)
            }
        }
    }

    /// Returns `true` if it supports alpha.
    pub fn holds_alpha(self) -> bool {
        matches!(self.kind(), CodecKind::Png | CodecKind::WebP)
    }

    /// Returns `true` if it supports images of a size, in texels across and down.
    pub(super) fn holds_size(self, size: [u32; 2]) -> bool {
        self.kind() != CodecKind::Ktx2 || size.iter().all(|side| side.is_multiple_of(4))
    }

    /// Checks that its number is in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the number.
    pub fn check(self) -> Result<()> {
        let (least, most) = match self {
            Self::Ktx2(_) => (0, 64),
            _ => (1, 100),
        };
        match self.number() {
            Some(number) if !(least..=most).contains(&number) => {
                Err(Error::invalid(format!("image format {self}"), format!("use {least} to {most}")))
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for ImageCodec {
    /// Writes a text that parses to the same value: `png`, `webp:85`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = self.kind().name();
        match self.number() {
            Some(number) => write!(f, "{kind}:{number}"),
            None => f.write_str(kind),
        }
    }
}

impl FromStr for ImageCodec {
    type Err = Error;

    /// Parses `png`, `webp`, `webp:85`, `jpeg:90`, `avif:80`, `ktx2` or `ktx2:2`.
    fn from_str(text: &str) -> Result<Self> {
        let text = text.trim();
        let (name, number) = match text.split_once(':') {
            Some((name, number)) => (name, Some(number)),
            None => (text, None),
        };
        let wrong = |why: &str| Error::invalid(format!("image format `{text}`"), why);
        let number: Option<u8> = match number.map(str::parse) {
            Some(Err(_)) => return Err(wrong("expected an integer after the colon, such as webp:85")),
            Some(Ok(number)) => Some(number),
            None => None,
        };
        let codec = match (CodecKind::from_name(name)?, number) {
            (CodecKind::Png, None) => Self::Png,
            (CodecKind::Png, Some(_)) => return Err(wrong("PNG is lossless; leave out the quality")),
            (CodecKind::Jpeg, Some(quality)) => Self::Jpeg(quality),
            (CodecKind::Jpeg, None) => return Err(wrong("specify a quality, such as jpeg:90")),
            (CodecKind::Avif, Some(quality)) => Self::Avif(quality),
            (CodecKind::Avif, None) => return Err(wrong("specify a quality, such as avif:80")),
            (CodecKind::WebP, None) => Self::WebP,
            (CodecKind::WebP, Some(quality)) => Self::LossyWebP(quality),
            (CodecKind::Ktx2, lambda) => Self::Ktx2(lambda.unwrap_or(0)),
        };
        codec.check()?;
        Ok(codec)
    }
}

/// The image formats of the textures of a model.
///
/// ```
/// use taotie_io::{ImageCodec, TextureCodecs};
///
/// let lossy: TextureCodecs = "webp:85".parse()?;
/// assert_eq!((lossy.colors, lossy.normals), (ImageCodec::LossyWebP(85), ImageCodec::WebP));
/// let each: TextureCodecs = "jpeg:90/webp/webp:75".parse()?;
/// assert_eq!(each.to_string(), "jpeg:90/webp/webp:75");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct TextureCodecs {
    /// For base colour and emission.
    pub colors: ImageCodec,
    /// For normal maps.
    pub normals: ImageCodec,
    /// For roughness, metallic and occlusion, whose channels bleed into each other in lossy formats.
    pub numbers: ImageCodec,
}

impl From<ImageCodec> for TextureCodecs {
    /// Derives the formats of all textures from that of colours: the loss of JPEG, WebP and AVIF applies only to
    /// colours, λ of KTX2 to all but normals.
    fn from(colors: ImageCodec) -> Self {
        let (normals, numbers) = match colors {
            ImageCodec::Png | ImageCodec::Jpeg(_) => (ImageCodec::Png, ImageCodec::Png),
            ImageCodec::WebP | ImageCodec::LossyWebP(_) | ImageCodec::Avif(_) => {
                (ImageCodec::WebP, ImageCodec::WebP)
            }
            ImageCodec::Ktx2(_) => (ImageCodec::Ktx2(0), colors),
        };
        Self { colors, normals, numbers }
    }
}

impl TextureCodecs {
    /// Returns the format of images with texels of this encoding.
    pub fn of(&self, encoding: Encoding) -> ImageCodec {
        match encoding {
            Encoding::Srgb => self.colors,
            Encoding::Normal => self.normals,
            Encoding::Linear => self.numbers,
        }
    }

    /// Returns the formats of colours, normals and numbers.
    pub fn all(&self) -> [ImageCodec; 3] {
        [self.colors, self.normals, self.numbers]
    }

    /// Returns `true` if any texture has a format of this kind.
    pub fn has(&self, kind: CodecKind) -> bool {
        self.all().iter().any(|codec| codec.kind() == kind)
    }

    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] with the number.
    pub fn check(&self) -> Result<()> {
        self.all().into_iter().try_for_each(ImageCodec::check)
    }
}

impl fmt::Display for TextureCodecs {
    /// Writes only the format of colours if the others follow from it, else all three: `webp:85`,
    /// `jpeg:90/webp/webp:75`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { colors, normals, numbers } = self;
        match Self::from(*colors) == *self {
            true => colors.fmt(f),
            false => write!(f, "{colors}/{normals}/{numbers}"),
        }
    }
}

impl FromStr for TextureCodecs {
    type Err = Error;

    /// Parses one format, or those of colours, normals and numbers.
    fn from_str(text: &str) -> Result<Self> {
        match text.split('/').collect::<Vec<_>>()[..] {
            [one] => Ok(one.parse::<ImageCodec>()?.into()),
            [colors, normals, numbers] => {
                Ok(Self { colors: colors.parse()?, normals: normals.parse()?, numbers: numbers.parse()? })
            }
            _ => Err(Error::invalid(
                format!("image formats `{text}`"),
                "specify one format, or those of colours, normals and numbers, such as jpeg:90/webp/webp:75",
            )),
        }
    }
}

macro_rules! as_text {
    ($($name:ty),*) => {$(
        impl From<$name> for String {
            fn from(codec: $name) -> Self {
                codec.to_string()
            }
        }

        impl TryFrom<String> for $name {
            type Error = Error;

            fn try_from(text: String) -> Result<Self> {
                text.parse()
            }
        }
    )*};
}
as_text!(ImageCodec, TextureCodecs);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_read_back_as_written() {
        for text in ["png", "jpeg:90", "webp", "webp:1", "avif:80", "ktx2", "ktx2:64", "jpeg:90/webp/png"] {
            assert_eq!(text.parse::<TextureCodecs>().unwrap().to_string(), text);
        }
    }

    #[test]
    fn wrong_formats_name_the_fault() {
        let cases = [
            ("gif", "png, jpeg, webp, avif, ktx2"),
            ("png:5", "PNG is lossless"),
            ("jpeg", "specify a quality"),
            ("avif", "specify a quality"),
            ("webp:0", "1 to 100"),
            ("jpeg:101", "1 to 100"),
            ("ktx2:65", "0 to 64"),
            ("webp:x", "integer"),
            ("webp/png", "colours, normals and numbers"),
        ];
        for (text, why) in cases {
            let error = text.parse::<TextureCodecs>().unwrap_err().to_string();
            assert!(error.contains(why), "{error}");
        }
    }
}
