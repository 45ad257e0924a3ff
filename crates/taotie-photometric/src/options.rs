//! The options of an estimate: what is known about the photographs, and what to write in addition.

use crate::calibration::Setup;
use crate::circle::Circle;
use crate::photograph::Transfer;
use crate::relight::RelightFormat;
use crate::samples::Reading;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::length::Unit;
use taotie_engine::names::Named;
use taotie_io::Limits;

/// Known facts about photographs, and the files to write in addition to normals.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PhotometricOptions {
    /// The mask: white where normals are estimated; defaults to an image named `mask` next to the photographs, otherwise
    /// to everything.
    pub mask: Option<PathBuf>,
    /// The encoding of the photographs.
    pub encoding: Transfer,
    /// Chrome balls; without any, they are looked for if no file states the lights.
    pub balls: Vec<Circle>,
    /// A matt grey ball, which shows how bright each light is.
    pub grey_ball: Option<Circle>,
    /// A folder with a photograph of a flat white board under each light, of the same names.
    pub flat: Option<PathBuf>,
    /// The side of a pixel on the object: the unit of depth, and of lamp positions in an `.lp` file.
    pub pixel_size: Option<f64>,
    /// The unit of `pixel_size`: models are then written in metres.
    pub unit: Option<Unit>,
    /// Relightable images to write in addition.
    pub relight: Vec<RelightFormat>,
}

impl PhotometricOptions {
    /// Checks the options, before any work begins.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a size that is not above 0, a format named twice, or if a grey ball and a white board are both
    /// given.
    pub fn check(&self) -> Result<()> {
        if let Some(size) = self.pixel_size.filter(|size| !(size.is_finite() && *size > 0.0)) {
            let what = format!("invalid size of a pixel `{size}`");
            return Err(Error::invalid(what, "use a number above 0, e.g. 0.05"));
        }
        if let (Some(unit), None) = (self.unit, self.pixel_size) {
            let what = format!("a unit, {}, without the size of a pixel", unit.name());
            return Err(Error::invalid(what, "state that size, too"));
        }
        let is_repeated = |(i, format): (usize, &RelightFormat)| self.relight[..i].contains(format);
        if let Some(format) = self.relight.iter().enumerate().find(|(i, format)| is_repeated((*i, format))) {
            let what = format!("the relightable image `{}` twice", format.1.name());
            return Err(Error::invalid(what, "name each once"));
        }
        match self.grey_ball.is_some() && self.flat.is_some() {
            true => Err(Error::invalid("a grey ball and a white board", "give only one of them")),
            false => Ok(()),
        }
    }

    /// Returns the side of a pixel in models: in metres if the unit is known, as glTF requires.
    pub fn side_in_models(&self) -> f64 {
        self.pixel_size.unwrap_or(1.0) * self.unit.map_or(1.0, Unit::metres)
    }

    /// Returns the facts that are known before photographs are read.
    pub fn setup(&self, limits: Limits) -> Setup {
        Setup {
            balls: self.balls.clone(),
            grey_ball: self.grey_ball,
            pixel_size: self.pixel_size,
            transfer: self.encoding,
            limits,
        }
    }

    /// Returns how to read the photographs.
    pub fn reading(&self, limits: Limits) -> Reading<'_> {
        Reading { mask: self.mask.as_deref(), transfer: self.encoding, flat: self.flat.as_deref(), limits }
    }

    /// Returns all paths in the options.
    pub fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        self.mask.iter_mut().chain(&mut self.flat)
    }

    /// Returns the files that the options name, including those in the folder of white boards.
    ///
    /// # Errors
    /// [`Error::Io`] if that folder cannot be read.
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        let boards = self.flat.as_deref().map(crate::folder::input_files).transpose()?;
        Ok(self.mask.iter().cloned().chain(boards.into_iter().flatten()).collect())
    }
}

/// Returns true for a file whose folder holds photographs of an object: an `.lp` file, or `light_directions.txt` of the
/// DiLiGenT data set.
pub fn marks_photographs(file: &Path) -> bool {
    let has_extension = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("lp"));
    has_extension || file.file_name().is_some_and(|name| name.eq_ignore_ascii_case(crate::diligent::FILES[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_contradict_are_errors() {
        let wrong = |options: PhotometricOptions| options.check().unwrap_err().to_string();
        let ball: Circle = "20,20,10".parse().expect("a circle");
        let both = PhotometricOptions {
            grey_ball: Some(ball),
            flat: Some("boards".into()),
            ..PhotometricOptions::default()
        };
        assert!(wrong(both).contains("give only one"));
        let size = |size| PhotometricOptions { pixel_size: Some(size), ..PhotometricOptions::default() };
        assert!(wrong(size(0.0)).contains("above 0") && wrong(size(f64::NAN)).contains("`NaN`"));
        assert!(size(0.05).check().is_ok());
        let twice =
            PhotometricOptions { relight: vec![RelightFormat::Ptm; 2], ..PhotometricOptions::default() };
        assert!(wrong(twice).contains("`ptm` twice"));
    }

    #[test]
    fn options_are_read_by_the_names_of_the_command() {
        let text = r#"{"encoding": "srgb", "balls": [[20, 30, 10]], "relight": ["openlime", "ptm-rgb"]}"#;
        let read: PhotometricOptions = serde_json::from_str(text).expect("it is valid");
        assert_eq!(read.balls, [Circle { center: [20.0, 30.0], radius: 10.0 }]);
        assert_eq!(
            (read.encoding, &read.relight[..]),
            (Transfer::Srgb, &[RelightFormat::Web, RelightFormat::PtmRgb][..])
        );
        let again: PhotometricOptions =
            serde_json::from_str(&serde_json::to_string(&read).expect("it is JSON")).expect("it is valid");
        assert_eq!(again, read);
        for wrong in [r#"{"balls": [[1, 2, 3]]}"#, r#"{"encoding": "gamma"}"#, r#"{"pixel_size": "1"}"#] {
            assert!(serde_json::from_str::<PhotometricOptions>(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn lights_mark_a_folder_of_photographs() {
        let marks = |name: &str| marks_photographs(Path::new(name));
        assert!(marks("a/dome.LP") && marks("Light_Directions.txt"));
        assert!(!marks("a/dome.ply") && !marks("filenames.txt") && !marks("lp"));
    }
}
