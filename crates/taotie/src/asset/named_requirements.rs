//! Sets of requirements that have a name.

use super::figure::Figure;
use super::preset::Preset;
use super::requirement::Requirement;
use crate::error::Result;
use crate::names::Named;

impl Requirement {
    /// Returns the requirements of `--require standard`: a mean angle of at most 1° and p95 of 5° as seen, no window
    /// of 1 % of the surface with more than 10° or ΔE 3 on average, at most 0.1 % missed, a Hausdorff distance of at
    /// most 1 % of the diagonal, and a mean colour difference of at most ΔE 1. Limits of colours hold only if colours
    /// are compared.
    pub fn standard() -> Vec<Self> {
        vec![
            Self::mean_angle_deg(1.0),
            Self::of(Figure::P95Angle, 5.0),
            Self::of(Figure::PatchAngle, 10.0),
            Self::missed(0.001),
            Self::hausdorff(0.01),
            Self { if_compared: true, ..Self::mean_color(1.0) },
            Self { if_compared: true, ..Self::of(Figure::PatchColor, 3.0) },
        ]
    }

    /// Returns the requirements of `--require visually-lossless`, the default goal of a bake: a mean angle of at most
    /// 0.5° and p95 of 2° as seen, a mean colour difference of at most ΔE 0.5 and p95 of 1.5, and no window of 1 % of
    /// the surface with more than ΔE 3 on average. Limits of colours hold only if colours are compared.
    pub fn visually_lossless() -> Vec<Self> {
        Self::as_seen([0.5, 2.0], [0.5, 1.5, 3.0])
    }

    /// Returns limits of the mean and p95 of angles, degrees, and of the mean, p95 and worst patch of colours,
    /// CIEDE2000. Those of colours hold only if colours are compared.
    pub(super) fn as_seen([mean, p95]: [f64; 2], colors: [f64; 3]) -> Vec<Self> {
        let angles = [Self::mean_angle_deg(mean), Self::of(Figure::P95Angle, p95)];
        let figures = [Figure::MeanColor, Figure::P95Color, Figure::PatchColor];
        let of_color = |(figure, most)| Self { if_compared: true, ..Self::of(figure, most) };
        angles.into_iter().chain(figures.into_iter().zip(colors).map(of_color)).collect()
    }

    /// Returns the named sets of requirements; a set that begins with another is listed before it.
    pub(super) fn named() -> Vec<(&'static str, Vec<Self>)> {
        let presets = Preset::NAMES.iter().map(|(name, preset)| (*name, preset.requirements()));
        let own = [("standard", Self::standard()), ("visually-lossless", Self::visually_lossless())];
        presets.chain(own).collect()
    }

    /// Parses comma-separated requirements, such as `mean-angle=2`, or names of sets: `standard` for
    /// [`Requirement::standard`], `visually-lossless` for [`Requirement::visually_lossless`], or the name of a
    /// [`Preset`], such as `web`.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) if one is neither.
    pub fn read(text: &str) -> Result<Vec<Self>> {
        let named = Self::named();
        let one = |text: &str| match named.iter().find(|(name, _)| *name == text.trim()) {
            Some((_, several)) => Ok(several.clone()),
            None => Ok(vec![text.parse()?]),
        };
        Ok(text.split(',').map(one).collect::<Result<Vec<_>>>()?.concat())
    }
}
