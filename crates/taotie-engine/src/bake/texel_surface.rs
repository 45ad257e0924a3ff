//! The surface of a mesh at a position of its map: at each texel, and, for pairs of meshes that share uvs, at any uv.

use super::coverage::{Coverage, TexelGrid, uv_set};
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, Point, blend};
use crate::parallel;
use crate::scene::Scene;
use crate::trace::{Bvh, Ray};
use std::cell::Cell;
use std::fmt;

/// A point of a mesh as the renderer sees it: interpolated between vertices, in object space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Model units.
    pub position: Vec3<f64>,
    /// Interpolated from unit normals, not normalised.
    pub normal: Vec3<f64>,
    /// Interpolated from unit tangents, not normalised.
    pub tangent: Vec3<f64>,
    /// ±1: the bitangent is this times cross(normal, tangent).
    pub handedness: f64,
    /// The derivatives of the position by u and v over the flat triangle, in model units.
    pub position_by_uv: [Vec3<f64>; 2],
    /// The derivatives of the interpolated normal by u and v.
    pub normal_by_uv: [Vec3<f64>; 2],
}

/// A mesh with tangents, laid out on a map.
#[derive(Debug, Clone)]
pub struct TexelSurface {
    mesh: Mesh,
    uv_set: usize,
    coverage: Coverage,
}

/// Padding extends no farther from its triangle than the triangle is large: its weights stay above this.
const LEAST_WEIGHT: f64 = -1.0;

impl TexelSurface {
    /// Lays out a mesh that has normals and tangents, such as [`crate::surface::with_tangents`] makes. Those that are
    /// not unit are normalised, as the renderer does.
    ///
    /// # Errors
    /// As [`Coverage::new`], and [`Error::Invalid`] if normals or tangents are missing.
    pub fn new(mesh: Mesh, grid: &TexelGrid) -> Result<Self> {
        if mesh.normals().is_empty() || mesh.tangents().is_empty() {
            return Err(Error::invalid(
                "the mesh for a map",
                "it has no normals or no tangents; compute them first",
            ));
        }
        let mesh = with_unit_frames(mesh)?;
        Ok(Self { coverage: Coverage::new(&mesh, grid)?, mesh, uv_set: grid.uv_set })
    }

    /// Returns the triangle of each texel.
    pub fn coverage(&self) -> &Coverage {
        &self.coverage
    }

    /// Returns the mesh, with unit normals and tangents.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the surface at the centre of a texel; in padding, the triangle is extrapolated. `None` away from all
    /// UV islands.
    pub fn point(&self, x: u32, y: u32) -> Option<SurfacePoint> {
        Some(UvTriangle::new(self, self.coverage.triangle(x, y)?).at(&self.coverage, x, y))
    }

    /// Makes a map texel by texel, row by row from the top; `fill` is the value away from all UV islands.
    pub fn map<T: Copy + Send + Sync>(
        &self,
        fill: T,
        texel: impl Fn(u32, u32, &SurfacePoint) -> T + Sync,
    ) -> Vec<T> {
        let (width, height) = (self.coverage.width(), self.coverage.height());
        let mut texels = vec![fill; width as usize * height as usize];
        parallel::pieces(&mut texels, width as usize, &|y, row| {
            let mut uv_triangle: Option<UvTriangle> = None;
            for (x, value) in row.iter_mut().enumerate() {
                let (x, y) = (x as u32, y as u32);
                let Some(triangle) = self.coverage.triangle(x, y) else { continue };
                let uv_triangle = match &mut uv_triangle {
                    Some(uv_triangle) if uv_triangle.triangle == triangle => uv_triangle,
                    other => other.insert(UvTriangle::new(self, triangle)),
                };
                *value = texel(x, y, &uv_triangle.at(&self.coverage, x, y));
            }
        });
        texels
    }
}

/// Returns the mesh with unit normals and tangents; those already unit to single precision stay bit-identical.
fn with_unit_frames(mesh: Mesh) -> Result<Mesh> {
    const ROUNDING: f32 = 1e-5;
    let unit = |v: Vec3, fallback: Vec3| match (v.dot(v) - 1.0).abs() < ROUNDING {
        true => v,
        false => v.normalize_or(fallback),
    };
    let mut data = mesh.into_data();
    for normal in &mut data.normals {
        *normal = unit(*normal, Vec3::new(0.0, 0.0, 1.0));
    }
    for [x, y, z, _] in &mut data.tangents {
        [*x, *y, *z] = unit(Vec3::new(*x, *y, *z), Vec3::new(0.0, 0.0, 1.0)).to_array();
    }
    Mesh::new(data)
}

/// A quantity linear in uv over a triangle: its value at uv (0, 0) and its derivatives by u and v.
#[derive(Debug, Clone, Copy)]
struct Linear {
    origin: Vec3<f64>,
    by_uv: [Vec3<f64>; 2],
}

impl Linear {
    fn new(values: [Vec3<f64>; 3], [a, b, c]: [Vec2<f64>; 3]) -> Self {
        let (e, f) = (b - a, c - a);
        let det = e.cross(f);
        let (p, q) = (values[1] - values[0], values[2] - values[0]);
        let by_u = (p * f.y - q * e.y) / det;
        let by_v = (q * e.x - p * f.x) / det;
        Self { origin: values[0] - by_u * a.x - by_v * a.y, by_uv: [by_u, by_v] }
    }

    fn at(&self, uv: Vec2<f64>) -> Vec3<f64> {
        self.origin + self.by_uv[0] * uv.x + self.by_uv[1] * uv.y
    }
}

/// A triangle in uv space.
struct UvTriangle {
    triangle: u32,
    corners: [Vec2<f64>; 3],
    position: Linear,
    normal: Linear,
    tangent: Linear,
    handedness: f64,
}

impl UvTriangle {
    fn new(surface: &TexelSurface, triangle: u32) -> Self {
        let mesh = &surface.mesh;
        let vertices = mesh.triangles()[triangle as usize].map(|v| v as usize);
        let uvs = uv_set(mesh, surface.uv_set).expect("the uv set existed when the mesh was laid out");
        let corners = vertices.map(|v| Vec2::new(f64::from(uvs[v].x), f64::from(uvs[v].y)));
        let tangent = |v: usize| {
            let [x, y, z, _] = mesh.tangents()[v];
            Vec3::new(x, y, z).to_f64()
        };
        Self {
            triangle,
            corners,
            position: Linear::new(vertices.map(|v| mesh.positions()[v].to_f64()), corners),
            normal: Linear::new(vertices.map(|v| mesh.normals()[v].to_f64()), corners),
            tangent: Linear::new(vertices.map(tangent), corners),
            handedness: f64::from(mesh.tangents()[vertices[0]][3]),
        }
    }

    fn at(&self, coverage: &Coverage, x: u32, y: u32) -> SurfacePoint {
        let centre = Vec2::new(
            (f64::from(x) + 0.5) / f64::from(coverage.width()),
            (f64::from(y) + 0.5) / f64::from(coverage.height()),
        );
        let uv = self.unwrapped(centre, u8::from(!coverage.is_covered(x, y)));
        SurfacePoint {
            position: self.position.at(uv),
            normal: self.normal.at(uv),
            tangent: self.tangent.at(uv),
            handedness: self.handedness,
            position_by_uv: self.position.by_uv,
            normal_by_uv: self.normal.by_uv,
        }
    }

    /// Returns the copy of a uv in [0, 1] that is inside the triangle, or nearest to it and not too far away;
    /// `beyond` is 1 if copies beyond those that the triangle touches must be searched.
    fn unwrapped(&self, uv: Vec2<f64>, beyond: u8) -> Vec2<f64> {
        let copies = |of: fn(&Vec2<f64>) -> f64| {
            let (low, high) =
                self.corners.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            low.floor() as i64 - i64::from(beyond)..=high.floor() as i64 + i64::from(beyond)
        };
        let (columns, rows) = (copies(|c| c.x), copies(|c| c.y));
        let all = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
        let copy = |(column, row): (i64, i64)| Vec2::new(uv.x + column as f64, uv.y + row as f64);
        let nearest =
            all.map(copy).map(|uv| (self.least_weight(uv), uv)).reduce(|a, b| if b.0 > a.0 { b } else { a });
        match nearest {
            Some((weight, uv)) if weight < LEAST_WEIGHT => self.drawn_in(uv, weight),
            Some((_, uv)) => uv,
            None => uv,
        }
    }

    /// Returns the minimum barycentric weight of a uv: below 0 outside.
    fn least_weight(&self, p: Vec2<f64>) -> f64 {
        let [a, b, c] = self.corners;
        let area = (b - a).cross(c - a);
        let (v, w) = ((p - a).cross(c - a) / area, (b - a).cross(p - a) / area);
        v.min(w).min(1.0 - v - w)
    }

    /// Returns the uv moved towards the middle of the triangle until its minimum weight is [`LEAST_WEIGHT`]: the
    /// weights change linearly, from 1/3 each at the middle.
    fn drawn_in(&self, uv: Vec2<f64>, least: f64) -> Vec2<f64> {
        let [a, b, c] = self.corners;
        let middle = (a + b + c) * (1.0 / 3.0);
        let third = 1.0 / 3.0;
        middle + (uv - middle) * ((third - LEAST_WEIGHT) / (third - least))
    }
}

/// The triangles of a mesh by their first uvs, which repeat beyond the map.
pub struct UvIndex {
    /// Each triangle with uv area at (u, v, 0), moved so that its middle is on the map.
    bvh: Bvh,
    /// Their numbers in the mesh.
    numbers: Vec<u32>,
    /// The positions of their corners.
    corners: Vec<[Vec3; 3]>,
}

impl fmt::Debug for UvIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "UvIndex of {} triangles", self.corners.len())
    }
}

impl UvIndex {
    /// Indexes all triangles.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no uvs, or none of its triangles has uv area.
    pub fn of(mesh: &Mesh) -> Result<Self> {
        let wrong =
            |why: &str| Error::invalid("the scan", format!("{why}; give it those of the low-poly mesh"));
        let Some(uvs) = mesh.uvs().first() else { return Err(wrong("it has no uvs to match")) };
        let placed = |t: usize| -> Option<[Vec3; 3]> {
            let [a, b, c] = mesh.triangles()[t].map(|v| uvs[v as usize]);
            let has_area = (b - a).cross(c - a) != 0.0;
            let middle = (a + b + c) * (1.0 / 3.0);
            let tile = Vec2::new(middle.x.floor(), middle.y.floor());
            let at = |uv: Vec2| Vec3::new(uv.x - tile.x, uv.y - tile.y, 0.0);
            has_area.then(|| [a, b, c].map(at))
        };
        let (numbers, places): (Vec<u32>, Vec<[Vec3; 3]>) =
            (0..mesh.triangles().len()).filter_map(|t| Some((t as u32, placed(t)?))).unzip();
        if numbers.is_empty() {
            return Err(wrong("none of its uvs has area"));
        }
        let corners = numbers.iter().map(|t| mesh.corners(*t as usize)).collect();
        Ok(Self { bvh: Bvh::of(places.len(), |t| places[t]), numbers, corners })
    }

    /// Returns the point at this uv; if triangles overlap, the closest to a position. Away from all triangles, it is the point
    /// of the nearest one, at most 0.005 away.
    pub fn closest(&self, uv: Vec2, position: Vec3) -> Option<Point> {
        const NEAR: f32 = 0.005;
        let uv = Vec2::new(uv.x - uv.x.floor(), uv.y - uv.y.floor());
        // Triangles on the border of the map reach beyond it.
        let copies = [0.0, 1.0, -1.0].map(|y| [0.0, 1.0, -1.0].map(|x| Vec2::new(uv.x + x, uv.y + y)));
        let copies = || copies.as_flattened().iter();
        let hits = copies().filter_map(|uv| self.closest_hit(*uv, position));
        let best = hits.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, point)| point);
        let nearest = || {
            let places = copies().filter_map(|uv| self.bvh.closest(Vec3::new(uv.x, uv.y, 0.0), NEAR));
            places.reduce(|a, b| if b.distance < a.distance { b } else { a }).map(|place| place.point())
        };
        let Point { triangle, weights } = best.or_else(nearest)?;
        Some(Point { triangle: self.numbers[triangle as usize], weights })
    }

    /// Returns the hit at a uv that is closest to a position, and its distance.
    fn closest_hit(&self, uv: Vec2, position: Vec3) -> Option<(f32, Point)> {
        let line = Ray::new(Vec3::new(uv.x, uv.y, -1.0), Vec3::new(0.0, 0.0, 1.0));
        let closest = Cell::new(None::<(f32, Point)>);
        // All hits are visited, since none is accepted.
        self.bvh.nearest_of(&line, f32::INFINITY, |hit| {
            let point = hit.point();
            let away = (blend(self.corners[point.triangle as usize], point.weights) - position).length();
            if closest.get().is_none_or(|(least, _)| away < least) {
                closest.set(Some((away, point)));
            }
            false
        });
        closest.get()
    }
}

/// The first uv set of a scene as a flat mesh whose points map to a position and normal.
pub struct UvLookup {
    /// Each triangle at (u, v, 0).
    bvh: Bvh,
    surface: TexturedMesh,
}

impl UvLookup {
    /// Indexes all triangles of `scene` by their first uvs. Meshes without uvs are skipped.
    ///
    /// # Errors
    /// [`Error::Limit`] if the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: &Scene) -> Result<Self> {
        let mut scene = scene.clone().into_data();
        scene.instances.retain(|instance| !scene.meshes[instance.mesh].uvs().is_empty());
        let surface = TexturedMesh::new(Scene::new(scene)?)?;
        let mesh = surface.mesh();
        let place = |v: u32| Vec3::new(mesh.uvs()[0][v as usize].x, mesh.uvs()[0][v as usize].y, 0.0);
        let bvh = Bvh::of(mesh.triangles().len(), |t| mesh.triangles()[t].map(place));
        Ok(Self { bvh, surface })
    }

    /// Returns the position and the unit normal (world space) at this uv, with normal and height maps read at their
    /// finest level; if triangles overlap, of the first. `None` if there is none.
    pub fn at(&self, uv: Vec2) -> Option<(Vec3, Vec3)> {
        let ray = Ray::new(Vec3::new(uv.x, uv.y, -1.0), Vec3::new(0.0, 0.0, 1.0));
        let point = self.bvh.nearest(&ray, f32::INFINITY)?.point();
        let mesh = self.surface.mesh();
        let normal = self.surface.normal(LookupPoint::finest(point), point.normal(mesh)).normal;
        Some((point.position(mesh), normal))
    }
}
