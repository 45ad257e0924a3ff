//! Light positions of dome photography (`.lp`): a count, then one line `NAME X Y Z` for each photograph.
//!
//! Programs disagree on everything else. Also read: decimal commas, a number instead of a name, no name, spaces in
//! names, quotes, tabs and semicolons, a missing count, comments from `#`, and vectors of any length.

use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_io::{parse, quote};

/// One line of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its number, from 1.
    pub line: usize,
    /// The photograph: a file name, a path, or a number; empty if the line has only a vector.
    pub name: String,
    /// The vector towards the light, of any length except 0.
    pub vector: [f64; 3],
}

/// The most lights of a file.
const MOST: usize = 4096;

/// The longest line that is read, bytes.
const LONGEST: usize = 4096;

/// Reads the text of an `.lp` file; `path` is named in errors.
///
/// # Errors
/// [`Error::Parse`] with the line that is wrong, [`Error::Limit`] for more than 4,096 lights.
pub fn parse_lp(path: &Path, text: &str) -> Result<Vec<Entry>> {
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.by_ref().filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let Some(&(first, line)) = lines.peek() else {
        return Err(Error::parse(
            path,
            "line 1",
            "no lights: expected their number, then a line `NAME X Y Z` for each",
        ));
    };
    let count = stated_count(path, first, line)?;
    if count.is_some() {
        lines.next();
    }
    let mut entries = Vec::new();
    for (number, line) in lines {
        if entries.len() == MOST {
            return Err(Error::limit(path.display().to_string(), format!("at most {MOST} lights")));
        }
        let entry = entry(number, line);
        entries.push(entry.map_err(|what| Error::parse(path, format!("line {number}"), what))?);
    }
    check_count(path, count.map(|count| (first, count)), entries.len())?;
    check_names(path, &entries)?;
    Ok(entries)
}

/// Returns the number of lights that the first line states; `None` if it is a light itself.
fn stated_count(path: &Path, number: usize, line: &str) -> Result<Option<u64>> {
    if line.contains(is_gap) || line.matches(',').count() > 1 {
        return Ok(None);
    }
    line.parse().map(Some).map_err(|_| {
        let what = format!("expected the number of lights, found {}", quote(line));
        Error::parse(path, format!("line {number}"), what)
    })
}

fn check_count(path: &Path, stated: Option<(usize, u64)>, found: usize) -> Result<()> {
    match stated {
        _ if found == 0 => {
            Err(Error::parse(path, "the end", "no lights: expected a line `NAME X Y Z` for each photograph"))
        }
        Some((line, count)) if count != found as u64 => {
            let what = format!("{count} lights stated, but {found} follow; correct the number or the list");
            Err(Error::parse(path, format!("line {line}"), what))
        }
        _ => Ok(()),
    }
}

/// Rejects a file in which only some lines have names.
fn check_names(path: &Path, entries: &[Entry]) -> Result<()> {
    let is_unnamed = entries[0].name.is_empty();
    match entries.iter().find(|entry| entry.name.is_empty() != is_unnamed) {
        Some(other) => {
            let what = "some lines have a name and others do not; name all photographs or none";
            Err(Error::parse(path, format!("line {}", other.line), what))
        }
        None => Ok(()),
    }
}

fn is_gap(c: char) -> bool {
    c.is_whitespace() || c == ';'
}

fn entry(line: usize, text: &str) -> std::result::Result<Entry, String> {
    if text.len() > LONGEST {
        return Err(format!("{} bytes long; expected `NAME X Y Z`", text.len()));
    }
    let [name, x, y, z] = fields(text)
        .ok_or_else(|| format!("expected `NAME X Y Z`, found {}; add the missing numbers", quote(text)))?;
    let mut vector = [0.0; 3];
    for (value, word) in vector.iter_mut().zip([x, y, z]) {
        *value = number(word)?;
    }
    if vector.iter().all(|v| v.abs() < 1e-9) {
        return Err("the vector towards the light is zero; correct its numbers".to_owned());
    }
    let name = name.trim_matches(|c| c == '"' || c == '\'').trim();
    Ok(Entry { line, name: name.to_owned(), vector })
}

/// Returns the name and the last three words of a line; `None` if there are fewer.
fn fields(text: &str) -> Option<[&str; 4]> {
    let mut words = [""; 3];
    let mut rest = text.trim_end_matches(|c| is_gap(c) || c == ',');
    // Commas without spaces separate; otherwise they are decimal or trail a word.
    let separates = |c: char| if text.contains(is_gap) { is_gap(c) } else { c == ',' };
    for (i, word) in words.iter_mut().enumerate().rev() {
        let from = match rest.rfind(separates) {
            Some(at) => at + rest[at..].chars().next().map_or(1, char::len_utf8),
            None if i == 0 => 0,
            None => return None,
        };
        *word = &rest[from..];
        rest = rest[..from].trim_end_matches(|c| separates(c) || is_gap(c));
        if i > 0 || !rest.is_empty() {
            rest = rest.strip_suffix(',').unwrap_or(rest);
        }
    }
    let [x, y, z] = words.map(|word| word.trim_end_matches(','));
    Some([rest, x, y, z])
}

/// Parses a number with a decimal point or a decimal comma.
fn number(word: &str) -> std::result::Result<f64, String> {
    let single_comma = word.matches(',').count() == 1 && !word.contains('.');
    let text = if single_comma { word.replace(',', ".") } else { word.to_owned() };
    parse::number(&text).map_err(|_| {
        format!(
            "{} is not a number; expected the direction of the light as three, such as 0.1 0.2 0.97",
            quote(word)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(String, [f64; 3])> {
        let entries = parse_lp(Path::new("a.lp"), text).unwrap();
        entries.into_iter().map(|entry| (entry.name, entry.vector)).collect()
    }

    #[test]
    fn all_ways_to_write_a_light_are_read() {
        let v = [0.1, -0.25, 0.5];
        let same = |text: &str, name: &str| {
            assert_eq!(read(&format!("1\r\n{text}\r\n")), [(name.to_owned(), v)], "{text}");
        };
        same("a.jpg 0.1 -0.25 0.5", "a.jpg");
        same("a.jpg\t0,1\t-0,25\t0,5", "a.jpg");
        same("a.jpg;0,1;-0,25;0,5", "a.jpg");
        same("a.jpg 0.1, -0.25, 0.5", "a.jpg");
        same("a.jpg, 0.1, -0.25, 0.5", "a.jpg");
        same("a.jpg,0.1,-0.25,0.5", "a.jpg");
        same("0.1,-0.25,0.5", "");
        same("7 0.1 -0.25 0.5", "7");
        same("0.1 -0.25 0.5", "");
        same("  my first photo.jpg   1e-1  -.25 +0.5 ", "my first photo.jpg");
        same("\"C:\\dome\\a 1.jpg\" 0.1 -0.25 0.5", "C:\\dome\\a 1.jpg");
        same("müller.jpg 0.1\u{a0}-0.25 0.5", "müller.jpg");
    }

    #[test]
    fn counts_comments_and_empty_lines_may_be_missing_or_there() {
        let two = [("a".to_owned(), [0.0, 0.0, 1.0]), ("b".to_owned(), [0.0, 1.0, 1.0])];
        for text in
            ["2\na 0 0 1\nb 0 1 1", "a 0 0 1\nb 0 1 1\n", "# dome\n\n 2 \n\na 0 0 1\n# x\nb 0 1 1\n\n"]
        {
            assert_eq!(read(text), two, "{text}");
        }
    }

    #[test]
    fn the_line_and_the_fault_are_named() {
        let why = |text: &str| parse_lp(Path::new("a.lp"), text).unwrap_err().to_string();
        assert_eq!(
            why("2\na 0 0 1"),
            "a.lp: line 1: 2 lights stated, but 1 follow; correct the number or the list"
        );
        assert!(
            why("1\na 0 1").contains("line 2: expected `NAME X Y Z`, found 'a 0 1'")
                || why("1\na 0 1").contains("'a' is not a number")
        );
        assert!(why("1\na 0 0 x").contains("line 2: 'x' is not a number"));
        assert!(why("1\na 0 0 0").contains("is zero"));
        assert!(why("2\na 0 0 1\n0 0 1").contains("line 3: some lines have a name"));
        assert!(why("").contains("no lights") && why("3").contains("no lights"));
    }
}
