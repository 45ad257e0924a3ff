//! Converts rows of faces to triangles, block by block.

use super::super::polygon::{Cutter, Outline};
use super::names::{Role, slot};
use super::payload::{Element, Rows};
use super::vertices::attribute;
use crate::math::Vec3;

/// The faces of an element.
pub(super) struct FaceElement<'a> {
    /// Its rows.
    pub rows: Element<'a>,
    /// `true` if a row is a set of triangle strips rather than a polygon.
    pub strips: bool,
}

impl FaceElement<'_> {
    /// Returns all faces as one block if they are triangles with only indices; else `None`.
    pub fn triangles(&self, wanted: &Wanted) -> Option<Block> {
        let plain = !self.strips && !wanted.splits() && wanted.lack_normals.is_empty();
        let triangles = plain.then(|| self.rows.triangles(wanted.positions.len()))??;
        Some(Block { faces: triangles.len(), triangles, ..Block::default() })
    }
}

/// The data required from faces.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// The vertices' positions.
    pub positions: &'a [Vec3],
    /// See [`super::vertices::Vertices::lack_normals`].
    pub lack_normals: &'a [bool],
    /// `true` if corners have their own uvs.
    pub uvs: bool,
    /// `true` if faces have their own colours.
    pub colors: bool,
}

impl Wanted<'_> {
    /// Returns `true` if corners with the same vertex may differ.
    pub fn splits(&self) -> bool {
        self.uvs || self.colors
    }
}

/// Some faces, triangulated.
#[derive(Default)]
pub(super) struct Block {
    /// The vertex of each corner, if corners have their own data.
    pub corners: Vec<u32>,
    /// The stored uv of each corner, if wanted.
    pub uvs: Vec<[f32; 2]>,
    /// The stored colour of each corner, if wanted.
    pub colors: Vec<[f32; 4]>,
    /// Triangles as indices of vertices, or of corners if these have their own data.
    pub triangles: Vec<[u32; 3]>,
    /// The number of faces.
    pub faces: usize,
    /// The number of faces with fewer than three corners.
    pub too_few: usize,
    /// The number of self-intersecting faces.
    pub crossing: usize,
    /// The number of corners with an invalid normal.
    pub without_normal: usize,
    /// The first unusable face, and the reason.
    pub error: Option<(usize, String)>,
}

impl Block {
    /// Reads and triangulates the faces of `rows`.
    pub fn read(mut rows: Rows, strips: bool, wanted: &Wanted) -> Self {
        let mut block = Self::default();
        block.triangles.reserve(rows.left);
        let mut scratch = Scratch::default();
        let mut row = Row::default();
        while row.read(&mut rows, wanted) {
            if strips {
                row.strip_triangles()
                    .for_each(|corners| block.add(&corners, &Row::default(), wanted, &mut scratch));
            } else {
                block.add(&row.corners, &row, wanted, &mut scratch);
            }
            if block.error.is_some() {
                break;
            }
        }
        block
    }

    #[inline(always)]
    fn add(&mut self, corners: &[u32], row: &Row, wanted: &Wanted, scratch: &mut Scratch) {
        self.faces += 1;
        if !wanted.lack_normals.is_empty() {
            let lacks = |c: &&u32| wanted.lack_normals.get(**c as usize) == Some(&true);
            self.without_normal += corners.iter().filter(lacks).count();
        }
        if corners.len() < 3 {
            self.too_few += 1;
            return;
        }
        if corners.len() > Cutter::MAX_CORNERS
            || corners.iter().any(|c| *c as usize >= wanted.positions.len())
        {
            let why = || (self.faces - 1, why_not(corners, wanted.positions.len()));
            self.error.get_or_insert_with(why);
            return;
        }
        if wanted.splits() {
            let first = self.corners.len() as u32;
            self.add_corners(corners, row, wanted);
            self.cut(corners, wanted.positions, |i| first + i, scratch);
        } else {
            self.cut(corners, wanted.positions, |i| corners[i as usize], scratch);
        }
    }

    fn add_corners(&mut self, corners: &[u32], row: &Row, wanted: &Wanted) {
        self.corners.extend_from_slice(corners);
        if wanted.uvs {
            let (uvs, _) = row.uvs.as_chunks::<2>();
            self.uvs.extend((0..corners.len()).map(|i| uvs.get(i).copied().unwrap_or_default()));
        }
        if wanted.colors {
            self.colors.extend(corners.iter().map(|_| row.color));
        }
    }

    /// Adds the triangles of a polygon; `name` maps its corners to indices.
    #[inline(always)]
    fn cut(&mut self, corners: &[u32], positions: &[Vec3], name: impl Fn(u32) -> u32, scratch: &mut Scratch) {
        if corners.len() == 3 {
            self.triangles.push([name(0), name(1), name(2)]);
            return;
        }
        scratch.points.clear();
        scratch.points.extend(corners.iter().map(|c| positions[*c as usize]));
        scratch.triangles.clear();
        let outline = scratch.cutter.cut(&scratch.points, &mut scratch.triangles);
        self.crossing += usize::from(outline == Outline::Crossing);
        self.triangles.extend(scratch.triangles.iter().map(|t| t.map(&name)));
    }
}

fn why_not(corners: &[u32], count: usize) -> String {
    if corners.len() > Cutter::MAX_CORNERS {
        return format!("{} corners; the maximum is {}", corners.len(), Cutter::MAX_CORNERS);
    }
    match corners.iter().find(|c| **c as usize >= count) {
        Some(&u32::MAX) => "negative vertex index; fix the file".to_owned(),
        index => format!(
            "vertex index {} is out of range: the count is {count}; fix the file",
            index.copied().unwrap_or_default()
        ),
    }
}

#[derive(Default)]
struct Scratch {
    cutter: Cutter,
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// The current row.
struct Row {
    /// Vertex indices; a negative one is `u32::MAX`.
    corners: Vec<u32>,
    /// u and v for each corner, or empty.
    uvs: Vec<f32>,
    color: [f32; 4],
}

impl Default for Row {
    fn default() -> Self {
        Self { corners: Vec::new(), uvs: Vec::new(), color: [1.0; 4] }
    }
}

impl Row {
    #[inline(always)]
    fn read(&mut self, rows: &mut Rows, wanted: &Wanted) -> bool {
        self.corners.clear();
        self.uvs.clear();
        rows.next(|role, values| match role {
            Role::Corners => {
                self.corners.clear();
                values.push_indices(&mut self.corners);
            }
            Role::Uvs if wanted.uvs => {
                self.uvs.clear();
                self.uvs.extend(values.numbers().map(|v| v as f32));
            }
            Role::Slot(slot) if wanted.colors => self.color[slot - slot::COLOR] = attribute(slot, values),
            _ => {}
        })
    }

    /// Returns the triangles of strips, which are separated by negative indices; every second one of a strip is
    /// flipped.
    fn strip_triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let strips = self.corners.split(|index| *index == u32::MAX);
        strips.flat_map(|strip| {
            strip.windows(3).enumerate().filter_map(|(i, w)| {
                let corners = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
                let is_joint = w[0] == w[1] || w[1] == w[2] || w[0] == w[2];
                (!is_joint).then_some(corners)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_alternate_and_restart() {
        let strips = Row { corners: vec![0, 1, 2, 3, 3, u32::MAX, 4, 5, 6], ..Row::default() };
        let triangles: Vec<[u32; 3]> = strips.strip_triangles().collect();
        assert_eq!(triangles, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
    }
}
