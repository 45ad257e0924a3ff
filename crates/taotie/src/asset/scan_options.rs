//! The options for reading a scan.

use crate::error::{Error, Result};
use crate::length::Unit;
use crate::names::Named;
use crate::scene::GreenChannel;

/// How a scan is read if its file is ambiguous. Built by `Default` and struct update.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{Limits, ScanFile, ScanOptions};
///
/// let options = ScanOptions { crease_angle_deg: Some(40.0), ..ScanOptions::default() };
/// let file = ScanFile::read("bracket.stl", &Limits::default(), Progress::SILENT)?;
/// let scan = file.with_options(options).into_scan(Progress::SILENT)?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct ScanOptions {
    /// The angle between facets above which an edge is hard, degrees, [0, 180]: 0 keeps all facets flat, 180 smooths
    /// everything. It applies to meshes without normals, or with one per facet. `None` smooths scans and keeps the
    /// hard edges of modelled shapes.
    pub crease_angle_deg: Option<f64>,
    /// The direction of green in the scan's tangent-space normal maps; `None` trusts the file unless the pixels
    /// contradict it.
    pub green: Option<GreenChannel>,
    /// The unit of the scan's coordinates; `None` is the metre for glTF, as its specification requires, and an
    /// unknown unit for other formats.
    pub unit: Option<Unit>,
}

impl ScanOptions {
    /// Returns these options, with unset ones taken from `others`.
    ///
    /// ```
    /// use taotie::asset::ScanOptions;
    /// use taotie::length::Unit;
    ///
    /// let recorded = ScanOptions { crease_angle_deg: Some(40.0), unit: Some(Unit::Inch), ..ScanOptions::default() };
    /// let given = ScanOptions { unit: Some(Unit::Millimetre), ..ScanOptions::default() };
    /// let both = given.or(recorded);
    /// assert_eq!((both.crease_angle_deg, both.unit), (Some(40.0), Some(Unit::Millimetre)));
    /// ```
    #[must_use]
    pub fn or(self, others: Self) -> Self {
        Self {
            crease_angle_deg: self.crease_angle_deg.or(others.crease_angle_deg),
            green: self.green.or(others.green),
            unit: self.unit.or(others.unit),
        }
    }

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a crease angle outside [0, 180].
    pub fn check(&self) -> Result<()> {
        match self.crease_angle_deg {
            Some(angle) if !(0.0..=180.0).contains(&angle) => {
                let why = "it must be between 0 and 180 degrees: 0 keeps all facets, 180 smooths everything";
                Err(Error::invalid(format!("crease angle {angle}"), why))
            }
            _ => Ok(()),
        }
    }

    /// Returns the command-line arguments for all options that differ from the defaults.
    pub(super) fn arguments(&self) -> Vec<String> {
        let crease_angle = self.crease_angle_deg.map(|angle| ("--crease-angle", angle.to_string()));
        let green = self.green.map(|green| ("--scan-green", green.name().to_owned()));
        let unit = self.unit.map(|unit| ("--unit", unit.name().to_owned()));
        let all = [crease_angle, green, unit].into_iter().flatten();
        all.flat_map(|(name, value)| [name.to_owned(), value]).collect()
    }
}
