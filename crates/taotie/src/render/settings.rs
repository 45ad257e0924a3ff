//! Settings of an image.

use crate::error::{self, Error};
use crate::math::{SimdLevel, Vec3, scalar};
use crate::names::Named;
use crate::pixel::Turn;
use crate::scene::{Camera, Light};
use crate::shade::environment::Environment;
use crate::shade::{Energy, Shading};
use crate::surface::{SurfaceMethod, TangentMethod};
use std::sync::Arc;

/// The largest scale of a height map.
const MOST_SCALE: f32 = 1e18;

/// The preparation of surfaces: where shading normals come from.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct SurfaceSettings {
    /// The method, or `None` for the best that each material provides: its normal map, else its height map, else
    /// smooth normals.
    pub method: Option<SurfaceMethod>,
    /// The method that makes tangents, or `None` for the mesh's own, else MikkTSpace.
    pub tangents: Option<TangentMethod>,
    /// The scale of the height map: for `bump` the height of 1 in model units, `None` for the material's; for
    /// `bump-printed` the paper's factor, `None` for 5.
    pub bump_scale: Option<f32>,
    /// The SIMD level of everything that is done for an image, from vertex normals to pixels: a choice of speed, never
    /// of pixels.
    pub simd: SimdLevel,
}

/// The treatment of mapped normals that face away from the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum GrazingNormals {
    /// The normal is bent until the viewer just sees it.
    #[default]
    Soften,
    /// The normal is kept as in the map, with black fringes at silhouettes.
    Keep,
}

impl Named for GrazingNormals {
    const WHAT: &'static str = "way with normals at grazing angles";
    const NAMES: &'static [(&'static str, Self)] = &[("soften", Self::Soften), ("keep", Self::Keep)];
}

/// Settings of rendering.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct RenderSettings {
    /// Pixels across, 1 to 16384.
    pub width: u32,
    /// Pixels down, 1 to 16384.
    pub height: u32,
    /// Samples a pixel: 1, 4 or 16; each is shaded.
    pub samples: u32,
    /// The reflectance model.
    pub shading: Shading,
    /// The source of shading normals.
    pub surface: SurfaceSettings,
    /// The method by which `ggx` and `cook-torrance` keep their energy.
    pub energy: Energy,
    /// `true` where relief too fine for the pixel widens the highlight instead of sparkling.
    pub specular_aa: bool,
    /// The treatment of mapped normals at grazing angles. The models as printed keep them.
    pub grazing_normals: GrazingNormals,
    /// `true` where lights cast shadows.
    pub shadows: bool,
    /// `true` where the object stands on a ground that shows nothing but its shadow.
    pub ground: bool,
    /// `true` where [`Frame::aovs`](super::Frame::aovs) is filled.
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
    /// The settings as the model takes them: models as printed in the paper take no corrections.
    ///
    /// This is the one place that asks whether an image's model is as printed.
    pub(super) fn as_taken(&self) -> Self {
        let corrected = !self.shading.is_printed();
        let grazing_normals = if corrected { self.grazing_normals } else { GrazingNormals::Keep };
        Self { specular_aa: self.specular_aa && corrected, grazing_normals, ..self.clone() }
    }
}

/// An image to render: from where, in what light, and how.
#[derive(Debug, Clone, Copy)]
pub struct Shot<'a> {
    /// The camera that it is taken from.
    pub camera: &'a Camera,
    /// The light on the scene.
    pub lighting: &'a Lighting,
    /// The settings of rendering.
    pub settings: &'a RenderSettings,
}

impl Shot<'_> {
    /// Refuses light and scales that no number of an image could hold.
    pub(super) fn check(&self) -> error::Result<()> {
        self.lighting.check()?;
        match self.settings.surface.bump_scale {
            Some(scale) if scale.is_nan() || scale.abs() > MOST_SCALE => {
                Err(Error::invalid(format!("bump scale {scale}"), "it must lie between -1e18 and 1e18"))
            }
            _ => Ok(()),
        }
    }
}

/// Light from all around as it falls on a scene.
#[derive(Debug, Clone)]
pub struct EnvironmentLight {
    /// The source of its light.
    pub environment: Arc<Environment>,
    /// Radians by which it is turned about +y, counter-clockwise as seen from above.
    pub rotation: f64,
    /// A factor of its radiance, at least 0.
    pub intensity: f32,
    /// `true` where it is seen wherever nothing stands before it.
    pub visible: bool,
}

impl EnvironmentLight {
    /// The direction in the environment's own space that lies in direction `world`.
    pub fn to_environment(&self, world: Vec3) -> Vec3 {
        self.turn().to_environment(world)
    }

    /// The world-space direction in which the environment's `direction` lies.
    pub fn to_world(&self, direction: Vec3) -> Vec3 {
        self.turn().to_world(direction)
    }

    /// Both of these for many directions.
    pub fn turn(&self) -> Turn<f32> {
        Turn { sin: scalar::sin(self.rotation) as f32, cos: scalar::cos(self.rotation) as f32 }
    }
}

/// The light on a scene.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct Lighting {
    /// The lights, of any number.
    pub lights: Vec<Light>,
    /// Radiance I_a from all around, linear RGB; reflected by k_a and darkened by occlusion maps.
    pub ambient: Vec3,
    /// Light from infinitely far all around; serde cannot say it.
    #[cfg_attr(
        feature = "serde",
        serde(serialize_with = "write_no_environment", deserialize_with = "read_no_environment")
    )]
    pub environment: Option<EnvironmentLight>,
}

impl Lighting {
    /// Checks ranges; all renderers do so before they begin.
    ///
    /// # Errors
    /// [`Error::Invalid`] where light is negative, not a number, or above [`Light::MOST`].
    pub fn check(&self) -> error::Result<()> {
        let intensity = self.environment.as_ref().map(|e| ("environment", Vec3::splat(e.intensity)));
        let lights = self.lights.iter().map(|light| ("light", light.color));
        let mut all = lights.chain([("ambient", self.ambient)]).chain(intensity);
        match all.find(|(_, color)| !Light::is_strength(*color)) {
            Some((what, _)) => Err(Error::invalid(what, "its strength must lie between 0 and 1e12")),
            None => Ok(()),
        }
    }
}

/// Refuses the light of an environment: it holds an image.
#[cfg(feature = "serde")]
fn write_no_environment<S: serde::Serializer>(
    light: &Option<EnvironmentLight>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match light {
        None => serializer.serialize_none(),
        Some(_) => Err(serde::ser::Error::custom(
            "light of an environment holds an image; write its `EnvironmentOptions` instead",
        )),
    }
}

/// Reads nothing, and refuses everything else.
#[cfg(feature = "serde")]
fn read_no_environment<'de, D: serde::Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<EnvironmentLight>, D::Error> {
    <Option<()> as serde::Deserialize>::deserialize(deserializer).map(|_| None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
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
}
