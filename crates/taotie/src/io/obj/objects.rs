//! Objects and groups: they name the meshes of an OBJ file, which are divided by material.

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
