//! A low-poly mesh laid out on a map, band by band.

use super::coverage::{NONE, Rasterizer};
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, Point};
use std::ops::Range;

/// Number of texel rows in a band, and the side of the tiles it is divided into.
pub(super) const BAND: u32 = 32;

/// The triangles of a mesh on a map with `side` · `side` samples per texel.
pub(super) struct Layout<'a> {
    pub mesh: &'a Mesh,
    pub size: [u32; 2],
    pub side: u32,
    rasterizer: Rasterizer<'a>,
    /// The triangles that touch each band, in order.
    bands: Vec<Vec<u32>>,
    /// Triangles whose uvs span no area.
    pub flat: usize,
}

/// A row of samples, its first and last column, and how many rows it is below the map's copy.
type Span = (i64, [i64; 2], i64);

/// The samples of one triangle in one tile.
#[derive(Clone)]
pub(super) struct TriangleSamples {
    pub triangle: u32,
    pub samples: Vec<Sample>,
    /// The weights of the triangle's corners at (0, 0), (1, 0) and (0, 1) of the tile, as (column, row).
    pub weights: [[f32; 3]; 3],
}

/// A sample of a triangle in a tile.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// Its texel, relative to the band.
    pub texel: u32,
    /// Its column and row in the tile.
    pub at: [u16; 2],
    /// The weights of the triangle's corners.
    pub weights: [f32; 3],
}

/// The surroundings of a triangle's edges.
pub(super) struct Edges {
    /// The weight of each corner at their border.
    widths: [f32; 3],
}

impl Edges {
    /// Returns `true` if a sample is within them.
    pub fn is_near(&self, sample: &Sample) -> bool {
        sample.weights.iter().zip(self.widths).any(|(weight, width)| *weight < width)
    }
}

impl TriangleSamples {
    /// Returns the point of the mesh at one of its samples.
    #[inline]
    pub fn point(&self, sample: &Sample) -> Point {
        Point { triangle: self.triangle, weights: sample.weights }
    }

    /// Returns the surroundings of the triangle's edges, one texel wide, with `side` samples along a texel.
    pub fn edges(&self, side: u32) -> Edges {
        let [origin, across, down] = self.weights;
        // The weight of a corner is the distance from the opposite edge, in heights of the triangle.
        let width = |k: usize| {
            let slope = [across[k] - origin[k], down[k] - origin[k]];
            (slope[0] * slope[0] + slope[1] * slope[1]).sqrt() * side as f32
        };
        Edges { widths: std::array::from_fn(width) }
    }

    /// Returns the distance between neighbouring samples on a triangle with these corners: the longer of the two
    /// axes, in model units.
    #[inline]
    pub fn spacing(&self, corners: [Vec3; 3]) -> f32 {
        let ([a, b, c], [origin, across, down]) = (corners, self.weights);
        // Differences of weights, since the weights themselves are large if the triangle is small relative to its
        // tile.
        let way = |to: [f32; 3]| ((b - a) * (to[1] - origin[1]) + (c - a) * (to[2] - origin[2])).length();
        way(across).max(way(down))
    }
}

impl<'a> Layout<'a> {
    /// Makes the layout from these uvs of the mesh.
    ///
    /// # Errors
    /// As [`super::Coverage::new`] if uvs span too many copies of the map.
    pub fn new(mesh: &'a Mesh, uvs: &'a [Vec2], size: [u32; 2], side: u32) -> Result<Self> {
        let rasterizer = Rasterizer::new(mesh.triangles(), uvs, size.map(|s| s * side))?;
        let mut layout = Self { mesh, size, side, rasterizer, bands: Vec::new(), flat: 0 };
        layout.bands = vec![Vec::new(); layout.band_count()];
        for t in 0..mesh.triangles().len() {
            let Some(rows) = layout.rows(t) else {
                layout.flat += 1;
                continue;
            };
            let per_band = i64::from(BAND * side);
            let bands = rows.start.div_euclid(per_band)..(rows.end - 1).div_euclid(per_band) + 1;
            for band in bands.take(layout.bands.len()) {
                let band = band.rem_euclid(layout.bands.len() as i64) as usize;
                layout.bands[band].push(t as u32);
            }
        }
        Ok(layout)
    }

    /// Returns the number of bands; the last may have fewer rows than the others.
    pub fn band_count(&self) -> usize {
        self.size[1].div_ceil(BAND) as usize
    }

    /// Returns the texel rows of a band.
    pub fn texel_rows(&self, band: usize) -> Range<u32> {
        let first = band as u32 * BAND;
        first..(first + BAND).min(self.size[1])
    }

    /// Calls `take` with all samples of a band, triangle by triangle and tile by tile, neighbours in sequence. If
    /// triangles overlap, the one with the lowest index gets the sample. Returns the number of samples that other
    /// triangles cover too.
    pub fn triangle_samples(&self, band: usize, mut take: impl FnMut(&TriangleSamples)) -> usize {
        let rows = self.texel_rows(band);
        let rows = i64::from(rows.start * self.side)..i64::from(rows.end * self.side);
        let places = Places { width: i64::from(self.size[0] * self.side), first: rows.start };
        let mut owners = vec![NONE; (places.width * (rows.end - rows.start)) as usize];
        let mut shared = 0;
        for t in &self.bands[band] {
            self.spans(*t, &rows, |y, [from, to], _| {
                for x in from..=to {
                    match &mut owners[places.at(x, y)] {
                        owner if *owner == NONE => *owner = *t,
                        owner => shared += usize::from(*owner != *t),
                    }
                }
            });
        }
        let mut spans: Vec<Span> = Vec::new();
        let mut triangle_samples =
            TriangleSamples { triangle: 0, samples: Vec::new(), weights: Default::default() };
        for t in &self.bands[band] {
            spans.clear();
            self.spans(*t, &rows, |y, span, down| spans.push((y, span, down)));
            let weights = Weights::new(&self.rasterizer, *t as usize);
            let tile = i64::from(BAND * self.side);
            let columns =
                spans.iter().fold((i64::MAX, i64::MIN), |(l, h), (_, s, _)| (l.min(s[0]), h.max(s[1])));
            for column in columns.0.div_euclid(tile)..=columns.1.div_euclid(tile) {
                triangle_samples.triangle = *t;
                triangle_samples.samples.clear();
                let left = column * tile;
                self.in_strips(&spans, left..left + tile, |x, y, down| {
                    let owner = &mut owners[places.at(x, y)];
                    if *owner == *t {
                        *owner = NONE;
                        triangle_samples.samples.push(Sample {
                            texel: self.texel(places.column(x), y - rows.start),
                            at: [(x - left) as u16, (y - rows.start) as u16],
                            weights: weights.at(x, y + down),
                        });
                    }
                });
                if let Some((_, _, down)) = spans.first() {
                    let corner = |x: i64, y: i64| weights.at(left + x, rows.start + y + down);
                    triangle_samples.weights = [corner(0, 0), corner(1, 0), corner(0, 1)];
                }
                if !triangle_samples.samples.is_empty() {
                    take(&triangle_samples);
                }
            }
        }
        shared
    }

    /// Calls `give` with the samples of some spans within these columns: two rows of texels at a time, back and
    /// forth, so that consecutive samples are neighbours. Samples of a texel follow one another row by row.
    #[inline]
    fn in_strips(&self, spans: &[Span], columns: Range<i64>, mut give: impl FnMut(i64, i64, i64)) {
        let side = i64::from(self.side);
        let row = |span: &Span| span.0.div_euclid(side);
        for (n, strip) in spans.chunk_by(|a, b| row(a) / 2 == row(b) / 2).enumerate() {
            let (from, to) =
                strip.iter().fold((i64::MAX, i64::MIN), |(l, h), (_, s, _)| (l.min(s[0]), h.max(s[1])));
            let (from, to) =
                (from.max(columns.start).div_euclid(side), to.min(columns.end - 1).div_euclid(side));
            for texel in from..=to {
                let texel = if n % 2 == 0 { texel } else { from + to - texel } * side;
                for (y, [from, to], down) in strip {
                    let (from, to) = ((*from).max(columns.start), (*to).min(columns.end - 1));
                    for x in from.max(texel)..=to.min(texel + side - 1) {
                        give(x, *y, *down);
                    }
                }
            }
        }
    }

    /// Returns the texel, relative to the band, of a sample at a column of the map and a row of the band.
    fn texel(&self, column: i64, row: i64) -> u32 {
        let [x, y] = [column, row].map(|v| v as u32 / self.side);
        y * self.size[0] + x
    }

    /// Calls `give` with the rows of a triangle in a band, the columns it spans there, and how many rows the triangle
    /// is below the map's copy in which they are counted.
    #[inline]
    fn spans(&self, triangle: u32, rows: &Range<i64>, mut give: impl FnMut(i64, [i64; 2], i64)) {
        let height = i64::from(self.size[1] * self.side);
        let Some(own) = self.rows(triangle as usize) else { return };
        for copy in own.start.div_euclid(height)..=(own.end - 1).div_euclid(height) {
            let down = copy * height;
            let here = rows.start + down..rows.end + down;
            self.rasterizer.spans(triangle as usize, here, |y, span| give(y - down, span, down));
        }
    }

    /// Returns the sample rows that a triangle may touch; `None` if its uvs span no area.
    fn rows(&self, triangle: usize) -> Option<Range<i64>> {
        let corners = self.rasterizer.corners(triangle)?;
        let (low, high) = corners.iter().fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(c[1]), h.max(c[1])));
        Some(low.floor() as i64..high.floor() as i64 + 1)
    }
}

/// The positions of samples in a band, row by row.
struct Places {
    /// Samples per row.
    width: i64,
    /// The first row.
    first: i64,
}

impl Places {
    fn at(&self, x: i64, y: i64) -> usize {
        ((y - self.first) * self.width + self.column(x)) as usize
    }

    /// Returns the column on the map itself; columns outside it continue through its copies.
    fn column(&self, x: i64) -> i64 {
        if (0..self.width).contains(&x) { x } else { x.rem_euclid(self.width) }
    }
}

/// The weights of a triangle's corners as linear functions of a sample's position.
struct Weights {
    origin: Vec2<f64>,
    second: Vec2<f64>,
    third: Vec2<f64>,
}

impl Weights {
    fn new(rasterizer: &Rasterizer<'_>, triangle: usize) -> Self {
        let corners = rasterizer.corners(triangle).unwrap_or_default();
        let [a, b, c] = corners.map(|[x, y]| Vec2::new(x, y));
        let (e, f) = (b - a, c - a);
        let det = e.cross(f);
        let scale = if det == 0.0 { 0.0 } else { 1.0 / det };
        Self {
            origin: a,
            second: Vec2::new(f.y * scale, -f.x * scale),
            third: Vec2::new(-e.y * scale, e.x * scale),
        }
    }

    fn at(&self, x: i64, y: i64) -> [f32; 3] {
        let p = Vec2::new(x as f64 + 0.5, y as f64 + 0.5) - self.origin;
        let dot = |q: Vec2<f64>| p.x * q.x + p.y * q.y;
        let (v, w) = (dot(self.second), dot(self.third));
        [(1.0 - v - w) as f32, v as f32, w as f32]
    }
}
