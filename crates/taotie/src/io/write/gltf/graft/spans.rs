//! The parts of buffers that are still in use, moved together without duplicates.

/// A range of bytes in a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Range {
    pub buffer: usize,
    pub start: usize,
    pub end: usize,
}

impl Range {
    /// Returns `true` if its buffer exists and is long enough, or has no bytes at all.
    pub fn is_in(&self, buffers: &[Option<Vec<u8>>]) -> bool {
        match buffers.get(self.buffer) {
            Some(Some(bytes)) => self.end <= bytes.len(),
            Some(None) => true,
            None => false,
        }
    }
}

/// The new positions of parts of buffers.
pub(super) struct Spans(Vec<Span>);

struct Span {
    from: Range,
    to: usize,
}

/// Positions are preserved modulo this, the largest alignment of any glTF component.
const ALIGNMENT: usize = 8;

impl Spans {
    /// Moves existing ranges of buffers into one buffer; its length is a multiple of four.
    pub fn moved(ranges: Vec<Range>, buffers: &[Option<Vec<u8>>]) -> (Self, Vec<u8>) {
        let (mut spans, mut bytes) = (Vec::new(), Vec::new());
        for from in merged(ranges) {
            let to = bytes.len().next_multiple_of(ALIGNMENT) + from.start % ALIGNMENT;
            bytes.resize(to, 0);
            bytes.extend_from_slice(buffers[from.buffer].as_ref().map_or(&[], |b| &b[from.start..from.end]));
            spans.push(Span { from, to });
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        (Self(spans), bytes)
    }

    /// Returns the new start of a range.
    pub fn moved_to(&self, range: &Range) -> usize {
        let begins_before = |span: &Span| (span.from.buffer, span.from.start) <= (range.buffer, range.start);
        let after = self.0.partition_point(begins_before);
        let span = after.checked_sub(1).and_then(|i| self.0.get(i));
        span.map_or(0, |span| span.to + range.start.saturating_sub(span.from.start))
    }
}

/// Returns the sorted ranges, with overlapping and adjacent ones merged.
fn merged(mut ranges: Vec<Range>) -> Vec<Range> {
    ranges.sort_unstable();
    let mut merged: Vec<Range> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if last.buffer == range.buffer && range.start <= last.end => {
                last.end = last.end.max(range.end);
            }
            _ => merged.push(range),
        }
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_named_is_there_once_and_aligned_as_it_was() {
        let buffers = [Some((0..40).collect()), None, Some(vec![7; 5])];
        let range = |buffer, start, end| Range { buffer, start, end };
        let ranges = vec![range(0, 12, 20), range(2, 1, 4), range(0, 16, 24), range(0, 32, 33)];
        let (spans, bytes) = Spans::moved(ranges.clone(), &buffers);
        for range in &ranges {
            let to = spans.moved_to(range);
            assert_eq!(to % ALIGNMENT, range.start % ALIGNMENT);
            let from = &buffers[range.buffer].as_ref().unwrap()[range.start..range.end];
            assert_eq!(&bytes[to..][..from.len()], from);
        }
        assert_eq!(spans.moved_to(&ranges[2]), spans.moved_to(&ranges[0]) + 4);
        assert!(bytes.len() < 40 && bytes.len().is_multiple_of(4), "{}", bytes.len());
    }

    #[test]
    fn what_is_not_there_is_known() {
        let buffers = [Some(vec![0; 4]), None];
        let is_in = |buffer, end| Range { buffer, start: 0, end }.is_in(&buffers);
        assert_eq!([is_in(0, 4), is_in(0, 5), is_in(1, 99), is_in(2, 0)], [true, false, true, false]);
    }
}
