//! Polynomial texture maps (`.ptm`): Malzbender and Gelb, "Polynomial Texture Map (.ptm) File Format", version 1.2,
//! Hewlett-Packard Laboratories 2001.
//!
//! A text header, then codes with rows from bottom to top. A coefficient is (code − bias) · scale, and colours are 0 to
//! 255. The terms are x², y², xy, x, y, 1.

use super::basis::Basis;
use super::header::Header;
use super::image::{ColorModel, Relightable, check_size};
use super::plane::Plane;
use std::fmt::Write;
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Texels;

/// Our term for each term of the file.
const ORDER: [usize; 6] = [3, 5, 4, 1, 2, 0];

/// Terms of the polynomial.
const TERMS: usize = 6;

/// Returns the file of an image with [`Basis::Ptm`].
pub fn encode(image: &Relightable) -> Vec<u8> {
    let color_planes = if image.colors == ColorModel::Lrgb { 3 } else { 0 };
    let plane = |term: usize, channel: usize| match image.colors {
        ColorModel::Rgb => &image.planes[3 * ORDER[term] + channel],
        ColorModel::Lrgb => &image.planes[color_planes + ORDER[term]],
    };
    let format = if image.colors == ColorModel::Lrgb { "LRGB" } else { "RGB" };
    let mut header = format!("PTM_1.2\nPTM_FORMAT_{format}\n{}\n{}\n", image.width, image.height);
    let words = |word: &dyn Fn(&Plane) -> String| {
        (0..TERMS).map(|term| word(plane(term, 0))).collect::<Vec<_>>().join(" ")
    };
    let _ = writeln!(header, "{}", words(&|plane| format!("{}", plane.scale as f32)));
    let _ =
        writeln!(header, "{}", words(&|plane| format!("{}", (-plane.bias / plane.scale * 255.0).round())));
    let mut bytes = header.into_bytes();
    let rows = || (0..image.height as usize).rev();
    let mut push = |planes: &[&Plane]| {
        for row in rows() {
            let start = row * image.width as usize;
            for pixel in start..start + image.width as usize {
                bytes.extend(planes.iter().map(|plane| plane.codes[pixel]));
            }
        }
    };
    match image.colors {
        ColorModel::Rgb => {
            (0..3).for_each(|channel| push(&std::array::from_fn::<_, TERMS, _>(|k| plane(k, channel))))
        }
        ColorModel::Lrgb => {
            push(&std::array::from_fn::<_, TERMS, _>(|k| plane(k, 0)));
            push(&std::array::from_fn::<_, 3, _>(|channel| &image.planes[channel]));
        }
    }
    bytes
}

/// Reads a file.
///
/// # Errors
/// [`Error::Parse`] if it is damaged, [`Error::Unsupported`] for formats other than RGB and LRGB, with or without JPEG.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Relightable> {
    let mut header = Header::new(path, bytes);
    let version = header.word("PTM_1.2")?;
    let format = header.word("a format, e.g. PTM_FORMAT_LRGB")?;
    let (colors, is_jpeg) = match format {
        "PTM_FORMAT_RGB" => (ColorModel::Rgb, false),
        "PTM_FORMAT_LRGB" => (ColorModel::Lrgb, false),
        "PTM_FORMAT_JPEG_RGB" => (ColorModel::Rgb, true),
        "PTM_FORMAT_JPEG_LRGB" => (ColorModel::Lrgb, true),
        _ => {
            let what = format!("{}: the format {}", path.display(), taotie_io::quote(format));
            return Err(Error::unsupported(what, "convert it to PTM_FORMAT_RGB or PTM_FORMAT_LRGB"));
        }
    };
    let size = [header.number("the width")?, header.number("the height")?];
    let [width, height] = check_size(path, "header", size)?;
    let scales: Vec<f32> = header.numbers(TERMS, "6 scales")?;
    let biases: Vec<f32> = header.numbers(TERMS, "6 biases")?;
    if scales.iter().chain(&biases).any(|v| !v.is_finite()) {
        return Err(header.error("scales and biases must be finite".to_owned()));
    }
    let size = [width, height];
    let stored = match is_jpeg {
        true => jpeg_planes(&mut header, (path, size), if colors == ColorModel::Lrgb { 9 } else { 18 })?,
        false => raw_planes(&mut header, (colors, version), size)?,
    };
    let mut planes: Vec<Option<Vec<u8>>> =
        stored.into_iter().map(|codes| Some(from_bottom(codes, width))).collect();
    let mut coefficient = |at: usize, term: usize| {
        let scale = f64::from(scales[term]);
        let codes = planes[at].take().unwrap_or_default();
        Plane { scale, bias: -f64::from(biases[term]) / 255.0 * scale, codes }
    };
    // The file's term for each of ours.
    let places: [usize; TERMS] =
        std::array::from_fn(|term| ORDER.iter().position(|own| *own == term).unwrap_or(term));
    let planes = match colors {
        ColorModel::Rgb => {
            (0..3 * TERMS).map(|k| coefficient(k % 3 * TERMS + places[k / 3], places[k / 3])).collect()
        }
        ColorModel::Lrgb => {
            let grey: Vec<Plane> = places.iter().map(|place| coefficient(*place, *place)).collect();
            let color = (TERMS..TERMS + 3).map(|at| Plane {
                scale: 1.0,
                bias: 0.0,
                codes: planes[at].take().unwrap_or_default(),
            });
            color.chain(grey).collect()
        }
    };
    Ok(Relightable { width, height, basis: Basis::Ptm, colors, planes })
}

/// Returns the planes of a file without JPEG in the order of the file.
fn raw_planes(
    header: &mut Header,
    (colors, version): (ColorModel, &str),
    [width, height]: [u32; 2],
) -> Result<Vec<Vec<u8>>> {
    header.end();
    let pixels = u64::from(width) * u64::from(height);
    // Blocks of interleaved planes. Before version 1.2, LRGB was one block.
    let blocks: &[usize] = match colors {
        ColorModel::Rgb => &[TERMS, TERMS, TERMS],
        ColorModel::Lrgb if version == "PTM_1.2" => &[TERMS, 3],
        ColorModel::Lrgb => &[TERMS + 3],
    };
    let mut planes = Vec::new();
    for count in blocks {
        let block = header.take(pixels * *count as u64)?;
        planes
            .extend((0..*count).map(|k| block.iter().skip(k).step_by(*count).copied().collect::<Vec<u8>>()));
    }
    Ok(planes)
}

/// Returns the planes of a file with a JPEG image for each. Planes may be stored as differences from another, with
/// corrections of single codes.
fn jpeg_planes(header: &mut Header, (path, size): (&Path, [u32; 2]), count: usize) -> Result<Vec<Vec<u8>>> {
    header.number::<i64>("the JPEG quality")?;
    let moved: Vec<i64> = header.numbers(3 * count, "transforms and motion vectors")?;
    if moved.iter().any(|v| *v != 0) {
        let what = format!("{}: planes predicted with transforms or motion", path.display());
        return Err(Error::unsupported(what, "convert it to PTM_FORMAT_RGB or PTM_FORMAT_LRGB"));
    }
    let order: Vec<usize> = header.numbers(count, "the order of the planes")?;
    let references: Vec<i64> = header.numbers(count, "reference planes")?;
    let lengths: Vec<u64> = header.numbers(count, "the lengths of the planes")?;
    let corrections: Vec<u64> = header.numbers(count, "the lengths of corrections")?;
    header.end();
    let mut files = Vec::with_capacity(count);
    for (length, corrections) in lengths.iter().zip(&corrections) {
        files.push((header.take(*length)?, header.take(*corrections)?));
    }
    let mut sequence: Vec<usize> = (0..count).collect();
    sequence.sort_by_key(|plane| order[*plane]);
    let mut planes: Vec<Option<Vec<u8>>> = vec![None; count];
    for plane in sequence {
        let (file, corrections) = files[plane];
        let mut codes = grey_codes(file, (path, plane), size)?;
        if references[plane] != -1 {
            let reference = usize::try_from(references[plane]).ok().and_then(|k| planes.get(k)?.as_ref());
            let reference = reference
                .ok_or_else(|| header.error(format!("plane {plane} refers to one that is not known yet")))?;
            codes
                .iter_mut()
                .zip(reference)
                .for_each(|(code, other)| *code = code.wrapping_sub(128).wrapping_add(*other));
        }
        for [a, b, c, d, code] in corrections.as_chunks::<5>().0 {
            let at = u32::from_be_bytes([*a, *b, *c, *d]) as usize;
            *codes
                .get_mut(at)
                .ok_or_else(|| header.error(format!("a correction of pixel {at}, outside the image")))? =
                *code;
        }
        planes[plane] = Some(codes);
    }
    Ok(planes.into_iter().flatten().collect())
}

/// Decodes a JPEG image of one channel.
fn grey_codes(file: &[u8], (path, plane): (&Path, usize), [width, height]: [u32; 2]) -> Result<Vec<u8>> {
    let bitmap = taotie_io::decode_bitmap(file, &format!("plane {plane}.jpg"), path)?;
    match bitmap.texels() {
        Texels::U8(texels) if [bitmap.width(), bitmap.height()] == [width, height] => {
            Ok(texels.iter().map(|texel| texel[0]).collect())
        }
        _ => {
            let what = format!("{}x{} pixels; expected {width}x{height}", bitmap.width(), bitmap.height());
            Err(Error::parse(path, format!("plane {plane}"), what))
        }
    }
}

/// Reverses the order of the rows.
fn from_bottom(codes: Vec<u8>, width: u32) -> Vec<u8> {
    codes.chunks(width as usize).rev().flatten().copied().collect()
}
