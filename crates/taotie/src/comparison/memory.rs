//! The memory needed for a comparison, estimated from its options.

use super::look::samples_per_side;
use super::options::ComparisonOptions;

impl ComparisonOptions {
    /// Returns the memory in bytes for the images of a comparison, in addition to the scenes.
    ///
    /// ```
    /// use taotie::comparison::ComparisonOptions;
    /// use taotie::render::RenderSettings;
    ///
    /// let small = ComparisonOptions::default();
    /// let settings = RenderSettings { width: 16_384, height: 16_384, ..RenderSettings::default() };
    /// let large = ComparisonOptions { settings, ..ComparisonOptions::default() };
    /// assert!(large.image_bytes() > 100 * small.image_bytes());
    /// ```
    pub fn image_bytes(&self) -> u64 {
        /// A sample of a look: light, output variables, and the truth there.
        const SAMPLE: u64 = 96 + 32;
        /// Data kept per pixel for each method: its normal, two angles, and for each shading the colours and FLIP.
        const METHOD: u64 = 16 + 8;
        const SHADING: u64 = 12 + 4;
        /// Colours and features in double precision while FLIP and SSIM are measured, and the heat maps' codes.
        const MEASURING: u64 = 160;
        /// A picture and its copies during writing.
        const PICTURE: u64 = 32;
        let pixels = u64::from(self.settings.width) * u64::from(self.settings.height);
        let per_side = u64::from(samples_per_side(&self.settings));
        let methods = self.methods.len() as u64 + 1;
        let kept = methods * (METHOD + SHADING * self.shadings.len() as u64);
        pixels * (SAMPLE * per_side * per_side + kept + MEASURING + PICTURE)
    }
}
