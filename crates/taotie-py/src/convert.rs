//! Images and maps: their differences, and normal maps from heights or from other normal maps.

use crate::arrays::{self, Heights, Picture};
use crate::error::{exception, no_json};
use crate::options::Options;
use crate::renderer::Color;
use crate::work::{self, Running};
use numpy::PyReadonlyArray3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::Deserialize;
use taotie::comparison::diff::{DiffOptions, ImagePair, NamedBitmap};
use taotie_engine::Error;
use taotie_engine::image::{Bitmap, Encoding, Wrap};
use taotie_engine::normal_map::{
    self, ConversionOptions, MapContent, MapSource, convert_map, tangent_from_height, with_content,
};
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::{GreenVerdict, green_direction};
use taotie_io::{PngColor, PngImage, PngSamples, encode_png};

/// Two images.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Pair<'py> {
    a: Picture<'py>,
    b: Picture<'py>,
}

/// Measures the difference of two images or normal maps: figures as JSON, the difference map, its title and unit, and
/// warnings.
#[pyfunction]
pub fn diff<'py>(
    py: Python<'py>,
    pair: Pair<'py>,
    request: Options,
    running: Running,
) -> PyResult<Bound<'py, PyDict>> {
    let options = request.read::<DiffOptions>()?;
    let (a, b) = (pair.a.taken(py)?, pair.b.taken(py)?);
    let (figures, map, warnings) = work::run(py, &running, move |progress| {
        let names = [a.name("a"), b.name("b")];
        let bitmaps = [a.bitmap()?, b.bitmap()?];
        let images = [0, 1].map(|i| NamedBitmap { name: &names[i], bitmap: &bitmaps[i] });
        let pair = ImagePair::new(images, &options)?;
        if pair.shared_normals() == Some(0) {
            return Err(Error::invalid("no texel holds a normal in both", "there is nothing to compare"));
        }
        Ok((pair.figures(&options, progress)?, pair.difference_map(&options)?, pair.warnings))
    })?;
    let result = PyDict::new(py);
    result.set_item("figures", serde_json::to_string(&figures).map_err(no_json)?)?;
    result.set_item("map", arrays::of_field(py, &map.field)?)?;
    result.set_item("title", map.title)?;
    result.set_item("unit", map.unit)?;
    result.set_item("warnings", work::listed(&warnings))?;
    Ok(result)
}

/// The options of a conversion.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ConvertRequest {
    /// The content of the map; `None` guesses it from the pixels.
    content: Option<MapContent>,
    /// The direction of its green channel; `None` guesses it from the pixels.
    green: Option<GreenChannel>,
    options: ConversionOptions,
}

/// Converts a map: texels, the angular error due to storage in degrees, and warnings.
#[pyfunction]
pub fn convert<'py>(
    py: Python<'py>,
    map: Picture<'py>,
    request: Options,
    running: Running,
) -> PyResult<Bound<'py, PyDict>> {
    let request = request.read::<ConvertRequest>()?;
    let map = map.taken(py)?;
    let made = work::run(py, &running, move |progress| {
        progress.begin("convert")?;
        let name = map.name("the map");
        let (bitmap, content) = with_content(map.bitmap()?, request.content)?;
        let why = "looks like neither heights nor normals; specify its content";
        let content = content.ok_or_else(|| Error::invalid(name, why))?;
        let green = request.green.unwrap_or_else(|| guessed_green(content, &bitmap));
        let source = MapSource { bitmap, content, green };
        convert_map(&source, &request.options, None)
    })?;
    let result = PyDict::new(py);
    result.set_item("map", arrays::of_bitmap(py, &made.bitmap)?)?;
    result.set_item("error", arrays::of_field(py, &made.stored)?)?;
    result.set_item("warnings", work::listed(&made.warnings))?;
    Ok(result)
}

/// Guesses the direction of green from the pixels of a tangent-space map; up if unclear, and for all other content.
fn guessed_green(content: MapContent, bitmap: &Bitmap) -> GreenChannel {
    match content {
        MapContent::Normals(NormalSpace::Tangent) => match green_direction(bitmap).verdict {
            GreenVerdict::Down => GreenChannel::Down,
            GreenVerdict::Up | GreenVerdict::Unclear => GreenChannel::Up,
        },
        _ => GreenChannel::Up,
    }
}

/// Heights and the shape of their map.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct HeightMap<'py> {
    values: Heights<'py>,
    size: [u32; 2],
}

/// Returns the tangent-space normals of heights, `(height, width, 3)`, with green up; `border` is the name of a wrap
/// mode.
#[pyfunction]
pub fn normals_of_heights<'py>(
    py: Python<'py>,
    heights: HeightMap<'py>,
    scale: f64,
    border: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let wrap: Wrap = serde_json::from_value(border.into()).map_err(no_json)?;
    let (values, size) = (heights.values.as_slice()?.to_vec(), heights.size);
    let image = work::detached(py, move || {
        tangent_from_height(&normal_map::Heights::new(size, values, [wrap; 2])?, scale)
    })?;
    arrays::of_image(py, &image, 3)
}

/// Returns a PNG of 8-bit sRGB codes, `(height, width, 4)`.
#[pyfunction]
pub fn write_png<'py>(py: Python<'py>, codes: PyReadonlyArray3<'py, u8>) -> PyResult<Bound<'py, PyBytes>> {
    let (shape, values) = (codes.shape().to_vec(), codes.as_slice()?.to_vec());
    let bytes = work::detached(py, move || {
        let side = |axis: usize| u32::try_from(shape[axis]).unwrap_or(u32::MAX);
        let (color, samples) = (PngColor::Rgba, PngSamples::U8(&values));
        encode_png(&PngImage { width: side(1), height: side(0), color, samples, encoding: Encoding::Srgb })
    })?;
    Ok(PyBytes::new(py, &bytes))
}

/// Parses a colour, a text or linear RGB, to linear RGB.
#[pyfunction]
pub fn color(py: Python<'_>, color: Options) -> PyResult<[f32; 3]> {
    let rgb = color.read::<Color>()?.rgb();
    rgb.map(|rgb| rgb.to_array()).map_err(|error| exception(py, &error))
}
