//! The statements of an OBJ file, in blocks that are read independently of one another.

use super::super::polygon::Cutter;
use super::super::text::{Words, line_ends, lines, quote};
use super::content::{Face, Mark, Obj, corner, plain_corner};
use std::collections::HashMap;
use taotie_engine::error::Warnings;
use taotie_engine::math::{Vec2, Vec3};

/// The colour of a vertex without one.
pub(super) const WHITE: [f32; 3] = [1.0; 3];

/// In a [`Face`] of one block: the material of the previous block.
const INHERITED: u32 = u32::MAX - 1;

/// Reads one block.
pub(super) struct Parser {
    /// The start of the block; `None` if unknown, in which case relative indices are errors.
    start: Option<FileOffset>,
    /// The content of the block. Corners count from the start of the file, everything else from the start of the
    /// block.
    pub obj: Obj,
    /// The number of lines.
    pub lines: usize,
    /// Skipped statements, counted.
    pub warnings: Warnings,
    /// The material of the last statement.
    pub material: u32,
    material_ids: HashMap<String, u32>,
    /// The first smoothing group.
    pub first_smoothing: Option<String>,
    /// The last smoothing group.
    pub smoothing: Option<String>,
}

impl Parser {
    /// Creates a parser for a block that starts at `start`, if known.
    pub fn new(start: Option<FileOffset>) -> Self {
        Self {
            start,
            obj: Obj::default(),
            lines: 0,
            warnings: Warnings::default(),
            material: INHERITED,
            material_ids: HashMap::new(),
            first_smoothing: None,
            smoothing: None,
        }
    }

    /// Reads all statements; an error includes its line.
    pub fn block(mut self, block: &str) -> std::result::Result<Self, (usize, String)> {
        let before = self.start.map_or(0, |start| start.lines);
        let read = if block.contains('\\') { self.joined_lines(block) } else { self.lines(block) };
        read.map_err(|(line, what)| (before + line, what))?;
        self.lines = line_ends(block.as_bytes());
        if !self.obj.colors.is_empty() {
            self.obj.colors.resize(self.obj.positions.len(), WHITE);
        }
        Ok(self)
    }

    /// Reads statements that may continue on the next line.
    fn joined_lines(&mut self, block: &str) -> std::result::Result<(), (usize, String)> {
        lines(block)
            .try_for_each(|(line, statement)| self.statement(&statement, line).map_err(|what| (line, what)))
    }

    /// Reads statements on one line each.
    fn lines(&mut self, block: &str) -> std::result::Result<(), (usize, String)> {
        let (mut rest, mut line) = (block, 0);
        while !rest.is_empty() {
            line += 1;
            if let Some(behind) = self.plain(rest.as_bytes(), line).and_then(|length| rest.get(length..)) {
                rest = behind;
                continue;
            }
            let (statement, behind) = rest.split_once('\n').unwrap_or((rest, ""));
            let statement = statement.trim();
            if !statement.is_empty() && !statement.starts_with('#') {
                self.statement(statement, line).map_err(|what| (line, what))?;
            }
            rest = behind;
        }
        Ok(())
    }

    /// Reads the line at the start of `text` and returns its length in bytes if it is a vertex, uv, normal or face of
    /// plain numbers; otherwise reads nothing.
    #[inline]
    fn plain(&mut self, text: &[u8], line: usize) -> Option<usize> {
        let mut words = Words::new(text);
        match text {
            [b'v', b' ' | b'\t', ..] => {
                words.skip(2);
                let (values, count) = plain_numbers(&mut words)?;
                let [x, y, z, r, g, b] = values;
                let position = Vec3::new(x, y, z);
                if !matches!(count, 3 | 6) || !position.is_finite() {
                    return None;
                }
                self.push_vertex(position, (count > 3).then_some([r, g, b]));
            }
            [b'v', b't', b' ' | b'\t', ..] => {
                words.skip(3);
                let ([u, v, _], count) = plain_numbers(&mut words)?;
                (count > 0).then(|| self.obj.uvs.push(Vec2::new(u, v)))?;
            }
            [b'v', b'n', b' ' | b'\t', ..] => {
                words.skip(3);
                let (normal, count) = plain_numbers(&mut words)?;
                (count == 3).then(|| self.obj.normals.push(Vec3::from_array(normal)))?;
            }
            [b'f', b' ' | b'\t', ..] => {
                words.skip(2);
                self.plain_face(&mut words, line)?;
            }
            _ => return None,
        }
        Some(text.len() - words.rest().len())
    }

    fn plain_face(&mut self, words: &mut Words, line: usize) -> Option<()> {
        let first = self.obj.corners.len();
        let found = self.plain_corners(words);
        let count = self.obj.corners.len() - first;
        if found.is_none() || !(3..=Cutter::MAX_CORNERS).contains(&count) {
            self.obj.corners.truncate(first);
            return None;
        }
        self.push_face(first, line);
        Some(())
    }

    /// Reads the remaining corners of a line, up to the first that is not plain.
    fn plain_corners(&mut self, words: &mut Words) -> Option<()> {
        while !words.at_end_of_line() {
            self.obj.corners.push(plain_corner(words)?);
        }
        words.end_line()
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
            "call" | "csh" => warnings.note("skipped statements that include other files", 1),
            "curv" | "curv2" | "surf" | "bsp" | "bzp" | "cdc" | "cdp" => {
                warnings.note("free-form curves and surfaces are not drawn", 1)
            }
            _ if is_harmless(keyword) => {}
            _ => warnings.note("skipped unrecognised lines", 1),
        }
        Ok(())
    }

    /// Reads `v x y z`, `v x y z w`, `v x y z r g b` or `v x y z r g b a`; as in other readers, w divides.
    fn vertex(&mut self, rest: &str) -> std::result::Result<(), String> {
        let mut values = [0.0; 7];
        let count = fill(rest, &mut values)?;
        let [x, y, z, r, g, b, alpha] = values;
        self.warnings.note("ignored alpha of vertex colours", usize::from(count == 7 && alpha != 1.0));
        let mut position = Vec3::new(x, y, z);
        if count < 3 {
            return Err(format!("vertex with {count} numbers; expected at least 3"));
        }
        if count == 4 {
            position = position / r;
        }
        if !position.is_finite() {
            return Err(format!("vertex position {} is infinite or NaN; fix the file", quote(rest)));
        }
        self.push_vertex(position, (count >= 6).then_some([r, g, b]));
        Ok(())
    }

    #[inline]
    fn push_vertex(&mut self, position: Vec3, color: Option<[f32; 3]>) {
        if color.is_some() && self.obj.colors.is_empty() {
            self.obj.colors.resize(self.obj.positions.len(), WHITE);
        }
        if color.is_some() || !self.obj.colors.is_empty() {
            self.obj.colors.push(color.unwrap_or(WHITE));
        }
        self.obj.positions.push(position);
    }

    /// Adds the face whose corners start at `first`.
    fn push_face(&mut self, first: usize, line: usize) {
        let count = (self.obj.corners.len() - first) as u32;
        let (first, line) = (first as u32, line as u32);
        self.obj.faces.push(Face { first, count, material: self.material, line });
    }

    fn face(&mut self, rest: &str, line: usize) -> std::result::Result<(), String> {
        if self.start.is_none() && rest.contains('-') {
            return Err("relative index".to_owned());
        }
        let [positions, uvs, normals] = self.start.unwrap_or_default().counts;
        let Obj { positions: p, uvs: t, normals: n, .. } = &self.obj;
        let counts = [positions + p.len(), uvs + t.len(), normals + n.len()];
        let first = self.obj.corners.len();
        for token in tokens(rest) {
            self.obj.corners.push(corner(token, counts)?);
        }
        let count = self.obj.corners.len() - first;
        if count < 3 {
            self.obj.corners.truncate(first);
            self.warnings.note("skipped faces with fewer than three corners", 1);
            return Ok(());
        }
        if count > Cutter::MAX_CORNERS {
            return Err(format!("face with {count} corners; the maximum is {}", Cutter::MAX_CORNERS));
        }
        self.push_face(first, line);
        Ok(())
    }

    fn smooth(&mut self, group: &str) {
        if self.smoothing.as_deref() != Some(group) {
            self.obj.smoothing_changes += usize::from(self.smoothing.is_some());
            self.smoothing = Some(group.to_owned());
            self.first_smoothing.get_or_insert_with(|| group.to_owned());
        }
    }

    /// Returns a mark for the faces that follow.
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

/// Returns `true` if a statement does not affect the image: merging groups, and attributes of free-form geometry.
fn is_harmless(keyword: &str) -> bool {
    const KEYWORDS: [&str; 28] = [
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

/// Writes the numbers of `rest` to `values` and returns how many there were; any beyond `values` are dropped.
fn fill(rest: &str, values: &mut [f32]) -> std::result::Result<usize, String> {
    let mut count = 0;
    for (value, token) in values.iter_mut().zip(tokens(rest)) {
        *value = token.parse().map_err(|_| format!("{} is not a number; fix the file", quote(token)))?;
        count += 1;
    }
    Ok(count)
}

/// Reads all numbers of a line and returns their count; `None` if there are more than `N`, or other words.
#[inline]
fn plain_numbers<const N: usize>(words: &mut Words) -> Option<([f32; N], usize)> {
    let (mut values, mut count) = ([0.0; N], 0);
    while !words.at_end_of_line() {
        *values.get_mut(count)? = words.number()?;
        count += 1;
    }
    words.end_line()?;
    Some((values, count))
}

/// Returns the first `N` numbers of `rest`, at least `needed` of which must exist; the others are 0.
fn numbers<const N: usize>(rest: &str, needed: usize) -> std::result::Result<[f32; N], String> {
    let mut values = [0.0; N];
    match fill(rest, &mut values)? {
        count if count < needed => Err(format!("{count} numbers; expected at least {needed}")),
        _ => Ok(values),
    }
}

/// Bytes per block; a block may be one line longer.
const BLOCK: usize = 1 << 20;

/// An offset in a file, in lines and entries.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FileOffset {
    /// The number of lines.
    pub lines: usize,
    /// The numbers of positions, uvs and normals.
    pub counts: [usize; 3],
}

impl FileOffset {
    /// Counts the content of `text`.
    pub fn of(text: &str) -> Self {
        let mut counts = [0; 3];
        for (_, statement) in lines(text) {
            match split_keyword(&statement).0 {
                "v" => counts[0] += 1,
                "vt" => counts[1] += 1,
                "vn" => counts[2] += 1,
                _ => {}
            }
        }
        Self { lines: line_ends(text.as_bytes()), counts }
    }

    /// Advances by `length` and returns the previous offset.
    pub fn advance(&mut self, length: &Self) -> Self {
        let so_far = *self;
        self.lines += length.lines;
        self.counts.iter_mut().zip(length.counts).for_each(|(count, more)| *count += more);
        so_far
    }
}

/// Returns the keyword of a statement, and the words that follow it.
fn split_keyword(statement: &str) -> (&str, &str) {
    statement.split_once(char::is_whitespace).unwrap_or((statement, ""))
}

/// Splits `text` into blocks of whole statements, which are read in parallel: after lines that do not continue on the
/// next.
pub(super) fn blocks(text: &str) -> Vec<&str> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let (block, behind) = rest.split_at(end_of_block(rest));
        blocks.push(block);
        rest = behind;
    }
    blocks
}

fn end_of_block(text: &str) -> usize {
    let mut from = BLOCK.min(text.len());
    while let Some(more) = text.as_bytes()[from..].iter().position(|b| *b == b'\n') {
        from += more + 1;
        let last = text[..from].lines().next_back().unwrap_or_default();
        if !last.trim_end().ends_with('\\') {
            return from;
        }
    }
    text.len()
}
