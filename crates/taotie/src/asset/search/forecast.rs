//! The estimated bytes and errors of candidates with a normal map.

use super::curve::Curve;
use super::map_size::{Loss, MapSize};
use super::workshop::{Draft, Shape, Workshop};
use crate::error::Result;
use crate::io::ImageCodec;
use crate::progress::Progress;

/// The triangles of the meshes measured for the finest level, and of the one on which map sizes are measured.
const TRIANGLES: [u32; 3] = [2_000, 8_000, 32_000];
const ON_TRIANGLES: u32 = 8_000;
/// The map sizes measured for it, and the one with which meshes are measured.
const SIZES: [u32; 4] = [256, 512, 1024, 2048];
const ON_SIZE: u32 = 512;
/// If a size has more than this fraction of the error of half the size, doubling it is not worthwhile.
const WORTH_DOUBLING: f64 = 0.85;
/// The minimum number of triangles for it, and the ratio between successive candidates.
const LEAST: u32 = 200;
const RATIO: f64 = 1.1;
/// The fraction of the square of an error that remains, however much a mesh or a map is refined.
const FLOOR: f64 = 0.1;

/// Curves from which bytes and errors are estimated.
pub(super) struct Forecast {
    /// The square of the error of meshes with a lossless map of one size, over their triangles.
    squared: Curve,
    mesh_bytes: Curve,
    /// The measured sizes, in ascending order, and the square of the error at which the curves cross.
    sizes: Vec<MapSize>,
    crossing: f64,
    /// The minimum and maximum number of triangles.
    triangles: [f64; 2],
    /// The ratio of true to estimated bytes.
    factor: f64,
}

/// A candidate and its estimated bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    pub shape: Shape,
    /// The format of the normal map.
    pub normals: ImageCodec,
    pub bytes: f64,
}

impl Forecast {
    /// Measures meshes and maps, the latter of at least `least_size`; `None` if the first mesh is refused, or if just
    /// its maps exceed `most_bytes`. Maps of twice the size of such maps are not measured.
    pub fn measured(
        workshop: &mut Workshop<'_>,
        least_size: u32,
        most_bytes: f64,
        progress: Progress<'_>,
    ) -> Result<Option<Self>> {
        let (all, level) = (workshop.triangles(), workshop.level());
        let on = level.triangles(ON_TRIANGLES).min(all);
        let size = level.side(ON_SIZE).max(least_size).min(workshop.most_side());
        let Some(draft) = workshop.draft(mapped(on, size), progress)? else { return Ok(None) };
        let crossing = MapSize::measured(workshop, &draft)?;
        let least = crossing.least();
        if size == least_size.max(level.side(SIZES[0])) && crossing.least_bytes() > most_bytes {
            return Ok(None);
        }
        let mut forecast = Self {
            squared: Curve::default(),
            mesh_bytes: Curve::default(),
            crossing: crossing.squared,
            sizes: Vec::new(),
            triangles: [level.triangles(LEAST), all].map(f64::from),
            factor: 1.0,
        };
        forecast.add_mesh(&draft, &crossing);
        forecast.sizes.push(crossing);
        for triangles in TRIANGLES
            .map(|count| level.triangles(count))
            .into_iter()
            .filter(|count| *count != on && *count < all)
        {
            if let Some(draft) = workshop.draft(mapped(triangles, size), progress)? {
                forecast.add_mesh(&draft, &MapSize::with(workshop, &draft, least)?);
            }
        }
        let range = least_size..=workshop.most_side();
        for size in SIZES
            .map(|size| level.side(size))
            .into_iter()
            .filter(|other| *other != size && range.contains(other))
        {
            if forecast.is_worth_doubling(size / 2)
                && forecast.sizes.iter().all(|known| known.size > size || known.least_bytes() <= most_bytes)
                && let Some(draft) = workshop.draft(mapped(on, size), progress)?
            {
                forecast.sizes.push(MapSize::measured(workshop, &draft)?);
                forecast.sizes.sort_by_key(|of| of.size);
            }
        }
        Ok(Some(forecast))
    }

    /// Adds a mesh with the maps measured on it.
    fn add_mesh(&mut self, draft: &Draft, maps: &MapSize) {
        let count = draft.low.mesh.triangles().len() as f64;
        self.squared.add(count, maps.squared);
        self.mesh_bytes.add(count, maps.mesh_bytes);
    }

    /// Returns `true` unless the step from half of this size hardly helped.
    fn is_worth_doubling(&self, size: u32) -> bool {
        let squared = |size: u32| self.sizes.iter().find(|of| of.size == size).map(|of| of.squared);
        match (squared(size / 2), squared(size)) {
            (Some(half), Some(own)) => own < WORTH_DOUBLING * WORTH_DOUBLING * half,
            // It was not worth measuring.
            (Some(_), None) => false,
            _ => true,
        }
    }

    /// Returns the smallest candidate with at most this ratio of angles.
    pub fn smallest(&self, ratio: f64) -> Option<Choice> {
        let enough = self.choices().filter(|(_, squared)| *squared <= ratio * ratio);
        enough.map(|(choice, _)| choice).min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }

    /// Returns the smallest ratio of angles of any candidate.
    pub fn least_ratio(&self) -> f64 {
        self.choices().map(|(_, squared)| squared).fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Returns all candidates with the squares of their ratios.
    fn choices(&self) -> impl Iterator<Item = (Choice, f64)> {
        let [least, most] = self.triangles;
        let steps = std::iter::successors(Some(least.min(most)), |count| Some(count * RATIO));
        let counts = steps.take_while(move |count| *count < most).chain([most]);
        let pairs = self.sizes.windows(2).flat_map(|pair| pair[0].up_to(&pair[1]));
        let sizes: Vec<MapSize> = pairs.chain(self.sizes.last().cloned()).collect();
        counts.flat_map(move |triangles| {
            let of_size = |size: &MapSize| {
                let squared = self.lossless(triangles, size);
                let choice = |loss: Loss| (self.choice(triangles, size, loss), squared + loss.squared);
                size.losses().map(choice).collect::<Vec<_>>()
            };
            sizes.iter().flat_map(of_size).collect::<Vec<_>>()
        })
    }

    /// Returns the square of the error with lossless maps: those of mesh and map, minus their common part.
    fn lossless(&self, triangles: f64, size: &MapSize) -> f64 {
        let of_mesh = self.squared.at(triangles);
        (of_mesh + size.squared - self.crossing).max(FLOOR * of_mesh.max(size.squared))
    }

    fn choice(&self, triangles: f64, size: &MapSize, loss: Loss) -> Choice {
        let shape = mapped(triangles as u32, size.size);
        let bytes = (self.mesh_bytes.at(triangles) + loss.bytes) * self.factor;
        Choice { shape, normals: loss.normals, bytes }
    }

    /// Corrects estimated bytes by the ratio of true to estimated bytes of the last choice.
    pub fn correct(&mut self, factor: f64) {
        self.factor *= factor;
    }
}

fn mapped(triangles: u32, size: u32) -> Shape {
    Shape { triangles, size, has_normal_map: true }
}
