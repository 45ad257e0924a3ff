//! Normals, depths and uvs of a surface as seen by a camera, before lighting.

use crate::error::Result;
use crate::image::Image;
use crate::math::Vec3;
use crate::parallel;
use crate::render::{Frame, GrazingNormals, Lighting, RenderSettings, Shot};
use crate::scene::Camera;

/// Neighbouring samples whose depths differ by more than this many of their sizes see a silhouette, or a surface
/// slanted by more than 76°.
const STEEPEST: f64 = 4.0;

/// The rule of [`Look::inner`] in words, for reports.
pub(super) const INNER_RULE: &str = "a pixel is away from silhouettes if each of its samples and their eight \
    neighbours are covered and matched, and no neighbour's depth differs by more than 4 sample sizes, so the model \
    slants by less than about 76°";

/// Normals, depths and uvs at the centres of samples, in squares of `per_side` × `per_side` in each pixel.
pub(super) struct Look {
    /// As [`crate::render::Aovs::normals`].
    pub(super) normals: Image,
    /// As [`crate::render::Aovs::depth`].
    pub(super) depth: Image,
    /// As [`crate::render::Aovs::uv`].
    pub(super) uv: Image,
    /// The camera that sees them.
    pub(super) camera: Camera,
    per_side: u32,
}

/// Maximum number of samples of a look: each takes 96 bytes during rendering.
const MOST: u64 = 1 << 24;

/// Returns the number that `settings` requests, or fewer if the look would exceed [`MOST`].
pub(super) fn samples_per_side(settings: &RenderSettings) -> u32 {
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    let wanted = settings.samples.isqrt();
    (1..=wanted).rev().find(|n| pixels * u64::from(n * n) <= MOST).unwrap_or(1)
}

/// Makes a look with `take`, with as many samples per pixel as `settings` requests, or fewer if that is too many.
pub(super) fn look(
    camera: &Camera,
    settings: &RenderSettings,
    take: impl FnOnce(&Shot<'_>) -> Result<Frame>,
) -> Result<Look> {
    let per_side = samples_per_side(settings);
    let (width, height) = (settings.width * per_side, settings.height * per_side);
    // The map's own normals are to be judged, not their modification by shading.
    let grazing_normals = GrazingNormals::Keep;
    let settings = RenderSettings {
        width,
        height,
        samples: 1,
        aovs: true,
        shadows: false,
        grazing_normals,
        ..settings.clone()
    };
    let lighting = Lighting::default();
    let frame = take(&Shot { camera, lighting: &lighting, settings: &settings })?;
    let aovs = frame.aovs.expect("output variables were requested");
    Ok(Look { normals: aovs.normals, depth: aovs.depth, uv: aovs.uv, camera: camera.clone(), per_side })
}

impl Look {
    /// Returns the unit mean normal of each pixel, over this look's samples or others at the same positions. The
    /// fourth channel is 1 if all of them saw a surface.
    pub(super) fn mean_normals(&self, normals: &Image) -> Result<Image> {
        let n = self.per_side;
        let mut means = Image::new(normals.width() / n, normals.height() / n, [0.0; 4])?;
        let width = means.width();
        parallel::change(means.pixels_mut(), |i, mean| {
            let samples =
                samples_of([i as u32 % width, i as u32 / width], n).map(|[x, y]| normals.pixel(x, y));
            let sum = samples.fold([0.0; 4], |sum: [f32; 4], sample| {
                std::array::from_fn(|channel| sum[channel] + sample[channel])
            });
            let direction = Vec3::new(sum[0], sum[1], sum[2]).normalize_or(Vec3::splat(0.0));
            if sum[3] == (n * n) as f32 && direction.length() > 0.0 {
                *mean = [direction.x, direction.y, direction.z, 1.0];
            }
        });
        Ok(means)
    }

    /// Returns `true` for each pixel away from silhouettes, row by row: see [`INNER_RULE`]. The fourth channel of
    /// `matched` is 1 if a sample has a corresponding point.
    pub(super) fn inner(&self, matched: &Image) -> Vec<bool> {
        let n = self.per_side;
        let (width, height) = (matched.width() / n, matched.height() / n);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        pixels.map(|at| samples_of(at, n).all(|sample| self.is_inner(matched, sample))).collect()
    }

    fn is_inner(&self, matched: &Image, [x, y]: [u32; 2]) -> bool {
        let (width, height) = (self.depth.width(), self.depth.height());
        if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
            return false;
        }
        let [middle, ..] = self.depth.pixel(x, y);
        let most = STEEPEST * self.camera.pixel_size(middle.into(), width, height);
        let near = |x: u32, y: u32| f64::from(self.depth.pixel(x, y)[0] - middle).abs() <= most;
        let sound = |x: u32, y: u32| matched.pixel(x, y)[3] == 1.0 && near(x, y);
        (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| sound(x, y)))
    }
}

/// Returns the samples of a pixel.
fn samples_of([x, y]: [u32; 2], per_side: u32) -> impl Iterator<Item = [u32; 2]> {
    let side = 0..per_side;
    side.clone().flat_map(move |j| side.clone().map(move |i| [x * per_side + i, y * per_side + j]))
}
