//! The texels of a material's maps: the point of the model that each shows.

use super::frame::Frame;
use super::model::{Model, Texel};
use super::sight::Sight;
use crate::grid::Grid;
use crate::indirect::quantile;
use taotie_engine::bake::{Coverage, LookupPoint, TexelGrid, leading_texture};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData, Point};
use taotie_engine::parallel;
use taotie_engine::scene::TextureRef;
use taotie_io::{Limits, read_bitmap_within};

/// The texels of a material.
pub struct Layout {
    /// The index of the material.
    pub material: usize,
    /// Texels along a side.
    pub side: u32,
    /// Covered texels, row by row.
    pub texels: Vec<Texel>,
    /// The texture reference by which the model reads these maps, except for its texture.
    pub used: Option<TextureRef>,
}

impl Layout {
    /// Lays out a material on a square map.
    ///
    /// # Errors
    /// Those of [`Coverage::new`]; [`Error::Invalid`] if no triangle covers a texel.
    pub fn new(model: &Model, material: usize, side: u32, warnings: &mut Warnings) -> Result<Self> {
        let all = model.surface.mesh();
        let own = |t: &u32| model.surface.material_number(*t) == material;
        let triangles: Vec<u32> = (0..all.triangles().len() as u32).filter(own).collect();
        let places = model.surface.map_places();
        let mesh = Mesh::new(MeshData {
            positions: all.positions().to_vec(),
            uvs: vec![places.to_vec()],
            triangles: triangles.iter().map(|t| all.triangles()[*t as usize]).collect(),
            ..MeshData::default()
        })?;
        let grid = TexelGrid { width: side, height: side, uv_set: 0, padding: 0 };
        let coverage = Coverage::new(&mesh, &grid)?;
        let name = || match model.material(material).name.as_str() {
            "" => format!("material {material}"),
            name => format!("material '{name}'"),
        };
        if coverage.covered() == 0 {
            let why = "its texture coordinates span no area, so that no map can be laid out; unwrap it first";
            return Err(Error::invalid(name(), why));
        }
        warnings.note(
            "a triangle has texture coordinates without area: its material cannot be measured",
            coverage.skipped(),
        );
        warnings.note(
            "a texel belongs to several triangles: only the first of them is measured",
            coverage.shared(),
        );
        let rows = parallel::tasks(side as usize, &|y| {
            let texels = (0..side).filter_map(|x| {
                let triangle = coverage.triangle(x, y as u32)?;
                let at = UvTriangle::new(&mesh, &places, triangle).point([x, y as u32], side)?;
                Some(texel(
                    model,
                    Point { triangle: triangles[triangle as usize], ..at.point },
                    at.width,
                    y as u32 * side + x,
                ))
            });
            texels.collect::<Vec<Texel>>()
        });
        let texels = with_bends(rows.concat(), side as usize);
        let used = leading_texture(model.material(material), all.uvs().len());
        Ok(Self { material, side, texels, used })
    }
}

/// Computes the bends of texels, row by row.
fn with_bends(mut texels: Vec<Texel>, side: usize) -> Vec<Texel> {
    /// The greatest bend: beyond, texels are on different parts of the surface.
    const EDGE: f64 = 0.5;
    let grid = Grid::new(side, side, texels.iter().map(|texel| texel.index).collect());
    let bends: Vec<f64> = parallel::collect(texels.len(), |i| {
        let around = grid.neighbours(i).map(|j| (texels[j].normal - texels[i].normal).length());
        let (sum, count) = around
            .filter(|bend| *bend < EDGE)
            .fold((0.0, 0.0), |(sum, n), bend| (sum + bend * bend, n + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    });
    texels.iter_mut().zip(bends).for_each(|(texel, bend)| texel.bend = bend);
    texels
}

fn texel(model: &Model, point: Point, width: f64, index: u32) -> Texel {
    let smooth = model.smooth(point);
    let at = LookupPoint { point, width: width as f32 };
    let mapped = model.surface.normal(at, smooth.to_f32());
    let sample = model.surface.sample(at);
    Texel {
        index,
        triangle: point.triangle,
        position: model.position(point),
        facet: model.facet(point.triangle),
        smooth,
        normal: mapped.normal.to_f64().normalize_or(smooth),
        variance: f64::from(mapped.variance),
        bend: 0.0,
        width,
        metallic: f64::from(sample.metallic),
        alpha: f64::from(sample.alpha),
    }
}

/// The least and the greatest number of texels along a side that is chosen.
const SIDES: [f64; 2] = [64.0, 4096.0];

/// Returns the power of two of texels along a side with which texels are about as large as the pixels of photographs, all of
/// which have the size of the first.
///
/// # Errors
/// Those of reading the first photograph and of [`Layout::new`].
pub fn fitting_side(model: &Model, frames: &[Frame], limits: &Limits) -> Result<u32> {
    const TRIAL: u32 = 64;
    const STEP: usize = 17;
    let first = read_bitmap_within(&frames[0].path, limits)?;
    let size = [first.width(), first.height()];
    let mut most = SIDES[0];
    for material in model.materials() {
        let layout = Layout::new(model, material, TRIAL, &mut Warnings::default())?;
        let ratios = frames.iter().flat_map(|frame| {
            let sight = Sight::new(model, frame, size);
            layout
                .texels
                .iter()
                .step_by(STEP)
                .filter_map(move |texel| Some(texel.width / sight.facing(texel)?.pixel))
        });
        let ratios: Vec<f64> = ratios.collect();
        if !ratios.is_empty() {
            most = (f64::from(TRIAL) * quantile(ratios, 0.5)).max(most);
        }
    }
    let power = (scalar::log2(most.min(SIDES[1])) + 0.5).floor();
    Ok(scalar::exp2(power) as u32)
}

/// A triangle on the map.
struct UvTriangle {
    triangle: u32,
    corners: [Vec2<f64>; 3],
    /// Area on the surface over that on the map.
    stretch: f64,
}

/// A texel's centre on a triangle.
struct Place {
    point: Point,
    width: f64,
}

impl UvTriangle {
    fn new(mesh: &Mesh, places: &[Vec2], triangle: u32) -> Self {
        let vertices = mesh.triangles()[triangle as usize].map(|v| v as usize);
        let corners = vertices.map(|v| Vec2::new(f64::from(places[v].x), f64::from(places[v].y)));
        let [a, b, c] = mesh.corners(triangle as usize).map(Vec3::to_f64);
        let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).abs();
        Self { triangle, corners, stretch: (b - a).cross(c - a).length() / area.max(f64::MIN_POSITIVE) }
    }

    /// Returns the centre of a texel, on the copy of the map where the triangle covers it; `None` if it has no area.
    fn point(&self, [x, y]: [u32; 2], side: u32) -> Option<Place> {
        let centre = [x, y].map(|v| (f64::from(v) + 0.5) / f64::from(side));
        let low =
            |of: fn(&Vec2<f64>) -> f64| self.corners.iter().map(of).fold(f64::INFINITY, f64::min).floor();
        let high =
            |of: fn(&Vec2<f64>) -> f64| self.corners.iter().map(of).fold(f64::NEG_INFINITY, f64::max).floor();
        let columns = low(|c| c.x) as i64..=high(|c| c.x) as i64;
        let rows = low(|c| c.y) as i64..=high(|c| c.y) as i64;
        let copies = rows.flat_map(|row| columns.clone().map(move |column| [column as f64, row as f64]));
        let weights = copies.map(|copy| self.weights(Vec2::new(centre[0] + copy[0], centre[1] + copy[1])));
        let least = |weights: &[f64; 3]| weights.iter().fold(f64::INFINITY, |least, v| v.min(least));
        let best = weights.reduce(|a, b| if least(&b) > least(&a) { b } else { a })?;
        // Centres on an edge may be outside by rounding.
        let sum: f64 = best.iter().map(|v| v.max(0.0)).sum();
        let weights = best.map(|v| (v.max(0.0) / sum) as f32);
        let width = self.stretch.sqrt() / f64::from(side);
        let is_finite = weights.iter().all(|v| v.is_finite()) && width.is_finite() && width > 0.0;
        is_finite.then_some(Place { point: Point { triangle: self.triangle, weights }, width })
    }

    fn weights(&self, p: Vec2<f64>) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let area = (b - a).cross(c - a);
        let (v, w) = ((p - a).cross(c - a) / area, (b - a).cross(p - a) / area);
        [1.0 - v - w, v, w]
    }
}
