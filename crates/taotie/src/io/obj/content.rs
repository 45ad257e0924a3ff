//! The content of an OBJ file, as stored.

use super::corner::Corner;
use super::objects::Marks;
use crate::math::{Vec2, Vec3};

/// A face of three or more corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Index of its first corner.
    pub first: u32,
    /// The number of corners.
    pub count: u32,
    /// Index into [`Obj::material_names`], or [`NONE`](super::corner::NONE).
    pub material: u32,
    /// The line in the file, starting at 1.
    pub line: u32,
}

/// The content of an OBJ file. Every index of a corner is in range or [`NONE`](super::corner::NONE).
#[derive(Debug, Default)]
pub(super) struct Obj {
    /// The positions, model units; finite.
    pub positions: Vec<Vec3>,
    /// The vertex colours as in the file; empty, or one per position.
    pub colors: Vec<[f32; 3]>,
    /// The uvs as in the file: the origin is bottom left.
    pub uvs: Vec<Vec2>,
    /// The normals, of any length.
    pub normals: Vec<Vec3>,
    /// The corners of all faces.
    pub corners: Vec<Corner>,
    /// The faces.
    pub faces: Vec<Face>,
    /// The names used by `usemtl`, each once.
    pub material_names: Vec<String>,
    /// The words after each `mtllib`.
    pub libraries: Vec<String>,
    /// The objects and groups.
    pub marks: Marks,
    /// The number of times that `s` switches to another smoothing group, not counting the first.
    pub smoothing_changes: usize,
}
