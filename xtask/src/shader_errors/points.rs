//! Random surface points, as pictures that shaders read: one texel of each picture per pixel.
//!
//! Shaders compute derivatives within squares of two by two pixels. The four points of a square therefore lie in one
//! plane, like those of a triangle. Their coordinates are multiples of 2⁻¹⁶: sums and differences are exact in 32
//! bits, so all implementations use the same derivatives.

use super::cases::NORMAL_MATRIX;
use super::lighting::Lighting;
use super::random::Random;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::pixel::Place;
use taotie_engine::scene::TextureRole;

/// Points per row.
pub const WIDTH: usize = 256;

/// The number of pictures for a point's vertex values, stacked vertically.
pub const BLOCKS: usize = 5;

/// The name of the object-space normal map.
pub const OBJECT_NORMALS: &str = "object_normal_texture";

/// Points under a kind of light.
pub struct Points {
    /// Rows of points, an even number.
    pub rows: usize,
    /// Position and handedness; normal, and 1 if the front is visible; tangent; uv; colour.
    pub inputs: Vec<[f32; 4]>,
    /// The texels of each point, by texture name.
    pub textures: BTreeMap<&'static str, Vec<[f32; 4]>>,
}

/// The vertex values of a point.
#[derive(Clone, Copy)]
pub struct Point {
    pub position: Vec3,
    pub normal: Vec3,
    pub tangent: Vec3,
    pub handedness: f32,
    pub front: bool,
    /// u, v and 0.
    pub uv: Vec3,
    pub color: Vec3,
}

/// The values that the points of a square share.
struct Square {
    position: Vec3<f64>,
    position_step: [Vec3<f64>; 2],
    normal: Vec3<f64>,
    normal_step: [Vec3<f64>; 2],
    front: bool,
}

/// Rounds to the nearest multiples of 2⁻¹⁶.
fn on_grid(vector: Vec3<f64>) -> Vec3<f64> {
    vector.map(|component| (component * 65536.0).round() / 65536.0)
}

fn texel(vector: Vec3<f64>, w: f64) -> [f32; 4] {
    let [x, y, z] = vector.to_f32().to_array();
    [x, y, z, w as f32]
}

/// Encodes a direction like normal maps.
fn stored(normal: Vec3<f64>) -> Vec3<f64> {
    normal * 0.5 + Vec3::splat(0.5)
}

impl Points {
    /// Creates points under a kind of light.
    pub fn new(rows: usize, lighting: &Lighting, random: &mut Random) -> Self {
        let mut points =
            Self { rows, inputs: vec![[0.0; 4]; BLOCKS * rows * WIDTH], textures: BTreeMap::new() };
        for y in (0..rows).step_by(2) {
            for x in (0..WIDTH).step_by(2) {
                let square = Square::new(lighting, random);
                for (across, down) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    points.put([x + across, y + down], &square.at([across, down]), random);
                }
            }
        }
        points.add_textures(random);
        points
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.rows * WIDTH
    }

    fn put(&mut self, [x, y]: [usize; 2], square: &Square, random: &mut Random) {
        let (all, at) = (self.len(), y * WIDTH + x);
        let uv = [x, y].map(|i| i as f64 + 0.5);
        let uv = Vec3::new(uv[0] / WIDTH as f64, uv[1] / self.rows as f64, 0.0);
        let tangent = (random.unit() + random.unit() * 0.2).cross(square.normal).normalize();
        let handedness = if random.next() < 0.5 { -1.0 } else { 1.0 };
        let rows = [
            texel(square.position, handedness),
            texel(square.normal, if square.front { 1.0 } else { 0.0 }),
            texel(tangent, 0.0),
            texel(uv, 0.0),
            texel(random.color(), 1.0),
        ];
        rows.into_iter().enumerate().for_each(|(block, row)| self.inputs[block * all + at] = row);
    }

    /// Returns the vertex values of point `at`.
    pub fn point(&self, at: usize) -> Point {
        let all = self.len();
        let row = |block: usize| self.inputs[block * all + at];
        let vector = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z);
        Point {
            position: vector(row(0)),
            handedness: row(0)[3],
            normal: vector(row(1)),
            front: row(1)[3] > 0.5,
            tangent: vector(row(2)),
            uv: vector(row(3)),
            color: vector(row(4)),
        }
    }

    fn add_textures(&mut self, random: &mut Random) {
        let all = self.len();
        for role in TextureRole::ALL {
            let texels = (0..all).map(|_| texel_of(role, random)).collect();
            self.textures.insert(role.name(), texels);
        }
        let columns = NORMAL_MATRIX.map(|column| Vec3::from_array(column).to_f64());
        let object = (0..all).map(|at| {
            let normal = tilted(self.point(at).normal.to_f64().normalize(), random);
            let [x, y, z] = columns.map(|column| column.dot(normal));
            texel(stored(Vec3::new(x, y, z)), variance(random))
        });
        let object = object.collect();
        self.textures.insert(OBJECT_NORMALS, object);
    }
}

/// Returns a direction near another one, usually very near.
fn tilted(n: Vec3<f64>, random: &mut Random) -> Vec3<f64> {
    let share = random.next();
    (n + random.unit() * (0.9 * share * share)).normalize()
}

/// Returns the variance of a normal map texel.
fn variance(random: &mut Random) -> f64 {
    (0.4 * random.next() - 0.2).max(0.0)
}

fn texel_of(role: TextureRole, random: &mut Random) -> [f32; 4] {
    match role {
        TextureRole::Normal | TextureRole::ClearcoatNormal => {
            let normal = tilted(Vec3::new(0.0, 0.0, 1.0), random);
            texel(stored(normal), variance(random))
        }
        TextureRole::Anisotropy => {
            let angle = random.between(0.0, TAU);
            let turn = stored(Vec3::new(scalar::cos(angle), scalar::sin(angle), 0.0));
            texel(Vec3::new(turn.x, turn.y, random.next()), 1.0)
        }
        _ => texel(random.color(), random.next()),
    }
}

impl Square {
    fn new(lighting: &Lighting, random: &mut Random) -> Self {
        let position = random.color() * 2.0 - Vec3::splat(1.0);
        let [x, y, z, w] = lighting.eye.map(f64::from);
        let eye = Vec3::new(x, y, z);
        let v = if w == 0.0 { eye } else { (eye - position).normalize() };
        let any = random.unit();
        let mut facet = if any.dot(v) < 0.0 { -any } else { any };
        // A quarter of the squares are in the highlight of a light.
        let light = lighting.lights.first().filter(|_| random.next() < 0.25);
        if let Some(light) = light {
            let l = match light.place {
                Place::At(place) => (place.to_f64() - position).normalize(),
                Place::Towards(l) => l.to_f64(),
            };
            let share = random.next();
            facet = (l + v).normalize_or(v) + random.unit() * (0.3 * share * share * share);
            facet = facet.normalize();
        }
        Self::of(facet, position, random)
    }

    fn of(facet: Vec3<f64>, position: Vec3<f64>, random: &mut Random) -> Self {
        let (along, front) = (facet.any_perpendicular(), random.next() < 0.5);
        let across = facet.cross(along);
        let mut step = |least: f64| {
            let angle = random.between(least, least + 1.0);
            let direction = along * scalar::cos(angle) + across * scalar::sin(angle);
            on_grid(direction * random.between(0.01, 0.03))
        };
        // About 1.5 to 3 radians apart, in either direction.
        let mut position_step = [step(0.3), step(2.6)];
        if random.next() < 0.5 {
            position_step.reverse();
        }
        let smooth = tilted(facet, random) * random.between(0.8, 1.0);
        let bend = 0.05 * random.next() * random.next();
        Self {
            position: on_grid(position),
            position_step,
            normal: on_grid(if front { smooth } else { -smooth }),
            normal_step: [on_grid(random.unit() * bend), on_grid(random.unit() * bend)],
            front,
        }
    }

    /// Returns the square with one of its other points as the first.
    fn at(&self, [across, down]: [usize; 2]) -> Self {
        let moved = |from: Vec3<f64>, [x, y]: [Vec3<f64>; 2]| from + x * across as f64 + y * down as f64;
        Self {
            position: moved(self.position, self.position_step),
            normal: moved(self.normal, self.normal_step),
            ..*self
        }
    }
}
