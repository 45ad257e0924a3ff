//! The lighting of a scene: the requested lights, else the file's, else key, fill and rim.

use super::light_spec::LightSpec;
use super::viewpoint::View;
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::render::{EnvironmentLight, Lighting};
use crate::scene::{Light, Scene, three_point_rig};

/// Default ambient radiance without lights: a dim room.
const ROOM: f32 = 0.12;

/// The requested lights; by default those of the file, else key, fill and rim in a dim room.
///
/// ```
/// use taotie::studio::LightOptions;
///
/// let raking = LightOptions { lights: vec!["directional from=-75,10 strength=4".parse()?], ..LightOptions::default() };
/// assert_eq!(raking.lights.len(), 1);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct LightOptions {
    /// Lights fixed relative to the camera while a turntable turns the object; the file's turn with it.
    pub lights: Vec<LightSpec>,
    /// Radiance from all around, linear RGB; `None` for none if lights or an environment are specified, else a dim
    /// room.
    pub ambient: Option<Vec3>,
}

impl LightOptions {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a colour is negative, NaN, or above [`Light::MOST`].
    pub fn check(&self) -> Result<()> {
        let colors = self.lights.iter().map(|light| ("light", light.color));
        let mut colors = colors.chain(self.ambient.map(|ambient| ("ambient", ambient)));
        match colors.find(|(_, color)| !Light::is_strength(*color)) {
            Some((what, _)) => Err(Error::invalid(what, "its colour must be between 0 and 1e12")),
            None => Ok(()),
        }
    }

    /// Returns the lighting of `scene` in this view. The environment is fixed relative to the camera; with it, only
    /// the requested lights and the file's are used.
    pub fn lighting(
        &self,
        environment: Option<&EnvironmentLight>,
        scene: &Scene,
        view: View<'_>,
    ) -> Lighting {
        let lit = environment.is_some() || !self.lights.is_empty() || !scene.lights().is_empty();
        let ambient = self.ambient.unwrap_or(Vec3::splat(if lit { 0.0 } else { ROOM }));
        let turned = |light: &EnvironmentLight| EnvironmentLight {
            rotation: light.rotation - view.angle(),
            ..light.clone()
        };
        let lights = if lit { self.named(scene, view) } else { three_point_rig(&view.camera()) };
        Lighting { lights, ambient, environment: environment.map(turned) }
    }

    fn named(&self, scene: &Scene, view: View<'_>) -> Vec<Light> {
        match self.lights.is_empty() {
            true => scene.lights().to_vec(),
            false => self.lights.iter().map(|spec| spec.light(view)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::viewpoint::{CameraOptions, Framing, Viewpoint};
    use super::*;
    use crate::mesh::Mesh;
    use crate::scene::{LightKind, Material};
    use std::f64::consts::FRAC_PI_2;

    fn ball() -> (Scene, Viewpoint) {
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 16, 8), Material::default()).unwrap();
        let front = CameraOptions { azimuth: 0.0, elevation: 0.0, ..CameraOptions::default() };
        let framing = Framing { size: [9, 9], all_around: false };
        let viewpoint = Viewpoint::choose(&front, framing, &scene).unwrap();
        (scene, viewpoint)
    }

    fn direction(light: &Light) -> Vec3 {
        let LightKind::Directional { direction } = light.kind else { panic!("not directional") };
        direction
    }

    #[test]
    fn lights_asked_for_stand_still_with_the_camera() {
        let (scene, viewpoint) = ball();
        let options = LightOptions {
            lights: vec!["directional from=90,0".parse().unwrap()],
            ..LightOptions::default()
        };
        let shines = |turn| direction(&options.lighting(None, &scene, viewpoint.at(turn)).lights[0]);
        assert!((shines(0.0) - Vec3::new(-1.0, 0.0, 0.0)).length() < 1e-6);
        assert!((shines(FRAC_PI_2) - Vec3::new(0.0, 0.0, -1.0)).length() < 1e-6, "{:?}", shines(FRAC_PI_2));
    }

    #[test]
    fn what_no_light_can_be_is_refused() {
        for wrong in [-1.0, f32::NAN, f32::INFINITY, 2.0 * Light::MOST] {
            let ambient = Some(Vec3::splat(wrong));
            assert!(LightOptions { ambient, ..LightOptions::default() }.check().is_err(), "{wrong}");
            let mut light: LightSpec = "point at=0,1,0".parse().unwrap();
            light.color.y = wrong;
            let options = LightOptions { lights: vec![light], ambient: None };
            assert!(options.check().unwrap_err().to_string().starts_with("light: "), "{wrong}");
        }
        assert!(LightOptions { ambient: Some(Vec3::default()), ..LightOptions::default() }.check().is_ok());
    }

    #[cfg(feature = "serde")]
    #[test]
    fn options_survive_json() {
        let line = "spot at=0,1,0 toward=0,0,0 angle=20 falloff=none";
        let ambient = Some(Vec3::splat(0.5));
        let options = LightOptions { lights: vec![line.parse().unwrap()], ambient };
        let json = serde_json::to_string(&options).unwrap();
        assert!(
            json.contains(r#""position":[0.0,1.0,0.0]"#) && json.contains(r#""falloff":"none""#),
            "{json}"
        );
        assert_eq!(serde_json::from_str::<LightOptions>(&json).unwrap(), options);
        assert_eq!(serde_json::from_str::<LightOptions>("{}").unwrap(), LightOptions::default());
    }

    #[test]
    fn a_dim_room_where_nothing_is_named() {
        let (scene, viewpoint) = ball();
        let lighting = LightOptions::default().lighting(None, &scene, viewpoint.at(0.0));
        assert_eq!((lighting.lights.len(), lighting.ambient), (3, Vec3::splat(ROOM)));
        let dark = LightOptions { ambient: Some(Vec3::default()), ..LightOptions::default() };
        assert_eq!(dark.lighting(None, &scene, viewpoint.at(0.0)).ambient, Vec3::default());
    }
}
