//! Relightable images for web viewers, as relight writes them and OpenLIME shows them: `info.json`, and the images
//! `plane_0.jpg`, `plane_1.jpg` and so on with three coefficients each.
//!
//! A coefficient is (code / 255 − bias) · scale, and 1 is white.

use super::basis::Basis;
use super::image::{ColorModel, Relightable, check_size};
use super::plane::Plane;
use serde::{Deserialize, Serialize};
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::names::Named;
use taotie_io::{FileBytes, Limits, encode_jpeg_bitmap, read_bitmap_within};

/// The name of the description.
pub const INFO: &str = "info.json";

/// The JPEG quality of the images.
const QUALITY: u8 = 95;

/// The description of the images.
#[derive(Serialize, Deserialize)]
struct Info {
    width: u64,
    height: u64,
    /// The extension of the images.
    format: String,
    /// The functions of the light: `ptm` or `hsh`.
    #[serde(rename = "type")]
    kind: String,
    colorspace: String,
    #[serde(default)]
    nplanes: usize,
    #[serde(default)]
    quality: u8,
    materials: Vec<MaterialInfo>,
}

/// Scale and bias of each coefficient.
#[derive(Serialize, Deserialize)]
struct MaterialInfo {
    scale: Vec<f64>,
    bias: Vec<f64>,
}

/// Returns the files of an image in a folder; the description is the first.
///
/// # Errors
/// [`Error::Invalid`] if a side is too long for JPEG.
pub fn encode(image: &Relightable, folder: &Path) -> Result<Vec<FileBytes>> {
    let info = Info {
        width: image.width.into(),
        height: image.height.into(),
        format: "jpg".to_owned(),
        kind: if image.basis == Basis::Ptm { "ptm" } else { "hsh" }.to_owned(),
        colorspace: image.colors.name().to_owned(),
        nplanes: image.planes.len(),
        quality: QUALITY,
        materials: vec![MaterialInfo {
            scale: image.planes.iter().map(|plane| plane.scale).collect(),
            bias: image.planes.iter().map(|plane| 0.0 - plane.bias / plane.scale).collect(),
        }],
    };
    let text = serde_json::to_string_pretty(&info)
        .map_err(|error| Error::invalid(folder.join(INFO).display().to_string(), error.to_string()))?;
    let mut files = vec![FileBytes { path: folder.join(INFO), bytes: text.into_bytes() }];
    for (i, planes) in image.planes.chunks(3).enumerate() {
        let code = |channel: usize, pixel: usize| planes.get(channel).map_or(0, |plane| plane.codes[pixel]);
        let texels = (0..image.len()).map(|i| [code(0, i), code(1, i), code(2, i), u8::MAX]).collect();
        let bitmap = Bitmap::new(image.width, image.height, 3, Texels::U8(texels))?;
        let path = folder.join(format!("plane_{i}.jpg"));
        files.push(FileBytes { path, bytes: encode_jpeg_bitmap(&bitmap, QUALITY)? });
    }
    Ok(files)
}

/// Returns an image as its written files hold it, after the losses of JPEG.
///
/// # Errors
/// None that can occur: the files were just written.
pub fn written(files: &[FileBytes]) -> Result<Relightable> {
    let [info, images @ ..] = files else { return Err(Error::invalid(INFO, "there are no files")) };
    decode_with(&info.bytes, &info.path, &|path| match images.iter().find(|file| file.path == path) {
        Some(file) => taotie_io::decode_bitmap(&file.bytes, "plane.jpg", path),
        None => Err(Error::invalid(path.display().to_string(), "it was not written")),
    })
}

/// Reads a description and its images, which are next to it.
///
/// # Errors
/// [`Error::Parse`] if a file is damaged; [`Error::Unsupported`] for functions other than `ptm` and `hsh`; [`Error::Io`]
/// and [`Error::Limit`] for images.
pub fn decode(bytes: &[u8], path: &Path, limits: &Limits) -> Result<Relightable> {
    decode_with(bytes, path, &|path| read_bitmap_within(path, limits))
}

/// Reads a description, and each image with `read`.
fn decode_with(bytes: &[u8], path: &Path, read: &dyn Fn(&Path) -> Result<Bitmap>) -> Result<Relightable> {
    let info: Info = serde_json::from_slice(bytes).map_err(|error| {
        Error::parse(
            path,
            format!("line {}", error.line()),
            format!("not a description of coefficients: {error}"),
        )
    })?;
    let [width, height] = check_size(path, "width and height", [info.width, info.height])?;
    let colors = ColorModel::from_name(&info.colorspace).ok();
    let color_planes = if colors == Some(ColorModel::Lrgb) { 3 } else { 0 };
    let per_term = if color_planes == 0 { 3 } else { 1 };
    let basis = match info.kind.as_str() {
        "ptm" => Some(Basis::Ptm),
        "hsh" => info.nplanes.checked_sub(color_planes).and_then(|terms| Basis::hsh(terms / per_term)),
        _ => None,
    };
    let (Some(basis), Some(colors)) = (basis, colors) else {
        let what = format!(
            "{}: coefficients of type {} in {}, {} planes",
            path.display(),
            taotie_io::quote(&info.kind),
            taotie_io::quote(&info.colorspace),
            info.nplanes
        );
        return Err(Error::unsupported(what, "export it as ptm or hsh, in rgb or lrgb"));
    };
    let count = color_planes + per_term * basis.terms();
    let of_material = |numbers: fn(&MaterialInfo) -> &Vec<f64>, what: &str| {
        let found = info.materials.first().map(numbers).filter(|all| all.len() >= count);
        let finite = found.filter(|all| all.iter().all(|v| v.is_finite()));
        finite.ok_or_else(|| Error::parse(path, "materials", format!("expected {count} numbers as {what}")))
    };
    let (scales, biases) = (of_material(|m| &m.scale, "scale")?, of_material(|m| &m.bias, "bias")?);
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut planes = Vec::with_capacity(count);
    for i in 0..count.div_ceil(3) {
        let file = folder.join(format!("plane_{i}.{}", extension(&info.format, path)?));
        let bitmap = read(&file)?;
        let texels = match bitmap.texels() {
            Texels::U8(texels) if [bitmap.width(), bitmap.height()] == [width, height] => texels,
            _ => {
                let what =
                    format!("{}x{} pixels; {} has {width}x{height}", bitmap.width(), bitmap.height(), INFO);
                return Err(Error::parse(file, "image", what));
            }
        };
        for k in (3 * i..count).take(3) {
            let codes = texels.iter().map(|texel| texel[k % 3]).collect();
            planes.push(Plane { scale: scales[k], bias: -biases[k] * scales[k], codes });
        }
    }
    Ok(Relightable { width, height, basis, colors, planes })
}

/// Returns the extension of the images.
fn extension<'a>(format: &'a str, path: &Path) -> Result<&'a str> {
    match ["jpg", "jpeg", "png"].contains(&format) {
        true => Ok(format),
        false => Err(Error::parse(
            path,
            "format",
            format!("expected jpg or png, found {}", taotie_io::quote(format)),
        )),
    }
}
