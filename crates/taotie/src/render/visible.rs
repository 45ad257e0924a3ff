//! The surfaces visible at a sample of a tile's pixels, and their division into batches.

use super::batch::BATCH;

/// Consecutive pixels in a row of a tile that show the same triangle at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibleSpan {
    /// The first pixel, `y · TILE_SIZE + x` in the tile.
    pub start: u32,
    /// One more than the last pixel.
    pub end: u32,
    /// The triangle's index over all draws.
    pub triangle: u32,
    /// Reversed depth of layers that may be transparent; 0, the farthest, for opaque ones.
    pub depth: f32,
}

impl VisibleSpan {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    /// Returns true if it contains no pixel.
    pub fn is_empty(&self) -> bool {
        self.start == self.end
    }
}

/// At most `BATCH` consecutive entries in a list of visible pixels.
#[derive(Debug, Clone, Copy)]
pub struct VisibleBatch<'s> {
    spans: &'s [VisibleSpan],
    /// The pixels of the first span that belong to the previous batch.
    skipped: u32,
    len: usize,
}

/// Divides spans into batches, all full except the last.
pub fn batches(spans: &[VisibleSpan]) -> impl Iterator<Item = VisibleBatch<'_>> {
    let (mut rest, mut taken) = (spans, 0);
    std::iter::from_fn(move || {
        rest.first()?;
        let (spans, skipped, mut room) = (rest, taken, BATCH as u32);
        while let [span, more @ ..] = rest {
            let left = span.end - span.start - taken;
            if left > room {
                (taken, room) = (taken + room, 0);
                break;
            }
            (rest, taken, room) = (more, 0, room - left);
        }
        let count = spans.len() - rest.len() + usize::from(taken > 0);
        Some(VisibleBatch { spans: &spans[..count], skipped, len: BATCH - room as usize })
    })
}

impl VisibleBatch<'_> {
    /// The number of pixels.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if it contains no pixel.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The spans, without the parts that belong to other batches.
    pub fn spans(&self) -> impl Iterator<Item = VisibleSpan> {
        let (mut skipped, mut left) = (self.skipped, self.len as u32);
        self.spans.iter().map(move |span| {
            let start = span.start + skipped;
            let end = span.end.min(start + left);
            (skipped, left) = (0, left - (end - start));
            VisibleSpan { start, end, ..*span }
        })
    }

    /// Each pixel with its span.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, VisibleSpan)> {
        self.spans().flat_map(|span| (span.start..span.end).map(move |pixel| (pixel, span)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_have_every_pixel_once_and_all_but_the_last_are_full() {
        let lengths = [31, 225, 3, 256, 300, 1, 1, 700, 5];
        let mut spans = Vec::new();
        for (triangle, length) in lengths.into_iter().enumerate() {
            let start = spans.last().map_or(7, |last: &VisibleSpan| last.end + 2);
            spans.push(VisibleSpan { start, end: start + length, triangle: triangle as u32, depth: 0.0 });
        }
        for spans in [&spans[..], &spans[..2], &spans[3..4], &[]] {
            let expected: Vec<(u32, u32)> = spans
                .iter()
                .flat_map(|span| (span.start..span.end).map(|pixel| (pixel, span.triangle)))
                .collect();
            let all: Vec<VisibleBatch<'_>> = batches(spans).collect();
            let found: Vec<(u32, u32)> = all
                .iter()
                .flat_map(|batch| batch.pixels().map(|(pixel, span)| (pixel, span.triangle)))
                .collect();
            assert_eq!(found, expected);
            assert!(all.iter().all(|batch| batch.len() == batch.pixels().count() && !batch.is_empty()));
            assert!(all.iter().rev().skip(1).all(|batch| batch.len() == BATCH));
        }
    }
}
