//! The settings of an image, the light on a scene, and shots: validated ones can be drawn by any renderer.

use super::camera::{Eye, View};
use crate::error::{self, Error};
use crate::image::Image;
use crate::math::{Mat4, SimdLevel, Vec3, scalar};
use crate::names::Named;
use crate::pixel::Turn;
use crate::raster::SamplePattern;
use crate::scene::{Camera, Light};
use crate::shade::environment::Environment;
use crate::shade::{Energy, Shading};
use crate::surface::{SurfaceMethod, TangentMethod};
use std::sync::Arc;

/// The maximum scale of a height map.
const MOST_SCALE: f32 = 1e18;

/// How surfaces are prepared: the source of shading normals.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct SurfaceSettings {
    /// The method, or `None` for the best that each material supports: its normal map, else its height map, else
    /// smooth normals.
    pub method: Option<SurfaceMethod>,
    /// The method for computing tangents, or `None` for those of the mesh, else MikkTSpace.
    pub tangents: Option<TangentMethod>,
    /// The scale of the height map: for `bump` the height of 1 in model units, `None` for the material's; for
    /// `bump-printed` the paper's factor, `None` for 5.
    pub bump_scale: Option<f32>,
    /// The SIMD level for the whole image, from vertex normals to pixels: it affects speed, never pixels.
    pub simd: SimdLevel,
}

/// How mapped normals that face away from the viewer are treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GrazingNormals {
    /// The normal is bent until it is just visible to the viewer.
    #[default]
    Soften,
    /// The normal is kept as in the map, with black fringes at silhouettes.
    Keep,
}

impl Named for GrazingNormals {
    const WHAT: &'static str = "treatment of grazing normals";
    const NAMES: &'static [(&'static str, Self)] = &[("soften", Self::Soften), ("keep", Self::Keep)];
}

/// Settings of rendering.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct RenderSettings {
    /// Width in pixels, 1 to 16384.
    pub width: u32,
    /// Height in pixels, 1 to 16384.
    pub height: u32,
    /// Samples per pixel: 1, 4 or 16; each is shaded.
    pub samples: u32,
    /// The reflectance model.
    pub shading: Shading,
    /// The source of shading normals.
    pub surface: SurfaceSettings,
    /// How `ggx` and `cook-torrance` conserve energy.
    pub energy: Energy,
    /// `true` if subpixel relief widens the highlight instead of sparkling.
    pub specular_aa: bool,
    /// How mapped normals at grazing angles are treated. The models as printed keep them.
    pub grazing_normals: GrazingNormals,
    /// `true` if lights cast shadows.
    pub shadows: bool,
    /// `true` to place the object on a ground that shows only its shadow.
    pub ground: bool,
    /// `true` to fill [`Frame::aovs`](super::Frame::aovs).
    pub aovs: bool,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            width: 1024,
            height: 1024,
            samples: 4,
            shading: Shading::Ggx,
            surface: SurfaceSettings::default(),
            energy: Energy::Compensated,
            specular_aa: true,
            grazing_normals: GrazingNormals::Soften,
            shadows: false,
            ground: false,
            aovs: false,
        }
    }
}

impl RenderSettings {
    /// Returns the settings effective for the model: models as printed in the paper use no corrections.
    ///
    /// This is the only place that checks whether an image's model is a printed one.
    pub(super) fn as_taken(&self) -> Self {
        let corrected = !self.shading.is_printed();
        let grazing_normals = if corrected { self.grazing_normals } else { GrazingNormals::Keep };
        Self { specular_aa: self.specular_aa && corrected, grazing_normals, ..self.clone() }
    }
}

/// An image to render: camera, light and settings.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The light on the scene.
    pub lighting: &'a Lighting,
    /// The settings of rendering.
    pub settings: &'a RenderSettings,
}

impl Shot<'_> {
    /// Rejects light and scales that would exceed the range of an image's numbers.
    pub(super) fn check(&self) -> error::Result<()> {
        self.lighting.check()?;
        match self.settings.surface.bump_scale {
            Some(scale) if scale.is_nan() || scale.abs() > MOST_SCALE => {
                Err(Error::invalid(format!("bump scale {scale}"), "it must be between -1e18 and 1e18"))
            }
            _ => Ok(()),
        }
    }
}

/// A shot that has been validated, with the settings effective for its model and the camera's transform.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CheckedShot {
    /// The settings; models as printed in the paper use no corrections.
    pub settings: RenderSettings,
    /// The sample positions in a pixel.
    pub pattern: SamplePattern,
    /// The transform to reversed-z clip space: 1 at the near plane, 0 at the far plane or at infinity.
    pub clip_from_world: Mat4,
    /// The viewpoint of the scene.
    pub eye: Eye,
}

impl CheckedShot {
    /// Validates a shot like [`super::Pass::new`].
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] or [`crate::Error::Limit`] for a size, sample count, light or camera that cannot be
    /// rendered.
    pub fn new(shot: &Shot<'_>) -> error::Result<Self> {
        shot.check()?;
        let settings = shot.settings.as_taken();
        Image::check_size(settings.width, settings.height)?;
        let pattern = SamplePattern::new(settings.samples)?;
        let View { clip_from_world, eye, .. } = View::new(shot.camera, settings.width, settings.height)?;
        Ok(Self { settings, pattern, clip_from_world, eye })
    }
}

/// The light of an environment as it falls on a scene.
#[derive(Debug, Clone)]
pub struct EnvironmentLight {
    /// The source of the light.
    pub environment: Arc<Environment>,
    /// The rotation about +y in radians, counter-clockwise as seen from above.
    pub rotation: f64,
    /// The factor of its radiance, at least 0.
    pub intensity: f32,
    /// `true` if it is visible wherever no surface is in front of it.
    pub visible: bool,
}

impl EnvironmentLight {
    /// The direction `world` in the environment's local space.
    pub fn to_environment(&self, world: Vec3) -> Vec3 {
        self.turn().to_environment(world)
    }

    /// The world-space direction of the environment's `direction`.
    pub fn to_world(&self, direction: Vec3) -> Vec3 {
        self.turn().to_world(direction)
    }

    /// The precomputed rotation for both of these, for many directions.
    pub fn turn(&self) -> Turn<f32> {
        Turn { sin: scalar::sin(self.rotation) as f32, cos: scalar::cos(self.rotation) as f32 }
    }
}

/// The light on a scene.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Lighting {
    /// The lights, of any number.
    pub lights: Vec<Light>,
    /// Ambient radiance I_a from all directions, linear RGB; reflected by k_a and darkened by occlusion maps.
    pub ambient: Vec3,
    /// Light from infinitely far away in all directions; not serialisable.
    #[serde(serialize_with = "write_no_environment", deserialize_with = "read_no_environment")]
    pub environment: Option<EnvironmentLight>,
}

impl Lighting {
    /// Checks ranges; all renderers do so first.
    ///
    /// # Errors
    /// [`Error::Invalid`] if light is negative, NaN, or above [`Light::MOST`].
    pub fn check(&self) -> error::Result<()> {
        let intensity = self.environment.as_ref().map(|e| ("environment", Vec3::splat(e.intensity)));
        let lights = self.lights.iter().map(|light| ("light", light.color));
        let mut all = lights.chain([("ambient", self.ambient)]).chain(intensity);
        match all.find(|(_, color)| !Light::is_strength(*color)) {
            Some((what, _)) => Err(Error::invalid(what, "its strength must be between 0 and 1e12")),
            None => Ok(()),
        }
    }
}

/// Rejects the light of an environment: it contains an image.
fn write_no_environment<S: serde::Serializer>(
    light: &Option<EnvironmentLight>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match light {
        None => serializer.serialize_none(),
        Some(_) => Err(serde::ser::Error::custom(
            "environment light contains an image; serialise its `EnvironmentOptions` instead",
        )),
    }
}

/// Accepts only absence.
fn read_no_environment<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<EnvironmentLight>, D::Error> {
    <Option<()> as serde::Deserialize>::deserialize(deserializer).map(|_| None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Orbit;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn light_that_no_image_can_hold_is_refused() {
        for wrong in [-1.0, f32::NAN, f32::INFINITY, 1e20] {
            let lighting = Lighting { ambient: Vec3::new(0.0, wrong, 0.0), ..Lighting::default() };
            assert!(lighting.check().unwrap_err().to_string().starts_with("ambient: "), "{wrong}");
        }
        assert!(Lighting::default().check().is_ok());
    }

    #[test]
    fn an_environment_turns_counter_clockwise_seen_from_above() {
        let picture = Image::new(2, 1, [1.0; 4]).unwrap();
        let environment = Arc::new(Environment::new(picture).unwrap());
        let light = EnvironmentLight { environment, rotation: FRAC_PI_2, intensity: 1.0, visible: true };
        let (x, z) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
        // Seen from above with +x to the right, +z points down the page.
        assert!((light.to_world(z) - x).length() < 1e-6);
        assert!((light.to_world(x) + z).length() < 1e-6);
        let any = Vec3::new(0.6, -0.48, 0.64);
        assert!((light.to_environment(light.to_world(any)) - any).length() < 1e-6);
    }

    #[test]
    fn models_as_printed_take_no_corrections_and_nonsense_is_refused() {
        let orbit =
            Orbit { azimuth: 0.0, elevation: 0.0, distance: 3.0, target: Default::default(), fov_y: 0.7 };
        let (camera, lighting) = (orbit.camera(1.0), Lighting::default());
        let printed = RenderSettings { shading: Shading::GgxPrinted, ..RenderSettings::default() };
        let check = |settings: &RenderSettings| {
            CheckedShot::new(&Shot { camera: &camera, lighting: &lighting, settings })
        };
        assert!(printed.specular_aa && !check(&printed).unwrap().settings.specular_aa);
        assert!(check(&RenderSettings { samples: 3, ..RenderSettings::default() }).is_err());
        assert!(check(&RenderSettings { width: 0, ..RenderSettings::default() }).is_err());
    }
}
