//! Normals, depths and uvs of a surface as seen by a camera, before lighting, and the points of the reference that
//! correspond to the points of the model seen.
//!
//! A low-poly mesh deviates from the high-poly one, so at the same pixel the two show different points of the relief.

use taotie_engine::bake::{ProjectionRay, Scan, Target, UvLookup};
use taotie_engine::error::Result;
use taotie_engine::image::Image;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::names::Named;
use taotie_engine::parallel;
use taotie_engine::render::{Frame, GrazingNormals, Lighting, RenderSettings, Shot};
use taotie_engine::scene::{Camera, Scene};

/// Neighbouring samples whose depths differ by more than this many of their sizes see a silhouette, or a surface
/// slanted by more than 76°.
const STEEPEST: f64 = 4.0;

/// The rule of [`Look::inner`] in words, for reports.
pub(super) const INNER_RULE: &str = "a pixel is away from silhouettes if each of its samples and their eight \
    neighbours are covered and matched, and no neighbour's depth differs by more than 4 sample sizes, so the model \
    slants by less than about 76°";

/// Normals, depths and uvs at the centres of samples, in squares of `per_side` × `per_side` in each pixel.
pub(super) struct Look {
    /// As [`taotie_engine::render::Aovs::normals`].
    pub(super) normals: Image,
    /// As [`taotie_engine::render::Aovs::depth`].
    depth: Image,
    /// As [`taotie_engine::render::Aovs::uv`].
    uv: Image,
    /// The camera that sees them.
    camera: Camera,
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

/// How corresponding points of model and reference are found.
///
/// ```
/// use taotie::comparison::Matching;
/// use taotie_engine::names::Named;
///
/// assert_eq!(Matching::from_name("uv")?, Matching::Uv);
/// assert!(Matching::Uv.rule().contains("point of the same uv"));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Matching {
    /// Along the model's vertex normal, as bakers do.
    Normal,
    /// By uv, for meshes that share them.
    Uv,
    /// At the same pixel, although the two may show different points there.
    Pixel,
}

impl Named for Matching {
    const WHAT: &'static str = "matching method";
    const NAMES: &'static [(&'static str, Self)] =
        &[("normal", Self::Normal), ("uv", Self::Uv), ("pixel", Self::Pixel)];
}

/// The maximum distance between reference and model, as a fraction of the model's diagonal.
const REACH: f64 = 0.02;

impl Matching {
    /// Returns the rule in words.
    pub fn rule(self) -> &'static str {
        match self {
            Self::Normal => {
                "each covered sample shows a point of the model; the corresponding point of the reference is along \
                 the interpolated vertex normal there, in either direction and at most 2 % of the model's diagonal \
                 away, if it faces the same way"
            }
            Self::Uv => {
                "each covered sample shows a point of the model; the reference's point of the same uv corresponds to it"
            }
            Self::Pixel => "pixel by pixel, although the two meshes may show different points there",
        }
    }

    /// Returns the reference's normals at the points that correspond to each sample's; the fourth channel is 1 where
    /// there is one.
    ///
    /// `smooth` shows the model without relief, whose diagonal is `diagonal`. By pixel there are no corresponding
    /// points: the caller compares with the reference at the same pixel.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Limit`] if the reference has too many vertices.
    pub(super) fn normals(self, smooth: &Look, reference: &Scene, diagonal: f64) -> Result<Image> {
        match self {
            Self::Pixel => matched(smooth, |_| None),
            Self::Uv => {
                let lookup = UvLookup::new(reference)?;
                matched(smooth, |at| {
                    let [u, v, ..] = smooth.uv.pixel(at[0], at[1]);
                    lookup.at(Vec2::new(u, v)).map(|(_, normal)| normal)
                })
            }
            Self::Normal => {
                let scan = Scan::new(reference.clone())?;
                let distance = (REACH * diagonal) as f32;
                let size = [smooth.depth.width(), smooth.depth.height()];
                matched(smooth, |at| {
                    let [depth, ..] = smooth.depth.pixel(at[0], at[1]);
                    let [x, y, z, _] = smooth.normals.pixel(at[0], at[1]);
                    let point = smooth.camera.point_at(at, depth.into(), size).to_f32();
                    let direction = Vec3::new(x, y, z);
                    let projection = ProjectionRay {
                        point,
                        direction,
                        distance,
                        among: None,
                        floating: None,
                        target: Target::OnRay,
                    };
                    scan.project(&projection).map(|found| scan.mapped_normal(&found, 0.0).normal)
                })
            }
        }
    }
}

/// Returns the normal that `find` gives for each covered sample.
fn matched(smooth: &Look, find: impl Fn([u32; 2]) -> Option<Vec3> + Sync) -> Result<Image> {
    let (width, height) = (smooth.depth.width(), smooth.depth.height());
    let mut matched = Image::new(width, height, [0.0; 4])?;
    parallel::change(matched.pixels_mut(), |i, pixel| {
        let at = [i as u32 % width, i as u32 / width];
        let covered = smooth.depth.pixel(at[0], at[1])[3] == 1.0;
        if let Some(n) = covered.then(|| find(at)).flatten() {
            *pixel = [n.x, n.y, n.z, 1.0];
        }
    });
    Ok(matched)
}
