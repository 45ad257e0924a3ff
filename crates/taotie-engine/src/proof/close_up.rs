//! Points spread over the visible part of a surface, each compared with the other surface in its place.

use super::{Difference, Look, NOTHING_DEG, Pair, Properties, Sample, Side, view_ray};
use crate::bake::{LookupPoint, Scan, SightLine};
use crate::error::Result;
use crate::math::{Vec3, scalar};
use crate::mesh::{Mesh, Point, sample_area};
use crate::parallel;
use crate::trace::{Hit, Ray, RayInterval};

/// A surface farther along the line of sight than this fraction of the diagonal is another part of the object.
const SAME_PART: f32 = 0.02;
/// A surface within this fraction of the diagonal of a line of sight that misses it belongs to an outline.
pub(super) const OUTLINE: f32 = 0.005;
/// Minimum number of pixels across the object: edges of modelled shapes may be as long as the object, and carry no
/// information about its detail.
const LEAST_PIXELS: f64 = 256.0;

/// A visible point and its counterpart on the other surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SurfaceSample {
    /// The position, world space.
    pub position: Vec3,
    /// The direction of the viewer, unit.
    pub toward: Vec3,
    /// The triangle on the sampled surface.
    pub triangle: u32,
    /// Degrees between the shown normals; 90 if the other surface shows nothing, or if the asset is unlit and the scan
    /// is not.
    pub angle_deg: f32,
    /// The colour difference, CIEDE2000; NaN if colours are not compared, or if nothing is shown.
    pub color: f32,
    /// CIEDE2000 between the emission; NaN as above, or if neither of them emits light.
    pub emission: f32,
    /// The difference of metallic, roughness or occlusion, whichever is largest, [0, 1]; NaN as for colours.
    pub material: f32,
    /// The unit shading normals of scan and asset; zero if nothing is compared.
    pub normals: [Vec3; 2],
    /// Their base colours, CIE L*a*b*; zero without colours.
    pub labs: [Vec3; 2],
    /// `true` if the other surface shows nothing there, or another part of the object; or if the asset is unlit there
    /// and the scan is not, so that its relief is not shown.
    pub is_missing: bool,
    /// The distance to the closest point of the other surface, in model units.
    pub distance: f32,
    /// The width of the asset's finest texel there, in model units; NaN without a texture.
    pub texel: f32,
    /// The same relative to the scan's detail, as by [`Coarseness`].
    pub coarser: f32,
}

/// Samples of the visible part of one surface.
#[derive(Debug, Clone, Default)]
pub struct CloseUp {
    /// Visible points, spread evenly.
    pub samples: Vec<SurfaceSample>,
    /// The share of the area that other parts of the surface hide, or that only an asset shows, [0, 1].
    pub hidden: f64,
    /// The share of the area that alpha makes transparent, [0, 1].
    pub transparent: f64,
    /// Number of points sampled, including those not seen.
    pub points: usize,
    /// `true` if the points are those of the scan, `false` if they are the asset's.
    pub is_of_scan: bool,
}

/// The two surfaces in the roles of a close-up.
#[derive(Clone, Copy)]
pub(super) struct Viewer<'a> {
    pair: &'a Pair<'a>,
    own: &'a Side<'a>,
    other: &'a Side<'a>,
    coarseness: Coarseness,
    is_of_scan: bool,
}

impl<'a> Viewer<'a> {
    /// Views points of the scan, and the asset in their place.
    pub fn of_scan(pair: &'a Pair<'a>) -> Self {
        let half_edge = pair.asset.footprint.half_edge;
        let coarseness = Coarseness { footprint: pair.scan.footprint, half_edge };
        Self { pair, own: pair.scan, other: pair.asset, coarseness, is_of_scan: true }
    }

    /// Views points of the asset, and the scan in their place.
    pub fn of_asset(pair: &'a Pair<'a>) -> Self {
        Self { own: pair.asset, other: pair.scan, is_of_scan: false, ..Self::of_scan(pair) }
    }

    /// Returns the sample at a point of the sampled surface; `None` if it is hidden, transparent, or a back that only the asset
    /// shows.
    pub fn sample(&self, point: Point) -> Option<SurfaceSample> {
        let (own, other) = (self.own.surface, self.other.surface);
        if self.is_transparent(point) {
            return None;
        }
        let line = self.own.visibility.sight_line(point)?;
        let (position, reach) = (point.position(own.mesh()), self.pair.diagonal * SAME_PART);
        let ray = view_ray(position, line.toward, line.distance);
        // Of glass and what is behind it, the surface nearest to the point is its counterpart.
        let (from, limit) = (line.distance - reach, line.distance + reach);
        let first = other.first_seen_beyond(&ray, (f32::INFINITY, limit));
        let to = first.map_or(limit, |hit| hit.distance);
        let clear = other.seen_through(&ray, RayInterval { from: from.max(0.0), center: line.distance, to });
        let seen = [first.filter(|hit| hit.distance > from), clear];
        let off = |hit: &Hit| (hit.distance - line.distance).abs();
        let hit = seen.into_iter().flatten().min_by(|a, b| off(a).total_cmp(&off(b)));
        // An asset may show backs that its scan does not, unless they hide something.
        let is_extra = !self.is_of_scan && hit.is_none() && !own.mesh().faces(point.triangle, line.toward);
        if is_extra && other.first_seen(&ray, f32::INFINITY).is_none() {
            return None;
        }
        let on_scan = if self.is_of_scan { Some(point) } else { hit.map(|hit| hit.point()) };
        let on_asset = if self.is_of_scan { hit.map(|hit| hit.point()) } else { Some(point) };
        let (scan, footprint) = (self.pair.scan.surface, &self.coarseness.footprint);
        let pixel = footprint.pixel(on_scan.map_or(footprint.least, |at| footprint.at(scan, at)));
        let look = |surface: &Scan, point: Point| {
            let sample = Sample { at: LookupPoint { point, width: pixel }, toward: line.toward };
            Look::of(surface, [sample], self.pair.properties)
        };
        let texel =
            on_asset.and_then(|at| self.pair.asset.surface.surface().texel_size(at)).unwrap_or(f32::NAN);
        let closest = other.bvh().closest(position, f32::INFINITY);
        // Next to an outline the line of sight passes an existing surface, or another part is slightly in the way.
        let near = (line.toward, self.pair.diagonal * OUTLINE);
        let is_beside = hit.is_none()
            && self.other.is_near(position, near)
            && self.is_at_outline((position, line), first.is_some());
        let mut sample = SurfaceSample {
            position,
            toward: line.toward,
            triangle: point.triangle,
            angle_deg: if is_beside { f32::NAN } else { NOTHING_DEG },
            color: f32::NAN,
            emission: f32::NAN,
            material: f32::NAN,
            normals: [Vec3::default(); 2],
            labs: [Vec3::default(); 2],
            is_missing: !is_beside,
            distance: closest.map_or(f32::INFINITY, |closest| closest.distance),
            texel,
            coarser: on_scan.map_or(f32::NAN, |at| self.coarseness.at(scan, at, texel)),
        };
        if let Some(hit) = hit {
            let (seen, shown) = (look(own, point), look(other, hit.point()));
            let [of_scan, of_asset] = if self.is_of_scan { [seen, shown] } else { [shown, seen] };
            let found = Difference::between(&of_scan, &of_asset, self.pair.properties);
            let Difference { angle_deg, color, emission, material, is_hidden } = found;
            let looks = [&of_scan, &of_asset];
            let has_color = matches!(self.pair.properties, Properties::Colors | Properties::All);
            sample = SurfaceSample {
                angle_deg,
                color,
                emission,
                material,
                normals: looks.map(Look::unit_normal),
                labs: if has_color { looks.map(Look::lab) } else { sample.labs },
                is_missing: is_hidden,
                ..sample
            };
        }
        Some(sample)
    }

    /// Returns `true` if its own surface ends or steps back next to a line of sight to one of its points, and the other one
    /// is there farther inside, unless another part is in the way: otherwise the other surface has a hole, or lacks a thin part
    /// as a whole.
    fn is_at_outline(&self, (position, line): (Vec3, SightLine), is_blocked: bool) -> bool {
        /// Neighbouring lines of sight on each of several rings, every ring twice as wide as the previous one.
        const AROUND: usize = 8;
        const RINGS: i32 = 3;
        let reach = self.pair.diagonal * SAME_PART;
        let right = line.toward.any_perpendicular();
        let up = line.toward.cross(right);
        let (mut is_at_edge, mut is_beside_other) = (false, is_blocked);
        for i in 0..AROUND {
            let angle = std::f64::consts::TAU * i as f64 / AROUND as f64;
            let [across, along] = [scalar::cos(angle), scalar::sin(angle)].map(|part| part as f32);
            let rays = (0..RINGS).map(|ring| {
                let aside = self.pair.diagonal * OUTLINE / (1 << (RINGS - 1 - ring)) as f32;
                view_ray(position + (right * across + up * along) * aside, line.toward, line.distance)
            });
            let is_there = |side: &Side<'_>, ray: &Ray| {
                let (from, limit) = (line.distance - reach, line.distance + reach);
                let hit = side.surface.first_seen_beyond(ray, (from, limit));
                hit.is_some_and(|hit| hit.distance > line.distance - reach)
            };
            let inside: Vec<Ray> = rays.take_while(|ray| is_there(self.own, ray)).collect();
            is_at_edge |= inside.len() < RINGS as usize;
            is_beside_other = is_beside_other || inside.iter().any(|ray| is_there(self.other, ray));
        }
        is_at_edge && is_beside_other
    }

    /// Returns `true` if alpha makes the sampled surface transparent at a point.
    fn is_transparent(&self, point: Point) -> bool {
        !self.own.surface.surface().is_shown_at(point)
    }

    /// Returns the surface whose points are sampled.
    pub fn own(&self) -> &'a Side<'a> {
        self.own
    }
}

impl CloseUp {
    /// Samples `count` points spread evenly over the scan.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if it has no area.
    pub fn of_scan(pair: &Pair<'_>, count: usize) -> Result<Self> {
        Self::by(Viewer::of_scan(pair), count)
    }

    /// Samples `count` points spread evenly over the asset.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if it has no area.
    pub fn of_asset(pair: &Pair<'_>, count: usize) -> Result<Self> {
        Self::by(Viewer::of_asset(pair), count)
    }

    fn by(viewer: Viewer<'_>, count: usize) -> Result<Self> {
        let point = sample_area(viewer.own.surface.mesh(), count)?;
        let found: Vec<Option<SurfaceSample>> = parallel::collect(count, |i| viewer.sample(point(i)));
        let unseen = found.iter().filter(|sample| sample.is_none()).count();
        let transparent = parallel::count(count, |i| found[i].is_none() && viewer.is_transparent(point(i)));
        let [hidden, transparent] =
            [unseen - transparent, transparent].map(|points| points as f64 / count as f64);
        let samples = found.into_iter().flatten().collect();
        Ok(Self { samples, hidden, transparent, points: count, is_of_scan: viewer.is_of_scan })
    }

    /// Returns the share of the visible area whose [`SurfaceSample::is_missing`] is `true`, [0, 1].
    pub fn missing(&self) -> f64 {
        let missing = self.samples.iter().filter(|sample| sample.is_missing).count();
        missing as f64 / self.samples.len().max(1) as f64
    }
}

/// Maximum number of pixels across the object.
const MOST_PIXELS: f64 = 4096.0;
/// Number of triangles whose edges are measured.
const TRIANGLES: usize = 20_000;

/// The size of a close-up's pixels on a scan, which are as fine as its detail: a texel of its finest texture, or half
/// its median edge, whichever is finer, but no more than 4096 pixels across the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Half the median edge, in model units.
    pub half_edge: f32,
    /// The smallest pixel, in model units.
    pub least: f32,
    /// The largest pixel of a close-up, in model units.
    most: f32,
}

impl Footprint {
    /// Measures the edges of a scan.
    pub fn of(scan: &Scan) -> Self {
        let mesh = scan.mesh();
        let lengths = Self::looked_at(mesh.triangles().len()).flat_map(|t| edges(mesh, t));
        Self::of_edges(lengths.collect(), mesh.diagonal())
    }

    /// Returns an evenly spread subset of this number of triangles, whose edges are measured.
    pub fn looked_at(triangles: usize) -> impl Iterator<Item = usize> {
        (0..triangles).step_by(triangles.div_ceil(TRIANGLES).max(1))
    }

    /// Makes a footprint from the edge lengths of a scan with this diagonal, in model units.
    pub fn of_edges(mut lengths: Vec<f32>, diagonal: f64) -> Self {
        lengths.sort_unstable_by(f32::total_cmp);
        let median = lengths.get(lengths.len() / 2).copied().unwrap_or(0.0);
        let [least, most] = [MOST_PIXELS, LEAST_PIXELS].map(|across| (diagonal / across) as f32);
        Self { half_edge: median * 0.5, least, most }
    }

    /// Returns the size of a close-up's pixel for detail of this width, in model units.
    pub fn pixel(&self, width: f32) -> f32 {
        width.min(self.most)
    }

    /// Returns the size of a pixel at a point of the scan, in model units.
    pub fn at(&self, scan: &Scan, point: Point) -> f32 {
        self.of_texel(scan.surface().texel_size(point))
    }

    /// Returns the size of a pixel if the finest texel has this width, in model units.
    pub fn of_texel(&self, texel: Option<f32>) -> f32 {
        self.half_edge.min(texel.unwrap_or(f32::INFINITY)).max(self.least)
    }
}

/// Compares the texels of an asset with the detail of its scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarseness {
    /// The detail of the scan.
    footprint: Footprint,
    /// Half the asset's median edge, in model units.
    half_edge: f32,
}

impl Coarseness {
    /// Measures the edges of both.
    pub fn between(scan: &Scan, asset: &Scan) -> Self {
        Self { footprint: Footprint::of(scan), half_edge: Footprint::of(asset).half_edge }
    }

    /// Returns the factor by which the asset is coarser than the scan at a point of the scan where the asset's finest texel
    /// has the width `texel`, in model units: texels compared with those of the scan's textures, and the finer of texels and
    /// triangles with the scan's triangles. NaN if `texel` is.
    pub fn at(&self, scan: &Scan, point: Point, texel: f32) -> f32 {
        let Self { footprint: Footprint { half_edge, least, .. }, half_edge: own } = *self;
        if texel.is_nan() {
            return texel;
        }
        let of_textures = scan.surface().texel_size(point).map_or(0.0, |width| texel / width.max(least));
        of_textures.max(texel.min(own) / half_edge.max(least))
    }
}

/// Returns the lengths of a triangle's edges.
pub fn edges(mesh: &Mesh, triangle: usize) -> [f32; 3] {
    let [a, b, c] = mesh.corners(triangle);
    [b - a, c - b, a - c].map(Vec3::length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Sampler, Texels, Texture};
    use crate::scene::{Material, Scene, TextureRef, UvTransform};

    fn ball(columns: usize) -> Scene {
        Scene::of_mesh(Mesh::sphere(1.0, columns, columns / 2), Material::default()).unwrap()
    }

    #[test]
    fn texels_may_be_coarse_where_triangles_are_as_fine_as_the_scan_s() {
        let point = Point { triangle: 4000, weights: [1.0 / 3.0; 3] };
        let [fine, coarse] = [96, 12].map(|columns| Scan::new(ball(columns)).unwrap());
        let of = |scan: &Scan, asset: &Scan| Coarseness::between(scan, asset).at(scan, point, 1.0);
        assert_eq!(of(&fine, &fine), 1.0);
        assert!((7.0..9.0).contains(&of(&fine, &coarse)), "{}", of(&fine, &coarse));
        let mut textured = ball(96);
        let texels = Texels::U8(vec![[255; 4]; 1024 * 512]);
        let texture = Texture::new(Bitmap::new(1024, 512, 4, texels).unwrap(), Encoding::Srgb);
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        let base_color_texture = Some(TextureRef { texture: 0, uv_set: 0, sampler, transform });
        let material = Material { base_color_texture, ..Material::default() };
        textured.edit(|scene| (scene.textures, scene.materials) = (vec![texture], vec![material])).unwrap();
        let textured = Scan::new(textured).unwrap();
        assert!(of(&textured, &textured) > 100.0, "its texels are as wide as 1/300 of its radius");
        let width = textured.surface().texel_size(point).unwrap();
        assert_eq!(Coarseness::between(&textured, &coarse).at(&textured, point, width), 1.0);
    }
}
