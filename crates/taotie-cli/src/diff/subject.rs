//! What is compared: two pictures, or the normals that two files hold.

use super::args::{DiffArgs, Encoding, Metric};
use anyhow::{Context, Result, bail};
use std::path::Path;
use taotie::compare::{NormalEncoding, Picture, StoredNormals, stored_normals, stored_picture};
use taotie::image::{Bitmap, Texels};
use taotie::surface::{NormalMapKind, is_normal_map};
use taotie::{Warnings, io};

/// The two files.
pub struct Subject {
    /// As they are stored.
    pub bitmaps: [Bitmap; 2],
    /// As they are compared.
    pub content: Content,
}

/// What two files hold.
pub enum Content {
    /// Colours.
    Pictures([Picture; 2]),
    /// Normals, with how each file stores them.
    Normals([(StoredNormals, NormalEncoding); 2]),
}

impl Subject {
    /// Reads the two files and decides what they hold.
    pub fn read(args: &DiffArgs) -> Result<(Self, Warnings)> {
        let bitmaps = [io::read_bitmap(&args.a)?, io::read_bitmap(&args.b)?];
        check_sizes(args, &bitmaps)?;
        let mut warnings = Warnings::default();
        let content = match normal_encodings(args, &bitmaps, &mut warnings)? {
            Some(encodings) => normals(&bitmaps, encodings)?,
            None => pictures(args, &bitmaps, &mut warnings)?,
        };
        Ok((Self { bitmaps, content }, warnings))
    }
}

fn check_sizes(args: &DiffArgs, [a, b]: &[Bitmap; 2]) -> Result<()> {
    if (a.width(), a.height()) != (b.width(), b.height()) {
        let size = |path: &Path, bitmap: &Bitmap| {
            format!("{} is {}x{}", path.display(), bitmap.width(), bitmap.height())
        };
        let (a, b) = (size(&args.a, a), size(&args.b, b));
        bail!("{a}, {b}: only pictures of one size can be compared; resample one of them");
    }
    Ok(())
}

/// How the files store normals; `None` where colours are to be compared.
fn normal_encodings(
    args: &DiffArgs,
    bitmaps: &[Bitmap; 2],
    warnings: &mut Warnings,
) -> Result<Option<[NormalEncoding; 2]>> {
    let looks_at_colors = args.metric.is_some_and(|metric| metric != Metric::Angle);
    match args.encoding {
        Encoding::Color => return Ok(None),
        Encoding::Unit => return Ok(Some([NormalEncoding::Unit; 2])),
        Encoding::Signed => return Ok(Some([NormalEncoding::Signed; 2])),
        Encoding::Auto if looks_at_colors => return Ok(None),
        Encoding::Auto => {}
    }
    let [a, b] = [guess(&bitmaps[0])?, guess(&bitmaps[1])?];
    if let (Some(a), Some(b)) = (a, b) {
        return Ok(Some([a, b]));
    }
    let (other, is) = if a.is_some() { (&args.b, &args.a) } else { (&args.a, &args.b) };
    if args.metric == Some(Metric::Angle) {
        bail!(
            "{}: it does not look like a normal map; if it is one, say how it stores normals: --encoding unit or signed",
            other.display()
        );
    }
    if a.is_some() || b.is_some() {
        let (is, other) = (is.display(), other.display());
        warnings.note(
            format!("{is} looks like a normal map and {other} does not; they are compared as pictures"),
            1,
        );
    }
    Ok(None)
}

/// How a file seems to store normals, by their length.
fn guess(bitmap: &Bitmap) -> Result<Option<NormalEncoding>> {
    if matches!(bitmap.texels(), Texels::F32(_)) {
        let signed = stored_normals(bitmap, NormalEncoding::Signed)?;
        let opaque = bitmap.texels().len() - signed.transparent;
        if opaque > 0 && signed.not_unit * 10 < opaque {
            return Ok(Some(NormalEncoding::Signed));
        }
    }
    Ok((is_normal_map(bitmap) != NormalMapKind::No).then_some(NormalEncoding::Unit))
}

fn normals(bitmaps: &[Bitmap; 2], [a, b]: [NormalEncoding; 2]) -> Result<Content> {
    Ok(Content::Normals([(stored_normals(&bitmaps[0], a)?, a), (stored_normals(&bitmaps[1], b)?, b)]))
}

fn pictures(args: &DiffArgs, bitmaps: &[Bitmap; 2], warnings: &mut Warnings) -> Result<Content> {
    let mut shown = |path: &Path, bitmap: &Bitmap| -> Result<Picture> {
        let background = args.background;
        let (picture, clipped) =
            stored_picture(bitmap, background).with_context(|| path.display().to_string())?;
        warnings.note(format!("{}: pixels beyond black or white are clipped", path.display()), clipped);
        Ok(picture)
    };
    Ok(Content::Pictures([shown(&args.a, &bitmaps[0])?, shown(&args.b, &bitmaps[1])?]))
}
