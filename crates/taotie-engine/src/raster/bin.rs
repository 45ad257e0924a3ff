//! Clips, culls and snaps triangles, and sorts them into tiles.

use super::cull::{BLOCK, Corners, CullResult, Culling};
use super::screen::{ScreenTriangle, ScreenVertices, Setup};
use super::{Faces, SUBPIXELS, TILE_SIZE, Viewport};
use crate::error::Result;
use crate::math::SimdLevel;
use fearless_simd::Level;
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
