//! Coincident vertices of a mesh.

use std::collections::HashMap;
use taotie_engine::math::Vec3;
use taotie_engine::mesh::Mesh;

/// The coincident vertices of a mesh.
pub(super) struct Welds {
    /// For each vertex, the first at the same position.
    place: Vec<u32>,
    /// For each vertex, the first at the same position with the same normal.
    pub smooth: Vec<u32>,
}

impl Welds {
    /// Finds coincident vertices by comparing positions and normals bitwise.
    pub fn new(mesh: &Mesh) -> Self {
        let bits = |v: &Vec3| v.to_array().map(|c| (c + 0.0).to_bits());
        let (mut places, mut normals) = (HashMap::new(), HashMap::new());
        let pairs = mesh.positions().iter().zip(mesh.normals()).enumerate();
        let (place, smooth) = pairs
            .map(|(i, (p, n))| {
                let i = i as u32;
                (*places.entry(bits(p)).or_insert(i), *normals.entry((bits(p), bits(n))).or_insert(i))
            })
            .unzip();
        Self { place, smooth }
    }

    /// Returns the key of an edge, the same from both sides: the position indices of its ends, the smaller first.
    pub fn edge(&self, a: u32, b: u32) -> (u32, u32) {
        let (a, b) = self.ordered(a, b);
        (self.place[a as usize], self.place[b as usize])
    }

    /// Returns the corners of an edge, the one with the smaller position index first.
    pub fn ordered(&self, a: u32, b: u32) -> (u32, u32) {
        if self.place[a as usize] < self.place[b as usize] { (a, b) } else { (b, a) }
    }
}
