//! The requirements that a proof must meet.

use super::proof::{Figures, Proof};
use crate::compare::Summary;
use crate::error::{Error, Result};
use crate::names::Named;
use std::str::FromStr;

/// A figure of a proof that a limit can be set for.
///
/// ```
/// use taotie::asset::{Figure, Requirement};
/// use taotie::names::Named;
///
/// let figure = Figure::from_name("p95-angle")?;
/// assert_eq!("p95-angle=3".parse::<Requirement>()?, Requirement { figure, most: 3.0 });
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Figure {
    /// The mean angle between normals, degrees.
    MeanAngle,
    /// The angle that 95 % of the points stay below, degrees.
    P95Angle,
    /// The largest angle, degrees.
    MaxAngle,
    /// The part of the texels with a ray that missed.
    Missed,
    /// The largest distance between the surfaces, as a part of the diagonal.
    Hausdorff,
    /// Bytes of the asset.
    Bytes,
}

impl Named for Figure {
    const WHAT: &'static str = "figure";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("mean-angle", Self::MeanAngle),
        ("p95-angle", Self::P95Angle),
        ("max-angle", Self::MaxAngle),
        ("missed", Self::Missed),
        ("hausdorff", Self::Hausdorff),
        ("bytes", Self::Bytes),
    ];
}

/// A figure and the most that it may be.
///
/// ```
/// use taotie::asset::Requirement;
///
/// assert_eq!("mean-angle=2".parse::<Requirement>()?, Requirement::mean_angle_deg(2.0));
/// assert!("mean-angle=2%".parse::<Requirement>().is_err(), "an angle is no part of anything");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Requirement {
    /// The figure that is limited.
    pub figure: Figure,
    /// The most, in the figure's unit; parts as such, not in per cent.
    pub most: f64,
}

impl Requirement {
    /// Demands a mean angle between normals of at most so many degrees.
    pub fn mean_angle_deg(most: f64) -> Self {
        Self { figure: Figure::MeanAngle, most }
    }

    /// Demands that at most this part of the texels has a ray that missed, [0, 1].
    pub fn missed(most: f64) -> Self {
        Self { figure: Figure::Missed, most }
    }

    /// Demands that the surfaces are nowhere farther apart than this part of the diagonal.
    pub fn hausdorff(most: f64) -> Self {
        Self { figure: Figure::Hausdorff, most }
    }

    /// Demands an asset of at most so many bytes.
    pub fn bytes(most: u64) -> Self {
        Self { figure: Figure::Bytes, most: most as f64 }
    }

    /// Holds the requirement against what was measured; what could not be measured is not met.
    fn against(&self, figures: &Figures) -> Met {
        let angle = |of: fn(&Summary) -> f64| figures.angles.as_ref().map(of);
        let value = match self.figure {
            Figure::MeanAngle => angle(|summary| summary.mean),
            Figure::P95Angle => angle(|summary| summary.p95),
            Figure::MaxAngle => angle(|summary| summary.max),
            Figure::Missed => Some(figures.missed_texels),
            Figure::Hausdorff => Some(figures.hausdorff_of_diagonal),
            Figure::Bytes => Some(figures.bytes_out as f64),
        };
        let met = value.is_some_and(|value| value <= self.most);
        Met { figure: self.figure, most: self.most, value, met }
    }
}

impl FromStr for Requirement {
    type Err = Error;

    /// Reads `mean-angle=2`, `missed=0.1%` and the like.
    fn from_str(text: &str) -> Result<Self> {
        let wrong = |why: &str| Error::invalid(format!("`{text}`"), why);
        let (name, most) = text
            .split_once('=')
            .ok_or_else(|| wrong("write a figure and the most it may be, such as mean-angle=2"))?;
        let figure = Figure::from_name(name)?;
        let (number, scale) = match most.strip_suffix('%') {
            Some(number) => (number, 0.01),
            None => (most, 1.0),
        };
        if scale != 1.0 && !matches!(figure, Figure::Missed | Figure::Hausdorff) {
            return Err(wrong(&format!("{name} is not measured in %")));
        }
        match number.trim().parse::<f64>() {
            Ok(number) if number >= 0.0 && number.is_finite() => Ok(Self { figure, most: number * scale }),
            Ok(number) if number < 0.0 => Err(wrong(&format!("{most} is below 0"))),
            _ => Err(wrong(&format!("`{number}` is not a number"))),
        }
    }
}

/// The outcome of a requirement.
///
/// ```
/// use taotie::asset::Met;
/// use taotie::names::Named;
///
/// /// Returns a line for each requirement that is not met.
/// fn shortfalls(met: &[Met]) -> Vec<String> {
///     let line = |met: &Met| format!("{}: {:?}, at most {}", met.figure.name(), met.value, met.most);
///     met.iter().filter(|met| !met.met).map(line).collect()
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Met {
    /// The figure that is limited.
    pub figure: Figure,
    /// The most that it may be.
    pub most: f64,
    /// The figure's value; `None` where it could not be measured.
    pub value: Option<f64>,
    /// `true` where it is no more.
    pub met: bool,
}

impl Proof {
    /// Holds each requirement against what was measured; what could not be measured is not met.
    pub fn require(&self, requirements: &[Requirement]) -> Vec<Met> {
        requirements.iter().map(|requirement| requirement.against(&self.figures)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requirements_are_read_with_their_units() {
        let read = |text: &str| text.parse::<Requirement>();
        assert_eq!(read("mean-angle=2").unwrap(), Requirement::mean_angle_deg(2.0));
        assert!((read("missed=0.1%").unwrap().most - 0.001).abs() < 1e-12);
        assert_eq!(read("missed=0.5").unwrap().most, 0.5);
        for wrong in ["mean-angle", "mean-angle=2%", "beauty=3", "missed=-1", "missed=x", "missed=inf"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
