//! The error of a low-poly mesh with its normal map against the scan it was baked from.

use super::area_samples::sample_area;
use super::cage::Cage;
use super::projection::Correspondence;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::compare::{Field, angle_deg};
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::surface::facet_normal;

/// A low-poly mesh as a viewer shows it, measured along the rays of a bake.
pub struct Verifier<'a> {
    /// The low-poly mesh, with normals.
    pub mesh: &'a Mesh,
    /// The same triangles with their material, whose normals are measured; `None` measures vertex normals.
    pub shown: Option<&'a TexturedMesh>,
    /// The cage from which each of its points is projected onto the scan.
    pub cage: &'a Cage,
    /// The scan that it should match.
    pub scan: &'a Scan,
}

/// The angles between the mesh's normals and those of the scan.
#[derive(Debug, Clone)]
pub struct NormalError {
    /// Degrees, one value for each of many points spread evenly over the low-poly mesh.
    pub angles: Field,
    /// The fraction of points whose projection ray missed the scan, so that its closest point was used: [0, 1].
    pub missed: f64,
    /// The fraction for which that failed too; they have no angle.
    pub lost: f64,
}

impl Verifier<'_> {
    /// Measures the angle between the normal that a viewer shows, the map looked up bilinearly at its finest level,
    /// and the scan's, at `count` points spread evenly over the low-poly mesh's area. The scan's normal and height
    /// maps are read at their finest level, so relief that the low-poly mesh cannot represent counts.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no area, no normals, or different triangles from its material.
    pub fn normal_error(&self, count: usize) -> Result<NormalError> {
        self.check(self.shown)?;
        let point = sample_area(self.mesh, count)?;
        let found: Vec<(f32, Way)> = parallel::collect(count, |i| self.angle(point(i)));
        let part = |way: Way| found.iter().filter(|(_, w)| *w == way).count() as f64 / count as f64;
        let angles = found.iter().map(|(angle, _)| *angle).collect();
        Ok(NormalError {
            angles: Field::new(count as u32, 1, angles)?,
            missed: part(Way::Closest) + part(Way::Lost),
            lost: part(Way::Lost),
        })
    }

    pub(super) fn check(&self, shown: Option<&TexturedMesh>) -> Result<()> {
        let count = |mesh: &Mesh| mesh.triangles().len();
        match shown {
            Some(shown) if count(shown.mesh()) != count(self.mesh) => Err(Error::invalid(
                "the low-poly mesh",
                format!(
                    "it has {} triangles; the mesh of its material has {}",
                    count(self.mesh),
                    count(shown.mesh())
                ),
            )),
            None if self.mesh.normals().is_empty() => {
                Err(Error::invalid("the low-poly mesh", "it has no normals"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the angle between the shown and the expected normal, in degrees; NaN if nothing was found.
    fn angle(&self, point: Point) -> (f32, Way) {
        let (found, way) = self.found(point);
        (found.map_or(f32::NAN, |found| self.angle_to(point, &found)), way)
    }

    /// Returns the angle between the normal shown at a point and the scan's at its correspondence, in degrees.
    pub(super) fn angle_to(&self, point: Point, found: &Correspondence) -> f32 {
        angle_deg(self.shown(point).to_f64(), self.scan.mapped_normal(found, 0.0).normal.to_f64()) as f32
    }

    /// Returns the point of the scan that corresponds to a point.
    pub(super) fn found(&self, point: Point) -> (Option<Correspondence>, Way) {
        let projection = self.cage.projection_ray(self.mesh, point);
        match self.scan.project(&projection) {
            Some(found) => (Some(found), Way::Met),
            None => match self.cage.fallback(self.scan, &projection) {
                Some(found) => (Some(found), Way::Closest),
                None => (None, Way::Lost),
            },
        }
    }

    /// Returns the normal that a viewer shows.
    fn shown(&self, point: Point) -> Vec3 {
        let Some(shown) = self.shown else { return point.mean_normal(self.mesh) };
        shown.normal(LookupPoint::finest(point), point.normal(shown.mesh())).normal
    }
}

/// How a point found the scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Way {
    #[default]
    Met,
    Closest,
    Lost,
}

/// Measures a pair of meshes before anything is baked.
impl Verifier<'_> {
    /// For points spread over the low-poly mesh: the fraction with no surface of the scan nearby, the fraction whose
    /// closest surface faces the other way, and the mean distance to it as a fraction of `diagonal`; `None` if the
    /// mesh has no area.
    pub fn fit(&self, count: usize, diagonal: f64) -> Option<Fit> {
        let point = sample_area(self.mesh, count).ok()?;
        let look = |i: usize| {
            let point = point(i);
            let facing = facet_normal(self.mesh.corners(point.triangle as usize)).unwrap_or_default();
            let closest = self.scan.bvh().closest(point.position(self.mesh), f32::INFINITY)?;
            let normal = closest.point().normal(self.scan.mesh());
            Some((f64::from(closest.distance) / diagonal, normal.dot(facing) < 0.0))
        };
        let found: Vec<(f64, bool)> = parallel::collect(count, look).into_iter().flatten().collect();
        let part = |of: &dyn Fn(&(f64, bool)) -> bool| {
            found.iter().filter(|f| of(f)).count() as f64 / found.len().max(1) as f64
        };
        Some(Fit {
            away: part(&|f| f.0 > AWAY),
            turned: part(&|f| f.1),
            distance: found.iter().map(|f| f.0).sum::<f64>() / found.len().max(1) as f64,
        })
    }
}

/// The fraction of the diagonal beyond which a scan does not match the surface of a low-poly mesh.
const AWAY: f64 = 0.02;

/// Measures how well a low-poly mesh and a scan fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The fraction of the low-poly mesh that is farther than a fiftieth of the diagonal from the scan, [0, 1].
    pub away: f64,
    /// The fraction that faces the opposite way to the closest surface of the scan, [0, 1].
    pub turned: f64,
    /// The mean distance as a fraction of the diagonal.
    pub distance: f64,
}
