//! The lights asked for.

use super::LightArgs;
use super::camera::Viewpoint;
use crate::options;
use anyhow::{Result, anyhow, bail};
use std::collections::BTreeMap;
use taotie::math::Vec3;
use taotie::render::{EnvironmentLight, Lighting};
use taotie::scene::{Camera, Falloff, Light, LightKind, Scene, from_view, three_point_rig};

/// Ambient radiance where no light is named: a dim room.
const ROOM: f32 = 0.12;

/// The light on a scene after it has turned by `turn` radians on a turntable.
///
/// Ambient light is as asked for, else none where lights or an environment were named, else a dim room. The environment
/// stands still with the camera while the turntable turns.
pub fn lighting(
    args: &LightArgs,
    environment: Option<&EnvironmentLight>,
    scene: &Scene,
    viewpoint: &Viewpoint,
    turn: f64,
) -> Result<Lighting> {
    let lit = environment.is_some() || !args.lights.is_empty() || !scene.lights().is_empty();
    let ambient = args.ambient.unwrap_or(Vec3::splat(if lit { 0.0 } else { ROOM }));
    let turned =
        |light: &EnvironmentLight| EnvironmentLight { rotation: light.rotation - turn, ..light.clone() };
    let lights = if environment.is_some() && args.lights.is_empty() {
        scene.lights().to_vec()
    } else {
        choose(args, scene, viewpoint, turn)?
    };
    Ok(Lighting { lights, ambient, environment: environment.map(turned) })
}

/// The lights of a picture: those asked for, else the file's, else key, fill and rim.
///
/// Lights that were asked for stand still with the camera while a turntable turns; the file's turn with the object.
fn choose(args: &LightArgs, scene: &Scene, viewpoint: &Viewpoint, turn: f64) -> Result<Vec<Light>> {
    if args.lights.is_empty() {
        let rig = || three_point_rig(&viewpoint.camera(turn));
        return Ok(if scene.lights().is_empty() { rig() } else { scene.lights().to_vec() });
    }
    let camera = viewpoint.camera(0.0);
    let turned = viewpoint.turned(turn);
    args.lights
        .iter()
        .map(|spec| {
            let mut light = parse(spec, &camera).map_err(|why| anyhow!("--light \"{spec}\": {why}"))?;
            let place = |p: Vec3| turned.transform_point(p.to_f64()).to_f32();
            let turn = |d: Vec3| turned.transform_vector(d.to_f64()).to_f32();
            light.kind = match light.kind {
                LightKind::Point { position } => LightKind::Point { position: place(position) },
                LightKind::Directional { direction } => LightKind::Directional { direction: turn(direction) },
                LightKind::Spot { position, direction, inner, outer } => {
                    LightKind::Spot { position: place(position), direction: turn(direction), inner, outer }
                }
            };
            Ok(light)
        })
        .collect()
}

/// The words of a light: `KIND key=value key=value`.
struct Words<'a> {
    kind: &'a str,
    values: BTreeMap<&'a str, &'a str>,
}

impl<'a> Words<'a> {
    fn new(spec: &'a str) -> Result<Self> {
        let mut words = spec.split_whitespace();
        let kind =
            words.next().ok_or_else(|| anyhow!("it is empty; start with point, spot or directional"))?;
        let mut values = BTreeMap::new();
        for word in words {
            let (key, value) = word.split_once('=').ok_or_else(|| anyhow!("`{word}` is not key=value"))?;
            values.insert(key, value);
        }
        Ok(Self { kind, values })
    }

    fn take<T>(&mut self, key: &str, read: impl Fn(&str) -> Result<T, String>) -> Result<Option<T>> {
        self.values.remove(key).map(|value| read(value).map_err(|why| anyhow!("{key}: {why}"))).transpose()
    }

    fn need<T>(&mut self, key: &str, read: impl Fn(&str) -> Result<T, String>) -> Result<T> {
        self.take(key, read)?.ok_or_else(|| anyhow!("a {} light needs {key}=", self.kind))
    }
}

fn parse(spec: &str, camera: &Camera) -> Result<Light> {
    let mut words = Words::new(spec)?;
    let position =
        |words: &mut Words<'_>| Ok::<_, anyhow::Error>(words.need("at", options::vector)?.to_f32());
    let kind = match words.kind {
        "point" => LightKind::Point { position: position(&mut words)? },
        "spot" => {
            let position = position(&mut words)?;
            spot(position, &mut words)?
        }
        "directional" => LightKind::Directional { direction: direction(&mut words, camera)? },
        other => bail!("there is no light of the kind `{other}`; choose point, spot or directional"),
    };
    let strength = words.take("strength", options::number)?.unwrap_or(3.0);
    let color = words.take("color", options::color)?.unwrap_or(Vec3::splat(1.0));
    let falloff = words.take("falloff", falloff)?;
    if let Some((key, _)) = words.values.first_key_value() {
        bail!("a {} light has no `{key}`", words.kind);
    }
    if strength < 0.0 {
        bail!("strength: it must not be below 0");
    }
    Ok(Light {
        name: String::new(),
        kind,
        color: color * strength as f32,
        falloff: falloff.unwrap_or(Falloff::InverseSquare),
    })
}

fn falloff(value: &str) -> Result<Falloff, String> {
    match value {
        "none" => Ok(Falloff::None),
        "inverse-square" => Ok(Falloff::InverseSquare),
        _ => Err(format!("there is no falloff `{value}`; choose none or inverse-square")),
    }
}

/// The way the light travels: from a place relative to the view, or a world direction.
fn direction(words: &mut Words<'_>, camera: &Camera) -> Result<Vec3> {
    if let Some(toward) = words.take("toward", options::vector)? {
        return unit(toward, "toward");
    }
    match words.need("from", options::numbers)?.as_slice() {
        [azimuth, elevation] => Ok(-from_view(camera, azimuth.to_radians(), elevation.to_radians())),
        _ => bail!("from: write AZIMUTH,ELEVATION in degrees, such as from=-60,20"),
    }
}

fn spot(position: Vec3, words: &mut Words<'_>) -> Result<LightKind> {
    let toward = words.need("toward", options::vector)?;
    let direction = unit(toward - position.to_f64(), "toward")?;
    let outer = words.take("angle", options::number)?.unwrap_or(30.0);
    let inner = words.take("inner", options::number)?.unwrap_or(outer * 0.8);
    if !(outer > 0.0 && outer <= 90.0 && inner >= 0.0 && inner < outer) {
        bail!("angle must lie in (0, 90] degrees and inner in [0, angle)");
    }
    let [inner, outer] = [inner, outer].map(f64::to_radians);
    Ok(LightKind::Spot { position, direction, inner, outer })
}

fn unit(v: Vec3<f64>, key: &str) -> Result<Vec3> {
    if v.length() == 0.0 {
        bail!("{key}: the direction has no length");
    }
    Ok(v.normalize().to_f32())
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::scene::Orbit;

    fn front() -> Camera {
        Orbit { azimuth: 0.0, elevation: 0.0, distance: 3.0, target: Vec3::default(), fov_y: 0.5 }.camera(1.0)
    }

    #[test]
    fn reads_every_kind() {
        let point = parse("point at=1,2,3 strength=2 color=0.5 falloff=none", &front()).unwrap();
        assert_eq!(point.kind, LightKind::Point { position: Vec3::new(1.0, 2.0, 3.0) });
        assert_eq!((point.color, point.falloff), (Vec3::splat(1.0), Falloff::None));
        let LightKind::Directional { direction } = parse("directional from=90,0", &front()).unwrap().kind
        else {
            panic!("not directional")
        };
        assert!((direction - Vec3::new(-1.0, 0.0, 0.0)).length() < 1e-6);
        assert!(matches!(
            parse("spot at=0,1,0 toward=0,0,0 angle=20", &front()).unwrap().kind,
            LightKind::Spot { .. }
        ));
    }

    #[test]
    fn says_what_is_wrong() {
        let why = |spec: &str| parse(spec, &front()).unwrap_err().to_string();
        assert!(why("").contains("empty"));
        assert!(why("sun from=0,0").contains("point, spot or directional"));
        assert!(why("point").contains("at="));
        assert!(why("point at=0,0").contains("three numbers"));
        assert!(why("point at=0,0,0 bright=3").contains("bright"));
        assert!(why("spot at=0,0,0 toward=0,0,0").contains("no length"));
        assert!(why("directional from=1").contains("AZIMUTH"));
    }
}
