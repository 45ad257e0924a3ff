//! The content of an OBJ file, as stored: its arrays, its faces with their corners, and the objects and groups that
//! name them.

use super::super::text::{Words, is_for_baking, quote};
use std::collections::HashMap;
use taotie_engine::math::{Vec2, Vec3};

/// The content of an OBJ file. Every index of a corner is in range or [`NONE`].
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

/// A face of three or more corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Index of its first corner.
    pub first: u32,
    /// The number of corners.
    pub count: u32,
    /// Index into [`Obj::material_names`], or [`NONE`].
    pub material: u32,
    /// The line in the file, starting at 1.
    pub line: u32,
}

/// In a [`Corner`]: no uv or no normal. In a face: no material.
pub(super) const NONE: u32 = u32::MAX;

/// Indices of position, uv and normal.
pub(super) type Corner = [u32; 3];

/// Reads a corner of plain indices starting at 1, like [`corner`]; returns `None` for any other form, or if none is
/// left.
#[inline]
pub(super) fn plain_corner(words: &mut Words) -> Option<Corner> {
    let mut corner = [plain_index(words)?, NONE, NONE];
    if words.byte(b'/') {
        if !words.byte(b'/') {
            corner[1] = plain_index(words)?;
            if !words.byte(b'/') {
                return words.between_words().then_some(corner);
            }
        }
        corner[2] = plain_index(words)?;
    }
    words.between_words().then_some(corner)
}

#[inline]
fn plain_index(words: &mut Words) -> Option<u32> {
    words.whole()?.checked_sub(1)
}

/// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative indices count back from the latest element.
pub(super) fn corner(token: &str, counts: [usize; 3]) -> std::result::Result<Corner, String> {
    let mut corner = [NONE; 3];
    let mut parts = token.split('/');
    for ((index, count), name) in corner.iter_mut().zip(counts).zip(["vertex", "uv", "normal"]) {
        match parts.next() {
            None | Some("") => {}
            Some(part) => *index = resolve(part, count).map_err(|why| format!("{name} index {why}"))?,
        }
    }
    if corner[0] == NONE || parts.next().is_some() {
        return Err(format!("invalid corner {}: expected v, v/vt, v//vn or v/vt/vn", quote(token)));
    }
    Ok(corner)
}

fn resolve(part: &str, count: usize) -> std::result::Result<u32, String> {
    let index: i64 = part.parse().map_err(|_| format!("{} is not an integer; fix the file", quote(part)))?;
    let from_zero = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
    match u32::try_from(from_zero) {
        Ok(found) if found != NONE => Ok(found),
        _ if index == 0 => Err("0 is invalid; indices start at 1".to_owned()),
        _ => Err(format!("{index} is out of range: the count is {count}; fix the file")),
    }
}

/// Maximum number of names in the name of a mesh.
const MOST: usize = 8;

/// A statement `o` or `g`: it names the faces that follow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Mark {
    /// The index of its first face.
    pub face: u32,
    /// The words after the keyword.
    pub name: String,
}

/// The objects and groups of a file, in file order.
#[derive(Debug, Default)]
pub(super) struct Marks {
    /// From statements `o`.
    pub objects: Vec<Mark>,
    /// From statements `g`.
    pub groups: Vec<Mark>,
}

impl Marks {
    /// Appends those of the next block, whose first face is `face`.
    pub fn append(&mut self, block: Self, face: u32) {
        let moved =
            |marks: Vec<Mark>| marks.into_iter().map(move |mark| Mark { face: mark.face + face, ..mark });
        self.objects.extend(moved(block.objects));
        self.groups.extend(moved(block.groups));
    }

    /// Returns the objects, or the groups if the file has no objects.
    pub fn chosen(&self) -> &[Mark] {
        if self.objects.is_empty() { &self.groups } else { &self.objects }
    }

    /// Returns the number of the object of each chosen mark, equal for equal names, if objects are named for baking
    /// (`wheel_low`, `wheel_high`), so that each must be a mesh; empty if faces of one material are one mesh.
    pub fn kept_apart(&self) -> Vec<u32> {
        if !self.chosen().iter().any(|mark| is_for_baking(&mark.name)) {
            return Vec::new();
        }
        let (mut numbers, mut of_marks) = (HashMap::new(), Vec::new());
        for mark in self.chosen() {
            let next = numbers.len() as u32 + 1;
            of_marks.push(*numbers.entry(mark.name.as_str()).or_insert(next));
        }
        of_marks
    }
}

/// Iterates over the faces of a file, tracking the mark of each.
pub(super) struct Walk<'a> {
    marks: &'a [Mark],
    passed: usize,
}

impl<'a> Walk<'a> {
    /// Starts before the first face.
    pub fn new(marks: &'a [Mark]) -> Self {
        Self { marks, passed: 0 }
    }

    /// Advances to a face and returns the number of its mark, starting at 1; 0 for none.
    pub fn at(&mut self, face: usize) -> usize {
        while self.marks.get(self.passed).is_some_and(|mark| mark.face as usize <= face) {
            self.passed += 1;
        }
        self.passed
    }
}

/// Returns the names of these marks, each once: at most [`MOST`], then an ellipsis. Empty for none.
pub(super) fn joined(marks: &[Mark], numbers: &[usize]) -> String {
    let mut names: Vec<&str> = Vec::new();
    let mut more = 0;
    for name in numbers.iter().filter_map(|number| Some(marks.get(number.checked_sub(1)?)?.name.as_str())) {
        match names.contains(&name) || name.is_empty() {
            true => {}
            false if names.len() == MOST => more += 1,
            false => names.push(name),
        }
    }
    let rest = (more > 0).then(|| "…".to_owned());
    names.into_iter().map(str::to_owned).chain(rest).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_corners_are_read_as_any_others() {
        for text in ["1", "7/8", "7//9", "7/8/9", "007/999999999/1"] {
            let plain = plain_corner(&mut Words::new(text.as_bytes()));
            assert_eq!(plain.ok_or(String::new()), corner(text, [0; 3]), "{text}");
        }
        for text in
            ["", "0", "-1", "+1", "1/", "1//", "1/2/", "1/0", "1/2/3/4", "x", "1x", "1234567890", "/1"]
        {
            assert_eq!(plain_corner(&mut Words::new(text.as_bytes())), None, "{text}");
        }
    }

    fn marks(all: &[(u32, &str)]) -> Vec<Mark> {
        all.iter().map(|(face, name)| Mark { face: *face, name: (*name).to_owned() }).collect()
    }

    #[test]
    fn each_face_has_the_mark_before_it() {
        let all = marks(&[(1, "a"), (3, "nothing"), (3, "b")]);
        let mut walk = Walk::new(&all);
        assert_eq!([0, 1, 2, 3, 9].map(|face| walk.at(face)), [0, 1, 1, 3, 3]);
    }

    #[test]
    fn a_mesh_has_the_names_of_its_faces() {
        let all = marks(&[(0, "a"), (1, "b"), (2, "a"), (3, "")]);
        assert_eq!(joined(&all, &[0, 1, 2, 3, 4]), "a, b");
        assert_eq!((joined(&all, &[0]), joined(&[], &[])), (String::new(), String::new()));
        let many: Vec<Mark> = (0..20).map(|i| Mark { face: i, name: format!("part {i}") }).collect();
        let name = joined(&many, &(0..=20).collect::<Vec<_>>());
        assert!(name.starts_with("part 0, part 1, ") && name.ends_with("part 7, …"), "{name}");
    }

    #[test]
    fn objects_go_before_groups() {
        let mut all = Marks { groups: marks(&[(0, "g")]), ..Marks::default() };
        assert_eq!(all.chosen()[0].name, "g");
        all.append(Marks { objects: marks(&[(2, "o")]), ..Marks::default() }, 5);
        assert_eq!(all.chosen(), marks(&[(7, "o")]));
    }
}
