//! Options of a comparison.

use super::matching::Matching;
use super::method::Method;
use super::sample_points::SamplePoints;
use crate::error::{Error, Result};
use crate::film::Development;
use crate::image::Image;
use crate::math::{Vec3, srgb};
use crate::names::Named;
use crate::render::{Lighting, RenderSettings};
use crate::scene::{Camera, Scene, three_point_rig};
use crate::shade::Shading;
use crate::studio::{CameraOptions, Framing, Viewpoint};

/// Options of a comparison of models.
///
/// ```
/// use taotie::comparison::{ComparisonOptions, Matching, Method, SamplePoints};
/// use taotie::shade::Shading;
///
/// let options = ComparisonOptions {
///     shadings: vec![Shading::Lambert, Shading::Ggx],
///     matching: Matching::Uv,
///     points: SamplePoints::Pixels(vec![[320, 320]]),
///     ..ComparisonOptions::default()
/// };
/// assert_eq!(options.methods, Method::defaults());
/// ```
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
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
}
