//! Splits vertices for corners with their own uvs or colours.

use super::faces::{Block, Wanted};
use std::collections::HashMap;

/// The vertex of a corner in the file, and the bits of its face's values.
type Corner = [u32; 7];

/// Gives identical corners the same vertex, numbered in order of first appearance.
pub(super) struct Splitter {
    /// `true` if corners have their own uvs.
    pub uvs: bool,
    /// `true` if corners have their own colours.
    pub colors: bool,
    corners: Vec<Corner>,
    /// The first corner of each vertex of the file, which is usually the only one.
    first: Vec<u32>,
    /// All other corners.
    known: HashMap<Corner, u32>,
}

impl Splitter {
    /// Makes a splitter for corners with the wanted values.
    pub fn new(wanted: &Wanted) -> Self {
        let first = vec![u32::MAX; wanted.positions.len()];
        Self { uvs: wanted.uvs, colors: wanted.colors, corners: Vec::new(), first, known: HashMap::new() }
    }

    /// Returns the vertex of corner `i` of `block`.
    pub fn index(&mut self, block: &Block, i: usize) -> u32 {
        let vertex = block.corners[i];
        let [u, v] = block.uvs.get(i).copied().unwrap_or_default();
        let [r, g, b, a] = block.colors.get(i).copied().unwrap_or_default();
        let [u, v, r, g, b, a] = [u, v, r, g, b, a].map(f32::to_bits);
        let corner = [vertex, u, v, r, g, b, a];
        let next = self.corners.len() as u32;
        let first = &mut self.first[vertex as usize];
        let index = match self.corners.get(*first as usize) {
            Some(known) if *known == corner => *first,
            Some(_) => *self.known.entry(corner).or_insert(next),
            None => {
                *first = next;
                next
            }
        };
        if index == next {
            self.corners.push(corner);
        }
        index
    }

    /// Returns the source vertex in the file for each vertex.
    pub fn vertices(&self) -> impl Iterator<Item = usize> {
        self.corners.iter().map(|corner| corner[0] as usize)
    }

    /// Returns the uvs of the vertices as stored.
    pub fn own_uvs(&self) -> impl Iterator<Item = [f32; 2]> {
        self.corners.iter().map(|[_, u, v, ..]| [*u, *v].map(f32::from_bits))
    }

    /// Returns the colours of the vertices as stored.
    pub fn own_colors(&self) -> impl Iterator<Item = [f32; 4]> {
        self.corners.iter().map(|[_, _, _, color @ ..]| color.map(f32::from_bits))
    }
}
