//! The boxes of a HEIF file, as far as they have to be checked before its reader sees them. Source: ISO/IEC 14496-12, 8.11.

use super::super::limits::Failure;

/// The most items of a file: the image, its alpha, thumbnails, metadata.
const MOST_ITEMS: u64 = 64;

/// A box: its type and its content.
type FileBox<'a> = ([u8; 4], &'a [u8]);

/// Refuses items in several extents, which the reader would join whatever their lengths add up to, and images that are to be
/// turned, mirrored or cropped.
pub(super) fn check(bytes: &[u8]) -> Result<(), Failure> {
    let meta = content(bytes, *b"meta").ok_or_else(|| Failure::damaged("it has no list of items"))?;
    // A version and flags come first.
    let meta = meta.get(4..).unwrap_or_default();
    let locations = content(meta, *b"iloc").ok_or_else(|| Failure::damaged("its items have no places"))?;
    if items_in_one_piece(locations).is_none() {
        return Err(Failure::Unsupported("an AVIF of many items, or of items in several pieces".into()));
    }
    let properties = content(meta, *b"iprp").and_then(|all| content(all, *b"ipco")).unwrap_or_default();
    let is_transform = |(kind, _): &FileBox<'_>| [*b"irot", *b"imir", *b"clap"].contains(kind);
    match boxes(properties).any(|property| is_transform(&property)) {
        true => Err(Failure::Unsupported("an AVIF that is turned, mirrored or cropped".into())),
        false => Ok(()),
    }
}

/// Returns the content of the first box of a type.
fn content(bytes: &[u8], wanted: [u8; 4]) -> Option<&[u8]> {
    boxes(bytes).find(|(kind, _)| *kind == wanted).map(|(_, content)| content)
}

/// Returns boxes that follow one another, up to the first that is damaged.
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

/// Reads numbers, the most significant byte first.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    /// Reads a number of so many bytes, at most 8; 0 of none.
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
        SOUND.windows(4).position(|four| four == name).expect("the box is there")
    }

    #[test]
    fn items_in_many_extents_are_refused() {
        assert!(check(SOUND).is_ok());
        let mut many = SOUND.to_vec();
        // Behind the type: version and flags, sizes, the number of items, the first item's number, source and base.
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
