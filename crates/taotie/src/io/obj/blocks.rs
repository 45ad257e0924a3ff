//! Splits the text of an OBJ file into blocks of whole statements, which are read in parallel.

use super::super::text;
use super::super::words::line_ends;

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
        for (_, statement) in text::lines(text) {
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
pub(super) fn split_keyword(statement: &str) -> (&str, &str) {
    statement.split_once(char::is_whitespace).unwrap_or((statement, ""))
}

/// Splits `text` after lines that do not continue on the next.
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
