//! Generates uvs for a mesh: UV islands that face one way, flattened and packed into one square.

mod island;
mod layout;
mod merge;
mod pack;
mod regions;

use super::coverage::Rasterizer;
use super::simplify::{UnitCube, chosen};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, MeshData};
use crate::parallel;
use crate::progress::Progress;
use island::{Island, Measure, flatten};
pub use layout::UnwrapOptions;
use layout::{Layout, Start, lay_out};
use merge::{Limits, Merger, shorten_borders};
use regions::{NONE, Topology, regions};
use std::collections::{BTreeMap, HashMap};

/// The maximum angles between the triangles of a UV island and its axis: 62° for the smooth surface, 80° for single
/// triangles.
const WIDE: Limits = Limits { smooth: 0.47, own: 0.17, small: f64::INFINITY };
/// The same if one side is a crumb.
const CRUMBS: Limits = Limits { smooth: 0.26, own: 0.12, small: f64::INFINITY };
/// A crumb is smaller than this fraction of the surface.
const CRUMB: f64 = 1.0 / 400.0;
/// A first estimate of the fraction of the square that UV islands cover.
const COVER: f64 = 0.7;
/// Texels along a side per texel of the map, used to search UV islands for overlaps.
const FINER: f64 = 2.0;
/// The maximum number of layouts: overlaps of less than a texel show up only there.
const ROUNDS: u32 = 8;
/// No UV island is longer than this fraction of the map: a blade in one piece would leave the rest of it empty.
const LONGEST: f64 = 0.95;

/// A mesh with uvs.
#[derive(Debug, Clone)]
pub struct Unwrapped {
    /// The triangles of the input in their order; vertices are split where UV islands meet. Uv set 0 is the new one,
    /// the only one, in [0, 1], origin top left; tangents are dropped, everything else is bit-identical.
    pub mesh: Mesh,
    /// The number of UV islands.
    pub islands: usize,
    /// The UV island of each triangle; `None` for triangles without area, whose uvs are 0.
    pub island_of: Vec<Option<u32>>,
    /// The fraction of the map that triangles cover, 0 to 1.
    pub utilisation: f64,
    /// Texels of the map per model unit, on average.
    pub texels_per_unit: f64,
}

/// Unwraps any mesh: it need not be closed, connected or manifold.
///
/// UV islands are unions of triangles that face within about 60° of a common axis and are projected along it, so
/// areas are preserved within a factor of 2 except for single steep triangles. No island overlaps itself or another
/// one on the map of this size. The result depends neither on the order of vertices nor on the number of threads.
///
/// # Errors
/// [`Error::Cancelled`]; [`Error::Invalid`] if the map is empty or all padding, or no triangle has an area;
/// [`Error::Limit`] if it is larger than [`Image::MAX_SIDE`] or the padding of the mesh's UV islands fills it.
pub fn unwrap(mesh: &Mesh, options: &UnwrapOptions, progress: Progress<'_>) -> Result<Unwrapped> {
    check(options)?;
    let topology = Topology::new(mesh);
    let surface: f64 = topology.areas.iter().sum();
    if !(0..topology.len()).any(|t| topology.is_flat_enough(t)) {
        return Err(Error::invalid("the mesh to unwrap", "no triangle has an area; check the file"));
    }
    progress.at(0.1)?;
    let flat = Flat { mesh, topology: &topology, size: f64::from(options.size) };
    let (labels, axes) = joined_regions(&topology, surface, progress)?;
    let scale = (COVER / surface).sqrt();
    let measure = Measure { density: FINER * f64::from(options.size) * scale, longest: LONGEST / scale };
    let mut islands = flat_islands(&topology, &labels, &axes, &measure);
    progress.at(0.5)?;
    let mut start = Start::Guess(scale * f64::from(options.size));
    for round in 0..ROUNDS {
        let laid: Vec<Vec<[[f64; 2]; 3]>> = parallel::tasks(islands.len(), &|i| islands[i].laid(&topology));
        let attempt = progress.part(1.0 - 0.5 / f64::from(round + 1), 1.0);
        let layout = lay_out(&laid, options, start, attempt)?;
        let unwrapped = flat.cut(&islands, &layout)?;
        let overlaps = overlaps(&unwrapped, options.size)?;
        if overlaps.is_empty() {
            progress.at(1.0)?;
            return Ok(unwrapped);
        }
        start = Start::Near(layout.scale);
        islands = without_overlaps(&topology, islands, &overlaps, &measure);
    }
    Err(Error::limit(
        "a mesh whose UV islands overlap however they are cut",
        "use a larger map, or simplify the mesh",
    ))
}

/// Number of map rows searched for overlaps at a time.
const SEARCHED_ROWS: usize = 256;

/// For each UV island, its first triangle that overlaps another of its triangles, preceded by that one.
type Overlaps = BTreeMap<u32, [u32; 2]>;

/// Returns the overlap of each UV island that has one.
fn overlaps(unwrapped: &Unwrapped, size: u32) -> Result<Overlaps> {
    let mesh = &unwrapped.mesh;
    let rasterizer = Rasterizer::new(mesh.triangles(), &mesh.uvs()[0], [size; 2])?;
    let size = size as usize;
    let bands = parallel::tasks(size.div_ceil(SEARCHED_ROWS), &|band| {
        let first = band * SEARCHED_ROWS;
        overlaps_in(unwrapped, &rasterizer, [first, (first + SEARCHED_ROWS).min(size)], size)
    });
    let mut found = Overlaps::new();
    for (island, pair) in bands.into_iter().flatten() {
        let first = found.entry(island).or_insert(pair);
        if pair[1] < first[1] {
            *first = pair;
        }
    }
    Ok(found)
}

/// Returns the overlaps in some rows of a map with `size` columns.
fn overlaps_in(
    unwrapped: &Unwrapped,
    rasterizer: &Rasterizer<'_>,
    [first, end]: [usize; 2],
    size: usize,
) -> Overlaps {
    let mut owners = vec![NONE; (end - first) * size];
    let mut found = Overlaps::new();
    for (t, island) in unwrapped.island_of.iter().enumerate() {
        let Some(island) = *island else { continue };
        // Uvs are within the map, but corners may be rounded onto its far border.
        rasterizer.spans(t, first as i64..end as i64, |y, [from, to]| {
            let row = &mut owners[(y as usize - first) * size..][..size];
            for x in from..=to {
                let owner = &mut row[x as usize % size];
                match *owner {
                    NONE => *owner = t as u32,
                    owner if unwrapped.island_of[owner as usize] == Some(island) => {
                        found.entry(island).or_insert([owner, t as u32]);
                    }
                    _ => {}
                }
            }
        });
    }
    found
}

fn without_overlaps(
    topology: &Topology,
    islands: Vec<Island>,
    overlaps: &Overlaps,
    measure: &Measure,
) -> Vec<Island> {
    let parts = |(island, number): (Island, u32)| match overlaps.get(&number) {
        Some(pair) => island.cut(topology, *pair, measure),
        None => vec![island],
    };
    islands.into_iter().zip(0..).flat_map(parts).collect()
}

fn check(options: &UnwrapOptions) -> Result<()> {
    Image::check_size(options.size, options.size)?;
    if options.size <= options.padding.saturating_mul(2) {
        return Err(Error::invalid(
            format!("a padding of {} texels on a map of {}", options.padding, options.size),
            "no room is left between the borders; use a larger map or less padding",
        ));
    }
    Ok(())
}

/// Returns the UV island of each triangle and the axis of each UV island.
fn joined_regions(
    topology: &Topology,
    surface: f64,
    progress: Progress<'_>,
) -> Result<(Vec<u32>, Vec<Vec3<f64>>)> {
    let (labels, count) = regions(topology);
    progress.at(0.3)?;
    let mut merger = Merger::new(topology, &labels, count);
    merger.join(&WIDE);
    merger.join(&Limits { small: CRUMB * surface, ..CRUMBS });
    let (mut labels, axes) = merger.islands(&labels);
    shorten_borders(topology, &mut labels, &axes, &WIDE);
    Ok((labels, axes))
}

fn flat_islands(topology: &Topology, labels: &[u32], axes: &[Vec3<f64>], measure: &Measure) -> Vec<Island> {
    let mut members = vec![Vec::new(); axes.len()];
    for (t, label) in labels.iter().enumerate().filter(|(_, label)| **label != NONE) {
        members[*label as usize].push(t as u32);
    }
    let islands: Vec<Vec<Island>> = parallel::tasks(axes.len(), &|i| match members[i].is_empty() {
        true => Vec::new(),
        false => flatten(topology, members[i].clone(), axes[i], measure),
    });
    islands.into_iter().flatten().collect()
}

/// A mesh to flatten onto a map.
struct Flat<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// Texels along a side of the map.
    size: f64,
}

impl Flat<'_> {
    /// Returns the mesh with its vertices split between UV islands.
    fn cut(&self, islands: &[Island], layout: &Layout) -> Result<Unwrapped> {
        let mut island_of = vec![None; self.topology.len()];
        for (island, number) in islands.iter().zip(0u32..) {
            island.triangles.iter().for_each(|t| island_of[*t as usize] = Some(number));
        }
        let mut split = Split::default();
        let mut covered = 0.0;
        for (t, island) in island_of.iter().enumerate() {
            let places = match island {
                Some(island) => self.topology.corners[t]
                    .map(|p| layout.place(*island, islands[*island as usize].place(p))),
                None => [[0.0; 2]; 3],
            };
            covered += area(places);
            let uvs = places.map(|p| p.map(|v| (v / self.size) as f32));
            split.add(self.mesh.triangles()[t], island.unwrap_or(NONE), uvs);
        }
        let extent = UnitCube::of(self.mesh.positions()).extent;
        Ok(Unwrapped {
            mesh: split.mesh(self.mesh)?,
            islands: islands.len(),
            island_of,
            utilisation: covered / (self.size * self.size),
            texels_per_unit: layout.scale / extent,
        })
    }
}

fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() * 0.5
}

/// Vertices during splitting.
#[derive(Default)]
struct Split {
    numbers: HashMap<(u32, u32), u32>,
    sources: Vec<u32>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
}

impl Split {
    fn add(&mut self, triangle: [u32; 3], island: u32, uvs: [[f32; 2]; 3]) {
        let mut corner = |k: usize| {
            *self.numbers.entry((triangle[k], island)).or_insert_with(|| {
                self.sources.push(triangle[k]);
                self.uvs.push(Vec2::new(uvs[k][0], uvs[k][1]));
                self.sources.len() as u32 - 1
            })
        };
        self.triangles.push([corner(0), corner(1), corner(2)]);
    }

    fn mesh(self, mesh: &Mesh) -> Result<Mesh> {
        Mesh::new(MeshData {
            positions: chosen(mesh.positions(), &self.sources),
            normals: chosen(mesh.normals(), &self.sources),
            colors: chosen(mesh.colors(), &self.sources),
            uvs: vec![self.uvs],
            triangles: self.triangles,
            tangents: Vec::new(),
        })
    }
}
