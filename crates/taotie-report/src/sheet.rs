//! Contact sheets: labelled 8-bit pictures side by side, made from the library's images, and the sheet of all
//! material presets.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use std::sync::Arc;
use taotie_engine::Result;
use taotie_engine::compare::DisplayImage;
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::{Bitmap, Encoding, Image};
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Material, Orbit, PRESETS, Scene, preset};
use taotie_engine::shade::environment::{Environment, studio};
use taotie_engine::surface::encode_normal;
use taotie_io::{PngColor, PngImage, PngSamples};

/// The gap between pictures and at the border, pixels.
const GAP: usize = 16;
/// The height of the two-line label below a picture.
const LABEL: usize = 52;
/// Spheres per row on the sheet of material presets.
const SPHERES_PER_ROW: usize = 4;

/// The background colour.
pub const GROUND: [u8; 3] = [24, 25, 27];
/// The colour of first lines.
pub const TITLE: [u8; 3] = [236, 230, 216];
/// The colour of second lines.
pub const NOTE: [u8; 3] = [150, 152, 156];

/// A picture with its label.
pub struct Cell {
    /// First line.
    pub title: String,
    /// Second line, smaller.
    pub note: String,
    /// sRGB pixels, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// The size of the monospaced letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextSize {
    /// 16 pixels high.
    Small,
    /// 20 pixels high.
    Large,
}

impl TextSize {
    fn raster(self) -> RasterHeight {
        match self {
            Self::Small => RasterHeight::Size16,
            Self::Large => RasterHeight::Size20,
        }
    }

    /// Returns the advance width of a letter, pixels.
    fn advance(self) -> usize {
        get_raster_width(FontWeight::Regular, self.raster())
    }

    /// Returns the width of `text`, pixels.
    pub fn width(self, text: &str) -> usize {
        text.chars().count() * self.advance()
    }
}

/// A line of text to write on a sheet.
pub struct Line<'a> {
    /// The letters; letters missing from the font leave a space.
    pub text: &'a str,
    /// Their size.
    pub size: TextSize,
    /// Their sRGB colour.
    pub color: [u8; 3],
    /// The width at which the line is cut off, pixels.
    pub room: usize,
}

/// An 8-bit sRGB picture.
pub struct Sheet {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

impl Sheet {
    /// Creates an empty sheet.
    pub fn blank(width: usize, height: usize) -> Self {
        Self { width, height, pixels: vec![GROUND; width * height] }
    }

    /// Arranges pictures of equal size in rows of `columns`, at least one.
    pub fn new(cells: &[Cell], size: [usize; 2], columns: usize) -> Self {
        let columns = columns.max(1);
        let [across, down] = size;
        let rows = cells.len().div_ceil(columns);
        let width = GAP + columns * (across + GAP);
        let height = GAP + rows * (down + LABEL + GAP);
        let mut sheet = Self::blank(width, height);
        for (i, cell) in cells.iter().enumerate() {
            let x = GAP + (i % columns) * (across + GAP);
            let y = GAP + (i / columns) * (down + LABEL + GAP);
            sheet.place(cell, size, [x, y]);
        }
        sheet
    }

    fn place(&mut self, cell: &Cell, [across, down]: [usize; 2], [x, y]: [usize; 2]) {
        for (row, pixels) in cell.pixels.chunks(across.max(1)).enumerate() {
            self.paste(pixels, [x, y + row]);
        }
        let title = Line { text: &cell.title, size: TextSize::Large, color: TITLE, room: across };
        let note = Line { text: &cell.note, size: TextSize::Small, color: NOTE, room: across };
        self.write(&title, [x, y + down + 6]);
        self.write(&note, [x, y + down + 29]);
    }

    /// Returns the picture in the form in which it is written to a file.
    pub fn png(&self) -> PngImage<'_> {
        PngImage {
            width: self.width as u32,
            height: self.height as u32,
            color: PngColor::Rgb,
            samples: PngSamples::U8(self.pixels.as_flattened()),
            encoding: Encoding::Srgb,
        }
    }

    /// Copies a row of pixels to the right of `at`, clipped to the sheet.
    pub fn paste(&mut self, row: &[[u8; 3]], at: [usize; 2]) {
        for (pixel, color) in self.row_from(at).iter_mut().zip(row) {
            *pixel = *color;
        }
    }

    /// Writes a line with its top left corner at `at`, clipped to the sheet.
    pub fn write(&mut self, line: &Line<'_>, [x, y]: [usize; 2]) {
        let advance = line.size.advance();
        for (i, letter) in line.text.chars().take(line.room / advance).enumerate() {
            let glyph = get_raster(letter, FontWeight::Regular, line.size.raster());
            let rows = glyph.iter().flat_map(|glyph| glyph.rows()).enumerate();
            for (row, inks) in rows {
                let pixels = self.row_from([x + i * advance, y + row]).iter_mut();
                for (pixel, ink) in pixels.zip(inks.iter()) {
                    *pixel = std::array::from_fn(|c| mix(pixel[c], line.color[c], *ink));
                }
            }
        }
    }

    /// The pixels of a row from `at` to the right border; empty if `at` is outside the sheet.
    fn row_from(&mut self, [x, y]: [usize; 2]) -> &mut [[u8; 3]] {
        let row = self.pixels.chunks_mut(self.width.max(1)).nth(y).unwrap_or_default();
        row.get_mut(x..).unwrap_or_default()
    }
}

/// Conversions of images of the library.
impl Sheet {
    /// Converts a developed picture.
    pub fn developed(picture: &DisplayImage) -> Self {
        let pixels = picture.pixels().iter().map(|rgb| rgb.map(code)).collect();
        Self { width: picture.width() as usize, height: picture.height() as usize, pixels }
    }

    /// Shows world-space unit normals n as the colours (n + 1) / 2, and the background if alpha is not 1.
    pub fn of_normals(normals: &Image) -> Self {
        let color = |[x, y, z, covered]: &[f32; 4]| match *covered == 1.0 {
            true => encode_normal(Vec3::new(*x, *y, *z)).to_array().map(code),
            false => GROUND,
        };
        let pixels = normals.pixels().iter().map(color).collect();
        Self { width: normals.width() as usize, height: normals.height() as usize, pixels }
    }

    /// Shows a map as stored, subsampled so that no side is longer than `side` pixels.
    pub fn preview(bitmap: &Bitmap, side: usize) -> Self {
        let (across, down) = (bitmap.width() as usize, bitmap.height() as usize);
        let step = across.max(down).div_ceil(side.max(1)).max(1);
        let (width, height) = ((across / step).max(1), (down / step).max(1));
        let pixel = |i: usize| {
            let [r, g, b, _] = bitmap.stored(i / width * step * across + i % width * step);
            [r, g, b].map(code)
        };
        Self { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    /// Averages whole blocks in linear light until no side is longer than `side` pixels.
    pub fn shrunk(&self, side: usize) -> Self {
        let factor = self.width.max(self.height).div_ceil(side.max(1)).max(1);
        let (width, height) = ((self.width / factor).max(1), (self.height / factor).max(1));
        let linear: Vec<f64> =
            (0..=255).map(|code| srgb::linear_from_srgb(f64::from(code) / 255.0)).collect();
        let mean = |i: usize, channel: usize| {
            let values = self.block(i % width * factor, i / width * factor, factor);
            let (sum, count) = values
                .fold((0.0, 0.0), |(sum, n), pixel| (sum + linear[usize::from(pixel[channel])], n + 1.0));
            (srgb::srgb_from_linear(sum / count) * 255.0 + 0.5) as u8
        };
        let pixel = |i: usize| std::array::from_fn(|channel| mean(i, channel));
        Self { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    /// The pixels of a square, clipped to the sheet, row by row.
    fn block(&self, x: usize, y: usize, side: usize) -> impl Iterator<Item = &[u8; 3]> {
        let rows = self.pixels.chunks(self.width.max(1)).skip(y).take(side);
        rows.flat_map(move |row| row.iter().skip(x).take(side))
    }
}

/// Draws a sphere in each material preset, lit by the built-in studio; its picture is `size` pixels wide.
///
/// # Errors
/// Those of [`render`].
pub fn swatches(size: u32) -> Result<Sheet> {
    let environment = Arc::new(Environment::new(studio())?);
    let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false };
    let lighting = Lighting { environment: Some(light), ..Lighting::default() };
    let known = PRESETS.iter().filter_map(|listed| Some((listed, preset(listed.name)?)));
    let cells = known.map(|(listed, material)| {
        let pixels = sphere(material, &lighting, size)?;
        Ok(Cell { title: listed.name.into(), note: listed.source.into(), pixels })
    });
    let cells = cells.collect::<Result<Vec<_>>>()?;
    Ok(Sheet::new(&cells, [size as usize; 2], SPHERES_PER_ROW))
}

fn sphere(material: Material, lighting: &Lighting, size: u32) -> Result<Vec<[u8; 3]>> {
    let scene = Scene::of_mesh(Mesh::sphere(1.0, 96, 48), material)?;
    let orbit = Orbit { azimuth: 0.4, elevation: 0.25, distance: 4.4, target: Vec3::default(), fov_y: 0.52 };
    let settings = RenderSettings { width: size, height: size, samples: 16, ..RenderSettings::default() };
    let camera = orbit.camera(1.0);
    let frame = render(&scene, &Shot { camera: &camera, lighting, settings: &settings })?;
    let development = Development { background: Some(Vec3::splat(0.02)), ..Development::default() };
    Ok(develop8(&frame.color, &development)?.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
}

fn mix(below: u8, above: u8, ink: u8) -> u8 {
    let ink = u32::from(ink);
    ((u32::from(below) * (255 - ink) + u32::from(above) * ink + 127) / 255) as u8
}

/// Rounds a value in [0, 1] to an 8-bit code.
fn code(v: f32) -> u8 {
    (v * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::Texels;

    #[test]
    fn cells_lie_in_rows_with_their_labels() {
        let cell = |grey| Cell { title: "ab".into(), note: String::new(), pixels: vec![[grey; 3]; 64] };
        let sheet = Sheet::new(&[cell(10), cell(20), cell(30)], [8, 8], 2);
        let at = |x: usize, y: usize| sheet.pixels[y * sheet.width + x];
        assert_eq!((sheet.width, sheet.height), (3 * GAP + 16, 3 * GAP + 2 * (8 + LABEL)));
        assert_eq!([at(GAP, GAP), at(2 * GAP + 8, GAP)], [[10; 3], [20; 3]]);
        assert_eq!(at(GAP, 2 * GAP + 8 + LABEL), [30; 3]);
        assert_eq!(at(0, 0), GROUND);
    }

    #[test]
    fn drawing_is_clipped_to_the_sheet() {
        let mut sheet = Sheet::blank(8, 2);
        sheet.paste(&[[9; 3]; 4], [6, 1]);
        sheet.paste(&[[9; 3]; 4], [0, 2]);
        sheet.paste(&[[9; 3]; 4], [8, 0]);
        let painted: Vec<usize> = (0..16).filter(|i| sheet.pixels[*i] == [9; 3]).collect();
        assert_eq!(painted, [14, 15]);
        let line = Line { text: "gg", size: TextSize::Large, color: [255; 3], room: 99 };
        sheet.write(&line, [4, 1]);
        assert_eq!(Sheet::new(&[], [0, 0], 0).pixels.len(), 2 * GAP * GAP);
    }

    #[test]
    fn labels_leave_ink_and_stay_within_their_cell() {
        let cell =
            Cell { title: "tangent-normal".repeat(9), note: "x".into(), pixels: vec![[0; 3]; 64 * 64] };
        let sheet = Sheet::new(&[cell], [64, 64], 1);
        let inked: Vec<usize> = sheet.pixels[(GAP + 64) * sheet.width..]
            .iter()
            .enumerate()
            .filter(|(_, p)| **p != GROUND)
            .map(|(i, _)| i % sheet.width)
            .collect();
        assert!(inked.len() > 50 && inked.iter().all(|x| (GAP..GAP + 64).contains(x)));
    }

    #[test]
    fn normals_are_colours_and_uncovered_pixels_are_background() {
        let mut normals = Image::new(2, 1, [0.0; 4]).unwrap();
        normals.pixels_mut()[1] = [0.0, 0.0, 1.0, 1.0];
        assert_eq!(Sheet::of_normals(&normals).pixels, [GROUND, [128, 128, 255]]);
    }

    #[test]
    fn previews_are_subsampled() {
        let texels = (0..8).map(|i| [i * 10, 0, 0, 255]).collect();
        let bitmap = Bitmap::new(8, 1, 3, Texels::U8(texels)).unwrap();
        let sheet = Sheet::preview(&bitmap, 3);
        assert_eq!((sheet.width, sheet.height), (2, 1));
        assert_eq!(sheet.pixels, [[0, 0, 0], [30, 0, 0]]);
    }

    #[test]
    fn shrinking_averages_light_and_keeps_small_sheets() {
        let sheet = Sheet { width: 4, height: 1, pixels: vec![[0; 3], [255; 3], [9; 3], [9; 3]] };
        assert_eq!(sheet.shrunk(4).pixels, sheet.pixels);
        assert_eq!(sheet.shrunk(2).pixels, [[188; 3], [9; 3]]);
    }
}
