//! The layout of the DiLiGenT data set: `filenames.txt`, `light_directions.txt` and `light_intensities.txt`, with a line
//! for each photograph.

use crate::light::Light;
use std::path::PathBuf;
use taotie_engine::error::{Error, Result};
use taotie_io::{parse, quote};

/// The names of the files.
pub const FILES: [&str; 3] = ["filenames.txt", "light_directions.txt", "light_intensities.txt"];

/// A text file by its path.
pub struct Text {
    /// Its path.
    pub path: PathBuf,
    /// Its content.
    pub text: String,
}

/// Returns the name of each photograph with its line and light. Without intensities they are all 1.
///
/// # Errors
/// [`Error::Parse`] with the file and line that is wrong, or with two files of different lengths.
pub fn parse_diligent(
    names: &Text,
    directions: &Text,
    intensities: Option<&Text>,
) -> Result<Vec<(usize, String, Light)>> {
    let all_names: Vec<(usize, &str)> = lines(&names.text).collect();
    let vectors = numbers(directions)?;
    same_count(names, all_names.len(), directions, vectors.len())?;
    let strengths = intensities.map(numbers).transpose()?;
    if let (Some(file), Some(strengths)) = (intensities, &strengths) {
        same_count(names, all_names.len(), file, strengths.len())?;
    }
    let light = |i: usize| -> Result<Light> {
        let (line, vector) = vectors[i];
        let zero =
            || Error::parse(&directions.path, format!("line {line}"), "the direction is zero; correct it");
        let light = Light::towards(vector).ok_or_else(zero)?;
        let Some((line, intensity)) = strengths.as_ref().map(|all| all[i]) else { return Ok(light) };
        let Some(file) = intensities.filter(|_| !intensity.iter().all(|v| *v > 0.0)) else {
            return Ok(Light { intensity, ..light });
        };
        Err(Error::parse(&file.path, format!("line {line}"), "intensities must be above 0; correct them"))
    };
    all_names.iter().enumerate().map(|(i, (line, name))| Ok((*line, (*name).to_owned(), light(i)?))).collect()
}

fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())).filter(|(_, line)| !line.is_empty())
}

fn numbers(file: &Text) -> Result<Vec<(usize, [f64; 3])>> {
    let vector = |(number, line): (usize, &str)| {
        let words: Vec<f64> = line
            .split(|c: char| c.is_whitespace() || c == ',')
            .filter(|word| !word.is_empty())
            .map_while(|word| parse::number(word).ok())
            .collect();
        let count =
            line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).count();
        match (words.as_slice(), count) {
            ([x, y, z], 3) => Ok((number, [*x, *y, *z])),
            _ => {
                let what = format!("expected three numbers, found {}", quote(line));
                Err(Error::parse(&file.path, format!("line {number}"), what))
            }
        }
    };
    lines(&file.text).map(vector).collect()
}

fn same_count(a: &Text, of_a: usize, b: &Text, of_b: usize) -> Result<()> {
    let name = a.path.file_name().unwrap_or_default().to_string_lossy();
    let what = format!("{of_b} lines, but {name} has {of_a}; each needs one for each photograph");
    if of_a == of_b { Ok(()) } else { Err(Error::parse(&b.path, "the end", what)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn text(name: &str, text: &str) -> Text {
        Text { path: Path::new(name).to_path_buf(), text: text.to_owned() }
    }

    #[test]
    fn lights_are_those_of_their_lines() {
        let names = text("filenames.txt", "001.png\r\n002.png\r\n");
        let directions = text("light_directions.txt", "0 0 2\n0.6 0 0.8\n");
        let read = parse_diligent(&names, &directions, Some(&text("i.txt", "1 2 3\n4 5 6"))).unwrap();
        assert_eq!(
            (read[0].1.as_str(), read[0].2.direction.z, read[1].2.intensity),
            ("001.png", 1.0, [4.0, 5.0, 6.0])
        );
        let plain = parse_diligent(&names, &directions, None).unwrap();
        assert_eq!(plain[1].2.intensity, [1.0; 3]);
    }

    #[test]
    fn the_file_and_the_line_are_named() {
        let names = text("filenames.txt", "001.png\n002.png\n");
        let why = |directions: &str, intensities: &str| {
            let [d, i] = [text("d.txt", directions), text("i.txt", intensities)];
            parse_diligent(&names, &d, Some(&i)).unwrap_err().to_string()
        };
        assert!(why("0 0 1", "1 1 1\n1 1 1").contains("d.txt: the end: 1 lines, but filenames.txt has 2"));
        assert!(
            why("0 0 1\n0 0", "1 1 1\n1 1 1").contains("d.txt: line 2: expected three numbers, found '0 0'")
        );
        assert!(why("0 0 1\n0 0 0", "1 1 1\n1 1 1").contains("d.txt: line 2: the direction is zero"));
        assert!(why("0 0 1\n0 0 1", "1 1 1\n1 0 1").contains("i.txt: line 2: intensities must be above 0"));
        assert!(why("0 0 1\n0 0 1", "1 1 1\n1 1 1\n1 1 1").contains("i.txt: the end: 3 lines"));
    }
}
