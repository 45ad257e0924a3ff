//! Solids of an ASCII STL file of any layout, with error messages.

use super::super::text;
use crate::error::{Error, Result};
use crate::math::Vec3;
use std::io::Cursor;
use std::path::Path;

/// Returns the corners of all triangles of the solids of `text`. `stl_io` reads one solid, with lower-case keywords.
///
/// # Errors
/// [`Error::Parse`] with the first unusable triangle, and if something else follows a solid.
pub(super) fn read(path: &Path, text: &str) -> Result<Vec<Vec3>> {
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
    Err(Error::parse(path, at, format!("expected `solid`, found {}; fix the file", text::quote(rest))))
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
pub(super) fn not_finite(path: &Path, at: String) -> Error {
    Error::parse(path, at, "a position is infinite or NaN; fix the file")
}

fn one_line(error: &std::io::Error) -> String {
    let text = error.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(160).collect()
}
