//! `taotie photometric --scan`: large shapes of the depth from a scan.

use super::PhotometricArgs;
use anyhow::Result;
use std::path::Path;
use taotie_engine::Warnings;
use taotie_engine::image::Encoding;
use taotie_io::{FileSet, PngColor, PngImage, PngSamples, load_model_within};
use taotie_photometric::{Anchoring, Model, Pose, Relief, ScanHeights};

/// A scan and the camera of the photographs.
pub struct Scan {
    model: Model,
    pose: Pose,
}

impl Scan {
    /// Reads the scan, if there is one.
    pub fn read(args: &PhotometricArgs, files: &FileSet, warnings: &mut Warnings) -> Result<Option<Self>> {
        let (Some(path), Some(pose)) = (&args.scan, &args.pose) else { return Ok(None) };
        let pose = Pose::open(pose)?;
        let loaded = load_model_within(path, &args.memory.limits())?;
        files.protect(&loaded.files)?;
        warnings.absorb(loaded.warnings);
        let model = Model::new(loaded.scene).map_err(|error| error.within(path.display()))?;
        Ok(Some(Self { model, pose }))
    }

    /// Moves the heights of a relief, and writes a mask of those that can be relied on.
    pub fn anchor(
        &self,
        relief: &mut Relief,
        (mask_path, files): (&Path, &FileSet),
        warnings: &mut Warnings,
    ) -> Result<Anchoring> {
        let [width, height] = [relief.grid.width as u32, relief.grid.height as u32];
        let heights = ScanHeights::new(&self.model, &self.pose, [width, height])?;
        let (anchored, anchoring) = relief.anchor(&heights);
        warnings.note(
            "a pixel is on a surface that the scan does not show: its height is unreliable",
            anchoring.unanchored,
        );
        let mut mask = vec![0_u8; width as usize * height as usize];
        let reliable = relief.grid.pixels.iter().zip(&anchored).filter(|(_, is)| **is);
        reliable.for_each(|(pixel, _)| mask[*pixel as usize] = 255);
        let (color, samples) = (PngColor::Grey, PngSamples::U8(&mask));
        let image = PngImage { width, height, color, samples, encoding: Encoding::Linear };
        files.write_png(mask_path, &image)?;
        Ok(anchoring)
    }
}
