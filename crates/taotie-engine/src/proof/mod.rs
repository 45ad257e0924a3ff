//! The proof: how an asset differs from its scan in the eyes of a viewer, measured without the rays of a bake.
//!
//! A bake looks from the asset to the scan along its own rays and stores the result in its maps, so measuring along
//! the same rays would confirm any mistake. Here both surfaces are seen from the viewer's side: the same pixel, the
//! first surface drawn, its shading normal. [`overview`] looks at whole objects, [`CloseUp`] at points spread over
//! either surface, [`silhouettes`] at outlines, [`distance_bounds`] at shape.

mod close_up;
mod distance;
mod map_error;
mod mismatch;
mod overview;
mod patch;
mod silhouette;
mod statistics;

pub use close_up::{CloseUp, Footprint, SurfaceSample, edges};
pub use distance::{DistanceBounds, Source, distance_bounds, hausdorff, root_mean_square, stray};
pub use map_error::{MapCheck, MapError, StoredMap};
pub use mismatch::Mismatch;
pub use overview::{
    ImageLook, Overview, Picture, PixelDifferences, Relook, Shown, overview, pixel_differences,
};
pub use patch::{Patch, PatchQuantity, PatchView, Region, Window, WorstRegions, most_missing, worst_patch};
pub use silhouette::{SilhouetteFigures, silhouettes};
pub use statistics::{Estimate, Exceedance, Share, share_interval};

use crate::bake::{LookupPoint, Scan, Visibility};
use crate::compare::{angle_deg, color_difference};
use crate::math::Vec3;
use crate::trace::Ray;

/// A surface and its visibility.
pub struct Side<'a> {
    /// The triangles with their materials, indexed for rays.
    pub surface: &'a Scan,
    /// Determines which of its points can be seen.
    pub visibility: Visibility<'a>,
}

/// A scan and an asset in the same space.
pub struct Pair<'a> {
    /// The expected surface.
    pub scan: &'a Side<'a>,
    /// The shown surface.
    pub asset: &'a Side<'a>,
    /// The scan's diagonal, in model units.
    pub diagonal: f32,
    /// `true` if colours are compared: the scan specifies colours or materials, and the asset's files contain any.
    pub has_material: bool,
}

/// One pixel's view of a surface: the mean over its samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Look {
    normal: Vec3,
    color: Vec3,
    emission: Vec3,
    samples: u32,
    /// Samples of unlit materials, which show no normals.
    unlit: u32,
}

/// The difference from black above which light is noticeable, CIEDE2000.
const NOTICEABLE: f64 = 1.0;

/// A point of a surface as seen by a viewer.
#[derive(Debug, Clone, Copy)]
struct Sample {
    /// The point, and its lookup width.
    pub at: LookupPoint,
    /// The direction of the viewer, unit.
    pub toward: Vec3,
}

impl<'a> Side<'a> {
    /// Determines the visibility of a surface.
    pub fn of(surface: &'a Scan) -> Self {
        Self { surface, visibility: Visibility::of(surface) }
    }
}

impl Look {
    /// Adds a point of a surface.
    pub fn add(&mut self, surface: &Scan, sample: Sample, reads_material: bool) {
        let Sample { at, toward } = sample;
        self.normal += surface.seen_normal(at, toward);
        if reads_material {
            let material = surface.seen_material(at);
            self.color += material.color;
            self.emission += material.emission;
        }
        self.samples += 1;
        self.unlit += u32::from(surface.surface().material(at.point.triangle).unlit);
    }

    /// Returns `true` if an asset's look hides the relief that this one of its scan shows: most of the asset's samples
    /// are unlit, and most of the scan's are lit.
    pub fn is_hidden_by(&self, asset: &Self) -> bool {
        let is_unlit = |look: &Self| 2 * look.unlit > look.samples;
        is_unlit(asset) && !is_unlit(self)
    }

    /// Returns the angle to another look's normal, in degrees; NaN if one of them saw nothing.
    pub fn angle_deg(&self, other: &Self) -> f32 {
        match self.samples.min(other.samples) {
            0 => f32::NAN,
            _ => angle_deg(self.normal.to_f64(), other.normal.to_f64()) as f32,
        }
    }

    /// Returns the CIEDE2000 difference to another look's base colour or emission, whichever is larger; NaN if one of them
    /// saw nothing.
    pub fn color_difference(&self, other: &Self) -> f32 {
        larger(self.difference(other, |look| look.color), self.difference(other, |look| look.emission)) as f32
    }

    /// Returns the CIEDE2000 difference to another look's emission; NaN if one of them saw nothing, or if neither emits
    /// noticeable light.
    pub fn emission_difference(&self, other: &Self) -> f32 {
        let dark = Self { emission: Vec3::splat(0.0), ..*self };
        let emits = |look: &Self| look.difference(&dark, |look| look.emission) > NOTICEABLE;
        match emits(self) || emits(other) {
            true => self.difference(other, |look| look.emission) as f32,
            false => f32::NAN,
        }
    }

    /// Returns the CIEDE2000 difference of the mean of a colour; NaN if one of them saw nothing.
    fn difference(&self, other: &Self, sum: fn(&Self) -> Vec3) -> f64 {
        let mean = |look: &Self| (sum(look) * (1.0 / look.samples as f32)).to_array();
        match self.samples.min(other.samples) {
            0 => f64::NAN,
            _ => color_difference(mean(self), mean(other)),
        }
    }
}

/// Returns the larger number; NaN if either is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Returns the ray of a viewer who looks at `point` from the distance `away` in the direction `toward`.
fn view_ray(point: Vec3, toward: Vec3, away: f32) -> Ray {
    Ray::new(point + toward * away, -toward)
}
