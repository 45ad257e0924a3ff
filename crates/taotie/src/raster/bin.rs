//! Clipping, snapping and sorting triangles into tiles.

use super::clip::{ClipVertex, ClipVolume};
use super::{SUBPIXELS, SamplePattern, TILE_SIZE};
use rayon::prelude::*;

/// How far outside the picture vertices may lie before they are clipped, pixels.
const GUARD: f64 = 8192.0;

/// The most chunks that triangles are split into; a tile walks over all of them in order.
const MAX_CHUNKS: usize = 256;

/// The fewest triangles worth a chunk.
const MIN_CHUNK: usize = 4096;

/// The picture to draw into.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Pixels across, 1 to 16384.
    pub width: u32,
    /// Pixels down, 1 to 16384.
    pub height: u32,
    /// Where in a pixel it is sampled.
    pub pattern: SamplePattern,
}

impl Viewport {
    /// How many tiles there are across and down.
    pub fn tiles(&self) -> (u32, u32) {
        (self.width.div_ceil(TILE_SIZE), self.height.div_ceil(TILE_SIZE))
    }
}

/// Which faces are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Faces {
    /// Those that turn counter-clockwise as seen.
    CounterClockwise,
    /// Those that turn clockwise as seen: the front of a mirrored mesh.
    Clockwise,
    /// All.
    Both,
}

/// Triangles to draw.
#[derive(Debug, Clone, Copy)]
pub struct Geometry<'a> {
    /// Vertices in clip space.
    pub clip: &'a [[f32; 4]],
    /// Indices into `clip`, in range.
    pub triangles: &'a [[u32; 3]],
    /// Which faces are drawn.
    pub faces: Faces,
    /// The id of the first triangle; the others follow.
    pub first_id: u32,
}

/// A triangle on the screen with its corners in clockwise order (y down), positions in 1/256 pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScreenTriangle {
    pub x: [i32; 3],
    pub y: [i32; 3],
    /// Reversed depth, z/w.
    pub depth: [f32; 3],
    pub id: u32,
}

/// Triangles by tile, in drawing order.
#[derive(Debug, Default)]
pub struct Bins {
    chunks: Vec<Chunk>,
}

#[derive(Debug, Default)]
struct Chunk {
    triangles: Vec<ScreenTriangle>,
    /// For each tile, where its part of `members` begins; one more at the end.
    starts: Vec<u32>,
    /// Indices into `triangles`.
    members: Vec<u32>,
}

impl Bins {
    /// The triangles that may touch a tile, in drawing order.
    pub(super) fn tile(&self, tile: usize) -> impl Iterator<Item = &ScreenTriangle> {
        self.chunks.iter().flat_map(move |chunk| {
            let members = match chunk.starts.get(tile..tile + 2) {
                Some(bounds) => &chunk.members[bounds[0] as usize..bounds[1] as usize],
                None => &[],
            };
            members.iter().map(|i| &chunk.triangles[*i as usize])
        })
    }

    /// How many triangles are left after clipping and culling.
    pub fn triangle_count(&self) -> usize {
        self.chunks.iter().map(|chunk| chunk.triangles.len()).sum()
    }
}

/// Clips, culls, snaps and sorts `geometry` into the tiles of `viewport`. The result does not depend on threads.
pub fn bin(geometry: &[Geometry<'_>], viewport: &Viewport) -> Bins {
    let total: usize = geometry.iter().map(|g| g.triangles.len()).sum();
    let chunk_size = total.div_ceil(MAX_CHUNKS).max(MIN_CHUNK);
    let ranges: Vec<(&Geometry<'_>, usize)> = geometry
        .iter()
        .flat_map(|g| (0..g.triangles.len()).step_by(chunk_size).map(move |start| (g, start)))
        .collect();
    let chunks = ranges
        .into_par_iter()
        .map(|(g, start)| Chunk::new(g, start, (start + chunk_size).min(g.triangles.len()), viewport))
        .collect();
    Bins { chunks }
}

impl Chunk {
    fn new(geometry: &Geometry<'_>, start: usize, end: usize, viewport: &Viewport) -> Self {
        let setup = Setup::new(viewport, geometry.faces);
        let mut triangles = Vec::with_capacity(end - start);
        for (i, triangle) in geometry.triangles[start..end].iter().enumerate() {
            let corners = triangle.map(|v| geometry.clip[v as usize].map(f64::from));
            setup.push(corners, geometry.first_id + (start + i) as u32, &mut triangles);
        }
        let (starts, members) = sort_into_tiles(&triangles, viewport);
        Self { triangles, starts, members }
    }
}

/// What turning clip space into screen triangles needs.
struct Setup<'a> {
    viewport: &'a Viewport,
    volume: ClipVolume,
    faces: Faces,
}

impl<'a> Setup<'a> {
    fn new(viewport: &'a Viewport, faces: Faces) -> Self {
        let guard = |side: u32| 1.0 + 2.0 * GUARD / f64::from(side);
        let volume = ClipVolume { guard_x: guard(viewport.width), guard_y: guard(viewport.height) };
        Self { viewport, volume, faces }
    }

    fn push(&self, corners: [ClipVertex; 3], id: u32, out: &mut Vec<ScreenTriangle>) {
        let codes = corners.map(|v| self.volume.outcode(v));
        if codes[0] & codes[1] & codes[2] != 0 {
            return;
        }
        let planes = codes[0] | codes[1] | codes[2];
        if planes == 0 {
            out.extend(self.screen_triangle(corners, id));
            return;
        }
        let polygon = self.volume.clip(corners, planes);
        if let [first, rest @ ..] = polygon.corners() {
            for pair in rest.windows(2) {
                out.extend(self.screen_triangle([*first, pair[0], pair[1]], id));
            }
        }
    }

    fn screen_triangle(&self, corners: [ClipVertex; 3], id: u32) -> Option<ScreenTriangle> {
        let [width, height] = [self.viewport.width, self.viewport.height].map(f64::from);
        let subpixels = f64::from(SUBPIXELS);
        let snap = |v: f64| (v * subpixels + 0.5).floor() as i32;
        let mut x = corners.map(|[x, _, _, w]| snap((x / w + 1.0) * 0.5 * width));
        let mut y = corners.map(|[_, y, _, w]| snap((1.0 - y / w) * 0.5 * height));
        let mut depth = corners.map(|[_, _, z, w]| (z / w) as f32);
        let area = cross(x, y);
        let drawn = match self.faces {
            Faces::CounterClockwise => area < 0,
            Faces::Clockwise => area > 0,
            Faces::Both => area != 0,
        };
        if !drawn {
            return None;
        }
        if area < 0 {
            x.swap(1, 2);
            y.swap(1, 2);
            depth.swap(1, 2);
        }
        let triangle = ScreenTriangle { x, y, depth, id };
        self.may_cover(&triangle).then_some(triangle)
    }

    /// Whether the triangle's box holds a sample of the picture.
    fn may_cover(&self, triangle: &ScreenTriangle) -> bool {
        let [left, top, right, bottom] = triangle.bounds();
        if right < 0 || bottom < 0 {
            return false;
        }
        if left >= self.viewport.width as i32 * SUBPIXELS || top >= self.viewport.height as i32 * SUBPIXELS {
            return false;
        }
        self.viewport.pattern.offsets().iter().any(|[sx, sy]| {
            let holds = |low: i32, high: i32, offset: i32| {
                (low - offset + SUBPIXELS - 1).div_euclid(SUBPIXELS) <= (high - offset).div_euclid(SUBPIXELS)
            };
            holds(left, right, *sx) && holds(top, bottom, *sy)
        })
    }
}

impl ScreenTriangle {
    /// Left, top, right and bottom in 1/256 pixel.
    pub(super) fn bounds(&self) -> [i32; 4] {
        let low = |v: [i32; 3]| v[0].min(v[1]).min(v[2]);
        let high = |v: [i32; 3]| v[0].max(v[1]).max(v[2]);
        [low(self.x), low(self.y), high(self.x), high(self.y)]
    }
}

/// Twice the signed area, positive clockwise with y down.
fn cross(x: [i32; 3], y: [i32; 3]) -> i64 {
    let [x, y] = [x.map(i64::from), y.map(i64::from)];
    (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
}

/// Counts, then places: for each tile the triangles whose box touches it, in order.
fn sort_into_tiles(triangles: &[ScreenTriangle], viewport: &Viewport) -> (Vec<u32>, Vec<u32>) {
    let (across, down) = viewport.tiles();
    let mut starts = vec![0u32; (across * down) as usize + 1];
    for triangle in triangles {
        for_each_tile(triangle, viewport, |tile| starts[tile + 1] += 1);
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut members = vec![0; *starts.last().unwrap_or(&0) as usize];
    for (i, triangle) in triangles.iter().enumerate() {
        for_each_tile(triangle, viewport, |tile| {
            members[next[tile] as usize] = i as u32;
            next[tile] += 1;
        });
    }
    (starts, members)
}

fn for_each_tile(triangle: &ScreenTriangle, viewport: &Viewport, mut visit: impl FnMut(usize)) {
    let (across, down) = viewport.tiles();
    let side = TILE_SIZE as i32 * SUBPIXELS;
    let [left, top, right, bottom] = triangle.bounds();
    let clamp = |v: i32, tiles: u32| v.div_euclid(side).clamp(0, tiles as i32 - 1) as usize;
    for row in clamp(top, down)..=clamp(bottom, down) {
        for column in clamp(left, across)..=clamp(right, across) {
            visit(row * across as usize + column);
        }
    }
}
