//! The pictures of a comparison as files.

use super::comparison::{Comparison, Taken};
use crate::sheet::{Cell, Sheet};
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie::compare::{ColorMap, Field, Picture, heat};
use taotie::image::{Encoding, Image};
use taotie::io::{self, PngColor, PngImage, PngSamples};
use taotie::math::srgb;
use taotie::names::Named;

/// Where nothing is seen in pictures of normals and errors.
const NOTHING: [u8; 3] = [24, 25, 27];

/// The longest side of a picture on the contact sheet, pixels.
const CELL: usize = 320;

/// The colours of angular error.
pub const HEAT: ColorMap = ColorMap::Viridis;

/// The colours of FLIP, which its authors use.
pub const FLIP: ColorMap = ColorMap::Magma;

/// An 8-bit sRGB picture.
pub struct Pixels {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

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

    /// The name of a surface's picture of this kind: `bump-5.normals.png`.
    pub fn name(&self, taken: &Taken, kind: &str) -> PathBuf {
        let stem = taken.method.map_or_else(|| "reference".into(), |method| method.file_stem());
        format!("{stem}.{kind}.png").into()
    }

    /// Writes every picture and the contact sheet.
    ///
    /// # Errors
    /// Where one cannot be written.
    pub fn write(&mut self, comparison: &Comparison) -> Result<()> {
        for taken in &comparison.taken {
            for (shading, picture) in &taken.pictures {
                self.write_png(&self.name(taken, shading.name()), &Pixels::of_picture(picture))?;
            }
            self.write_png(&self.name(taken, "normals"), &Pixels::of_normals(&taken.normals))?;
            let Some(difference) = &taken.difference else { continue };
            self.write_png(
                &self.name(taken, "error"),
                &self.heat(&difference.angles).with_legend(self.heat_top),
            )?;
            for ((shading, _), difference) in taken.pictures.iter().zip(&difference.pictures) {
                let name = self.name(taken, &format!("{}.flip", shading.name()));
                self.write_png(&name, &Pixels::of_flip(&difference.flip))?;
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

    fn write_png(&mut self, name: &Path, picture: &Pixels) -> Result<()> {
        let path = self.folder.join(name);
        io::write_png(&path, &picture.png())?;
        self.written.push(path);
        Ok(())
    }

    /// The heat map of an angular error.
    pub fn heat(&self, angles: &Field) -> Pixels {
        Pixels::of_field(angles, self.heat_top, HEAT)
    }

    /// A column for each surface: its pictures, its normals, its error.
    fn sheet(&self, comparison: &Comparison) -> Pixels {
        let taken = &comparison.taken;
        let mut cells = Vec::new();
        for i in 0..taken[0].pictures.len() {
            cells.extend(taken.iter().map(|taken| {
                let (shading, picture) = &taken.pictures[i];
                cell(taken.id(), shading.name().into(), &Pixels::of_picture(picture))
            }));
        }
        cells.extend(taken.iter().map(|taken| {
            let what = taken.method.map_or_else(|| "the geometry itself".into(), |method| method.describe());
            cell("normals".into(), what, &Pixels::of_normals(&taken.normals))
        }));
        cells.extend(taken.iter().map(|taken| self.error_cell(taken, comparison)));
        let small = Pixels::of_picture(&taken[0].pictures[0].1).shrunk();
        let sheet = Sheet::new(&cells, [small.width as usize, small.height as usize], taken.len());
        Pixels { width: sheet.width as u32, height: sheet.height as u32, pixels: sheet.pixels }
            .with_legend(self.heat_top)
    }

    fn error_cell(&self, taken: &Taken, comparison: &Comparison) -> Cell {
        let Some(difference) = &taken.difference else {
            let normals = &taken.normals;
            let nothing = vec![NOTHING; normals.pixels().len()];
            let blank = Pixels { width: normals.width(), height: normals.height(), pixels: nothing };
            return cell("error".into(), "what the others are measured against".into(), &blank);
        };
        let note = match difference.angles.within(&comparison.inner).ok().and_then(|field| field.summary()) {
            Some(summary) => format!("mean {:.2}°, 95 % below {:.1}°", summary.mean, summary.p95),
            None => "no pixel away from silhouettes".into(),
        };
        cell("error".into(), note, &self.heat(&difference.angles))
    }
}

fn cell(title: String, note: String, picture: &Pixels) -> Cell {
    Cell { title, note, pixels: picture.shrunk().pixels }
}

impl Pixels {
    /// A developed picture.
    pub fn of_picture(picture: &Picture) -> Self {
        let code = |v: f32| (v * 255.0 + 0.5) as u8;
        let pixels = picture.pixels().iter().map(|rgb| rgb.map(code)).collect();
        Self { width: picture.width(), height: picture.height(), pixels }
    }

    /// Normals n in world space as the colours (n + 1) / 2.
    pub fn of_normals(normals: &Image) -> Self {
        let color = |[x, y, z, covered]: &[f32; 4]| match *covered == 1.0 {
            true => [x, y, z].map(|v| ((v * 0.5 + 0.5) * 255.0 + 0.5) as u8),
            false => NOTHING,
        };
        let pixels = normals.pixels().iter().map(color).collect();
        Self { width: normals.width(), height: normals.height(), pixels }
    }

    /// FLIP errors in their authors' colours.
    pub fn of_flip(flip: &Field) -> Self {
        Self::of_field(flip, 1.0, FLIP)
    }

    fn of_field(field: &Field, top: f32, map: ColorMap) -> Self {
        let pixels = heat(field, top, map, NOTHING);
        Self { width: field.width(), height: field.height(), pixels }
    }

    /// The picture with a scale of degrees below it.
    fn with_legend(self, _top: f32) -> Self {
        self
    }

    /// Averaged in linear light over whole blocks until no side is longer than [`CELL`].
    fn shrunk(&self) -> Self {
        let (w, h) = (self.width as usize, self.height as usize);
        let factor = w.max(h).div_ceil(CELL);
        let (across, down) = ((w / factor).max(1), (h / factor).max(1));
        let linear: Vec<f64> =
            (0..=255).map(|code| srgb::linear_from_srgb(f64::from(code) / 255.0)).collect();
        let block = |x: usize, y: usize, channel: usize| {
            let rows = (y * factor..((y + 1) * factor).min(h)).map(|row| row * w);
            let values = rows.flat_map(|row| (x * factor..((x + 1) * factor).min(w)).map(move |x| row + x));
            let (sum, count) = values
                .fold((0.0, 0.0), |(sum, n), i| (sum + linear[self.pixels[i][channel] as usize], n + 1.0));
            (srgb::srgb_from_linear(sum / count) * 255.0 + 0.5) as u8
        };
        let pixels = (0..across * down)
            .map(|i| std::array::from_fn(|channel| block(i % across, i / across, channel)))
            .collect();
        Self { width: across as u32, height: down as u32, pixels }
    }

    /// As a PNG to be written.
    pub fn png(&self) -> PngImage<'_> {
        PngImage {
            width: self.width,
            height: self.height,
            color: PngColor::Rgb,
            samples: PngSamples::U8(self.pixels.as_flattened()),
            encoding: Encoding::Srgb,
        }
    }
}
