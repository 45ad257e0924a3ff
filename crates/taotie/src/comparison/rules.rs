//! The rules behind the figures of a comparison, in words.

use super::look;
use super::matching::Matching;
use super::sample_points::{SPREAD_RULE, SamplePoints};
use crate::compare::PIXELS_PER_DEGREE;

/// The rules behind the figures, in words.
///
/// ```
/// use taotie::comparison::Report;
///
/// /// Returns the rules as a footnote.
/// fn footnote(report: &Report) -> String {
///     report.rules.in_words().join("\n")
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Rules {
    /// The normals between which angles are measured.
    pub angles: String,
    /// The rule by which corresponding points are found.
    pub places: String,
    /// The rule for pixels away from silhouettes.
    pub silhouettes: String,
    /// The rule by which sample points are chosen.
    pub points: String,
    /// The rule by which images are compared.
    pub pictures: String,
}

impl Rules {
    pub(super) fn new(matching: Matching, points: &SamplePoints) -> Self {
        Self {
            angles: "degrees between a method's shading normal and the true one at the corresponding point, each the mean \
                     over the pixel's samples"
                .into(),
            places: matching.rule().into(),
            silhouettes: look::INNER_RULE.into(),
            points: match points {
                SamplePoints::Spread(_) => SPREAD_RULE.into(),
                SamplePoints::Pixels(_) => "the requested pixels, from the top left".into(),
            },
            pictures: format!(
                "developed sRGB pictures of 8 bits with their background; SSIM with Gaussian windows of 11×11 pixels \
                 (Wang et al. 2004), FLIP at {PIXELS_PER_DEGREE:.0} pixels per degree (Andersson et al. 2020). They \
                 are compared pixel by pixel, so they include the deviation of the low-poly mesh from the high-poly \
                 one as well as errors of its normals"
            ),
        }
    }

    /// Returns the rules, one sentence each.
    pub fn in_words(&self) -> Vec<String> {
        vec![
            format!("Angles: {}.", self.angles),
            format!("Matching: {}.", self.places),
            format!("Silhouettes: {}.", self.silhouettes),
            format!("Sample points: {}.", self.points),
            format!("Pictures: {}.", self.pictures),
        ]
    }
}
