//! Conversion of arrays between NumPy and the library.

use numpy::{
    Element, PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use taotie_engine::Result;
use taotie_engine::compare::Field;
use taotie_engine::image::{Bitmap, Image, Texels};
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_io::Limits;

/// Rows of numbers, contiguous in row-major order.
type Rows<'py> = PyReadonlyArray2<'py, f32>;

fn rows<const N: usize, T>(array: &Rows<'_>, make: impl Fn([f32; N]) -> T) -> PyResult<Vec<T>> {
    Ok(array.as_slice()?.as_chunks::<N>().0.iter().map(|row| make(*row)).collect())
}

/// Colours, RGBA, contiguous in row-major order.
#[derive(FromPyObject)]
pub enum Colors<'py> {
    /// sRGB codes; alpha is linear.
    Codes(PyReadonlyArray2<'py, u8>),
    /// Linear light.
    Linear(Rows<'py>),
}

impl Colors<'_> {
    fn linear(&self) -> PyResult<Vec<[f32; 4]>> {
        let codes = match self {
            Self::Linear(colors) => return rows(colors, |color| color),
            Self::Codes(codes) => codes.as_slice()?.as_chunks::<4>().0,
        };
        let share = |code: u8| f64::from(code) / 255.0;
        let table: [f32; 256] = std::array::from_fn(|code| linear_from_srgb(share(code as u8)) as f32);
        let linear = |[r, g, b, a]: &[u8; 4]| {
            let [r, g, b] = [r, g, b].map(|code| table[usize::from(*code)]);
            [r, g, b, share(*a) as f32]
        };
        Ok(codes.iter().map(linear).collect())
    }
}

/// The arrays of a mesh, already checked by Python: contiguous, `(n, 2)`, `(n, 3)` or `(n, 4)`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct MeshArrays<'py> {
    vertices: Rows<'py>,
    faces: PyReadonlyArray2<'py, u32>,
    normals: Option<Rows<'py>>,
    uvs: Option<Rows<'py>>,
    colors: Option<Colors<'py>>,
}

impl MeshArrays<'_> {
    /// Returns the arrays in the library's form, UVs with their origin top left; nothing is checked.
    pub fn data(&self) -> PyResult<MeshData> {
        let vectors = |array: &Rows<'_>| rows(array, Vec3::from_array);
        let uvs = self.uvs.as_ref().map(|uvs| rows(uvs, |[x, y]| Vec2 { x, y })).transpose()?;
        Ok(MeshData {
            positions: vectors(&self.vertices)?,
            normals: self.normals.as_ref().map_or(Ok(Vec::new()), vectors)?,
            tangents: Vec::new(),
            uvs: uvs.into_iter().collect(),
            colors: self.colors.as_ref().map_or(Ok(Vec::new()), Colors::linear)?,
            triangles: self.faces.as_slice()?.as_chunks::<3>().0.to_vec(),
        })
    }
}

/// An image: its texels, `(height, width, channels)`, or a file.
#[derive(FromPyObject)]
pub enum Picture<'py> {
    /// 8 bits per channel.
    Bytes(PyReadonlyArray3<'py, u8>),
    /// 16 bits per channel.
    Words(PyReadonlyArray3<'py, u16>),
    /// Floats.
    Floats(PyReadonlyArray3<'py, f32>),
    /// A file.
    File(PathBuf),
}

/// An image taken from Python, usable without the interpreter's lock.
pub enum Taken {
    /// Texels.
    Texels(Bitmap),
    /// A file to be read.
    File(PathBuf),
}

impl Picture<'_> {
    /// Copies the texels, so that Python may change its array meanwhile.
    pub fn taken(&self, py: Python<'_>) -> PyResult<Taken> {
        let bitmap = match self {
            Self::Bytes(array) => bitmap(array.shape(), Texels::U8(rgba(array, u8::MAX)?)),
            Self::Words(array) => bitmap(array.shape(), Texels::U16(rgba(array, u16::MAX)?)),
            Self::Floats(array) => bitmap(array.shape(), Texels::F32(rgba(array, 1.0)?)),
            Self::File(path) => return Ok(Taken::File(path.clone())),
        };
        bitmap.map(Taken::Texels).map_err(|error| crate::error::exception(py, &error))
    }
}

impl Taken {
    /// Returns the texels, reading them from a file if necessary.
    pub fn bitmap(self) -> Result<Bitmap> {
        match self {
            Self::Texels(bitmap) => Ok(bitmap),
            Self::File(path) => taotie_io::read_bitmap_within(&path, &Limits::default().or_free()),
        }
    }

    /// Returns the file's name for messages, or `other`.
    pub fn name(&self, other: &str) -> String {
        match self {
            Self::Texels(_) => other.into(),
            Self::File(path) => path.display().to_string(),
        }
    }
}

/// Returns an image of shape (height, width, channels) from its texels.
///
/// # Errors
/// Those of [`Bitmap::new`].
pub fn bitmap(shape: &[usize], texels: Texels) -> Result<Bitmap> {
    let side = |axis: usize| u32::try_from(shape[axis]).unwrap_or(u32::MAX);
    Bitmap::new(side(1), side(0), shape[2] as u8, texels)
}

/// Returns texels with four channels: grey becomes red, green and blue; missing alpha becomes opaque.
fn rgba<T: Element + Copy>(array: &PyReadonlyArray3<'_, T>, opaque: T) -> PyResult<Vec<[T; 4]>> {
    let channels = array.shape()[2];
    let texel = |texel: &[T]| match *texel {
        [grey] => [grey, grey, grey, opaque],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, opaque],
        [r, g, b, a, ..] => [r, g, b, a],
        [] => [opaque; 4],
    };
    match channels {
        1..=4 => Ok(array.as_slice()?.chunks_exact(channels).map(texel).collect()),
        _ => Err(PyValueError::new_err(format!("an image of {channels} channels: use 1 to 4"))),
    }
}

/// Returns an array of the given shape that owns `values`, in row-major order.
pub fn array<'py, T: Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape.to_vec())?.into_any())
}

/// Returns the values of a field, `(height, width)`.
pub fn of_field<'py>(py: Python<'py>, field: &Field) -> PyResult<Bound<'py, PyAny>> {
    array(py, field.values().to_vec(), &[field.height() as usize, field.width() as usize])
}

/// Returns the first channels of an image, `(height, width, channels)`; NaN if the fourth channel is 0, unless all
/// channels are requested.
pub fn of_image<'py>(py: Python<'py>, image: &Image, channels: usize) -> PyResult<Bound<'py, PyAny>> {
    let shown = |pixel: &[f32; 4]| if channels < 4 && pixel[3] == 0.0 { [f32::NAN; 4] } else { *pixel };
    let values = image.pixels().iter().flat_map(|pixel| shown(pixel).into_iter().take(channels)).collect();
    let size = [image.height() as usize, image.width() as usize];
    let shape = [size[0], size[1], channels];
    array(py, values, if channels == 1 { &size } else { &shape })
}

/// Returns the texels of a bitmap, `(height, width, channels)`; `(height, width)` for one.
pub fn of_bitmap<'py>(py: Python<'py>, bitmap: &Bitmap) -> PyResult<Bound<'py, PyAny>> {
    let channels = bitmap.channels() as usize;
    let shape = [bitmap.height() as usize, bitmap.width() as usize, channels];
    let shape = if channels == 1 { &shape[..2] } else { &shape[..] };
    match bitmap.texels() {
        Texels::U8(texels) => array(py, kept(texels, channels), shape),
        Texels::U16(texels) => array(py, kept(texels, channels), shape),
        Texels::F32(texels) => array(py, kept(texels, channels), shape),
    }
}

/// Returns the channels that a file stores: for grey and alpha, the first and the last.
fn kept<T: Copy>(texels: &[[T; 4]], channels: usize) -> Vec<T> {
    let of = |texel: &[T; 4]| match channels {
        2 => vec![texel[0], texel[3]],
        _ => texel[..channels].to_vec(),
    };
    texels.iter().flat_map(of).collect()
}

/// Returns the arrays of a mesh by name.
pub fn of_mesh<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<Bound<'py, PyDict>> {
    let arrays = PyDict::new(py);
    let vectors = |values: &[Vec3]| {
        array(py, values.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>(), &[values.len(), 3])
    };
    arrays.set_item("vertices", vectors(mesh.positions())?)?;
    arrays.set_item(
        "faces",
        array(py, mesh.triangles().as_flattened().to_vec(), &[mesh.triangles().len(), 3])?,
    )?;
    if !mesh.normals().is_empty() {
        arrays.set_item("normals", vectors(mesh.normals())?)?;
    }
    if let Some(uvs) = mesh.uvs().first() {
        let values = uvs.iter().flat_map(|uv| [uv.x, uv.y]).collect::<Vec<f32>>();
        arrays.set_item("uvs", array(py, values, &[uvs.len(), 2])?)?;
    }
    for (name, rows) in [("tangents", mesh.tangents()), ("colors", mesh.colors())] {
        if !rows.is_empty() {
            arrays.set_item(name, array(py, rows.as_flattened().to_vec(), &[rows.len(), 4])?)?;
        }
    }
    Ok(arrays)
}

/// A table of numbers: one row per evaluation of a formula.
#[derive(FromPyObject)]
pub enum Table<'py> {
    /// Single precision.
    Single(PyReadonlyArray2<'py, f32>),
    /// Double precision.
    Double(PyReadonlyArray2<'py, f64>),
}

/// Heights, in row-major order.
pub type Heights<'py> = PyReadonlyArray1<'py, f32>;
