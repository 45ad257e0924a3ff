//! The point of the reference that corresponds to a point of the model.
//!
//! A low-poly mesh deviates from the high-poly one, so at the same pixel the two show different points of the relief.

use super::look::Look;
use crate::bake::{ProjectionRay, Scan, UvLookup};
use crate::error::Result;
use crate::image::Image;
use crate::math::{Vec2, Vec3};
use crate::names::Named;
use crate::parallel;
use crate::scene::Scene;

/// How corresponding points of model and reference are found.
///
/// ```
/// use taotie::comparison::Matching;
/// use taotie::names::Named;
///
/// assert_eq!(Matching::from_name("uv")?, Matching::Uv);
/// assert!(Matching::Uv.rule().contains("point of the same uv"));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Matching {
    /// Along the model's vertex normal, as bakers do.
    Normal,
    /// By uv, for meshes that share them.
    Uv,
    /// At the same pixel, although the two may show different points there.
    Pixel,
}

impl Named for Matching {
    const WHAT: &'static str = "matching method";
    const NAMES: &'static [(&'static str, Self)] =
        &[("normal", Self::Normal), ("uv", Self::Uv), ("pixel", Self::Pixel)];
}

/// The maximum distance between reference and model, as a fraction of the model's diagonal.
const REACH: f64 = 0.02;

impl Matching {
    /// Returns the rule in words.
    pub fn rule(self) -> &'static str {
        match self {
            Self::Normal => {
                "each covered sample shows a point of the model; the corresponding point of the reference is along \
                 the interpolated vertex normal there, in either direction and at most 2 % of the model's diagonal \
                 away, if it faces the same way"
            }
            Self::Uv => {
                "each covered sample shows a point of the model; the reference's point of the same uv corresponds to it"
            }
            Self::Pixel => "pixel by pixel, although the two meshes may show different points there",
        }
    }

    /// Returns the reference's normals at the points that correspond to each sample's; the fourth channel is 1 where
    /// there is one.
    ///
    /// `smooth` shows the model without relief, whose diagonal is `diagonal`. By pixel there are no corresponding
    /// points: the caller compares with the reference at the same pixel.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the reference has too many vertices.
    pub(super) fn normals(self, smooth: &Look, reference: &Scene, diagonal: f64) -> Result<Image> {
        match self {
            Self::Pixel => matched(smooth, |_| None),
            Self::Uv => {
                let lookup = UvLookup::new(reference)?;
                matched(smooth, |at| {
                    let [u, v, ..] = smooth.uv.pixel(at[0], at[1]);
                    lookup.at(Vec2::new(u, v)).map(|(_, normal)| normal)
                })
            }
            Self::Normal => {
                let scan = Scan::new(reference.clone())?;
                let distance = (REACH * diagonal) as f32;
                let size = [smooth.depth.width(), smooth.depth.height()];
                matched(smooth, |at| {
                    let [depth, ..] = smooth.depth.pixel(at[0], at[1]);
                    let [x, y, z, _] = smooth.normals.pixel(at[0], at[1]);
                    let point = smooth.camera.point_at(at, depth.into(), size).to_f32();
                    let direction = Vec3::new(x, y, z);
                    let projection = ProjectionRay { point, direction, distance };
                    scan.project(&projection).map(|found| scan.mapped_normal(&found, 0.0).normal)
                })
            }
        }
    }
}

/// Returns the normal that `find` gives for each covered sample.
fn matched(smooth: &Look, find: impl Fn([u32; 2]) -> Option<Vec3> + Sync) -> Result<Image> {
    let (width, height) = (smooth.depth.width(), smooth.depth.height());
    let mut matched = Image::new(width, height, [0.0; 4])?;
    parallel::change(matched.pixels_mut(), |i, pixel| {
        let at = [i as u32 % width, i as u32 / width];
        let covered = smooth.depth.pixel(at[0], at[1])[3] == 1.0;
        if let Some(n) = covered.then(|| find(at)).flatten() {
            *pixel = [n.x, n.y, n.z, 1.0];
        }
    });
    Ok(matched)
}
