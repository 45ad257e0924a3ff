//! The error of a low-poly mesh with its normal map against the scan it was baked from.

use super::cage::{Cage, triangle_weights};
use super::layout::{BAND, Layout};
use super::projection::Correspondence;
use super::scan::Scan;
use crate::compare::{Field, angle_deg};
use crate::error::{Error, Result};
use crate::image::{Sampler, Texture};
use crate::math::{Vec2, Vec3, sequence::Sequence};
use crate::mesh::{Mesh, Point};
use crate::parallel;
use crate::scene::NormalSpace;
use crate::surface::{decode_normal, decode_object_normal, facet_normal, tangent_normal};
use crate::trace::Bvh;

/// A low-poly mesh as a viewer shows it.
pub struct Verifier<'a> {
    /// With uvs, normals and tangents.
    pub mesh: &'a Mesh,
    /// Its normal map; without one its vertex normals are measured.
    pub normal: Option<ShownNormals<'a>>,
    /// The cage from which each of its points is projected onto the scan.
    pub cage: &'a Cage,
    /// The scan that it should look like.
    pub scan: &'a Scan,
}

/// A normal map as a viewer looks it up.
#[derive(Debug, Clone, Copy)]
pub struct ShownNormals<'a> {
    /// The map, on the first uv set.
    pub texture: &'a Texture,
    /// The space of its vectors.
    pub space: NormalSpace,
    /// The sampler that the file gives it. Its wrapping counts; its filters choose among levels, which are not read.
    pub sampler: Sampler,
}

impl ShownNormals<'_> {
    /// Returns the red, green and blue at a place, bilinear at the finest level.
    fn at(&self, uv: Vec2) -> Vec3 {
        let Sampler { wrap_u, wrap_v, .. } = self.sampler;
        let sampler = Sampler { wrap_u, wrap_v, ..Sampler::BILINEAR };
        let [r, g, b, _] = sampler.sample(self.texture, uv, 0.0);
        Vec3::new(r, g, b)
    }
}

/// The angles between normals and those of the scan.
#[derive(Debug, Clone)]
pub struct NormalError {
    /// Degrees, one number for each of many points spread evenly over the low-poly mesh.
    pub angles: Field,
    /// The part of the points whose projection ray missed the scan, so that its closest point was taken: [0, 1].
    pub missed: f64,
    /// The part for which that failed too; they have no angle.
    pub lost: f64,
}

/// The distance of two surfaces from one another, model units.
#[derive(Debug, Clone)]
pub struct Deviation {
    /// From points of the scan to the low-poly mesh.
    pub of_scan: Field,
    /// From points of the low-poly mesh to the scan.
    pub of_light: Field,
}

impl Deviation {
    /// Returns the largest distance either way; infinite where one could not be measured.
    pub fn hausdorff(&self) -> f64 {
        self.both().fold(0.0, f64::max)
    }

    /// Returns the square root of the mean squared distance, over both ways.
    pub fn rms(&self) -> f64 {
        let (sum, count) = self.both().fold((0.0, 0usize), |(sum, count), d| (sum + d * d, count + 1));
        (sum / count.max(1) as f64).sqrt()
    }

    fn both(&self) -> impl Iterator<Item = f64> + '_ {
        let all = self.of_scan.values().iter().chain(self.of_light.values());
        all.map(|d| f64::from(*d)).filter(|d| !d.is_nan())
    }
}

impl Verifier<'_> {
    /// Measures the angle between the normal that a viewer shows, the map looked up bilinearly at its finest level, and
    /// the scan's, at `count` points spread evenly over the low-poly mesh's area. The scan's normal and height maps are
    /// read at their finest level, so relief that the low-poly mesh cannot hold counts.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the mesh has no area, or lacks uvs, normals or tangents for its map.
    pub fn normal_error(&self, count: usize) -> Result<NormalError> {
        self.check()?;
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

    /// Returns the same angle at the middle of each texel of a map of this size, NaN away from all UV islands.
    ///
    /// # Errors
    /// As [`Verifier::normal_error`].
    pub fn error_map(&self, size: [u32; 2]) -> Result<Field> {
        self.check()?;
        let layout = Layout::new(self.mesh, size, 1)?;
        let mut values = vec![f32::NAN; size[0] as usize * size[1] as usize];
        parallel::pieces(&mut values, (BAND * size[0]) as usize, &|band, values| {
            layout.triangle_samples(band, |group| {
                for sample in &group.samples {
                    values[sample.texel as usize] = self.angle(group.point(sample)).0;
                }
            });
        });
        Field::new(size[0], size[1], values)
    }

    /// Returns the distances between the surfaces, from `count` points spread evenly over the area of each.
    ///
    /// # Errors
    /// [`Error::Invalid`] where one of them has no area.
    pub fn deviation(&self, count: usize) -> Result<Deviation> {
        let light = Bvh::of(self.mesh.triangles().len(), |t| self.mesh.corners(t));
        let measure = |from: &Mesh, to: &Bvh| {
            let point = sample_area(from, count)?;
            let distance = |i: usize| {
                let closest = to.closest(point(i).position(from), f32::INFINITY);
                closest.map_or(f32::INFINITY, |closest| closest.distance)
            };
            Field::new(count as u32, 1, parallel::collect(count, distance))
        };
        Ok(Deviation {
            of_scan: measure(self.scan.mesh(), &light)?,
            of_light: measure(self.mesh, self.scan.bvh())?,
        })
    }

    /// Texels a model unit on each triangle of the low-poly mesh, on a map of this size; NaN for those without area.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the mesh has no uvs or no triangles.
    pub fn density(&self, [width, height]: [u32; 2]) -> Result<Field> {
        let Some(uvs) = self.mesh.uvs().first() else {
            return Err(Error::invalid("the low-poly mesh", "it has no uvs"));
        };
        let density = |t: usize| {
            let [a, b, c] = self.mesh.triangles()[t].map(|v| uvs[v as usize]);
            let texels = f64::from(width) * f64::from(height);
            let (e, f) = (b - a, c - a);
            let on_map = f64::from((e.x * f.y - e.y * f.x).abs()) * texels;
            (on_map / doubled_area(self.mesh, t)).sqrt() as f32
        };
        let count = self.mesh.triangles().len();
        Field::new(count as u32, 1, parallel::collect(count, density))
    }

    fn check(&self) -> Result<()> {
        let lacks_frames = self.mesh.normals().is_empty() || self.mesh.tangents().is_empty();
        match self.normal {
            Some(_) if self.mesh.uvs().is_empty() || lacks_frames => Err(Error::invalid(
                "the low-poly mesh",
                "it has a normal map but no uvs, normals or tangents",
            )),
            None if self.mesh.normals().is_empty() => {
                Err(Error::invalid("the low-poly mesh", "it has no normals"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the angle between what is shown and what should be, degrees; NaN where nothing was found.
    fn angle(&self, point: Point) -> (f32, Way) {
        let (found, way) = self.found(point);
        let shown = self.shown(point).to_f64();
        let angle = found.map_or(f32::NAN, |found| {
            angle_deg(shown, self.scan.mapped_normal(&found, 0.0).normal.to_f64()) as f32
        });
        (angle, way)
    }

    /// Returns the point of the scan that a point corresponds to.
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
        let mesh = self.mesh;
        let Some(normals) = self.normal else { return point.mean_normal(mesh) };
        let stored = normals.at(point.uv(mesh, 0));
        if normals.space == NormalSpace::Object {
            return decode_object_normal(stored);
        }
        let frame = point.frame(mesh);
        let map = decode_normal(stored, 1.0, 1.0);
        tangent_normal(frame.normal, frame.tangent, frame.handedness, map)
    }
}

/// The way in which a point found the scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Way {
    #[default]
    Met,
    Closest,
    Lost,
}

/// Returns each of `count` points spread evenly over a mesh's area by its number; they are the same for the same mesh.
pub(super) fn sample_area(mesh: &Mesh, count: usize) -> Result<impl Fn(usize) -> Point + Sync> {
    sample_every(mesh, count, 1)
}

/// Like [`sample_area`], but on the triangles 0, `step`, 2 · `step` and so on only; `step` at least 1.
pub(super) fn sample_every(mesh: &Mesh, count: usize, step: usize) -> Result<impl Fn(usize) -> Point + Sync> {
    /// Triangles whose areas have one sum, so that sums take little memory.
    const BLOCK: usize = 32;
    let triangles = mesh.triangles().len().div_ceil(step);
    let areas = move |block: usize| {
        let block = block * BLOCK..((block + 1) * BLOCK).min(triangles);
        block.map(move |t| doubled_area(mesh, t * step)).map(|area| if area.is_finite() { area } else { 0.0 })
    };
    // The area up to the end of each block.
    let mut sums: Vec<f64> = parallel::collect(triangles.div_ceil(BLOCK), |block| areas(block).sum());
    let mut sum = 0.0;
    for to_end in &mut sums {
        sum += *to_end;
        *to_end = sum;
    }
    if sum <= 0.0 {
        return Err(Error::invalid("the mesh", "its triangles have no area"));
    }
    let points = Sequence::new(0);
    Ok(move |i: usize| {
        // One point in each of equal parts of the area.
        let [jitter, u, v, _] = points.four(i as u32 % Sequence::MOST, (i as u32 / Sequence::MOST) * 2);
        let target = (i as f64 + f64::from(jitter)) / count as f64 * sum;
        let block = sums.partition_point(|s| *s <= target).min(sums.len() - 1);
        let mut before = if block == 0 { 0.0 } else { sums[block - 1] };
        let is_before = |area: &f64| {
            before += area;
            before <= target
        };
        let triangle = (block * BLOCK + areas(block).take_while(is_before).count()).min(triangles - 1);
        Point { triangle: (triangle * step) as u32, weights: triangle_weights(u, v) }
    })
}

fn doubled_area(mesh: &Mesh, triangle: usize) -> f64 {
    let [a, b, c] = mesh.corners(triangle).map(Vec3::to_f64);
    (b - a).cross(c - a).length()
}

/// Faults of a pair of meshes, found before anything is baked.
impl Verifier<'_> {
    /// Of points spread over the low-poly mesh: the part near which the scan has no surface at all, the part where its
    /// closest surface faces the other way, and the mean distance to it as a part of `diagonal`; `None` where the mesh
    /// has no area.
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

/// The part of the diagonal beyond which a scan is not the surface of a low-poly mesh.
const AWAY: f64 = 0.02;

/// The measure of how well a low-poly mesh and a scan fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The part of the low-poly mesh that lies farther than a fiftieth of the diagonal from the scan, [0, 1].
    pub away: f64,
    /// The part that faces the other way than the closest surface of the scan, [0, 1].
    pub turned: f64,
    /// The mean distance as a part of the diagonal.
    pub distance: f64,
}
