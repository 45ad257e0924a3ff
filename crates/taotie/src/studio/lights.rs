//! The lighting of a scene: the requested lights, each written as one line of text, else the file's, else key, fill
//! and rim.

use super::viewpoint::View;
use std::collections::BTreeMap;
use std::str::FromStr;
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Vec3;
use taotie_engine::render::{EnvironmentLight, Lighting};
use taotie_engine::scene::{Falloff, Light, LightKind, Scene, from_view, three_point_rig};
use taotie_io::parse;

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
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
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

/// Default strength, and default angle from the axis of a spot to its edge in degrees.
const DEFAULT_STRENGTH: f64 = 3.0;
const DEFAULT_ANGLE: f64 = 30.0;

/// A light fixed in the studio: it keeps its position relative to the camera while a turntable turns the object.
///
/// It is parsed from a line of text: `point at=X,Y,Z`, `spot at=X,Y,Z toward=X,Y,Z angle=DEGREES inner=DEGREES`,
/// `directional from=AZIMUTH,ELEVATION` (degrees, relative to the view) or `directional toward=X,Y,Z`, each with
/// `strength=`, `color=` and `falloff=none|inverse-square`. Angles of a spot are measured from its axis.
///
/// ```
/// use taotie::studio::{LightForm, LightSpec};
///
/// let lamp: LightSpec = "point at=1,2,3 strength=2".parse()?;
/// assert_eq!(lamp.color.to_array(), [2.0; 3]);
/// assert!("point strength=2".parse::<LightSpec>().is_err());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LightSpec {
    /// Its form.
    pub form: LightForm,
    /// Linear RGB strength: intensity in W/sr (candela) for points and spots, irradiance (lux) for directions.
    pub color: Vec3,
    /// The falloff of the strength of points and spots with distance.
    pub falloff: Falloff,
}

/// The form of a light fixed in the studio. Positions are in world space before the object turns.
///
/// ```
/// use taotie::Vec3;
/// use taotie::studio::{LightForm, LightSpec};
///
/// let lamp: LightSpec = "point at=1,2,3".parse()?;
/// assert_eq!(lamp.form, LightForm::Point { position: Vec3::new(1.0, 2.0, 3.0) });
/// let key = LightForm::FromView { azimuth: 90f64.to_radians(), elevation: 0.0 };
/// assert_eq!("directional from=90,0".parse::<LightSpec>()?.form, key);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightForm {
    /// Shines from a position in all directions.
    Point {
        /// World space.
        position: Vec3,
    },
    /// Shines from a position within a cone.
    Spot {
        /// World space.
        position: Vec3,
        /// Unit direction of the cone's axis, world space.
        direction: Vec3,
        /// Angle from the axis up to which the light has full strength, radians, in [0, `outer`).
        inner: f64,
        /// Angle from the axis beyond which there is no light, radians, at most π/2.
        outer: f64,
    },
    /// Shines from infinitely far away.
    Directional {
        /// Unit direction in which the light travels, world space.
        direction: Vec3,
    },
    /// Shines from infinitely far away, from a direction relative to the viewer.
    FromView {
        /// Radians to the right of the viewer.
        azimuth: f64,
        /// Radians above the viewer.
        elevation: f64,
    },
}

impl LightSpec {
    /// Returns the light as it shines on the scene in this view.
    pub fn light(&self, view: View<'_>) -> Light {
        let world = view.world_from_studio();
        let place = |p: Vec3| world.transform_point(p.to_f64()).to_f32();
        let turn = |d: Vec3| world.transform_vector(d.to_f64()).to_f32();
        let kind = match self.form {
            LightForm::Point { position } => LightKind::Point { position: place(position) },
            LightForm::Spot { position, direction, inner, outer } => {
                LightKind::Spot { position: place(position), direction: turn(direction), inner, outer }
            }
            LightForm::Directional { direction } => LightKind::Directional { direction: turn(direction) },
            LightForm::FromView { azimuth, elevation } => {
                let direction = -from_view(&view.front(), azimuth, elevation);
                LightKind::Directional { direction: turn(direction) }
            }
        };
        Light { name: String::new(), kind, color: self.color, falloff: self.falloff }
    }
}

impl FromStr for LightSpec {
    type Err = Error;

    /// Parses a light in the format described at [`LightSpec`].
    ///
    /// # Errors
    /// [`Error::Invalid`] that names the line, the word and what is expected.
    fn from_str(line: &str) -> Result<Self> {
        let in_line = |error: Error| Error::invalid(format!("light \"{line}\""), reason(error));
        Words::new(line).and_then(Words::spec).map_err(in_line)
    }
}

/// Returns the reason why a value is invalid, prefixed by the word that contains it.
fn reason(error: Error) -> String {
    match error {
        Error::Invalid { what, why } if what.is_empty() => why,
        other => other.to_string(),
    }
}

/// Returns an error about the line as a whole.
fn wrong(why: impl Into<String>) -> Error {
    Error::invalid("", why)
}

/// The words of a light: `KIND key=value key=value`.
struct Words<'a> {
    kind: &'a str,
    values: BTreeMap<&'a str, &'a str>,
}

impl<'a> Words<'a> {
    fn new(line: &'a str) -> Result<Self> {
        let mut words = line.split_whitespace();
        let kind = words.next().ok_or_else(|| wrong("empty; expected point, spot or directional"))?;
        let mut values = BTreeMap::new();
        for word in words {
            let (key, value) =
                word.split_once('=').ok_or_else(|| wrong(format!("expected key=value, found `{word}`")))?;
            values.insert(key, value);
        }
        Ok(Self { kind, values })
    }

    fn spec(mut self) -> Result<LightSpec> {
        let form = match self.kind {
            "point" => LightForm::Point { position: self.position()? },
            "spot" => self.spot()?,
            "directional" => self.directional()?,
            other => {
                let choice = "expected point, spot or directional";
                return Err(wrong(format!("unknown light `{other}`; {choice}")));
            }
        };
        let strength = self.take("strength", parse::number)?.unwrap_or(DEFAULT_STRENGTH);
        let color = self.take("color", parse::color)?.unwrap_or(Vec3::splat(1.0));
        let falloff = self.take("falloff", falloff)?.unwrap_or_default();
        if let Some((key, _)) = self.values.first_key_value() {
            return Err(wrong(format!("unknown key `{key}` for a {} light", self.kind)));
        }
        if strength < 0.0 {
            return Err(Error::invalid("strength", "it must be at least 0"));
        }
        let color = color * strength as f32;
        if !Light::is_strength(color) {
            return Err(Error::invalid("strength", "it must be at most 1e12, multiplied by the colour"));
        }
        Ok(LightSpec { form, color, falloff })
    }

    fn position(&mut self) -> Result<Vec3> {
        Ok(self.need("at", parse::vector)?.to_f32())
    }

    fn spot(&mut self) -> Result<LightForm> {
        let position = self.position()?;
        let toward = self.need("toward", parse::vector)?;
        let direction = unit(toward - position.to_f64())?;
        let outer = self.take("angle", parse::number)?.unwrap_or(DEFAULT_ANGLE);
        let inner = self.take("inner", parse::number)?.unwrap_or(outer * 0.8);
        if !(outer > 0.0 && outer <= 90.0 && inner >= 0.0 && inner < outer) {
            return Err(wrong("angle must be in (0, 90] degrees and inner in [0, angle)"));
        }
        let [inner, outer] = [inner, outer].map(f64::to_radians);
        Ok(LightForm::Spot { position, direction, inner, outer })
    }

    /// Parses a light from a direction relative to the view, or in a world direction.
    fn directional(&mut self) -> Result<LightForm> {
        if let Some(toward) = self.take("toward", parse::vector)? {
            return Ok(LightForm::Directional { direction: unit(toward)? });
        }
        match self.need("from", parse::numbers)?.as_slice() {
            [azimuth, elevation] => {
                Ok(LightForm::FromView { azimuth: azimuth.to_radians(), elevation: elevation.to_radians() })
            }
            _ => Err(Error::invalid("from", "use AZIMUTH,ELEVATION in degrees, such as from=-60,20")),
        }
    }

    fn take<T>(&mut self, key: &str, read: impl Fn(&str) -> Result<T>) -> Result<Option<T>> {
        let value = self.values.remove(key);
        value.map(|value| read(value).map_err(|error| of_key(key, error))).transpose()
    }

    fn need<T>(&mut self, key: &str, read: impl Fn(&str) -> Result<T>) -> Result<T> {
        self.take(key, read)?.ok_or_else(|| wrong(format!("a {} light needs {key}=", self.kind)))
    }
}

/// Returns the error of a value, prefixed with its key.
fn of_key(key: &str, error: Error) -> Error {
    match error {
        Error::Invalid { why, .. } => Error::invalid(key, why),
        other => other,
    }
}

fn falloff(value: &str) -> Result<Falloff> {
    match value {
        "none" => Ok(Falloff::None),
        "inverse-square" => Ok(Falloff::InverseSquare),
        _ => Err(wrong(format!("unknown falloff `{value}`; expected none or inverse-square"))),
    }
}

fn unit(toward: Vec3<f64>) -> Result<Vec3> {
    if toward.length() == 0.0 {
        return Err(Error::invalid("toward", "the direction must not be zero"));
    }
    Ok(toward.normalize().to_f32())
}

#[cfg(test)]
mod tests {
    use super::*;

    use super::super::viewpoint::{CameraOptions, Framing, Viewpoint};
    use std::f64::consts::FRAC_PI_2;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::scene::Material;

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

    #[test]
    fn reads_every_kind() {
        let point: LightSpec = "point at=1,2,3 strength=2 color=0.5 falloff=none".parse().unwrap();
        assert_eq!(point.form, LightForm::Point { position: Vec3::new(1.0, 2.0, 3.0) });
        assert_eq!((point.color, point.falloff), (Vec3::splat(1.0), Falloff::None));
        let aside: LightSpec = "directional from=90,0".parse().unwrap();
        assert_eq!(aside.form, LightForm::FromView { azimuth: 90f64.to_radians(), elevation: 0.0 });
        let down: LightSpec = "directional toward=0,-2,0".parse().unwrap();
        assert_eq!(down.form, LightForm::Directional { direction: Vec3::new(0.0, -1.0, 0.0) });
        let spot: LightSpec = "spot at=0,1,0 toward=0,0,0 angle=20".parse().unwrap();
        assert!(matches!(spot.form, LightForm::Spot { outer, .. } if outer == 20f64.to_radians()));
    }

    #[test]
    fn says_what_is_wrong() {
        let why = |line: &str| line.parse::<LightSpec>().unwrap_err().to_string();
        assert_eq!(why(""), "light \"\": empty; expected point, spot or directional");
        assert!(why("sun from=0,0").contains("point, spot or directional"));
        assert!(why("point").contains("at="));
        assert!(why("point at=0,0").contains(": at: expected three numbers"));
        assert!(why("point at=0,0,0 bright=3").contains("bright"));
        assert!(why("spot at=0,0,0 toward=0,0,0").contains("toward: the direction must not be zero"));
        assert!(why("directional from=0,0 strength=1e13").contains("strength: it must be at most 1e12"));
        assert!(why("directional from=1").contains("from: use AZIMUTH"));
    }
}
