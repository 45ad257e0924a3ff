//! Images encoded for files.

use crate::work;
use numpy::{PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use taotie_engine::image::{Bitmap, Texels};
use taotie_io::{encode_jpeg_bitmap, encode_webp_bitmap};

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
        let side = |axis: usize| u32::try_from(shape[axis]).unwrap_or(u32::MAX);
        let bitmap = Bitmap::new(side(1), side(0), 4, Texels::U8(texels))?;
        quality.map_or_else(|| encode_webp_bitmap(&bitmap), |quality| encode_jpeg_bitmap(&bitmap, quality))
    })?;
    Ok(PyBytes::new(py, &bytes))
}
