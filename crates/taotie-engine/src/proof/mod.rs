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

pub use close_up::{CloseUp, Coarseness, Footprint, SurfaceSample, edges};
pub use distance::{DistanceBounds, Source, distance_bounds, hausdorff, root_mean_square, stray};
pub use map_error::{MapCheck, MapError, StoredMap};
pub use mismatch::Mismatch;
pub use overview::{
    ImageLook, Overview, Picture, PixelDifferences, Relook, Shown, overview, pixel_differences,
};
pub use patch::{
    PATCH_SHARE, Patch, PatchQuantity, PatchView, Region, Window, WorstRegions, most_missing, worst_patch,
};
pub use silhouette::{SilhouetteFigures, silhouettes};
pub use statistics::{Estimate, Exceedance, Share, share_interval};

use crate::bake::{LookupPoint, Scan, Visibility};
use crate::compare::{angle_deg, color_difference, lab_from_linear};
use crate::math::Vec3;
use crate::scene::AlphaMode;
use crate::surface::facet_normal;
use crate::trace::Ray;

/// A surface and its visibility.
pub struct Side<'a> {
    /// The triangles with their materials, indexed for rays.
    pub surface: &'a Scan,
    /// Determines which of its points can be seen.
    pub visibility: Visibility<'a>,
    /// How fine its detail is.
    footprint: Footprint,
}

/// A scan and an asset in the same space.
pub struct Pair<'a> {
    /// The expected surface.
    pub scan: &'a Side<'a>,
    /// The shown surface.
    pub asset: &'a Side<'a>,
    /// The scan's diagonal, in model units.
    pub diagonal: f32,
    /// The properties that are compared in addition to normals.
    pub properties: Properties,
}

/// The properties of surfaces that are compared in addition to normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Properties {
    /// None: the scan specifies no colours or materials, or the asset's files contain none.
    None,
    /// Opacity: the scan specifies no colours or materials, so it is opaque, and the asset is blended.
    Opacity,
    /// Colours and metallic: the scan's file states no roughness, and a coloured surface without a material is shown as a
    /// dielectric.
    Colors,
    /// Colours and materials.
    All,
}

impl Properties {
    /// Returns the properties to compare, given whether the scan has colours or materials, and whether its file states
    /// roughness.
    pub fn of([has_color, has_material]: [bool; 2], asset: &Scan) -> Self {
        match (has_color, has_material) {
            (true, true) => Self::All,
            (true, false) => Self::Colors,
            (false, _) if asset.surface().is_blended() => Self::Opacity,
            (false, _) => Self::None,
        }
    }
}

/// One pixel's view of a surface: sums over its samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Look {
    normal: Vec3,
    color: Vec3,
    emission: Vec3,
    /// Of blended materials; others are opaque where they are drawn.
    opacity: f32,
    metallic: f32,
    roughness: f32,
    occlusion: f32,
    samples: u32,
    /// Samples of materials with an occlusion texture.
    occluded: u32,
    /// Samples of unlit materials, which show no normals.
    unlit: u32,
}

/// How the look of an asset differs from that of its scan.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Difference {
    /// Degrees between the normals; 90 if the asset hides the scan's relief, NaN if one of them shows nothing.
    angle_deg: f32,
    /// The colour difference: CIEDE2000 between the base colours, or between the emission, or 100 times the difference of
    /// opacity, whichever is largest; NaN if materials are not compared.
    color: f32,
    /// CIEDE2000 between the emission; NaN if neither emits noticeable light, or if materials are not compared.
    emission: f32,
    /// The difference of metallic, of roughness, or of the occlusion that the scan has, whichever is largest, [0, 1]; of
    /// metallic only if the scan's file states no roughness. NaN if materials are not compared.
    material: f32,
    /// `true` if most of the asset's samples are unlit, and most of the scan's are lit.
    is_hidden: bool,
}

/// The angle used if the asset shows nothing, or no normals, in degrees.
const NOTHING_DEG: f32 = 90.0;
/// The difference from black above which light is noticeable, CIEDE2000.
const NOTICEABLE: f64 = 1.0;

/// The difference between transparent and opaque: that between black and white.
const TRANSPARENT: f64 = 100.0;

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
        Self { surface, visibility: Visibility::of(surface), footprint: Footprint::of(surface) }
    }

    /// Returns `true` if the surface is within the distance `reach` of a point, not turned away from a viewer in the
    /// direction `toward`, as with reversed winding. It need not be the closest part: at the edge of a blade that may well be
    /// its other side.
    fn is_near(&self, point: Vec3, (toward, reach): (Vec3, f32)) -> bool {
        /// The cosine to the viewer below which a surface is turned away.
        const AWAY: f32 = -0.5;
        let is_not_away = |triangle: u32| {
            let facet = facet_normal(self.surface.mesh().corners(triangle as usize));
            let is_double = || self.surface.surface().material(triangle).double_sided;
            facet.is_none_or(|facet| facet.dot(toward) > AWAY) || is_double()
        };
        self.surface.bvh().closest_of(point, reach, is_not_away).is_some()
    }
}

impl Look {
    /// Returns the look of a pixel at a surface.
    pub fn of(surface: &Scan, samples: impl IntoIterator<Item = Sample>, properties: Properties) -> Self {
        let mut look = Self::default();
        samples.into_iter().for_each(|sample| look.add(surface, sample, properties));
        look
    }

    /// Adds a point of a surface.
    fn add(&mut self, surface: &Scan, sample: Sample, properties: Properties) {
        let Sample { at, toward } = sample;
        self.normal += surface.seen_normal(at, toward);
        let shown = surface.surface().material(at.point.triangle);
        if properties != Properties::None {
            let material = surface.seen_material(at);
            self.color += material.color;
            self.emission += material.emission;
            self.opacity += if shown.alpha == AlphaMode::Blend { material.alpha } else { 1.0 };
            self.metallic += material.metallic;
            self.roughness += material.roughness;
            self.occlusion += material.occlusion;
            self.occluded += u32::from(shown.occlusion_texture.is_some());
        }
        self.samples += 1;
        self.unlit += u32::from(shown.unlit);
    }

    fn is_unlit(&self) -> bool {
        2 * self.unlit > self.samples
    }

    fn unit_normal(&self) -> Vec3 {
        self.normal.normalize_or(Vec3::default())
    }

    /// Returns the base colour, CIE L*a*b*; zero if it was not read.
    fn lab(&self) -> Vec3 {
        lab_from_linear(Vec3::from_array(self.shade().color).to_f64()).to_f32()
    }

    fn shade(&self) -> Shade {
        let mean = |sum: Vec3| (sum * (1.0 / self.samples as f32)).to_array();
        Shade {
            color: mean(self.color),
            light: mean(self.emission),
            opacity: self.opacity / self.samples as f32,
        }
    }
}

impl Difference {
    /// Compares the looks of a scan and an asset.
    pub fn between(scan: &Look, asset: &Look, properties: Properties) -> Self {
        let nothing = Self {
            angle_deg: f32::NAN,
            color: f32::NAN,
            emission: f32::NAN,
            material: f32::NAN,
            is_hidden: false,
        };
        if scan.samples.min(asset.samples) == 0 {
            return nothing;
        }
        let is_hidden = asset.is_unlit() && !scan.is_unlit();
        let angle = || angle_deg(scan.normal.to_f64(), asset.normal.to_f64()) as f32;
        let normals = Self { angle_deg: if is_hidden { NOTHING_DEG } else { angle() }, is_hidden, ..nothing };
        match properties {
            Properties::None => return normals,
            Properties::Opacity => {
                let opacity = (scan.shade().opacity - asset.shade().opacity).abs();
                return Self { color: opacity * TRANSPARENT as f32, ..normals };
            }
            Properties::Colors | Properties::All => (),
        }
        let off =
            |of: fn(&Look) -> f32| (of(scan) / scan.samples as f32 - of(asset) / asset.samples as f32).abs();
        let [seen, shown] = [scan, asset].map(Look::shade);
        let emits = |shade: Shade| light_difference(shade.light, [0.0; 3]) > NOTICEABLE;
        let is_lit = emits(seen) || emits(shown);
        let occlusion = if scan.occluded > 0 { off(|look| look.occlusion) } else { 0.0 };
        Self {
            color: seen.difference(shown) as f32,
            emission: if is_lit { light_difference(seen.light, shown.light) as f32 } else { f32::NAN },
            material: match properties {
                Properties::Colors => off(|look| look.metallic),
                _ => off(|look| look.metallic).max(off(|look| look.roughness)).max(occlusion),
            },
            ..normals
        }
    }
}

/// A pixel's colour without its normals.
#[derive(Debug, Clone, Copy)]
struct Shade {
    /// The base colour, linear RGB.
    color: [f32; 3],
    /// The emission, linear RGB.
    light: [f32; 3],
    opacity: f32,
}

impl Shade {
    /// Returns the colour difference, as in [`Difference::color`].
    fn difference(self, other: Self) -> f64 {
        let opacity = f64::from((self.opacity - other.opacity).abs()) * TRANSPARENT;
        let light = light_difference(self.light, other.light);
        larger(larger(color_difference(self.color, other.color), light), opacity)
    }
}

/// Returns the CIEDE2000 difference of two emissions in linear RGB, relative to the brightest channel if it exceeds 1.
fn light_difference(a: [f32; 3], b: [f32; 3]) -> f64 {
    let most = a.into_iter().chain(b).fold(1.0, f32::max);
    let [a, b] = [a, b].map(|light| light.map(|v| v / most));
    color_difference(a, b)
}

/// Returns the larger number; NaN if either is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Returns the ray of a viewer who looks at `point` from the distance `away` in the direction `toward`.
fn view_ray(point: Vec3, toward: Vec3, away: f32) -> Ray {
    Ray::new(point + toward * away, -toward)
}
