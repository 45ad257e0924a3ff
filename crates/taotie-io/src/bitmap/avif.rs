//! AVIF: the container through `avif-parse`, AV1 through `re_rav1d`, and the conversion from luma and chroma to RGB.

use super::super::reading::{Reading, caught};
use super::limits::{Failure, MAX_TEXELS_OF_PLAIN, TexelRoom, check_room, check_size, credible};
use avif_parse::{AV1Metadata, AvifData, read_avif};
use re_rav1d::dav1d::pixel::{MatrixCoefficients, YUVRange};
use re_rav1d::dav1d::{
    DecodeFrameType, Decoder, Error, Picture, PixelLayout, PlanarImageComponent, Plane, Settings,
};
use taotie_engine::image::{Bitmap, Texels};

/// Bytes that the decoder allocates per 8-bit texel: planes in whole blocks, filtered and unfiltered.
const BESIDE_OF_8_BITS: u64 = 12;

/// Decodes a still image, or the first frame only; 10 and 12 bits are rounded to 8, as in browsers.
pub(super) fn decode(bytes: &[u8], reading: &Reading) -> Result<Bitmap, Failure> {
    caught(|| decode_or_panic(bytes, reading))
        .unwrap_or_else(|| Err(Failure::damaged("inconsistent content")))
}

fn decode_or_panic(bytes: &[u8], reading: &Reading) -> Result<Bitmap, Failure> {
    check_boxes(bytes)?;
    let file: AvifData = read_avif(&mut &bytes[..]).map_err(container_failure)?;
    if file.premultiplied_alpha {
        return Err(Failure::Unsupported("premultiplied alpha".into()));
    }
    let header = file.primary_item_metadata().map_err(container_failure)?;
    let of_alpha = file.alpha_item_metadata().map_err(container_failure)?;
    let size = [header.max_frame_width.get(), header.max_frame_height.get()];
    check_size(size[0].into(), size[1].into(), credible(bytes).max(MAX_TEXELS_OF_PLAIN))?;
    let bytes_of_texel: u64 =
        [Some(&header), of_alpha.as_ref()].into_iter().flatten().map(beside_texel).sum();
    let scratch = bytes_of_texel * u64::from(size[0]) * u64::from(size[1]);
    check_room(reading, size, TexelRoom { depth: 1, scratch })?;
    let color = Planes::decode(&file.primary_item, size)?;
    let alpha = file.alpha_item.map(|alpha| Planes::decode(&alpha, size)).transpose()?;
    bitmap(&color, alpha.as_ref())
}

/// Returns the bytes that the decoder allocates per texel.
fn beside_texel(header: &AV1Metadata) -> u64 {
    let bytes_of_code = if header.bit_depth > 8 { 2 } else { 1 };
    BESIDE_OF_8_BITS * bytes_of_code
}

/// The planes of a decoded image.
struct Planes {
    size: [u32; 2],
    /// Luma, then chroma unless it is monochrome.
    planes: Vec<Plane>,
    /// Bytes from one row to the next, of luma and of chroma.
    strides: [usize; 2],
    bits: usize,
    layout: PixelLayout,
    matrix: MatrixCoefficients,
    range: YUVRange,
}

impl Planes {
    fn decode(content: &[u8], size: [u32; 2]) -> Result<Self, Failure> {
        let mut settings = Settings::new();
        settings.set_n_threads(1);
        settings.set_all_layers(false);
        settings.set_decode_frame_type(DecodeFrameType::Key);
        settings.set_frame_size_limit(size[0].saturating_mul(size[1]));
        let mut decoder = Decoder::with_settings(&settings).map_err(decoder_failure)?;
        match decoder.send_data(content.to_vec(), None, None, None) {
            Ok(()) | Err(Error::Again) => {}
            Err(error) => return Err(decoder_failure(error)),
        }
        let picture: Picture = decoder.get_picture().map_err(decoder_failure)?;
        if [picture.width(), picture.height()] != size {
            return Err(Failure::damaged("its planes do not have the declared size"));
        }
        let layout = picture.pixel_layout();
        let components = match layout {
            PixelLayout::I400 => &[PlanarImageComponent::Y][..],
            _ => &[PlanarImageComponent::Y, PlanarImageComponent::U, PlanarImageComponent::V],
        };
        let stride = |component| picture.stride(component) as usize;
        Ok(Self {
            size,
            planes: components.iter().map(|component| picture.plane(*component)).collect(),
            strides: [PlanarImageComponent::Y, PlanarImageComponent::U].map(stride),
            bits: picture.bit_depth(),
            layout,
            matrix: picture.matrix_coefficients(),
            range: picture.color_range(),
        })
    }

    /// Returns the largest code value.
    fn most(&self) -> f32 {
        ((1u32 << self.bits) - 1) as f32
    }

    fn code(&self, plane: usize, [x, y]: [usize; 2]) -> f32 {
        let (bytes, stride) = (&self.planes[plane], self.strides[plane.min(1)]);
        match self.bits {
            8 => bytes[y * stride + x].into(),
            _ => {
                let at = y * stride + 2 * x;
                u16::from_le_bytes([bytes[at], bytes[at + 1]]).into()
            }
        }
    }

    /// Returns luma in [0, 1].
    fn luma(&self, at: [usize; 2]) -> f32 {
        let code = self.code(0, at);
        match self.range {
            YUVRange::Full => code / self.most(),
            YUVRange::Limited => {
                let unit = (1u32 << (self.bits - 8)) as f32;
                (code - 16.0 * unit) / (219.0 * unit)
            }
        }
    }

    /// Returns the value of a chroma plane at a texel, interpolated if the plane is subsampled.
    fn chroma_code(&self, plane: usize, at: [usize; 2]) -> f32 {
        let is_halved = match self.layout {
            PixelLayout::I420 => [true, true],
            PixelLayout::I422 => [true, false],
            PixelLayout::I444 | PixelLayout::I400 => [false, false],
        };
        let [across, down] = [0, 1].map(|axis| {
            let samples = self.size[axis] as usize;
            if is_halved[axis] {
                halved(at[axis], samples.div_ceil(2))
            } else {
                [(at[axis], 1.0), (at[axis], 0.0)]
            }
        });
        let products =
            down.iter().flat_map(|(y, of_y)| across.iter().map(move |(x, of_x)| ([*x, *y], of_x * of_y)));
        products.filter(|(_, part)| *part > 0.0).map(|(at, part)| part * self.code(plane, at)).sum()
    }

    /// Returns chroma centred on 0.
    fn chroma(&self, plane: usize, at: [usize; 2]) -> f32 {
        let zero = (1u32 << (self.bits - 1)) as f32;
        let unit = match self.range {
            YUVRange::Full => self.most(),
            YUVRange::Limited => 224.0 * (1u32 << (self.bits - 8)) as f32,
        };
        (self.chroma_code(plane, at) - zero) / unit
    }

    /// Returns red, green and blue in [0, 1].
    fn rgb(&self, at: [usize; 2], weights: Option<[f32; 2]>) -> [f32; 3] {
        let luma = self.luma(at);
        if self.planes.len() < 3 {
            return [luma; 3];
        }
        let Some([of_red, of_blue]) = weights else {
            let [blue, red] = [1, 2].map(|plane| self.code(plane, at) / self.most());
            return [red, luma, blue];
        };
        let [blue, red] = [1, 2].map(|plane| self.chroma(plane, at));
        let (red, blue) = (luma + 2.0 * (1.0 - of_red) * red, luma + 2.0 * (1.0 - of_blue) * blue);
        [red, (luma - of_red * red - of_blue * blue) / (1.0 - of_red - of_blue), blue]
    }

    /// Returns the weights of red and blue in luma; `None` for RGB and greyscale. Source: ITU-T H.273, table 4.
    fn weights(&self) -> Result<Option<[f32; 2]>, Failure> {
        use MatrixCoefficients::{BT470BG, BT709, BT2020NonConstantLuminance, Identity, ST170M, Unspecified};
        if self.planes.len() < 3 {
            return Ok(None);
        }
        match self.matrix {
            Identity if self.layout == PixelLayout::I444 && self.range == YUVRange::Full => Ok(None),
            BT470BG | ST170M | Unspecified => Ok(Some([0.299, 0.114])),
            BT709 => Ok(Some([0.2126, 0.0722])),
            BT2020NonConstantLuminance => Ok(Some([0.2627, 0.0593])),
            other => Err(Failure::Unsupported(format!("colour matrix {other}"))),
        }
    }
}

/// Returns the two samples around a texel along an axis with half the samples, and their weights: samples lie between
/// texels.
fn halved(texel: usize, samples: usize) -> [(usize, f32); 2] {
    let own = texel / 2;
    let other = if texel.is_multiple_of(2) { own.saturating_sub(1) } else { (own + 1).min(samples - 1) };
    [(own, 0.75), (other, 0.25)]
}

fn bitmap(color: &Planes, alpha: Option<&Planes>) -> Result<Bitmap, Failure> {
    let ([width, height], weights) = (color.size, color.weights()?);
    let texel = |i: usize| {
        let at = [i % width as usize, i / width as usize];
        let [r, g, b] = color.rgb(at, weights);
        [r, g, b, alpha.map_or(1.0, |alpha| alpha.luma(at))]
    };
    let count = width as usize * height as usize;
    let rounded = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let texels = Texels::U8((0..count).map(|i| texel(i).map(rounded)).collect());
    let colors = if color.planes.len() < 3 { 1 } else { 3 };
    let channels = colors + u8::from(alpha.is_some());
    Bitmap::new(width, height, channels, texels).map_err(|error| Failure::damaged(&error.to_string()))
}

fn container_failure(error: avif_parse::Error) -> Failure {
    match error {
        avif_parse::Error::Unsupported(what) => Failure::Unsupported(what.to_owned()),
        other => Failure::damaged(&other.to_string()),
    }
}

fn decoder_failure(error: Error) -> Failure {
    match error {
        Error::UnsupportedBitstream => Failure::Unsupported("this kind of AV1 stream".into()),
        _ => Failure::damaged("cannot decode its pixels"),
    }
}

/// Maximum number of items in a file: the image, its alpha, thumbnails, metadata.
const MOST_ITEMS: u64 = 64;

/// A box: its type and its content.
type FileBox<'a> = ([u8; 4], &'a [u8]);

/// Checks the boxes of the HEIF file that its reader relies on: rejects items in several extents, which the reader
/// would join whatever their lengths add up to, and images with a rotation, mirror or crop. Source: ISO/IEC 14496-12,
/// 8.11.
fn check_boxes(bytes: &[u8]) -> Result<(), Failure> {
    let meta = content(bytes, *b"meta").ok_or_else(|| Failure::damaged("missing list of items"))?;
    // A version and flags come first.
    let meta = meta.get(4..).unwrap_or_default();
    let locations = content(meta, *b"iloc").ok_or_else(|| Failure::damaged("missing item locations"))?;
    if items_in_one_piece(locations).is_none() {
        return Err(Failure::Unsupported("AVIF with many items, or with items in several extents".into()));
    }
    let properties = content(meta, *b"iprp").and_then(|all| content(all, *b"ipco")).unwrap_or_default();
    let is_transform = |(kind, _): &FileBox<'_>| [*b"irot", *b"imir", *b"clap"].contains(kind);
    match boxes(properties).any(|property| is_transform(&property)) {
        true => Err(Failure::Unsupported("AVIF with a rotation, mirror or crop".into())),
        false => Ok(()),
    }
}

/// Returns the content of the first box of a type.
fn content(bytes: &[u8], wanted: [u8; 4]) -> Option<&[u8]> {
    boxes(bytes).find(|(kind, _)| *kind == wanted).map(|(_, content)| content)
}

/// Returns consecutive boxes, up to the first damaged one.
fn boxes(bytes: &[u8]) -> impl Iterator<Item = FileBox<'_>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let mut reader = Reader(rest);
        let length = reader.number(4)?;
        let kind = reader.number(4)? as u32;
        let (length, head) = match length {
            0 => (rest.len() as u64, 8),
            1 => (reader.number(8)?, 16),
            length => (length, 8),
        };
        let content = rest.get(head..usize::try_from(length).ok()?)?;
        rest = &rest[head + content.len()..];
        Some((kind.to_be_bytes(), content))
    })
}

/// Returns `Some` if an `iloc` box lists few items, each in one extent.
fn items_in_one_piece(iloc: &[u8]) -> Option<()> {
    let mut reader = Reader(iloc);
    let version = reader.number(1)?;
    reader.number(3)?;
    let [sizes, more] = [reader.number(1)?, reader.number(1)?].map(|byte| [byte >> 4, byte & 15]);
    let ([offset, length], [base, index]) = (sizes, more);
    let index = if version == 0 { 0 } else { index };
    let bytes_of_id = if version < 2 { 2 } else { 4 };
    let count = reader.number(bytes_of_id)?;
    if count > MOST_ITEMS {
        return None;
    }
    for _ in 0..count {
        reader.number(bytes_of_id)?;
        if version > 0 {
            reader.number(2)?;
        }
        reader.number(2)?;
        reader.number(base)?;
        if reader.number(2)? != 1 {
            return None;
        }
        [index, offset, length].into_iter().try_for_each(|bytes| reader.number(bytes).map(drop))?;
    }
    Some(())
}

/// Reads big-endian numbers.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    /// Reads a number of `bytes` bytes, at most 8; 0 if `bytes` is 0.
    fn number(&mut self, bytes: u64) -> Option<u64> {
        let (number, rest) = self.0.split_at_checked(bytes as usize)?;
        self.0 = rest;
        (bytes <= 8).then(|| number.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: &[u8] = include_bytes!("../../../../tests/data/pictures/avif-alpha.avif");

    fn at(name: &[u8; 4]) -> usize {
        SOUND.windows(4).position(|four| four == name).expect("the box exists")
    }

    #[test]
    fn items_in_many_extents_are_refused() {
        assert!(check_boxes(SOUND).is_ok());
        let mut many = SOUND.to_vec();
        // After the type: version and flags, sizes, the number of items, the first item's number, source and base.
        let extents = at(b"iloc") + 4 + 4 + 2 + 2 + 2 + 2;
        assert_eq!(many[extents..extents + 2], [0, 1], "one extent");
        many[extents..extents + 2].fill(0xff);
        assert!(matches!(check_boxes(&many), Err(Failure::Unsupported(_))));
    }

    #[test]
    fn turned_images_are_refused() {
        let mut turned = SOUND.to_vec();
        turned[at(b"pixi")..][..4].copy_from_slice(b"irot");
        assert!(matches!(check_boxes(&turned), Err(Failure::Unsupported(_))));
    }

    #[test]
    fn any_beginning_of_a_file_is_checked_without_panic() {
        for length in 0..SOUND.len() {
            let _ = check_boxes(&SOUND[..length]);
        }
        assert!(check_boxes(b"").is_err());
    }
}
