//! The difference between an image of an asset and that of its scan, in numbers.

/// The difference between an image of an asset and that of its scan.
///
/// ```
/// use taotie::asset::ViewFigures;
///
/// /// Returns a row of a table.
/// fn row(view: &ViewFigures) -> String {
///     format!("{:>4}° {:>4}° {:.3} {:.3}", view.azimuth_deg, view.elevation_deg, view.flip, view.ssim)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ViewFigures {
    /// The azimuth of the view, degrees.
    pub azimuth_deg: f64,
    /// Degrees above the horizon.
    pub elevation_deg: f64,
    /// The mean FLIP, [0, 1]; 0 if equal.
    pub flip: f64,
    /// SSIM; 1 if equal.
    pub ssim: f64,
}
