//! Options of a comparison: its methods, sample points, camera, light and settings; and the memory that it needs,
//! estimated from them.

use super::look::{Matching, samples_per_side};
use crate::studio::{CameraOptions, Framing, Viewpoint};
use std::collections::HashSet;
use std::fmt;
use taotie_engine::error::{Error, Result};
use taotie_engine::film::Development;
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::names::Named;
use taotie_engine::render::{Lighting, RenderSettings};
use taotie_engine::scene::{Camera, Scene, three_point_rig};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;

/// Options of a comparison of models.
///
/// ```
/// use taotie::Shading;
/// use taotie::comparison::{ComparisonOptions, Matching, Method, SamplePoints};
///
/// let options = ComparisonOptions {
///     shadings: vec![Shading::Lambert, Shading::Ggx],
///     matching: Matching::Uv,
///     points: SamplePoints::Pixels(vec![[320, 320]]),
///     ..ComparisonOptions::default()
/// };
/// assert_eq!(options.methods, Method::defaults());
/// ```
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ComparisonOptions {
    /// The surface methods, at least one and each once; the angles at sample points are measured from the first.
    pub methods: Vec<Method>,
    /// The reflectance models, at least one and each once.
    pub shadings: Vec<Shading>,
    /// The reflectance model with whose image of a surface the images under all others are compared: one of
    /// `shadings`, which must then contain another. `None` measures surfaces only.
    pub baseline: Option<Shading>,
    /// The pixels whose normals are listed.
    pub points: SamplePoints,
    /// How the corresponding point of the reference is found.
    pub matching: Matching,
    /// The camera of all images; `None` fits the model into the image, seen slightly from the side and from above.
    pub camera: Option<Camera>,
    /// The light of all images; `None` uses the model's own lights, else key, fill and rim.
    pub lighting: Option<Lighting>,
    /// Size, samples, shadows, tangents, the height of white for `bump`, and the SIMD level. Shading and surface
    /// method are ignored.
    pub settings: RenderSettings,
    /// The development of all images; it needs a background, since images are compared as a screen shows them.
    pub development: Development,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            methods: Method::defaults(),
            shadings: vec![Shading::Ggx],
            baseline: None,
            points: SamplePoints::Spread(10),
            matching: Matching::Normal,
            camera: None,
            lighting: None,
            settings: RenderSettings { width: 640, height: 640, ..RenderSettings::default() },
            development: Development { background: Some(charcoal()), ..Development::default() },
        }
    }
}

/// Returns #2a2b2e, linear.
fn charcoal() -> Vec3 {
    let linear = |code: u8| srgb::linear_from_srgb(f64::from(code) / 255.0) as f32;
    Vec3::new(linear(0x2a), linear(0x2b), linear(0x2e))
}

impl ComparisonOptions {
    /// Checks that the comparison is possible.
    pub(super) fn check(&self) -> Result<()> {
        let refuse = |what: &str, why: &str| Err(Error::invalid(what, why));
        Image::check_size(self.settings.width, self.settings.height)?;
        if self.methods.is_empty() || self.shadings.is_empty() {
            return refuse("an empty comparison", "name at least one surface method and one shading model");
        }
        let meaningless = |method: &&Method| method.factor.is_some() && !Method::takes_factor(method.surface);
        if let Some(method) = self.methods.iter().find(meaningless) {
            return refuse(&method.id(), "only bump and bump-printed take a factor");
        }
        if let Some(baseline) = self.baseline
            && (!self.shadings.contains(&baseline) || self.shadings == [baseline])
        {
            let what = format!("the baseline {}", baseline.name());
            return refuse(
                &what,
                "there is nothing to compare it with; include it and another in the shading models",
            );
        }
        if self.development.background.is_none() {
            return refuse(
                "a transparent background",
                "images are compared over a background; choose a colour",
            );
        }
        match self.points.outside([self.settings.width, self.settings.height]) {
            Some([x, y]) => refuse("sample points", &format!("pixel {x},{y} is outside the picture")),
            None => Ok(()),
        }
    }

    /// Returns the requested camera, else one that fits the model into the image.
    pub(super) fn camera_for(&self, model: &Scene) -> Result<Camera> {
        if let Some(camera) = &self.camera {
            return Ok(camera.clone());
        }
        let framing = Framing { size: [self.settings.width, self.settings.height], all_around: false };
        let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, model)?;
        Ok(viewpoint.at(0.0).camera())
    }

    /// Returns the requested light, else the model's own lights, else key, fill and rim.
    pub(super) fn lighting_for(&self, model: &Scene, camera: &Camera) -> Lighting {
        if let Some(lighting) = &self.lighting {
            return lighting.clone();
        }
        let own = !model.lights().is_empty();
        let lights = if own { model.lights().to_vec() } else { three_point_rig(camera) };
        Lighting { lights, ..Lighting::default() }
    }

    /// Returns the memory in bytes for the images of a comparison, in addition to the scenes.
    ///
    /// ```
    /// use taotie::RenderSettings;
    /// use taotie::comparison::ComparisonOptions;
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
        /// A picture and its copies during writing, and whether model and reference are there.
        const PICTURE: u64 = 32 + 2;
        let pixels = u64::from(self.settings.width) * u64::from(self.settings.height);
        let per_side = u64::from(samples_per_side(&self.settings));
        let methods = self.methods.len() as u64 + 1;
        let kept = methods * (METHOD + SHADING * self.shadings.len() as u64);
        pixels * (SAMPLE * per_side * per_side + kept + MEASURING + PICTURE)
    }
}

/// A way to find the shading normal: a surface method, and for the bump methods a factor.
///
/// ```
/// use taotie::SurfaceMethod;
/// use taotie::comparison::Method;
///
/// let bump = Method { surface: SurfaceMethod::Bump, factor: Some(5.0) };
/// assert_eq!(bump.id(), "bump:5");
/// assert_eq!(bump.file_stem(), "bump-5");
/// assert_eq!(Method::from(SurfaceMethod::TangentNormal).id(), "tangent-normal");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Method {
    /// The surface method.
    pub surface: SurfaceMethod,
    /// For `bump` the height of white above black in texels, for `bump-printed` the factor of Guo and Wang 2025.
    /// `None` uses the height in the material.
    pub factor: Option<f32>,
}

impl From<SurfaceMethod> for Method {
    fn from(surface: SurfaceMethod) -> Self {
        Self { surface, factor: None }
    }
}

/// The bump factors of Guo and Wang 2025.
const PAPER_FACTORS: [f32; 2] = [5.0, 50.0];

impl Method {
    /// Returns the methods compared by default: the four of Guo and Wang 2025, bump mapping as intended, and both
    /// kinds of normal map.
    pub fn defaults() -> Vec<Self> {
        let by_factor = |surface| PAPER_FACTORS.map(|factor| Self { surface, factor: Some(factor) });
        let mut methods = vec![Self::from(SurfaceMethod::Smooth), Self::from(SurfaceMethod::Bump)];
        methods.extend(by_factor(SurfaceMethod::Bump));
        methods.extend(by_factor(SurfaceMethod::BumpPrinted));
        methods.extend([Self::from(SurfaceMethod::ObjectNormal), Self::from(SurfaceMethod::TangentNormal)]);
        methods
    }

    /// Returns `true` if the method takes a factor, which only bump mapping does.
    pub fn takes_factor(surface: SurfaceMethod) -> bool {
        matches!(surface, SurfaceMethod::Bump | SurfaceMethod::BumpPrinted)
    }

    /// Returns its name with the factor: `tangent-normal`, `bump:5`.
    pub fn id(self) -> String {
        match self.factor {
            Some(factor) => format!("{}:{factor}", self.surface.name()),
            None => self.surface.name().into(),
        }
    }

    /// Returns [`Method::id`] as part of a file's name: `bump-5`.
    pub fn file_stem(self) -> String {
        self.id().replace(':', "-")
    }

    /// Returns a short description.
    pub fn describe(self) -> String {
        let what = match self.surface {
            SurfaceMethod::Facet => "one normal per triangle",
            SurfaceMethod::Smooth => "vertex normals",
            SurfaceMethod::Bump => "surface gradient",
            SurfaceMethod::BumpPrinted => "as printed in the paper",
            SurfaceMethod::ObjectNormal => "object-space map",
            SurfaceMethod::TangentNormal => "tangent-space map",
        };
        match (self.surface, self.factor) {
            (SurfaceMethod::Bump, Some(factor)) => format!("{what}, {factor} texels"),
            (SurfaceMethod::BumpPrinted, Some(factor)) => format!("{what}, factor {factor}"),
            _ => what.into(),
        }
    }
}

/// The sample points of a comparison: pixels whose normals are listed.
///
/// ```
/// use taotie::comparison::SamplePoints;
///
/// let pixels = SamplePoints::Pixels(vec![[3, 3], [4, 0]]);
/// assert_eq!(pixels.to_string(), "3,3;4,0");
/// assert_eq!(pixels.outside([4, 4]), Some([4, 0]));
/// assert_eq!(SamplePoints::Spread(10).outside([4, 4]), None);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SamplePoints {
    /// This many, spread over what is seen.
    Spread(usize),
    /// These pixels, from the top left.
    Pixels(Vec<[u32; 2]>),
}

/// The rule of [`SamplePoints::Spread`] in words, for reports.
pub(super) const SPREAD_RULE: &str = "points (i₂, i₃) of the Halton sequence, i = 1, 2, …, stretched over the \
    box around the pixels away from silhouettes; each takes the pixel it falls into if that is away from silhouettes \
    and not yet taken";

/// A count, or pixels as `X,Y;X,Y`.
impl fmt::Display for SamplePoints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Spread(count) => write!(f, "{count}"),
            Self::Pixels(pixels) => {
                let pixels: Vec<String> = pixels.iter().map(|[x, y]| format!("{x},{y}")).collect();
                f.write_str(&pixels.join(";"))
            }
        }
    }
}

impl SamplePoints {
    /// Returns the first pixel outside an image of this width and height.
    pub fn outside(&self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        match self {
            Self::Spread(_) => None,
            Self::Pixels(pixels) => pixels.iter().copied().find(|[x, y]| *x >= width || *y >= height),
        }
    }

    /// Returns the pixels. `inner` marks, row by row in rows of `width`, those away from silhouettes.
    pub(super) fn choose(&self, inner: &[bool], width: usize) -> Vec<[u32; 2]> {
        match self {
            Self::Pixels(pixels) => pixels.clone(),
            Self::Spread(count) => spread(*count, inner, width),
        }
    }
}

/// Chooses pixels: see [`SPREAD_RULE`]. Fewer than `count` only if there are fewer such pixels.
fn spread(count: usize, inner: &[bool], width: usize) -> Vec<[u32; 2]> {
    let all: Vec<[usize; 2]> =
        inner.iter().enumerate().filter(|(_, inner)| **inner).map(|(i, _)| [i % width, i / width]).collect();
    let Some(first) = all.first() else { return Vec::new() };
    let (mut low, mut high) = (*first, *first);
    for pixel in &all {
        low = [low[0].min(pixel[0]), low[1].min(pixel[1])];
        high = [high[0].max(pixel[0]), high[1].max(pixel[1])];
    }
    let [across, down] = [high[0] - low[0] + 1, high[1] - low[1] + 1];
    let wanted = count.min(all.len());
    let mut chosen = Vec::new();
    let mut taken = HashSet::new();
    for i in 1.. {
        if chosen.len() == wanted {
            break;
        }
        let x = low[0] + (radical_inverse(i, 2) * across as f64) as usize;
        let y = low[1] + (radical_inverse(i, 3) * down as f64) as usize;
        if inner[y * width + x] && taken.insert([x, y]) {
            chosen.push([x as u32, y as u32]);
        }
    }
    chosen
}

/// Returns the digits of `i` mirrored at the radix point, in [0, 1).
///
/// Source: Halton 1964, "Algorithm 247: Radical-inverse quasi-random point sequence".
fn radical_inverse(mut i: u64, base: u64) -> f64 {
    let (mut numerator, mut denominator) = (0, 1);
    while i > 0 {
        numerator = numerator * base + i % base;
        denominator *= base;
        i /= base;
    }
    numerator as f64 / denominator as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pixels_lie_outside() {
        let pixels = SamplePoints::Pixels(vec![[3, 3], [4, 0]]);
        assert_eq!((pixels.outside([4, 4]), pixels.outside([5, 4])), (Some([4, 0]), None));
        assert_eq!(SamplePoints::Spread(100).outside([4, 4]), None);
        assert_eq!(pixels.to_string(), "3,3;4,0");
    }

    #[test]
    fn points_are_spread_over_what_is_seen_and_nowhere_else() {
        let inner: Vec<bool> = (0..64 * 64).map(|i| (i % 64) > 20 && (i / 64) < 50).collect();
        let points = SamplePoints::Spread(40).choose(&inner, 64);
        assert_eq!(points.len(), 40);
        assert!(points.iter().all(|[x, y]| inner[(y * 64 + x) as usize]));
        // Each quarter of the region has its share.
        let quarter = |right: bool, low: bool| {
            points.iter().filter(|[x, y]| (*x > 42) == right && (*y > 25) == low).count()
        };
        for (right, low) in [(false, false), (false, true), (true, false), (true, true)] {
            assert!((7..=13).contains(&quarter(right, low)), "{}", quarter(right, low));
        }
    }

    #[test]
    fn few_pixels_are_all_chosen() {
        let inner: Vec<bool> = (0..100).map(|i| i % 37 == 5).collect();
        let mut points = SamplePoints::Spread(10).choose(&inner, 10);
        points.sort_unstable();
        assert_eq!(points, [[2, 4], [5, 0], [9, 7]]);
        assert!(SamplePoints::Spread(10).choose(&[false; 100], 10).is_empty());
    }
}
