//! Checks the boxes of a HEIF file that its reader relies on. Source: ISO/IEC 14496-12, 8.11.

use super::super::limits::Failure;

/// Maximum number of items in a file: the image, its alpha, thumbnails, metadata.
const MOST_ITEMS: u64 = 64;

/// A box: its type and its content.
type FileBox<'a> = ([u8; 4], &'a [u8]);

/// Rejects items in several extents, which the reader would join whatever their lengths add up to, and images with a
/// rotation, mirror or crop.
pub(super) fn check(bytes: &[u8]) -> Result<(), Failure> {
    let meta = content(bytes, *b"meta").ok_or_else(|| Failure::damaged("missing list of items"))?;
    // A version and flags come first.
    let meta = meta.get(4..).unwrap_or_default();
    let locations = content(meta, *b"iloc").ok_or_else(|| Failure::damaged("missing item locations"))?;
    if items_in_one_piece(locations).is_none() {
        return Err(Failure::Unsupported("AVIF with many items, or with items in several extents".into()));
    }
    let properties = content(meta, *b"iprp").and_then(|all| content(all, *b"ipco")).unwrap_or_default();
    let is_transform = |(kind, _): &FileBox<'_>| [*b"irot", *b"imir", *b"clap"].contains(kind);
    match boxes(properties).any(|property| is_transform(&property)) {
        true => Err(Failure::Unsupported("AVIF with a rotation, mirror or crop".into())),
        false => Ok(()),
    }
}

/// Returns the content of the first box of a type.
fn content(bytes: &[u8], wanted: [u8; 4]) -> Option<&[u8]> {
    boxes(bytes).find(|(kind, _)| *kind == wanted).map(|(_, content)| content)
}

/// Returns consecutive boxes, up to the first damaged one.
fn boxes(bytes: &[u8]) -> impl Iterator<Item = FileBox<'_>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let mut reader = Reader(rest);
        let length = reader.number(4)?;
        let kind = reader.number(4)? as u32;
        let (length, head) = match length {
            0 => (rest.len() as u64, 8),
            1 => (reader.number(8)?, 16),
            length => (length, 8),
        };
        let content = rest.get(head..usize::try_from(length).ok()?)?;
        rest = &rest[head + content.len()..];
        Some((kind.to_be_bytes(), content))
    })
}

/// Returns `Some` if an `iloc` box lists few items, each in one extent.
fn items_in_one_piece(iloc: &[u8]) -> Option<()> {
    let mut reader = Reader(iloc);
    let version = reader.number(1)?;
    reader.number(3)?;
    let [sizes, more] = [reader.number(1)?, reader.number(1)?].map(|byte| [byte >> 4, byte & 15]);
    let ([offset, length], [base, index]) = (sizes, more);
    let index = if version == 0 { 0 } else { index };
    let bytes_of_id = if version < 2 { 2 } else { 4 };
    let count = reader.number(bytes_of_id)?;
    if count > MOST_ITEMS {
        return None;
    }
    for _ in 0..count {
        reader.number(bytes_of_id)?;
        if version > 0 {
            reader.number(2)?;
        }
        reader.number(2)?;
        reader.number(base)?;
        if reader.number(2)? != 1 {
            return None;
        }
        [index, offset, length].into_iter().try_for_each(|bytes| reader.number(bytes).map(drop))?;
    }
    Some(())
}

/// Reads big-endian numbers.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    /// Reads a number of `bytes` bytes, at most 8; 0 if `bytes` is 0.
    fn number(&mut self, bytes: u64) -> Option<u64> {
        let (number, rest) = self.0.split_at_checked(bytes as usize)?;
        self.0 = rest;
        (bytes <= 8).then(|| number.iter().fold(0, |sum, byte| sum << 8 | u64::from(*byte)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: &[u8] = include_bytes!("../../../../tests/data/pictures/avif-alpha.avif");

    fn at(name: &[u8; 4]) -> usize {
        SOUND.windows(4).position(|four| four == name).expect("the box exists")
    }

    #[test]
    fn items_in_many_extents_are_refused() {
        assert!(check(SOUND).is_ok());
        let mut many = SOUND.to_vec();
        // After the type: version and flags, sizes, the number of items, the first item's number, source and base.
        let extents = at(b"iloc") + 4 + 4 + 2 + 2 + 2 + 2;
        assert_eq!(many[extents..extents + 2], [0, 1], "one extent");
        many[extents..extents + 2].fill(0xff);
        assert!(matches!(check(&many), Err(Failure::Unsupported(_))));
    }

    #[test]
    fn turned_images_are_refused() {
        let mut turned = SOUND.to_vec();
        turned[at(b"pixi")..][..4].copy_from_slice(b"irot");
        assert!(matches!(check(&turned), Err(Failure::Unsupported(_))));
    }

    #[test]
    fn any_beginning_of_a_file_is_checked_without_panic() {
        for length in 0..SOUND.len() {
            let _ = check(&SOUND[..length]);
        }
        assert!(check(b"").is_err());
    }
}
