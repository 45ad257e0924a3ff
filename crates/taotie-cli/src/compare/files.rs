//! The pictures of a comparison as files.

use crate::heat_map::HeatMap;
use crate::sheet::{Cell, GROUND, Sheet};
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::compare::{ColorMap, Field, Picture};
use taotie::comparison::{Comparison, RenderedSurface};
use taotie::image::Image;
use taotie::io;
use taotie::math::{Vec3, srgb};
use taotie::names::Named;
use taotie::surface::encode_normal;

/// The longest side of a picture on the contact sheet, pixels.
const CELL: usize = 320;

/// The folder that the pictures go to.
pub struct Files {
    folder: PathBuf,
    /// The angle at the top of the heat maps' scale, degrees.
    pub heat_top: f32,
    /// What was written, in order.
    pub written: Vec<PathBuf>,
}

impl Files {
    /// Makes the folder where it is not there.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn new(folder: &Path, heat_top: f32) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|error| taotie::Error::io(folder, error))?;
        Ok(Self { folder: folder.to_path_buf(), heat_top, written: Vec::new() })
    }

    /// Writes every picture and the contact sheet.
    ///
    /// # Errors
    /// Where one cannot be written.
    pub fn write(&mut self, comparison: &Comparison) -> Result<()> {
        for surface in &comparison.surfaces {
            for (shading, picture) in &surface.pictures {
                self.write_png(&surface.picture_name(*shading), &developed(picture))?;
            }
            self.write_png(&surface.file_name("normals"), &colored(&surface.normals))?;
            let Some(difference) = &surface.difference else { continue };
            let heat = heat_of_angles(&difference.angles, self.heat_top).with_scale();
            self.write_png(&surface.file_name("error"), &heat)?;
            for ((shading, _), difference) in surface.pictures.iter().zip(&difference.pictures) {
                let flip = heat_of_flip(&difference.flip).with_scale();
                self.write_png(&surface.flip_name(*shading), &flip)?;
            }
        }
        self.write_png("sheet.png", &self.sheet(comparison))
    }

    /// Writes text into the folder.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write_text(&mut self, name: &str, text: &str) -> Result<()> {
        let path = self.folder.join(name);
        io::write_text(&path, text)?;
        self.written.push(path);
        Ok(())
    }

    fn write_png(&mut self, name: &str, picture: &Sheet) -> Result<()> {
        let path = self.folder.join(name);
        io::write_png(&path, &picture.png())?;
        self.written.push(path);
        Ok(())
    }

    /// A column for each surface: its pictures, its normals, its error.
    fn sheet(&self, comparison: &Comparison) -> Sheet {
        let surfaces = &comparison.surfaces;
        let mut cells = Vec::new();
        for i in 0..surfaces[0].pictures.len() {
            cells.extend(surfaces.iter().map(|surface| {
                let (shading, picture) = &surface.pictures[i];
                cell(surface.id(), shading.name().into(), &developed(picture))
            }));
        }
        cells.extend(
            surfaces
                .iter()
                .map(|surface| cell("normals".into(), surface.describe(), &colored(&surface.normals))),
        );
        cells.extend(surfaces.iter().map(|surface| self.error_cell(surface)));
        let small = shrunk(&developed(&surfaces[0].pictures[0].1));
        let sheet = Sheet::new(&cells, [small.width, small.height], surfaces.len());
        match surfaces.iter().find_map(|surface| surface.difference.as_ref()) {
            Some(difference) => heat_of_angles(&difference.angles, self.heat_top).above_scale(&sheet),
            None => sheet,
        }
    }

    fn error_cell(&self, surface: &RenderedSurface) -> Cell {
        let Some(difference) = &surface.difference else {
            let blank = Sheet::blank(surface.normals.width() as usize, surface.normals.height() as usize);
            return cell("error".into(), "what the others are measured against".into(), &blank);
        };
        let note = match difference.inner_angles.summary() {
            Some(summary) => format!("mean {:.2}°, 95 % below {:.1}°", summary.mean, summary.p95),
            None => "no pixel away from silhouettes".into(),
        };
        cell("error".into(), note, &heat_of_angles(&difference.angles, self.heat_top).plain())
    }
}

fn cell(title: String, note: String, picture: &Sheet) -> Cell {
    Cell { title, note, pixels: shrunk(picture).pixels }
}

/// A developed picture.
pub fn developed(picture: &Picture) -> Sheet {
    let code = |v: f32| (v * 255.0 + 0.5) as u8;
    let pixels = picture.pixels().iter().map(|rgb| rgb.map(code)).collect();
    Sheet { width: picture.width() as usize, height: picture.height() as usize, pixels }
}

/// Normals n in world space as the colours (n + 1) / 2.
pub fn colored(normals: &Image) -> Sheet {
    let color = |[x, y, z, covered]: &[f32; 4]| match *covered == 1.0 {
        true => encode_normal(Vec3::new(*x, *y, *z)).to_array().map(|v| (v * 255.0 + 0.5) as u8),
        false => GROUND,
    };
    let pixels = normals.pixels().iter().map(color).collect();
    Sheet { width: normals.width() as usize, height: normals.height() as usize, pixels }
}

/// Angular error, degrees, in colours up to `top`.
pub fn heat_of_angles(field: &Field, top: f32) -> HeatMap<'_> {
    HeatMap { field, title: "angular error", unit: "°", map: ColorMap::Viridis, top }
}

/// FLIP in its authors' colours.
pub fn heat_of_flip(field: &Field) -> HeatMap<'_> {
    HeatMap { field, title: "FLIP", unit: "", map: ColorMap::Magma, top: 1.0 }
}

/// Averaged in linear light over whole blocks until no side is longer than [`CELL`].
fn shrunk(sheet: &Sheet) -> Sheet {
    let (w, h) = (sheet.width, sheet.height);
    let factor = w.max(h).div_ceil(CELL);
    let (width, height) = ((w / factor).max(1), (h / factor).max(1));
    let linear: Vec<f64> = (0..=255).map(|code| srgb::linear_from_srgb(f64::from(code) / 255.0)).collect();
    let block = |x: usize, y: usize, channel: usize| {
        let rows = (y * factor..((y + 1) * factor).min(h)).map(|row| row * w);
        let values = rows.flat_map(|row| (x * factor..((x + 1) * factor).min(w)).map(move |x| row + x));
        let (sum, count) =
            values.fold((0.0, 0.0), |(sum, n), i| (sum + linear[sheet.pixels[i][channel] as usize], n + 1.0));
        (srgb::srgb_from_linear(sum / count) * 255.0 + 0.5) as u8
    };
    let pixel = |i: usize| std::array::from_fn(|channel| block(i % width, i / width, channel));
    Sheet { width, height, pixels: (0..width * height).map(pixel).collect() }
}
