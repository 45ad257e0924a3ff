//! Images encoded for files.

use crate::{arrays, work};
use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use taotie_engine::compare::{ColorMap, Field, heat};
use taotie_engine::image::{Encoding, Texels};
use taotie_io::{encode_jpeg_bitmap, encode_png_bitmap, encode_webp_bitmap};

/// Returns the JPEG of 8-bit sRGB codes, `(height, width, 4)`, with a quality from 1 to 100; without one, the lossless
/// WebP. A JPEG has no alpha.
#[pyfunction]
pub fn write_photo<'py>(
    py: Python<'py>,
    codes: PyReadonlyArray3<'py, u8>,
    quality: Option<u8>,
) -> PyResult<Bound<'py, PyBytes>> {
    let (shape, texels) = (codes.shape().to_vec(), codes.as_slice()?.as_chunks::<4>().0.to_vec());
    let bytes = work::detached(py, move || {
        let bitmap = arrays::bitmap(&shape, Texels::U8(texels))?;
        quality.map_or_else(|| encode_webp_bitmap(&bitmap), |quality| encode_jpeg_bitmap(&bitmap, quality))
    })?;
    Ok(PyBytes::new(py, &bytes))
}

/// Returns the PNG of a map, `(height, width)`, in the colours of report pages: from 0 to `top`, and
/// transparent where it is NaN.
#[pyfunction]
pub fn write_heat<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f32>,
    top: f32,
) -> PyResult<Bound<'py, PyBytes>> {
    let (shape, values) = ([values.shape(), &[4]].concat(), values.as_slice()?.to_vec());
    let bytes = work::detached(py, move || {
        let side = |axis: usize| u32::try_from(shape[axis]).unwrap_or(u32::MAX);
        let field = Field::new(side(1), side(0), values)?;
        let colors = heat(&field, top, ColorMap::default(), [0; 3]);
        let shown = |([r, g, b], value): (&[u8; 3], &f32)| [*r, *g, *b, if value.is_nan() { 0 } else { 255 }];
        let texels = colors.iter().zip(field.values()).map(shown).collect();
        encode_png_bitmap(&arrays::bitmap(&shape, Texels::U8(texels))?, Encoding::Srgb)
    })?;
    Ok(PyBytes::new(py, &bytes))
}
