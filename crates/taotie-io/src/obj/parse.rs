//! Parses an OBJ file by reading blocks in parallel and combining them.

use super::content::{NONE, Obj};
use super::statements::{FileOffset, Parser, WHITE, blocks};
use std::collections::HashMap;
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::mesh::first;
use taotie_engine::parallel;

/// Reads the statements of `text` from the file `path`, in blocks and in parallel.
///
/// # Errors
/// [`Error::Parse`] with the line of the first unusable number or index, and if there are no faces.
pub(super) fn parse(path: &Path, text: &str, warnings: &mut Warnings) -> Result<Obj> {
    let mut whole = Whole::default();
    for group in blocks(text).chunks(4 * rayon::current_num_threads()) {
        let separate = if whole.is_relative { None } else { read_alone(group) };
        let parsers = match separate {
            Some(parsers) => parsers,
            None => {
                whole.is_relative = true;
                read_behind(group, whole.offset())
                    .map_err(|(line, what)| Error::parse(path, format!("line {line}"), what))?
            }
        };
        parsers.into_iter().for_each(|parser| whole.take(parser, warnings));
    }
    let obj = whole.obj;
    check_ranges(path, &obj)?;
    if obj.faces.is_empty() {
        let what = format!("no faces ({} vertices); export triangles or polygons", obj.positions.len());
        return Err(Error::parse(path, "whole file", what));
    }
    Ok(obj)
}

/// Reads blocks independently of what precedes them; `None` if one has relative indices or an error.
fn read_alone(blocks: &[&str]) -> Option<Vec<Parser>> {
    let read = |i: usize| Parser::new(None).block(blocks[i]).ok();
    parallel::tasks(blocks.len(), &read).into_iter().collect()
}

/// Reads blocks that follow `offset`. An error includes its line.
fn read_behind(blocks: &[&str], mut offset: FileOffset) -> std::result::Result<Vec<Parser>, (usize, String)> {
    let lengths = parallel::tasks(blocks.len(), &|i| FileOffset::of(blocks[i]));
    let starts: Vec<FileOffset> = lengths.iter().map(|length| offset.advance(length)).collect();
    let read = |i: usize| Parser::new(Some(starts[i])).block(blocks[i]);
    parallel::tasks(blocks.len(), &read).into_iter().collect()
}

/// The concatenated content of the blocks.
struct Whole {
    obj: Obj,
    /// The number of lines.
    lines: usize,
    /// `true` once a block has depended on what precedes it.
    is_relative: bool,
    material: u32,
    material_ids: HashMap<String, u32>,
    smoothing: Option<String>,
}

impl Default for Whole {
    fn default() -> Self {
        Self {
            obj: Obj::default(),
            lines: 0,
            is_relative: false,
            material: NONE,
            material_ids: HashMap::new(),
            smoothing: None,
        }
    }
}

impl Whole {
    /// Returns the start of the next block.
    fn offset(&self) -> FileOffset {
        let Obj { positions, uvs, normals, .. } = &self.obj;
        FileOffset { lines: self.lines, counts: [positions.len(), uvs.len(), normals.len()] }
    }

    /// Appends the content of the next block.
    fn take(&mut self, parser: Parser, warnings: &mut Warnings) {
        warnings.absorb(parser.warnings);
        let mut block = parser.obj;
        let materials: Vec<u32> = block.material_names.drain(..).map(|name| self.material_id(name)).collect();
        let first = self.obj.corners.len() as u32;
        for face in &mut block.faces {
            face.first += first;
            face.line += self.lines as u32;
            face.material = materials.get(face.material as usize).copied().unwrap_or(self.material);
        }
        self.lines += parser.lines;
        self.material = materials.get(parser.material as usize).copied().unwrap_or(self.material);
        if self.smoothing.is_some() && parser.first_smoothing.is_some() {
            self.obj.smoothing_changes += usize::from(self.smoothing != parser.first_smoothing);
        }
        self.obj.smoothing_changes += block.smoothing_changes;
        self.smoothing = parser.smoothing.or(self.smoothing.take());
        if !(self.obj.colors.is_empty() && block.colors.is_empty()) {
            self.obj.colors.resize(self.obj.positions.len(), WHITE);
            block.colors.resize(block.positions.len(), WHITE);
        }
        self.obj.colors.append(&mut block.colors);
        self.obj.positions.append(&mut block.positions);
        self.obj.uvs.append(&mut block.uvs);
        self.obj.normals.append(&mut block.normals);
        self.obj.corners.append(&mut block.corners);
        self.obj.marks.append(block.marks, self.obj.faces.len() as u32);
        self.obj.faces.append(&mut block.faces);
        self.obj.libraries.append(&mut block.libraries);
    }

    fn material_id(&mut self, name: String) -> u32 {
        let next = self.obj.material_names.len() as u32;
        let id = *self.material_ids.entry(name.clone()).or_insert(next);
        if id == next {
            self.obj.material_names.push(name);
        }
        id
    }
}

/// Checks the range of all indices at the end, since they may refer to later elements.
fn check_ranges(path: &Path, obj: &Obj) -> Result<()> {
    let counts = [obj.positions.len(), obj.uvs.len(), obj.normals.len()];
    let is_beyond = |(index, count): (&u32, usize)| *index as usize >= count && *index != NONE;
    let Some(bad) = first(&obj.corners, |corner| corner.iter().zip(counts).any(is_beyond)) else {
        return Ok(());
    };
    let face = obj.faces.partition_point(|face| face.first as usize <= bad).saturating_sub(1);
    let line = obj.faces.get(face).map_or(0, |face| face.line);
    let parts = obj.corners[bad].iter().zip(counts).zip(["vertex", "uv", "normal"]);
    let what = parts.filter(|(part, _)| is_beyond(*part)).map(|((index, count), name)| {
        let index = u64::from(*index) + 1;
        format!("{name} index {index} is out of range: the count is {count}; fix the file")
    });
    Err(Error::parse(path, format!("line {line}"), what.take(1).collect::<String>()))
}

#[cfg(test)]
mod tests {
    use super::super::content::Mark;
    use super::*;

    fn parse_text(text: &str) -> (Result<Obj>, Warnings) {
        let mut warnings = Warnings::default();
        (parse(Path::new("a.obj"), text, &mut warnings), warnings)
    }

    fn error(text: &str) -> String {
        parse_text(text).0.err().map(|e| e.to_string()).unwrap_or_default()
    }

    #[test]
    fn indices_count_from_one_and_back_from_the_last() {
        let (obj, warnings) =
            parse_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt .5\nvn 0 0 1\nf 1//1 -2/-1 3/1/-1 # c");
        assert_eq!(obj.unwrap().corners, [[0, NONE, 0], [1, 0, NONE], [2, 0, 0]]);
        assert!(warnings.is_empty());
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(error("v 0 0\n"), "a.obj: line 1: vertex with 2 numbers; expected at least 3");
        assert!(
            error("\nv nan 0 0").starts_with("a.obj: line 2: vertex position 'nan 0 0' is infinite or NaN")
        );
        assert!(error("v 0 0 1e40").contains("infinite"));
        assert!(error("v 1 1 1 0").contains("infinite"));
        assert!(error("v 0 0 0\nf 1 1 2").contains("line 2: vertex index 2 is out of range: the count is 1"));
        assert!(
            error("v 0 0 0\nf 1 1 -2").contains("line 2: vertex index -2 is out of range: the count is 1")
        );
        assert!(error("v 0 0 0\nf 1 1 0").contains("indices start at 1"));
        assert!(error("v 0 0 0\nf 1 1 1 0\n").contains("indices start at 1"));
        assert!(error("v 0 0 0\nf 1 1 1 1x\n").contains("'1x' is not an integer"));
        assert!(error("v 0 0 0\nf 1/1 1 1").contains("uv index 1 is out of range: the count is 0"));
        assert!(error("v 0 0 0\nf 1 1 1/2/3/4").contains("expected v, v/vt"));
        assert!(error("v 0 0 0\nf 1 1 99999999999999999999").contains("not an integer"));
        assert!(error("v 0 0 0\nf 1 1 4294967296").contains("out of range"));
        assert!(error("v 0 0 0\nf 1 1 -9223372036854775808").contains("out of range"));
        assert!(error("v 0 0 0\np 1\n").contains("no faces (1 vertices)"));
    }

    #[test]
    fn what_is_not_drawn_is_counted() {
        let (obj, warnings) =
            parse_text("v 0 0 0 2\np 1\nl 1 1 1\nl 1 1\nf 1 1\nf 1 1 1\ncurv 0 1 1\n\u{7f}ELF");
        assert_eq!(obj.unwrap().faces.len(), 1);
        let counts: Vec<usize> = warnings.iter().map(|(_, n)| n).collect();
        assert_eq!(counts, [1, 2, 1, 1, 1]);
    }

    /// A file of several blocks is read as a whole: relative indices count across block boundaries.
    #[test]
    fn blocks_are_read_as_one() {
        let filler = "# filler\n".repeat(300_000);
        let text = format!(
            "v 0 0 0\nv 1 0 0 1 0 0\nusemtl a\ns 1\n{filler}v 0 1 0\nf -3 -2 -1\ns 1\ns 2\n{filler}\
             usemtl b\nf 1 2 3\nusemtl a\ns 1\n{filler}f 1 2 \\\n 3\no last\nf 3 2 1\n"
        );
        let obj = parse_text(&text).0.unwrap();
        assert_eq!(
            obj.corners.iter().map(|c| c[0]).collect::<Vec<_>>(),
            [0, 1, 2, 0, 1, 2, 0, 1, 2, 2, 1, 0]
        );
        let faces: Vec<[u32; 3]> = obj.faces.iter().map(|f| [f.first, f.material, f.line]).collect();
        assert_eq!(faces, [[0, 0, 300_006], [3, 1, 600_010], [6, 0, 900_013], [9, 0, 900_016]]);
        assert_eq!(obj.marks.objects, [Mark { face: 3, name: "last".into() }]);
        assert_eq!((obj.material_names.concat(), obj.smoothing_changes), ("ab".to_owned(), 2));
        assert_eq!(obj.colors, [WHITE, [1.0, 0.0, 0.0], WHITE]);
        assert!(error(&format!("{text}f 1 2 4")).contains("line 900017: vertex index 4"));
        assert!(error(&format!("{text}f 1 2 -4")).contains("line 900017: vertex index -4"));
    }

    /// Lines of plain numbers, and the same after a space, which are read as statements.
    #[test]
    fn plain_lines_are_read_as_any_others() {
        let lines = [
            "v 0 .5 1.",
            "v\t-1e-3  12345678901234567890 0.1",
            "v 1 2 3 2",
            "v 1 2 3 .5 0.25 1",
            "v 4 5 6 1 0 1 1",
            "v 1 2 3 4 5 6 7 8",
            "vt .5",
            "vt 1 nan",
            "vt 1 2 3",
            "vt 1 2 3 4",
            "vn 0 0 -1",
            "vn 0 inf 1 7",
            "f 1 2 3",
            "f 1/2 2/2/1 3//2 4",
            "f\t1/1/1 \t2/1/1 3/1/2 ",
            "f 1 2",
            "f 1/ 2/ 3//",
            "f +1 0002 1",
            "p 1",
            "usemtl b",
            "s off",
            "# f 1 2 3",
            "",
            " v 7 8 9",
            "g a",
        ];
        for count in [1, 2_000] {
            for end in ["\n", "\r\n"] {
                let text: String =
                    (0..count).flat_map(|_| lines.map(|line| format!("{line}{end}"))).collect();
                let (plain, warnings) = parse_text(&text);
                let (other, others) =
                    parse_text(&text.lines().map(|line| format!(" {line}{end}")).collect::<String>());
                let counts = |warnings: &Warnings| format!("{:?}", warnings.iter().collect::<Vec<_>>());
                assert_eq!(format!("{:?}", plain.unwrap()), format!("{:?}", other.unwrap()));
                assert!(!warnings.is_empty() && counts(&warnings) == counts(&others));
            }
        }
    }

    /// Errors in a later block have the right line, whatever precedes it.
    #[test]
    fn errors_in_later_blocks_name_their_line() {
        let text = "v 0 0 0\n".repeat(400_000);
        for (end, error_there) in [
            ("f 1 1 x", "line 400001: vertex index 'x' is not an integer"),
            ("f 1 1 -400001", "line 400001: vertex index -400001 is out of range: the count is 400000"),
            ("f 1 1 400001", "line 400001: vertex index 400001 is out of range: the count is 400000"),
            ("f -400000 1 -1\nv 0", "line 400002: vertex with 1 numbers"),
        ] {
            let said = error(&format!("{text}{end}\n"));
            assert!(said.contains(error_there), "{said}");
        }
        let (obj, _) = parse_text(&format!("{text}f 1 2 3\n{text}f -1 -2 -3\nf 1 2 3\n"));
        let faces: Vec<u32> = obj.unwrap().faces.iter().map(|face| face.line).collect();
        assert_eq!(faces, [400_001, 800_002, 800_003]);
    }

    #[test]
    fn colours_are_white_where_a_vertex_has_none() {
        let (obj, _) = parse_text("v 0 0 0\nv 1 0 0 .5 .25 1\nv 0 1 0\nf 1 2 3");
        assert_eq!(obj.unwrap().colors, [WHITE, [0.5, 0.25, 1.0], WHITE]);
    }
}
