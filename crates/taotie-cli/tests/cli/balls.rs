//! Balls to bake: scans with waves on them, and low-poly meshes for them.

use std::fmt::Write;
use taotie_engine::math::scalar::{cos, sin};

/// A corner of a triangle: the indices of its position and of its UV.
type Corner = [usize; 2];

/// A closed ball with triangles between rings and meridians.
#[derive(Clone, Copy)]
pub struct Ball {
    pub rings: usize,
    pub meridians: usize,
    pub radius: f64,
    /// The height of its waves, as a fraction of the radius.
    pub waves: f64,
    pub center: [f64; 3],
    /// Maps fractions of the way around and up to UVs; `None` for no UVs.
    pub uv: Option<fn(f64, f64) -> [f64; 2]>,
}

/// A scan of 9,024 triangles without UVs.
pub const SCAN: Ball =
    Ball { rings: 48, meridians: 96, radius: 1.0, waves: 0.01, center: [0.0; 3], uv: None };

/// A low-poly mesh of 528 triangles that fits [`SCAN`].
pub const LOW: Ball = Ball { rings: 12, meridians: 24, waves: 0.0, uv: Some(|u, v| [u, v]), ..SCAN };

impl Ball {
    /// Returns it as an OBJ file.
    pub fn obj(&self) -> String {
        self.obj_of(&self.faces())
    }

    /// Returns it as an OBJ file with other triangles.
    pub fn obj_of(&self, faces: &[[Corner; 3]]) -> String {
        let mut text = String::new();
        for [x, y, z] in self.places() {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        let Some(uv) = self.uv else {
            faces.iter().for_each(|[[a, _], [b, _], [c, _]]| writeln!(text, "f {a} {b} {c}").unwrap());
            return text;
        };
        for i in 0..=self.rings {
            for j in 0..=self.meridians {
                let [u, v] = uv(j as f64 / self.meridians as f64, 1.0 - i as f64 / self.rings as f64);
                let _ = writeln!(text, "vt {u} {v}");
            }
        }
        for [[a, p], [b, q], [c, r]] in faces {
            let _ = writeln!(text, "f {a}/{p} {b}/{q} {c}/{r}");
        }
        text
    }

    /// Returns its triangles, which face outward; indices start at 1, as in the file.
    pub fn faces(&self) -> Vec<[Corner; 3]> {
        let mut faces = Vec::new();
        for i in 0..self.rings {
            for j in 0..self.meridians {
                let [a, b] = [(i, j), (i + 1, j)].map(|(i, j)| self.corner(i, j));
                let [c, d] = [(i + 1, j + 1), (i, j + 1)].map(|(i, j)| self.corner(i, j));
                if i > 0 {
                    faces.push([a, b, d]);
                }
                if i + 1 < self.rings {
                    faces.push([b, c, d]);
                }
            }
        }
        faces
    }

    fn corner(&self, i: usize, j: usize) -> Corner {
        let place = match i {
            0 => 0,
            i if i == self.rings => 1 + (i - 1) * self.meridians,
            i => 1 + (i - 1) * self.meridians + j % self.meridians,
        };
        [place + 1, i * (self.meridians + 1) + j + 1]
    }

    fn places(&self) -> Vec<[f64; 3]> {
        let mut places = vec![self.place(0, 0)];
        for i in 1..self.rings {
            places.extend((0..self.meridians).map(|j| self.place(i, j)));
        }
        places.push(self.place(self.rings, 0));
        places
    }

    fn place(&self, i: usize, j: usize) -> [f64; 3] {
        let down = std::f64::consts::PI * i as f64 / self.rings as f64;
        let around = std::f64::consts::TAU * j as f64 / self.meridians as f64;
        let wave = sin(12.0 * around) * sin(14.0 * down) * sin(down);
        let radius = self.radius * (1.0 + self.waves * wave);
        let [x, y, z] = [sin(down) * cos(around), cos(down), -sin(down) * sin(around)];
        let [a, b, c] = self.center;
        [a + radius * x, b + radius * y, c + radius * z]
    }
}
