//! Hemispherical harmonics as the RTI tools of Cultural Heritage Imaging store them (`.rti`, "HSH1.2").
//!
//! Comment lines, a text header, scale and bias of each term as floats, then codes with rows from top to bottom: for
//! each pixel the terms of red, green and blue. A coefficient is code / 255 · scale + bias, and 1 is white.

use super::basis::Basis;
use super::header::Header;
use super::image::{ColorModel, Relightable, check_size};
use super::plane::Plane;
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// The number of hemispherical harmonics among the kinds of coefficients.
const HSH: u32 = 3;

/// Returns the file of an image in RGB with hemispherical harmonics.
pub fn encode(image: &Relightable) -> Vec<u8> {
    let terms = image.basis.terms();
    let text = format!("#HSH1.2\n{HSH}\n{} {} 3\n{terms} 2 1\n", image.width, image.height);
    let mut bytes = text.into_bytes();
    let numbers = |number: &dyn Fn(&Plane) -> f64| -> Vec<u8> {
        image.planes.iter().step_by(3).flat_map(|plane| (number(plane) as f32).to_le_bytes()).collect()
    };
    bytes.extend(numbers(&|plane| plane.scale));
    bytes.extend(numbers(&|plane| plane.bias));
    for pixel in 0..image.len() {
        for channel in 0..3 {
            bytes.extend((0..terms).map(|term| image.planes[3 * term + channel].codes[pixel]));
        }
    }
    bytes
}

/// Reads a file.
///
/// # Errors
/// [`Error::Parse`] if it is damaged, [`Error::Unsupported`] for other kinds of coefficients.
pub fn decode(bytes: &[u8], path: &Path) -> Result<Relightable> {
    let mut header = Header::new(path, bytes);
    header.skip_comments();
    let kind: u32 = header.number("the kind of coefficients, 3 for hemispherical harmonics")?;
    let size = [header.number("the width")?, header.number("the height")?];
    let [width, height] = check_size(path, "header", size)?;
    let [channels, terms] = [header.number("the number of channels")?, header.number("the number of terms")?];
    let [_, element]: [usize; 2] = [header.number("the kind of terms")?, header.number("bytes of a code")?];
    let basis = Basis::hsh(terms).filter(|_| kind == HSH && channels == 3 && element == 1);
    let basis = basis.ok_or_else(|| {
        let what = format!(
            "{}: coefficients of kind {kind} with {terms} terms of {element} bytes for {channels} channels",
            path.display()
        );
        Error::unsupported(
            what,
            "hemispherical harmonics (kind 3) of 4, 9 or 16 bytes for 3 channels are read",
        )
    })?;
    header.end();
    let floats = |bytes: &[u8]| -> Vec<f64> {
        bytes.as_chunks::<4>().0.iter().map(|word| f64::from(f32::from_le_bytes(*word))).collect()
    };
    let scales = floats(header.take(4 * terms as u64)?);
    let biases = floats(header.take(4 * terms as u64)?);
    if scales.iter().chain(&biases).any(|v| !v.is_finite()) {
        return Err(header.error("scales and biases must be finite".to_owned()));
    }
    let codes = header.take(u64::from(width) * u64::from(height) * 3 * terms as u64)?;
    let plane = |k: usize| Plane {
        scale: scales[k / 3],
        bias: biases[k / 3],
        codes: codes.iter().skip(k % 3 * terms + k / 3).step_by(3 * terms).copied().collect(),
    };
    let planes = (0..3 * terms).map(plane).collect();
    Ok(Relightable { width, height, basis, colors: ColorModel::Rgb, planes })
}
