//! Facets of an ASCII STL file in the layout that nearly all programs write, read in parallel.

use super::super::words::Words;
use crate::math::Vec3;
use crate::parallel;

/// Bytes of text that a thread reads at a time; a piece may be one facet longer.
const PIECE: usize = 1 << 20;

/// Returns the corners of all triangles of `text`; `None` if it contains anything but solids of facets in the usual
/// layout.
pub(super) fn read(text: &str) -> Option<Vec<Vec3>> {
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

#[cfg(test)]
mod tests {
    use super::super::solids;
    use super::*;
    use std::path::Path;

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
        let slow = solids::read(Path::new("a.stl"), text).map_err(|error| error.to_string());
        let fast = read(text);
        if let Some(corners) = &fast {
            assert_eq!(Ok(corners), slow.as_ref(), "{}", &text[..text.len().min(200)]);
        }
        (slow, fast.is_some())
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
