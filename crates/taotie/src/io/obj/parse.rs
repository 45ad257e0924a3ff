//! The statements of an OBJ file, as they stand in it.

use super::super::polygon::Cutter;
use super::super::text::{self, quote};
use super::blocks::{FileOffset, blocks, split_keyword};
use super::objects::{Mark, Marks};
use crate::error::{Error, Result, Warnings};
use crate::math::{Vec2, Vec3};
use crate::mesh::first;
use crate::parallel;
use std::collections::HashMap;
use std::path::Path;

/// In a [`Corner`]: no uv or no normal. In a [`Face`]: no material.
pub(super) const NONE: u32 = u32::MAX;

/// Indices of position, uv and normal.
pub(super) type Corner = [u32; 3];

/// A face of three or more corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// Index of its first corner.
    pub first: u32,
    /// The number of corners.
    pub count: u32,
    /// Index into [`Obj::material_names`], or [`NONE`].
    pub material: u32,
    /// The line in the file, from 1.
    pub line: u32,
}

/// The content of an OBJ file. Every index of a corner is in range or [`NONE`].
#[derive(Debug, Default)]
pub(super) struct Obj {
    /// The positions, model units; finite.
    pub positions: Vec<Vec3>,
    /// The vertex colours as in the file; empty, or one a position.
    pub colors: Vec<[f32; 3]>,
    /// The uvs as in the file: the origin is bottom left.
    pub uvs: Vec<Vec2>,
    /// The normals, of any length.
    pub normals: Vec<Vec3>,
    /// The corners of all faces.
    pub corners: Vec<Corner>,
    /// The faces.
    pub faces: Vec<Face>,
    /// The names that `usemtl` gives, each once.
    pub material_names: Vec<String>,
    /// The words behind each `mtllib`.
    pub libraries: Vec<String>,
    /// The objects and groups.
    pub marks: Marks,
    /// The number of times that `s` names another smoothing group than before, once one was named.
    pub smoothing_changes: usize,
}

/// Reads the statements of `text`, which stands in the file `path`, in blocks and in parallel.
///
/// # Errors
/// [`Error::Parse`] naming the line of the first number or index that cannot be used, and where there is no face.
pub(super) fn parse(path: &Path, text: &str, warnings: &mut Warnings) -> Result<Obj> {
    let mut whole = Whole::default();
    let mut offset = FileOffset::default();
    for group in blocks(text).chunks(4 * rayon::current_num_threads()) {
        let lengths = parallel::tasks(group.len(), &|i| FileOffset::of(group[i]));
        let starts: Vec<FileOffset> = lengths.iter().map(|length| offset.advance(length)).collect();
        let read = |i: usize| Parser::new(starts[i]).block(group[i]);
        for parser in parallel::tasks(group.len(), &read) {
            let parser = parser.map_err(|(line, what)| Error::parse(path, format!("line {line}"), what))?;
            whole.take(parser, warnings);
        }
    }
    let obj = whole.obj;
    check_ranges(path, &obj)?;
    if obj.faces.is_empty() {
        let what = format!("no face ({} vertices); export triangles or polygons", obj.positions.len());
        return Err(Error::parse(path, "whole file", what));
    }
    Ok(obj)
}

const WHITE: [f32; 3] = [1.0; 3];

/// In a [`Face`] of one block: the material of the block before.
const INHERITED: u32 = u32::MAX - 1;

/// Reads one block.
struct Parser {
    start: FileOffset,
    /// The content of the block. Corners count from the start of the file, all else from that of the block.
    obj: Obj,
    warnings: Warnings,
    material: u32,
    material_ids: HashMap<String, u32>,
    first_smoothing: Option<String>,
    smoothing: Option<String>,
}

impl Parser {
    fn new(start: FileOffset) -> Self {
        Self {
            start,
            obj: Obj::default(),
            warnings: Warnings::default(),
            material: INHERITED,
            material_ids: HashMap::new(),
            first_smoothing: None,
            smoothing: None,
        }
    }

    /// Reads all statements; an error comes with its line.
    fn block(mut self, block: &str) -> std::result::Result<Self, (usize, String)> {
        for (line, statement) in text::lines(block) {
            let line = self.start.lines + line;
            self.statement(&statement, line).map_err(|what| (line, what))?;
        }
        if !self.obj.colors.is_empty() {
            self.obj.colors.resize(self.obj.positions.len(), WHITE);
        }
        Ok(self)
    }

    fn statement(&mut self, statement: &str, line: usize) -> std::result::Result<(), String> {
        let (keyword, rest) = split_keyword(statement);
        let rest = rest.trim();
        let warnings = &mut self.warnings;
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let [u, v] = numbers(rest, 1)?;
                self.obj.uvs.push(Vec2::new(u, v));
            }
            "vn" => self.obj.normals.push(Vec3::from_array(numbers(rest, 3)?)),
            "f" | "fo" => self.face(rest, line)?,
            "usemtl" => self.use_material(rest),
            "mtllib" => self.obj.libraries.push(rest.to_owned()),
            "s" => self.smooth(rest),
            "o" => self.obj.marks.objects.push(self.mark(rest)),
            "g" => self.obj.marks.groups.push(self.mark(rest)),
            "p" => warnings.note("point statements are not drawn", 1),
            "l" => warnings.note("line statements are not drawn", 1),
            "curv" | "curv2" | "surf" => warnings.note("free-form curves and surfaces are not drawn", 1),
            _ if is_harmless(keyword) => {}
            _ => warnings.note("lines that are no OBJ statement are left out", 1),
        }
        Ok(())
    }

    /// Reads `v x y z`, `v x y z w`, `v x y z r g b` or `v x y z r g b a`; as in other readers, w divides.
    fn vertex(&mut self, rest: &str) -> std::result::Result<(), String> {
        let mut values = [0.0; 7];
        let count = fill(rest, &mut values)?;
        let [x, y, z, r, g, b, _] = values;
        let mut position = Vec3::new(x, y, z);
        if count < 3 {
            return Err(format!("a vertex of {count} numbers; it needs 3"));
        }
        if count == 4 {
            position = position / r;
        }
        if !position.is_finite() {
            return Err(format!("vertex position {} is infinite or NaN; mend the file", quote(rest)));
        }
        let has_color = count >= 6;
        if has_color && self.obj.colors.is_empty() {
            self.obj.colors.resize(self.obj.positions.len(), WHITE);
        }
        if has_color || !self.obj.colors.is_empty() {
            self.obj.colors.push(if has_color { [r, g, b] } else { WHITE });
        }
        self.obj.positions.push(position);
        Ok(())
    }

    fn face(&mut self, rest: &str, line: usize) -> std::result::Result<(), String> {
        let [positions, uvs, normals] = self.start.counts;
        let Obj { positions: p, uvs: t, normals: n, .. } = &self.obj;
        let counts = [positions + p.len(), uvs + t.len(), normals + n.len()];
        let first = self.obj.corners.len();
        for token in tokens(rest) {
            self.obj.corners.push(corner(token, counts)?);
        }
        let count = self.obj.corners.len() - first;
        if count < 3 {
            self.obj.corners.truncate(first);
            self.warnings.note("faces of fewer than three corners are left out", 1);
            return Ok(());
        }
        if count > Cutter::MAX_CORNERS {
            return Err(format!("a face of {count} corners; at most {}", Cutter::MAX_CORNERS));
        }
        let (first, count, line) = (first as u32, count as u32, line as u32);
        self.obj.faces.push(Face { first, count, material: self.material, line });
        Ok(())
    }

    fn smooth(&mut self, group: &str) {
        if self.smoothing.as_deref() != Some(group) {
            self.obj.smoothing_changes += usize::from(self.smoothing.is_some());
            self.smoothing = Some(group.to_owned());
            self.first_smoothing.get_or_insert_with(|| group.to_owned());
        }
    }

    /// Returns a mark of the faces that follow.
    fn mark(&self, name: &str) -> Mark {
        Mark { face: self.obj.faces.len() as u32, name: name.to_owned() }
    }

    fn use_material(&mut self, name: &str) {
        let next = self.obj.material_names.len() as u32;
        self.material = *self.material_ids.entry(name.to_owned()).or_insert(next);
        if self.material == next {
            self.obj.material_names.push(name.to_owned());
        }
    }
}

/// The content of the blocks, one behind the other.
struct Whole {
    obj: Obj,
    material: u32,
    material_ids: HashMap<String, u32>,
    smoothing: Option<String>,
}

impl Default for Whole {
    fn default() -> Self {
        Self { obj: Obj::default(), material: NONE, material_ids: HashMap::new(), smoothing: None }
    }
}

impl Whole {
    /// Appends the content of the next block.
    fn take(&mut self, parser: Parser, warnings: &mut Warnings) {
        warnings.absorb(parser.warnings);
        let mut block = parser.obj;
        let materials: Vec<u32> = block.material_names.drain(..).map(|name| self.material_id(name)).collect();
        let first = self.obj.corners.len() as u32;
        for face in &mut block.faces {
            face.first += first;
            face.material = materials.get(face.material as usize).copied().unwrap_or(self.material);
        }
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

/// Says whether a statement changes nothing in the image: merging groups, and the attributes of free-form geometry.
fn is_harmless(keyword: &str) -> bool {
    const KEYWORDS: [&str; 34] = [
        "mg",
        "vp",
        "lod",
        "bevel",
        "c_interp",
        "d_interp",
        "usemap",
        "maplib",
        "shadow_obj",
        "trace_obj",
        "ctech",
        "stech",
        "cstype",
        "deg",
        "bmat",
        "step",
        "parm",
        "trim",
        "hole",
        "scrv",
        "sp",
        "end",
        "con",
        "call",
        "csh",
        "bsp",
        "bzp",
        "cdc",
        "cdp",
        "res",
        "vc",
        "vw",
        "vnr",
        "version",
    ];
    KEYWORDS.contains(&keyword)
}

fn tokens(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_ascii_whitespace().take_while(|token| !token.starts_with('#'))
}

/// Writes the numbers of `rest` to `values` and returns how many there were; those beyond `values` are left out.
fn fill(rest: &str, values: &mut [f32]) -> std::result::Result<usize, String> {
    let mut count = 0;
    for (value, token) in values.iter_mut().zip(tokens(rest)) {
        *value = token.parse().map_err(|_| format!("{} is not a number; mend the file", quote(token)))?;
        count += 1;
    }
    Ok(count)
}

/// Returns the first `N` numbers of `rest`, of which at least `needed` must be there; the others are 0.
fn numbers<const N: usize>(rest: &str, needed: usize) -> std::result::Result<[f32; N], String> {
    let mut values = [0.0; N];
    match fill(rest, &mut values)? {
        count if count < needed => Err(format!("{count} numbers; {needed} are needed")),
        _ => Ok(values),
    }
}

/// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`, where negative indices count back from the last element so far.
fn corner(token: &str, counts: [usize; 3]) -> std::result::Result<Corner, String> {
    let mut corner = [NONE; 3];
    let mut parts = token.split('/');
    for ((index, count), name) in corner.iter_mut().zip(counts).zip(["vertex", "uv", "normal"]) {
        match parts.next() {
            None | Some("") => {}
            Some(part) => *index = resolve(part, count).map_err(|why| format!("{name} index {why}"))?,
        }
    }
    if corner[0] == NONE || parts.next().is_some() {
        return Err(format!("{} is not of the form v, v/vt, v//vn or v/vt/vn; mend the file", quote(token)));
    }
    Ok(corner)
}

fn resolve(part: &str, count: usize) -> std::result::Result<u32, String> {
    let index: i64 =
        part.parse().map_err(|_| format!("{} is not a whole number; mend the file", quote(part)))?;
    let from_zero = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
    match u32::try_from(from_zero) {
        Ok(found) if found != NONE => Ok(found),
        _ if index == 0 => Err("0 means nothing; indices count from 1".to_owned()),
        _ => Err(format!("{index} is out of range, there are {count}; mend the file")),
    }
}

/// Checks the range of all indices at the end, since they may name elements that follow later.
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
        format!("{name} index {index} is out of range, there are {count}; mend the file")
    });
    Err(Error::parse(path, format!("line {line}"), what.take(1).collect::<String>()))
}

#[cfg(test)]
mod tests {
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
        assert_eq!(error("v 0 0\n"), "a.obj: line 1: a vertex of 2 numbers; it needs 3");
        assert!(
            error("\nv nan 0 0").starts_with("a.obj: line 2: vertex position 'nan 0 0' is infinite or NaN")
        );
        assert!(error("v 0 0 1e40").contains("infinite"));
        assert!(error("v 1 1 1 0").contains("infinite"));
        assert!(error("v 0 0 0\nf 1 1 2").contains("line 2: vertex index 2 is out of range, there are 1"));
        assert!(error("v 0 0 0\nf 1 1 -2").contains("line 2: vertex index -2 is out of range, there are 1"));
        assert!(error("v 0 0 0\nf 1 1 0").contains("indices count from 1"));
        assert!(error("v 0 0 0\nf 1/1 1 1").contains("uv index 1 is out of range, there are 0"));
        assert!(error("v 0 0 0\nf 1 1 1/2/3/4").contains("not of the form"));
        assert!(error("v 0 0 0\nf 1 1 99999999999999999999").contains("not a whole number"));
        assert!(error("v 0 0 0\nf 1 1 4294967296").contains("out of range"));
        assert!(error("v 0 0 0\nf 1 1 -9223372036854775808").contains("out of range"));
        assert!(error("v 0 0 0\np 1\n").contains("no face (1 vertices)"));
    }

    #[test]
    fn what_is_not_drawn_is_counted() {
        let (obj, warnings) =
            parse_text("v 0 0 0 2\np 1\nl 1 1 1\nl 1 1\nf 1 1\nf 1 1 1\ncurv 0 1 1\n\u{7f}ELF");
        assert_eq!(obj.unwrap().faces.len(), 1);
        let counts: Vec<usize> = warnings.iter().map(|(_, n)| n).collect();
        assert_eq!(counts, [1, 2, 1, 1, 1]);
    }

    /// A file of several blocks is read as if it were one: relative indices count over their borders.
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

    #[test]
    fn colours_are_white_where_a_vertex_has_none() {
        let (obj, _) = parse_text("v 0 0 0\nv 1 0 0 .5 .25 1\nv 0 1 0\nf 1 2 3");
        assert_eq!(obj.unwrap().colors, [WHITE, [0.5, 0.25, 1.0], WHITE]);
    }
}
