//! The pictures of a comparison as files.

use super::comparison::{Comparison, Taken};
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::io;
use taotie::names::Named;
use taotie_report::heat_map::HeatMap;
use taotie_report::sheet::{Cell, Sheet};

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
                self.write_png(&taken.file_name(shading.name()), &Sheet::developed(picture))?;
            }
            self.write_png(&taken.file_name("normals"), &Sheet::of_normals(&taken.normals))?;
            let Some(difference) = &taken.difference else { continue };
            let heat = HeatMap::of_angles(&difference.angles, self.heat_top).with_scale();
            self.write_png(&taken.file_name("error"), &heat)?;
            for ((shading, _), difference) in taken.pictures.iter().zip(&difference.pictures) {
                let name = taken.file_name(&format!("{}.flip", shading.name()));
                self.write_png(&name, &HeatMap::of_flip(&difference.flip).with_scale())?;
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
                cell(taken.id(), shading.name().into(), &Sheet::developed(picture))
            }));
        }
        cells.extend(
            taken
                .iter()
                .map(|taken| cell("normals".into(), taken.what(), &Sheet::of_normals(&taken.normals))),
        );
        cells.extend(taken.iter().map(|taken| self.error_cell(taken, comparison)));
        let small = Sheet::developed(&taken[0].pictures[0].1).shrunk(CELL);
        let sheet = Sheet::new(&cells, [small.width, small.height], taken.len());
        match taken.iter().find_map(|taken| taken.difference.as_ref()) {
            Some(difference) => HeatMap::of_angles(&difference.angles, self.heat_top).above_scale(&sheet),
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
        cell("error".into(), note, &HeatMap::of_angles(&difference.angles, self.heat_top).plain())
    }
}

fn cell(title: String, note: String, picture: &Sheet) -> Cell {
    Cell { title, note, pixels: picture.shrunk(CELL).pixels }
}
