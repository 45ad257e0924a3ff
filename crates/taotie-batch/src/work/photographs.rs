//! The process of photographs: their files are hashed, the host estimates normals, and the result is stored.

use super::outputs::{THUMBNAIL, Target, Work};
use super::{Made, Shown, pool, with_derived};
use crate::job::Message;
use crate::record::{EstimateFigures, FileEntry, read_photographs, slashed};
use crate::settings::{PhotometricSettings, Thumbnail};
use crate::store::{EstimateObject, Object, address_of};
use std::path::{Path, PathBuf};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::{Progress, Result, Warnings};
use taotie_io::{FileSet, Limits, LossyTexture, read_bitmap_within};
use taotie_photometric::{PhotographSet, Samples};

/// An estimate that the host makes.
pub struct Order<'a> {
    /// The name of the folder or file.
    pub name: &'a str,
    /// The photographs.
    pub set: &'a PhotographSet,
    /// The options, and whether a page is written.
    pub settings: &'a PhotometricSettings,
    /// The folder to write to, which is part of `files`.
    pub folder: &'a Path,
    /// The set that the files are added to.
    pub files: &'a FileSet,
    /// Limits of memory and image sizes.
    pub limits: Limits,
    /// Stages.
    pub progress: Progress<'a>,
}

impl Work<'_> {
    /// Estimates normals from photographs, unless the same estimate exists.
    pub(super) fn estimate(&self, settings: &PhotometricSettings, made: &mut Made) -> Result<()> {
        let job = self.job;
        self.progress.begin("hash")?;
        made.input = read_photographs(&job.scan, &self.name(), settings)?;
        let at = address_of(&job.settings.task, &made.input);
        (self.host.send)(Message::Address { address: at.clone() });
        let known = self.store.object::<EstimateObject>(&at).filter(|_| job.reuse);
        let reused = known.is_some();
        let most = pool(job.threads)?;
        let (object, threads) = match known {
            Some(object) => (object, most),
            None => {
                let mut warnings = Warnings::default();
                let setup = settings.options.setup(job.limits);
                let open = || PhotographSet::open_with(&job.scan, &setup, &mut warnings, self.progress);
                let set = most.install(open)?;
                let (need, samples) = Samples::need(&set, &settings.options.reading(job.limits))?;
                let what = format!("an estimate from {} photographs", set.photographs.len());
                let threads = self.admitted(what, with_derived(need), samples)?;
                (threads.install(|| self.store_estimate(settings, &set, (&at, made), warnings))?, threads)
            }
        };
        made.estimated = Some(object.estimated.clone());
        made.warnings.clone_from(&object.warnings);
        made.parts.push(object.into_part(at.clone(), reused));
        let [model, normals] = ["relief.glb", "normals.png"].map(|name| self.store.path(&at).join(name));
        threads.install(|| self.derive(&Shown { model, normals: Some(normals) }, &at, made))
    }

    /// Lets the host estimate, and stores its files at an address.
    fn store_estimate(
        &self,
        settings: &PhotometricSettings,
        set: &PhotographSet,
        (address, made): (&str, &Made),
        mut warnings: Warnings,
    ) -> Result<EstimateObject> {
        let files = (self.host.files)();
        let folder = self.store.claim(address, &files)?;
        files.protect(made.input.iter().map(|file| &file.path))?;
        let order = Order {
            name: &self.name(),
            set,
            settings,
            folder: &folder,
            files: &files,
            limits: self.job.limits,
            progress: self.progress,
        };
        let estimated = (self.host.estimate)(&order, &mut warnings)?;
        self.progress.begin("commit")?;
        let mut paths = files.files();
        paths.sort();
        files.commit()?;
        let bytes_in = made.input.iter().map(|file| file.bytes).sum();
        let estimated = EstimateFigures { bytes_in, ..estimated };
        let object = EstimateObject::of(estimated, warnings.list(), entries(&folder, &paths)?);
        self.store.complete(address, &object, &(self.host.files)())?;
        Ok(object)
    }
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
