//! STL: separate triangles, ASCII or binary, welded if positions are bitwise equal.
//!
//! Facets of an ASCII file in the usual layout are read here in parallel; any other layout is left to `stl_io`, which
//! also reports what is wrong.

use super::loaded::{Loaded, checked};
use super::obj::neutral;
use super::reading::Reading;
use super::text::{Words, decode_text, quote};
use std::io::Cursor;
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::{Mesh, MeshData, first};
use taotie_engine::parallel;
use taotie_engine::scene::{Instance, SceneData};
use taotie_engine::surface::{Classes, bits};

/// Bytes before the first triangle of a binary file: an 80-byte header and a count.
const BINARY_START: usize = 84;
/// Bytes per triangle in a binary file.
const BINARY_TRIANGLE: usize = 50;
/// Bytes needed per byte of a binary file, as if no triangles shared corners: only reading them would show that.
const BINARY_MADE: u64 = 4;
/// The same for an ASCII file, whose shortest triangles have ninety bytes.
const ASCII_MADE: u64 = 3;

/// Reads an STL file into one mesh without normals, since those in the file are per triangle.
///
/// All solids of an ASCII file are combined. A file is binary if its length matches its triangle count, whatever it
/// starts with; otherwise it is ASCII if it starts with `solid`.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Limit`] if it does not fit in memory, [`Error::Parse`] with the
/// first unusable triangle, or if there are no triangles.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let bytes = reading.read_own(path)?;
    let is_ascii = is_ascii(&bytes);
    reading.count_file(path, if is_ascii { ASCII_MADE } else { BINARY_MADE })?;
    let mut warnings = Warnings::default();
    let data = if is_ascii {
        let corners = ascii(path, &decode_text(bytes))?;
        welded(corners.len(), |c| corners[c])
    } else {
        binary(path, &bytes, &mut warnings)?
    };
    if data.triangles.is_empty() {
        return Err(Error::parse(path, "whole file", "no triangles; re-export the model"));
    }
    let mesh = Mesh::new(data)?;
    warnings.note("triangles without area", mesh.degenerate_triangles());
    let scene = SceneData {
        meshes: vec![mesh],
        materials: vec![neutral("")],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    };
    Ok(Loaded::new(checked(path, scene)?, warnings, "STL"))
}

fn is_ascii(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let says_solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    says_solid && declared(bytes).is_none_or(|count| BINARY_START + count * BINARY_TRIANGLE != bytes.len())
}

/// Returns the triangle count of a binary file.
fn declared(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..BINARY_START)?;
    Some(u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize)
}

/// Returns the mesh of a binary file.
fn binary(path: &Path, bytes: &[u8], warnings: &mut Warnings) -> Result<MeshData> {
    let Some(count) = declared(bytes) else {
        let what = format!("{} bytes are too few for an STL file", bytes.len());
        return Err(Error::parse(path, "header", what));
    };
    let (there, _) = bytes[BINARY_START..].as_chunks::<BINARY_TRIANGLE>();
    let Some(triangles) = there.get(..count) else {
        let there = there.len();
        let what = format!("{count} triangles declared, but the file ends after {there}; it is truncated");
        return Err(Error::parse(path, "header", what));
    };
    warnings
        .note("bytes after the last triangle", bytes.len() - BINARY_START - triangles.as_flattened().len());
    note_colors(bytes, triangles, warnings);
    let is_bad = |t: &[u8; BINARY_TRIANGLE]| (0..3).any(|corner| !stored_corner(t, corner).is_finite());
    match first(triangles, is_bad) {
        Some(i) => Err(not_finite(path, format!("triangle {i}"))),
        None => Ok(welded(3 * count, |c| stored_corner(&triangles[c / 3], c % 3))),
    }
}

/// Notes colours, which are not read: VisCAM and SolidView set the highest bit of a triangle's attribute word if it is a
/// colour; Magics clears it, and states the colour of all other triangles in the header. Words that are neither may be
/// anything.
fn note_colors(header: &[u8], triangles: &[[u8; BINARY_TRIANGLE]], warnings: &mut Warnings) {
    let is_magics = header[..80].windows(6).any(|word| word == b"COLOR=");
    warnings.note("ignored the colour in the header", usize::from(is_magics));
    let word = |t: &[u8; BINARY_TRIANGLE]| u16::from_le_bytes([t[48], t[49]]);
    let is_colored = |t: &&[u8; BINARY_TRIANGLE]| (word(t) >> 15 == 0) == is_magics;
    let is_other = |t: &&[u8; BINARY_TRIANGLE]| word(t) != 0 && !is_magics && !is_colored(t);
    warnings.note("ignored colours of triangles", triangles.iter().filter(is_colored).count());
    warnings.note("ignored attributes of triangles", triangles.iter().filter(is_other).count());
}

/// Returns a corner of a triangle in a binary file; the normal precedes the first.
fn stored_corner(triangle: &[u8; BINARY_TRIANGLE], corner: usize) -> Vec3 {
    let (words, _) = triangle[12 * (corner + 1)..].as_chunks::<4>();
    Vec3::new(f32::from_le_bytes(words[0]), f32::from_le_bytes(words[1]), f32::from_le_bytes(words[2]))
}

/// Returns the corners of all triangles of an ASCII file. Lines may end in any of the three ways.
fn ascii(path: &Path, text: &str) -> Result<Vec<Vec3>> {
    if text.contains('\r') && !text.contains('\n') {
        return ascii(path, &text.replace('\r', "\n"));
    }
    match read_facets(text) {
        Some(corners) => Ok(corners),
        None => read_solids(path, text),
    }
}

/// Welds triangle corners at equal positions into one vertex.
fn welded(corners: usize, corner: impl Fn(usize) -> Vec3 + Sync) -> MeshData {
    let places = Classes::by(corners, |c| bits(corner(c).to_array()));
    MeshData {
        positions: parallel::collect(places.firsts.len(), |i| corner(places.firsts[i] as usize)),
        triangles: places.of.as_chunks::<3>().0.to_vec(),
        ..MeshData::default()
    }
}

/// Bytes of text that a thread reads at a time; a piece may be one facet longer.
const PIECE: usize = 1 << 20;

/// Returns the corners of all triangles of `text`, read in parallel; `None` if it contains anything but solids of
/// facets in the layout that nearly all programs write.
fn read_facets(text: &str) -> Option<Vec<Vec3>> {
    let pieces = pieces(text.as_bytes());
    let mut corners = Vec::new();
    let numbers: Vec<usize> = (0..pieces.len()).collect();
    for group in numbers.chunks(4 * rayon::current_num_threads()) {
        for piece in parallel::tasks(group.len(), &|i| read_piece(&pieces, group[i])) {
            corners.append(&mut piece?);
        }
    }
    Some(corners)
}

/// Splits text before lines that start a facet.
fn pieces(mut text: &[u8]) -> Vec<&[u8]> {
    let mut pieces = Vec::new();
    while !text.is_empty() {
        let (piece, rest) = text.split_at(end_of_piece(text));
        pieces.push(piece);
        text = rest;
    }
    pieces
}

fn end_of_piece(text: &[u8]) -> usize {
    let mut words = Words::new(text);
    words.skip(PIECE);
    while !words.rest().is_empty() {
        words.skip_line();
        let start = text.len() - words.rest().len();
        if words.keyword(b"facet").is_some() {
            return start;
        }
    }
    text.len()
}

/// Returns the corners of a piece. The first one starts before a solid, the last one ends after one, and all others
/// start and end within one.
fn read_piece(pieces: &[&[u8]], number: usize) -> Option<Vec<Vec3>> {
    let mut words = Words::new(pieces[number]);
    let is_last = number + 1 == pieces.len();
    let mut corners = Vec::new();
    if number == 0 {
        begin_solid(&mut words)?;
    }
    loop {
        words.skip_empty_lines();
        if words.rest().is_empty() {
            return (!is_last).then_some(corners);
        }
        if words.keyword(b"endsolid").is_none() {
            corners.extend(facet(&mut words)?);
            continue;
        }
        words.skip_line();
        words.skip_empty_lines();
        if words.rest().is_empty() {
            return is_last.then_some(corners);
        }
        begin_solid(&mut words)?;
    }
}

/// Skips the line that starts a solid, whatever its name.
fn begin_solid(words: &mut Words) -> Option<()> {
    words.skip_empty_lines();
    words.skip_blanks();
    let start = words.rest().get(..5)?;
    let is_solid = start.eq_ignore_ascii_case(b"solid") && words.rest().contains(&b'\n');
    is_solid.then(|| words.skip_line())
}

/// Returns the corners of a facet, if its normal is finite too.
fn facet(words: &mut Words) -> Option<[Vec3; 3]> {
    words.keyword(b"facet")?;
    words.keyword(b"normal")?;
    point(words)?;
    line(words, &[b"outer", b"loop"])?;
    let corners = [corner(words)?, corner(words)?, corner(words)?];
    line(words, &[b"endloop"])?;
    line(words, &[b"endfacet"])?;
    Some(corners)
}

fn corner(words: &mut Words) -> Option<Vec3> {
    words.skip_empty_lines();
    words.keyword(b"vertex")?;
    point(words)
}

/// Returns the three finite numbers at the end of a line.
fn point(words: &mut Words) -> Option<Vec3> {
    let point = Vec3::new(words.number()?, words.number()?, words.number()?);
    words.end_line()?;
    point.is_finite().then_some(point)
}

/// Skips a line with these words.
fn line(words: &mut Words, all: &[&[u8]]) -> Option<()> {
    words.skip_empty_lines();
    all.iter().try_for_each(|word| words.keyword(word))?;
    words.end_line()
}

/// Returns the corners of all triangles of the solids of `text`, of any layout. `stl_io` reads one solid, with
/// lower-case keywords.
///
/// # Errors
/// [`Error::Parse`] with the first unusable triangle, and if something else follows a solid.
fn read_solids(path: &Path, text: &str) -> Result<Vec<Vec3>> {
    let text = text.to_ascii_lowercase();
    let mut corners = Vec::new();
    let mut solids = 0;
    let mut rest = text.trim_start();
    while rest.starts_with("solid") {
        let line = rest.find('\n').unwrap_or(rest.len());
        let end = rest.match_indices("endsolid").map(|(i, _)| i).find(|i| *i > line).unwrap_or(rest.len());
        let mut solid = String::from("solid \n");
        solid.push_str(rest[line..end].trim());
        solid.push_str(if end < rest.len() { "\nendsolid\n" } else { "\n" });
        solids += 1;
        read_solid(path, &solid, &format!("solid {solids}, triangle"), &mut corners)?;
        let after = &rest[end..];
        rest = after[after.find('\n').unwrap_or(after.len())..].trim_start();
    }
    if rest.is_empty() {
        return Ok(corners);
    }
    let at = format!("after solid {solids}");
    Err(Error::parse(path, at, format!("expected `solid`, found {}; fix the file", quote(rest))))
}

fn read_solid(path: &Path, solid: &str, at: &str, corners: &mut Vec<Vec3>) -> Result<()> {
    let mut source = Cursor::new(solid.as_bytes());
    let triangles =
        stl_io::create_stl_reader(&mut source).map_err(|e| Error::parse(path, "header", one_line(&e)))?;
    for (i, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|e| Error::parse(path, format!("{at} {i}"), one_line(&e)))?;
        let points = triangle.vertices.map(|v| Vec3::from_array(v.0));
        if !points.iter().all(|p| p.is_finite()) {
            return Err(not_finite(path, format!("{at} {i}")));
        }
        corners.extend(points);
    }
    Ok(())
}

/// Returns the error for a triangle with a non-finite position.
fn not_finite(path: &Path, at: String) -> Error {
    Error::parse(path, at, "a position is infinite or NaN; fix the file")
}

fn one_line(error: &std::io::Error) -> String {
    let text = error.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(160).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets(count: usize) -> String {
        let facet = |i: usize| {
            format!(
                "  facet normal 0 0 1e0\n    outer loop\n      vertex {i} 0 -1.5\n      vertex {}.25e-2 .5 1.\n      \
                 vertex 0 {:e} 12345678901234567890\n    endloop\n  endfacet\n",
                i * 7,
                i as f32 / 3.0
            )
        };
        (0..count).map(facet).collect()
    }

    /// Returns the corners as read both ways, and whether this one accepted the text.
    fn both(text: &str) -> (std::result::Result<Vec<Vec3>, String>, bool) {
        let slow = read_solids(Path::new("a.stl"), text).map_err(|error| error.to_string());
        let fast = read_facets(text);
        if let Some(corners) = &fast {
            assert_eq!(Ok(corners), slow.as_ref(), "{}", &text[..text.len().min(200)]);
        }
        (slow, fast.is_some())
    }

    #[test]
    fn lines_may_end_in_carriage_returns_only() {
        let text = format!("solid a\n{}endsolid a\n", facets(3));
        let read = |text: &str| ascii(Path::new("a.stl"), text).unwrap();
        assert_eq!(read(&text.replace('\n', "\r")), read(&text));
    }

    #[test]
    fn usual_lines_are_read_as_any_others() {
        let (many, few) = (facets(20_000), facets(2));
        assert!(many.len() > 3 * PIECE);
        for text in [
            format!("solid a b c\n{many}endsolid a b c\n"),
            format!("\n solid\n{many}endsolid\n\nsolid endsolid\n{many}ENDSOLID x\n solid2\n{few}endsolid"),
            format!("SOLID A\r\n{}EndSolid\r\n\r\n", many.to_uppercase().replace('\n', "\r\n\t\r\n")),
            "solid\nendsolid".to_owned(),
        ] {
            let (slow, taken) = both(&text);
            assert!(taken && slow.is_ok(), "{}", &text[..text.len().min(200)]);
        }
    }

    #[test]
    fn what_is_not_usual_is_left_to_the_other_reader() {
        let (many, few) = (facets(20_000), facets(2));
        let whole = format!("solid a\n{few}endsolid\n");
        let sound = [
            format!("solid a\n{}", few.trim_end()) + " endsolid",
            format!("solid a\n{few}endsolidity\n"),
            whole.replace(" vertex", "\u{2003}vertex"),
        ];
        for text in &sound {
            let (slow, taken) = both(text);
            assert!(!taken && slow.is_ok(), "{text}: {slow:?}");
        }
        let broken = [
            format!("solid a\n{many}"),
            format!("solid a\n{many}endsolid\n{few}"),
            format!("solid a\nendsolid\n{many}endsolid\n"),
            format!("{whole}solid"),
            whole.replacen("1e0", "nan", 1),
            whole.replacen("-1.5", "1e39", 1),
            whole.replacen("-1.5", "-1.5 2", 1),
            whole.replacen("-1.5", "-1,5", 1),
            whole.replacen("normal 0", "normal", 1),
            whole.replacen("outer loop", "outer\nloop", 1),
            whole.replacen("endloop", "endlop", 1),
            whole.replacen("    endloop\n", "", 1),
        ];
        for text in &broken {
            let (slow, taken) = both(text);
            assert!(!taken && slow.is_err(), "{}: {slow:?}", &text[..text.len().min(600)]);
        }
    }
}
