//! The outputs of a job on photographs: the normals that the host estimates, and their picture.

use super::outputs::{Order, THUMBNAIL, Target, Work};
use crate::record::{EstimateFigures, FileEntry, InputFile, slashed};
use crate::settings::{PhotometricSettings, Thumbnail};
use crate::store::EstimateObject;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::{Result, Warnings};
use taotie_io::{Limits, LossyTexture, read_bitmap_within};
use taotie_photometric::PhotographSet;

/// Photographs to estimate normals from, with the warnings about them.
pub struct Photographs<'a> {
    pub set: &'a PhotographSet,
    pub settings: &'a PhotometricSettings,
    /// All files that the estimate depends on.
    pub input: &'a [InputFile],
    pub warnings: Warnings,
}

/// Lets the host estimate normals, and writes all files to an address.
///
/// # Errors
/// Errors of the host, and write errors; in that case no files are left behind.
pub fn estimate(work: &Work<'_>, photographs: Photographs<'_>, address: &str) -> Result<EstimateObject> {
    let Photographs { set, settings, input, mut warnings } = photographs;
    let files = (work.host.files)();
    let folder = work.store.claim(address, &files)?;
    files.protect(input.iter().map(|file| &file.path))?;
    let order = Order {
        name: &work.name(),
        set,
        settings,
        folder: &folder,
        files: &files,
        limits: work.job.limits,
        progress: work.progress,
    };
    let estimated = (work.host.estimate)(&order, &mut warnings)?;
    work.progress.begin("commit")?;
    let mut paths = files.files();
    paths.sort();
    files.commit()?;
    let bytes_in = input.iter().map(|file| file.bytes).sum();
    let estimated = EstimateFigures { bytes_in, ..estimated };
    let object = EstimateObject::of(estimated, warnings.list(), entries(&folder, &paths)?);
    work.store.complete(address, &object, &(work.host.files)())?;
    Ok(object)
}

/// Describes files that have been written to a folder, by their paths in it.
fn entries(folder: &Path, paths: &[PathBuf]) -> Result<Vec<FileEntry>> {
    let name = |path: &Path| slashed(path.strip_prefix(folder).unwrap_or(path));
    paths.iter().map(|path| FileEntry::of(&name(path), path)).collect()
}

/// Writes the colours (n + 1) / 2 of normals as lossy WebP, at most as large as they are.
///
/// # Errors
/// Read and write errors.
pub fn thumbnail(
    normals: &Path,
    (path, files): Target<'_>,
    Thumbnail { size }: Thumbnail,
    work: &Work<'_>,
) -> Result<()> {
    let bitmap = read_bitmap_within(normals, &Limits { memory: work.limit(), ..Limits::default() })?;
    let [width, height] = [bitmap.width(), bitmap.height()];
    let code = |v: f32| (v * 255.0 + 0.5) as u8;
    let pixels = (0..width as usize * height as usize).map(|i| bitmap.stored(i).map(code)).collect();
    let picture = Bitmap::new(width, height, 4, Texels::U8(pixels))?;
    files.write_bytes(path, &LossyTexture::new(picture, Encoding::Linear).encoded(size, THUMBNAIL)?)
}
