//! A corner of a face: its indices.

use super::super::text::quote;
use super::super::words::Words;

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
}
