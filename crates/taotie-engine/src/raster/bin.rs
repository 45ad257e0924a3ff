//! Clips, culls and snaps triangles, and sorts them into tiles.
//!
//! [`Culling`] finds the small triangles that are visible at all, eight at a time and exactly.

use super::screen::{ScreenTriangle, ScreenVertices, Setup};
use super::{Faces, SUBPIXELS, TILE_SIZE, Viewport};
use crate::error::Result;
use crate::math::{SimdLevel, dispatch_registers};
use fearless_simd::{Level, Simd, i32x8, mask32x8, prelude::*};
use rayon::prelude::*;

/// The maximum number of chunks into which the triangles of a draw are split; a tile visits all of them in order.
const MAX_CHUNKS: usize = 64;

/// The minimum number of triangles per chunk.
const MIN_CHUNK: usize = 4096;

/// Triangles to draw.
#[derive(Debug, Clone, Copy)]
pub struct Geometry<'a> {
    /// Vertices in clip space.
    pub clip: &'a [[f32; 4]],
    /// Indices into `clip`, in range.
    pub triangles: &'a [[u32; 3]],
    /// The faces to draw.
    pub faces: Faces,
    /// The id of the first triangle; the others follow.
    pub first_id: u32,
}

/// Triangles by tile, in drawing order.
#[derive(Debug, Default)]
pub struct Bins {
    chunks: Vec<Chunk>,
    /// The vertices of each geometry.
    vertices: Vec<ScreenVertices>,
}

/// Consecutive triangles in drawing order.
#[derive(Debug, Default)]
struct Chunk {
    triangles: Vec<ScreenTriangle>,
    /// The tile that contains each triangle, or [`SEVERAL`].
    homes: Vec<u32>,
    /// The start of each tile's part of `members`, and two more at the end.
    starts: Vec<u32>,
    /// Indices into `triangles`.
    members: Vec<u32>,
}

/// Marks more than one tile.
const SEVERAL: u32 = u32::MAX;

impl Bins {
    /// Clips, culls, snaps and sorts `geometry` into the tiles of `viewport`, reusing the memory of the previous
    /// content. The result depends neither on threads nor on `simd`.
    ///
    /// # Errors
    /// If the SIMD level is not available on this machine.
    pub fn rebuild(&mut self, geometry: &[Geometry<'_>], viewport: &Viewport, simd: SimdLevel) -> Result<()> {
        let level = simd.dispatch()?;
        self.vertices.resize_with(geometry.len(), ScreenVertices::default);
        for (vertices, geometry) in self.vertices.iter_mut().zip(geometry) {
            vertices.fill(geometry.clip, viewport, level);
        }
        let total: usize = geometry.iter().map(|g| g.triangles.len()).sum();
        let chunk_size = total.div_ceil(MAX_CHUNKS).max(MIN_CHUNK);
        let parts: Vec<Part<'_>> = geometry
            .iter()
            .zip(&self.vertices)
            .flat_map(|(geometry, vertices)| {
                let starts = (0..geometry.triangles.len()).step_by(chunk_size);
                starts.map(move |start| Part { geometry, vertices, start, viewport, level })
            })
            .collect();
        self.chunks.resize_with(parts.len(), Chunk::default);
        self.chunks
            .par_iter_mut()
            .with_max_len(1)
            .zip(parts)
            .for_each(|(chunk, part)| chunk.rebuild(&part, chunk_size));
        Ok(())
    }

    /// The triangles that may touch a tile, in drawing order: chunks, and the triangles of each.
    pub(super) fn tile(&self, tile: usize) -> impl Iterator<Item = (&[ScreenTriangle], &[u32])> {
        self.chunks.iter().map(move |chunk| {
            let members = match chunk.starts.get(tile..tile + 2) {
                Some(bounds) => &chunk.members[bounds[0] as usize..bounds[1] as usize],
                None => &[],
            };
            (&chunk.triangles[..], members)
        })
    }

    /// The number of triangles remaining after clipping and culling.
    pub fn triangle_count(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.triangles.len()).sum()
    }
}

/// [`Bins::rebuild`] from scratch, at the fastest level of this machine.
pub fn bin(geometry: &[Geometry<'_>], viewport: &Viewport) -> Bins {
    let mut bins = Bins::default();
    // The level chosen for the machine is always available.
    let _ = bins.rebuild(geometry, viewport, SimdLevel::Auto);
    bins
}

/// The source of a chunk's triangles.
struct Part<'a> {
    geometry: &'a Geometry<'a>,
    vertices: &'a ScreenVertices,
    start: usize,
    viewport: &'a Viewport,
    level: Level,
}

impl Chunk {
    fn rebuild(&mut self, part: &Part<'_>, size: usize) {
        self.triangles.clear();
        let culling = Culling::new(part.viewport, part.geometry.faces, part.level);
        let end = (part.start + size).min(part.geometry.triangles.len());
        let mut corners = Corners { places: [[[0; 2]; BLOCK]; 3] };
        for start in (part.start..end).step_by(BLOCK) {
            let triangles = &part.geometry.triangles[start..end.min(start + BLOCK)];
            for (i, triangle) in triangles.iter().enumerate() {
                for (places, vertex) in corners.places.iter_mut().zip(triangle) {
                    places[i] = part.vertices.places[*vertex as usize];
                }
            }
            let result = culling.test(&corners, triangles.len());
            part.push(start, &corners, result, &mut self.triangles);
        }
        self.sort_into_tiles(part.viewport);
    }

    /// Counts, then fills: for each tile the triangles whose box touches it, in order.
    fn sort_into_tiles(&mut self, viewport: &Viewport) {
        let (across, down) = viewport.tiles();
        self.starts.clear();
        self.starts.resize((across * down) as usize + 2, 0);
        self.homes.clear();
        for triangle in &self.triangles {
            let tiles = Tiles::new(triangle, viewport);
            self.homes.push(tiles.home());
            tiles.for_each(|tile| self.starts[tile + 2] += 1);
        }
        for i in 2..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        // The entry one past a tile's start moves from its start to its end.
        self.members.clear();
        self.members.resize(self.starts.last().map_or(0, |count| *count as usize), 0);
        for (i, home) in self.homes.iter().enumerate() {
            let mut place = |tile: usize| {
                self.members[self.starts[tile + 1] as usize] = i as u32;
                self.starts[tile + 1] += 1;
            };
            match *home {
                SEVERAL => Tiles::new(&self.triangles[i], viewport).for_each(place),
                tile => place(tile as usize),
            }
        }
    }
}

impl Part<'_> {
    /// Adds the triangles of a block, starting at `start`, that may be visible.
    fn push(&self, start: usize, corners: &Corners, result: CullResult, out: &mut Vec<ScreenTriangle>) {
        let mut left = result.seen | result.unknown;
        while left != 0 {
            let i = left.trailing_zeros() as usize;
            left &= left - 1;
            let indices = self.geometry.triangles[start + i];
            let id = self.geometry.first_id + (start + i) as u32;
            if result.unknown >> i & 1 == 1 {
                let corners = indices.map(|v| self.geometry.clip[v as usize].map(f64::from));
                Setup::new(self.viewport, self.geometry.faces).push(corners, id, out);
                continue;
            }
            // The corners in clockwise order.
            let [a, b, c] = if result.counter_clockwise >> i & 1 == 1 { [0, 2, 1] } else { [0, 1, 2] };
            let order = |places: &[[[i32; 2]; BLOCK]; 3], axis: usize| {
                [places[a][i][axis], places[b][i][axis], places[c][i][axis]]
            };
            let depth = [a, b, c].map(|k| self.vertices.depths[indices[k] as usize]);
            out.push(ScreenTriangle {
                x: order(&corners.places, 0),
                y: order(&corners.places, 1),
                depth,
                id,
            });
        }
    }
}

/// The shift that converts coordinates in 1/256 pixel to those of tiles.
const TILE_SHIFT: u32 = (TILE_SIZE * SUBPIXELS as u32).trailing_zeros();

/// The tiles touched by a triangle's box.
struct Tiles {
    columns: [usize; 2],
    rows: [usize; 2],
    across: usize,
}

impl Tiles {
    fn new(triangle: &ScreenTriangle, viewport: &Viewport) -> Self {
        let (across, down) = viewport.tiles();
        let [left, top, right, bottom] = triangle.bounds();
        let clamp = |v: i32, tiles: u32| (v >> TILE_SHIFT).clamp(0, tiles as i32 - 1) as usize;
        Self {
            columns: [clamp(left, across), clamp(right, across)],
            rows: [clamp(top, down), clamp(bottom, down)],
            across: across as usize,
        }
    }

    /// The only tile, or [`SEVERAL`].
    fn home(&self) -> u32 {
        match self.columns[0] == self.columns[1] && self.rows[0] == self.rows[1] {
            true => (self.rows[0] * self.across + self.columns[0]) as u32,
            false => SEVERAL,
        }
    }

    fn for_each(&self, mut visit: impl FnMut(usize)) {
        for row in self.rows[0]..=self.rows[1] {
            for column in self.columns[0]..=self.columns[1] {
                visit(row * self.across + column);
            }
        }
    }
}

/// Triangles tested together: filled in one by one long before they are read as packs.
const BLOCK: usize = 64;

const PACK: usize = 8;

/// Triangles with a longer side take the slow path: products of shorter ones fit 32 bits.
const LONG: i32 = 1 << 15;

/// Corners of the triangles of a block, x and y alternating, in 1/256 pixel.
struct Corners {
    places: [[[i32; 2]; BLOCK]; 3],
}

/// Facts about the triangles of a block; bit i belongs to triangle i.
#[derive(Debug, Default, Clone, Copy)]
struct CullResult {
    /// The triangles that cover a sample, or have enough samples around them that they may.
    seen: u64,
    /// The counter-clockwise triangles.
    counter_clockwise: u64,
    /// The triangles that are too large for this test or need clipping.
    unknown: u64,
}

/// The visibility test for a viewport.
#[derive(Debug, Clone, Copy)]
struct Culling {
    viewport: Viewport,
    faces: Faces,
    level: Level,
}

impl Culling {
    fn new(viewport: &Viewport, faces: Faces, level: Level) -> Self {
        Self { viewport: *viewport, faces, level }
    }

    /// Tests the first `count` triangles of a block; the others must exist but may have any values.
    fn test(&self, corners: &Corners, count: usize) -> CullResult {
        dispatch_registers!(self.level, simd => self.block(simd, corners, count))
    }

    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, corners: &Corners, count: usize) -> CullResult {
        let mut all = CullResult::default();
        let mut start = 0;
        while start < count {
            let small = Small::load(simd, corners, start);
            let unknown = !small.is_small();
            let (turned, drawn) = small.turn(self.faces);
            let clockwise = small.clockwise(turned);
            let seen = drawn & !unknown;
            if seen.any_true() {
                let seen = seen & clockwise.covers(&self.viewport, seen);
                all.seen |= seen.to_bitmask() << start;
            }
            all.counter_clockwise |= turned.to_bitmask() << start;
            all.unknown |= unknown.to_bitmask() << start;
            start += PACK;
        }
        let asked = u64::MAX >> (BLOCK - count);
        CullResult { seen: all.seen & asked, unknown: all.unknown & asked, ..all }
    }
}

/// Eight triangles.
#[derive(Clone, Copy)]
struct Small<S: Simd> {
    simd: S,
    x: [i32x8<S>; 3],
    y: [i32x8<S>; 3],
    /// Left, top, right, bottom.
    bounds: [i32x8<S>; 4],
}

impl<S: Simd> Small<S> {
    #[inline(always)]
    fn load(simd: S, corners: &Corners, start: usize) -> Self {
        let (x0, y0) = load_places(simd, &corners.places[0][start..start + PACK]);
        let (x1, y1) = load_places(simd, &corners.places[1][start..start + PACK]);
        let (x2, y2) = load_places(simd, &corners.places[2][start..start + PACK]);
        let low = [x0.min(x1).min(x2), y0.min(y1).min(y2)];
        let high = [x0.max(x1).max(x2), y0.max(y1).max(y2)];
        Self { simd, x: [x0, x1, x2], y: [y0, y1, y2], bounds: [low[0], low[1], high[0], high[1]] }
    }

    #[inline(always)]
    fn is_small(&self) -> mask32x8<S> {
        let [left, top, right, bottom] = self.bounds;
        let long = self.splat(LONG);
        (right - left).simd_lt(long) & (bottom - top).simd_lt(long)
    }

    /// Returns the counter-clockwise triangles, and those with an area and a face that is drawn.
    #[inline(always)]
    fn turn(&self, faces: Faces) -> (mask32x8<S>, mask32x8<S>) {
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        let area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
        let zero = self.splat(0);
        let (turned, straight) = (area.simd_lt(zero), area.simd_gt(zero));
        let drawn = match faces {
            Faces::CounterClockwise => turned,
            Faces::Clockwise => straight,
            Faces::Both => turned | straight,
        };
        (turned, drawn)
    }

    /// The same with the corners of `turned` ones in clockwise order.
    #[inline(always)]
    fn clockwise(&self, turned: mask32x8<S>) -> Self {
        let ([x0, x1, x2], [y0, y1, y2]) = (self.x, self.y);
        let x = [x0, turned.select(x2, x1), turned.select(x1, x2)];
        let y = [y0, turned.select(y2, y1), turned.select(y1, y2)];
        Self { x, y, ..*self }
    }

    /// Returns the triangles, among those `asked` for, that cover a sample of the image. A triangle with more than
    /// two columns or rows of samples around it counts as covering one.
    #[inline(always)]
    fn covers(&self, viewport: &Viewport, asked: mask32x8<S>) -> mask32x8<S> {
        let mut covers = self.splat(0).simd_lt(self.splat(0));
        for &offset in viewport.pattern.offsets() {
            covers |= self.covers_at(viewport, offset);
            if !(asked & !covers).any_true() {
                break;
            }
        }
        covers
    }

    #[inline(always)]
    fn covers_at(&self, viewport: &Viewport, [sx, sy]: [i32; 2]) -> mask32x8<S> {
        let [left, top, right, bottom] = self.bounds;
        let (column, row) = (self.first(left, sx), self.first(top, sy));
        let columns = self.last(right, sx, viewport.width) - column;
        let rows = self.last(bottom, sy, viewport.height) - row;
        let (zero, one) = (self.splat(0), self.splat(1));
        let some = columns.simd_ge(zero) & rows.simd_ge(zero);
        let many = columns.simd_gt(one) | rows.simd_gt(one);
        if !(some & !many).any_true() {
            return some;
        }
        let at = [(column << 8) + sx, (row << 8) + sy];
        let edges = [self.edge([0, 1], at), self.edge([1, 2], at), self.edge([2, 0], at)];
        let (wide, tall) = (columns.simd_ge(one), rows.simd_ge(one));
        let [here, right] = [self.inside(&edges), self.inside(&moved(&edges, 1)) & wide];
        let edges = moved(&edges, 2);
        let [below, across] = [self.inside(&edges) & tall, self.inside(&moved(&edges, 1)) & wide & tall];
        some & (many | here | right | below | across)
    }

    /// The first column or row of samples at or after `low`.
    #[inline(always)]
    fn first(&self, low: i32x8<S>, offset: i32) -> i32x8<S> {
        ((low + (SUBPIXELS - 1 - offset)) >> 8).max(self.splat(0))
    }

    /// The last column or row of samples at or before `high`.
    #[inline(always)]
    fn last(&self, high: i32x8<S>, offset: i32, side: u32) -> i32x8<S> {
        ((high - offset) >> 8).min(self.splat(side as i32 - 1))
    }

    /// Returns the triangles for which no edge function is negative.
    #[inline(always)]
    fn inside(&self, edges: &[[i32x8<S>; 3]; 3]) -> mask32x8<S> {
        (edges[0][0] | edges[1][0] | edges[2][0]).simd_ge(self.splat(0))
    }

    /// The edge function from corner `i` to corner `j`, lowered by one unless the edge is a top or left one, at a
    /// position; with its steps one pixel to the right and one pixel down.
    #[inline(always)]
    fn edge(&self, [i, j]: [usize; 2], [x, y]: [i32x8<S>; 2]) -> [i32x8<S>; 3] {
        let (dx, dy) = (self.x[j] - self.x[i], self.y[j] - self.y[i]);
        let zero = self.splat(0);
        let top_left = dy.simd_lt(zero) | dy.simd_eq(zero) & dx.simd_gt(zero);
        let value = dx * (y - self.y[i]) - dy * (x - self.x[i]);
        [value - top_left.select(zero, self.splat(1)), zero - (dy << 8), dx << 8]
    }

    #[inline(always)]
    fn splat(&self, value: i32) -> i32x8<S> {
        i32x8::splat(self.simd, value)
    }
}

/// Eight positions as x and y.
#[inline(always)]
fn load_places<S: Simd>(simd: S, places: &[[i32; 2]]) -> (i32x8<S>, i32x8<S>) {
    let (low, high) = places.as_flattened().split_at(PACK);
    i32x8::from_slice(simd, low).deinterleave(i32x8::from_slice(simd, high))
}

/// Edge functions one `step` further: 1 to the right, 2 down.
#[inline(always)]
fn moved<S: Simd>(edges: &[[i32x8<S>; 3]; 3], step: usize) -> [[i32x8<S>; 3]; 3] {
    let mut moved = *edges;
    for edge in &mut moved {
        edge[0] += edge[step];
    }
    moved
}
