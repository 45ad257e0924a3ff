//! Changes of text: its lines, and the words of a line.

use fastrand::Rng;
use serde::{Deserialize, Serialize};

/// The most lines of a file after repeating a line.
const MOST: usize = 1 << 16;

/// Words that text readers may meet in damaged files.
const WORDS: [&str; 30] = [
    "",
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "99999999999999999999",
    "nan",
    "inf",
    "-inf",
    "1e20",
    "1e37",
    "1e38",
    "1e39",
    "-1e39",
    "1e-45",
    "1e400",
    "1/1/1",
    "-1//-9",
    "\"",
    "\\",
    "\u{e4}\0\u{1b}[2J",
];

/// A change of text. Lines and words are numbered from 0; words are separated by spaces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineChange {
    /// Replaces a word.
    Word {
        /// The line.
        line: usize,
        /// The word in the line.
        word: usize,
        /// The new word.
        text: String,
    },
    /// Removes a line.
    Remove {
        /// The line.
        line: usize,
    },
    /// Repeats a line.
    Repeat {
        /// The line.
        line: usize,
        /// The total number of repetitions.
        times: usize,
    },
    /// Inserts a copy of one line before another.
    Copy {
        /// The line.
        from: usize,
        /// The line that the copy is inserted before.
        to: usize,
    },
}

impl LineChange {
    /// Chooses a change; `None` for a file that does not start as text.
    pub fn choose(rng: &mut Rng, bytes: &[u8]) -> Option<Self> {
        let head = &bytes[..bytes.len().min(32)];
        if head.is_empty() || head.iter().any(|byte| !(byte.is_ascii_graphic() || byte.is_ascii_whitespace()))
        {
            return None;
        }
        let lines: Vec<&[u8]> = bytes.split(|byte| *byte == b'\n').collect();
        let line = rng.usize(..lines.len());
        Some(match rng.u8(..8) {
            0 => Self::Remove { line },
            1 => Self::Repeat { line, times: 1 << rng.u32(..13) },
            2 => Self::Copy { from: line, to: rng.usize(..lines.len()) },
            _ => {
                let word = rng.usize(..lines[line].split(|byte| *byte == b' ').count());
                Self::Word { line, word, text: text(rng, bytes) }
            }
        })
    }

    /// Applies the change to the text `bytes`.
    pub fn apply(&self, bytes: &mut Vec<u8>) {
        let mut lines: Vec<Vec<u8>> = bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
        let count = lines.len();
        match self {
            Self::Word { line, word, text } if *line < count => {
                lines[*line] = with_word(&lines[*line], *word, text.as_bytes());
            }
            Self::Remove { line } if *line < count => drop(lines.remove(*line)),
            Self::Repeat { line, times } if *line < count => {
                let repeated = vec![lines[*line].clone(); (*times).min(MOST)];
                lines.splice(*line..=*line, repeated);
            }
            Self::Copy { from, to } if *from < count && *to <= count => {
                lines.insert(*to, lines[*from].clone());
            }
            _ => return,
        }
        *bytes = lines.join(&b'\n');
    }
}

/// Chooses a word: a troublesome one, or one from the file itself.
fn text(rng: &mut Rng, bytes: &[u8]) -> String {
    if rng.u8(..4) > 0 {
        return rng.choice(WORDS).unwrap_or_default().to_owned();
    }
    let words: Vec<&[u8]> = bytes.split(u8::is_ascii_whitespace).take(256).collect();
    String::from_utf8_lossy(rng.choice(words).unwrap_or_default()).into_owned()
}

/// Returns the line with another word at position `word`.
fn with_word(line: &[u8], word: usize, text: &[u8]) -> Vec<u8> {
    let mut words: Vec<&[u8]> = line.split(|byte| *byte == b' ').collect();
    if let Some(place) = words.get_mut(word) {
        *place = text;
    }
    words.join(&b' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_does_what_it_says() {
        let changed = |change: LineChange| {
            let mut bytes = b"v 0 1\nf 2\n".to_vec();
            change.apply(&mut bytes);
            String::from_utf8(bytes).unwrap()
        };
        let word = |line, word| LineChange::Word { line, word, text: "nan".into() };
        assert_eq!(changed(word(0, 1)), "v nan 1\nf 2\n");
        assert_eq!(changed(word(1, 9)), "v 0 1\nf 2\n", "missing words are ignored");
        assert_eq!(changed(LineChange::Remove { line: 0 }), "f 2\n");
        assert_eq!(changed(LineChange::Repeat { line: 1, times: 2 }), "v 0 1\nf 2\nf 2\n");
        assert_eq!(changed(LineChange::Copy { from: 1, to: 0 }), "f 2\nv 0 1\nf 2\n");
        assert!(LineChange::choose(&mut Rng::with_seed(1), b"\x89PNG").is_none());
    }
}
