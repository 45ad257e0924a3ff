//! `--require`: what must be met.

use super::proof::Proof;
use serde::Serialize;
use std::str::FromStr;
use taotie::names::Named;

/// A figure of a proof that a limit can be set for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Degrees.
    MeanAngle,
    /// Degrees.
    P95Angle,
    /// Degrees.
    MaxAngle,
    /// Part of the texels.
    Missed,
    /// Part of the diagonal.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Which.
    pub figure: Figure,
    /// In the figure's unit; parts as such, not in per cent.
    pub most: f64,
}

impl FromStr for Requirement {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, most) = text.split_once('=').ok_or_else(|| {
            format!("`{text}`: write a figure and the most it may be, such as mean-angle=2")
        })?;
        let figure = Figure::from_name(name).map_err(|error| error.to_string())?;
        let (number, scale) = match most.strip_suffix('%') {
            Some(number) => (number, 0.01),
            None => (most, 1.0),
        };
        let number = crate::options::number(number)?;
        if scale != 1.0 && !matches!(figure, Figure::Missed | Figure::Hausdorff) {
            return Err(format!("{name} is not measured in %"));
        }
        if number < 0.0 {
            Err(format!("{most} is below 0"))
        } else {
            Ok(Self { figure, most: number * scale })
        }
    }
}

/// Whether a requirement was met.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Met {
    /// The figure's name.
    pub figure: &'static str,
    /// The most that it may be.
    pub most: f64,
    /// What it is; `None` where it could not be measured.
    pub value: Option<f64>,
    /// Whether it is no more.
    pub met: bool,
}

impl Requirement {
    /// Holds the requirement against what was measured; what could not be measured is not met.
    pub fn against(&self, proof: &Proof) -> Met {
        let angle = |of: fn(&taotie_report::spread::Spread) -> f64| proof.angles.as_ref().map(of);
        let value = match self.figure {
            Figure::MeanAngle => angle(|spread| spread.mean),
            Figure::P95Angle => angle(|spread| spread.p95),
            Figure::MaxAngle => angle(|spread| spread.max),
            Figure::Missed => Some(proof.missed_texels),
            Figure::Hausdorff => Some(proof.hausdorff_of_diagonal),
            Figure::Bytes => Some(proof.bytes_out as f64),
        };
        let met = value.is_some_and(|value| value <= self.most);
        Met { figure: self.figure.name(), most: self.most, value, met }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requirements_are_read_with_their_units() {
        let read = |text: &str| text.parse::<Requirement>();
        assert_eq!(read("mean-angle=2").unwrap(), Requirement { figure: Figure::MeanAngle, most: 2.0 });
        assert!((read("missed=0.1%").unwrap().most - 0.001).abs() < 1e-12);
        assert_eq!(read("missed=0.5").unwrap().most, 0.5);
        for wrong in ["mean-angle", "mean-angle=2%", "beauty=3", "missed=-1", "missed=x"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
