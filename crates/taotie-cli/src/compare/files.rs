//! The pictures of a comparison as files.

use super::comparison::{Comparison, Taken};
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::compare::{ColorMap, Field, Picture};
use taotie::image::Image;
use taotie::io;
use taotie::math::{Vec3, srgb};
use taotie::names::Named;
use taotie::surface::encode_normal;
use taotie_report::heat_map::HeatMap;
use taotie_report::sheet::{Cell, GROUND, Sheet};

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
        for taken in &comparison.taken {
            for (shading, picture) in &taken.pictures {
                self.write_png(&taken.file_name(shading.name()), &developed(picture))?;
            }
            self.write_png(&taken.file_name("normals"), &colored(&taken.normals))?;
            let Some(difference) = &taken.difference else { continue };
            let heat = heat_of_angles(&difference.angles, self.heat_top).with_scale();
            self.write_png(&taken.file_name("error"), &heat)?;
            for ((shading, _), difference) in taken.pictures.iter().zip(&difference.pictures) {
                let name = taken.file_name(&format!("{}.flip", shading.name()));
                self.write_png(&name, &heat_of_flip(&difference.flip).with_scale())?;
            }
        }
        self.write_png(Path::new("sheet.png"), &self.sheet(comparison))
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

    fn write_png(&mut self, name: &Path, picture: &Sheet) -> Result<()> {
        let path = self.folder.join(name);
        io::write_png(&path, &picture.png())?;
        self.written.push(path);
        Ok(())
    }

    /// A column for each surface: its pictures, its normals, its error.
    fn sheet(&self, comparison: &Comparison) -> Sheet {
        let taken = &comparison.taken;
        let mut cells = Vec::new();
        for i in 0..taken[0].pictures.len() {
            cells.extend(taken.iter().map(|taken| {
                let (shading, picture) = &taken.pictures[i];
                cell(taken.id(), shading.name().into(), &developed(picture))
            }));
        }
        cells
            .extend(taken.iter().map(|taken| cell("normals".into(), taken.what(), &colored(&taken.normals))));
        cells.extend(taken.iter().map(|taken| self.error_cell(taken, comparison)));
        let small = shrunk(&developed(&taken[0].pictures[0].1));
        let sheet = Sheet::new(&cells, [small.width, small.height], taken.len());
        match taken.iter().find_map(|taken| taken.difference.as_ref()) {
            Some(difference) => heat_of_angles(&difference.angles, self.heat_top).above_scale(&sheet),
            None => sheet,
        }
    }

    fn error_cell(&self, taken: &Taken, comparison: &Comparison) -> Cell {
        let Some(difference) = &taken.difference else {
            let blank = Sheet::blank(taken.normals.width() as usize, taken.normals.height() as usize);
            return cell("error".into(), "what the others are measured against".into(), &blank);
        };
        let note = match difference.angles.within(&comparison.inner).ok().and_then(|field| field.summary()) {
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
