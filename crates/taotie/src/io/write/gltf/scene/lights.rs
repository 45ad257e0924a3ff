//! Lights (KHR_lights_punctual) and cameras, each on a separate node.

use super::super::number::short;
use super::writer::{Writer, placed};
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::scene::{Camera, Falloff, Light, LightKind, Projection};
use serde_json::{Value, json};

const LIGHTS: &str = "KHR_lights_punctual";

impl Writer<'_> {
    /// Writes the lights.
    pub(super) fn lights(&mut self) -> Result<()> {
        let lights = self.scene.lights();
        if lights.is_empty() {
            return Ok(());
        }
        let constant =
            |l: &&Light| l.falloff == Falloff::None && !matches!(l.kind, LightKind::Directional { .. });
        let what = "lights without distance falloff, which glTF lights always have";
        self.note(what, lights.iter().filter(constant).count());
        self.draft.uses(LIGHTS);
        let described: Vec<Value> = lights.iter().map(light).collect();
        self.draft.json["extensions"] = json!({ LIGHTS: { "lights": described } });
        for (i, light) in lights.iter().enumerate() {
            let node = json!({ "extensions": { LIGHTS: { "light": i } } });
            self.show(placed(node, &place(&light.kind))?);
        }
        Ok(())
    }

    /// Writes the cameras.
    pub(super) fn cameras(&mut self) -> Result<()> {
        let cameras = self.scene.cameras();
        if cameras.is_empty() {
            return Ok(());
        }
        self.draft.json["cameras"] = cameras.iter().map(camera).collect();
        for (i, camera) in cameras.iter().enumerate() {
            self.show(placed(json!({ "camera": i }), &camera.world_from_view)?);
        }
        Ok(())
    }
}

fn light(light: &Light) -> Value {
    let color = light.color.to_array();
    let intensity = color.into_iter().fold(0.0, f32::max);
    let hue = if intensity > 0.0 { color.map(|v| v / intensity) } else { [1.0; 3] };
    let mut json = json!({ "color": hue.map(short), "intensity": short(intensity) });
    json["type"] = match light.kind {
        LightKind::Point { .. } => "point".into(),
        LightKind::Directional { .. } => "directional".into(),
        LightKind::Spot { inner, outer, .. } => {
            json["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
            "spot".into()
        }
    };
    if let (Falloff::Windowed(range), false) =
        (light.falloff, matches!(light.kind, LightKind::Directional { .. }))
    {
        json["range"] = short(range).into();
    }
    named(json, &light.name)
}

/// Returns the transform from −z to the light's direction. Source: KHR_lights_punctual.
fn place(kind: &LightKind) -> Mat4 {
    let (position, direction) = match kind {
        LightKind::Point { position } => return Mat4::translation(position.to_f64()),
        LightKind::Directional { direction } => (Vec3::splat(0.0), direction),
        LightKind::Spot { position, direction, .. } => (position.to_f64(), direction),
    };
    let z = (-direction.to_f64()).normalize_or(Vec3::new(0.0, 0.0, 1.0));
    let up = if z.y.abs() < 0.9 { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::new(1.0, 0.0, 0.0) };
    let x = up.cross(z).normalize_or(Vec3::new(1.0, 0.0, 0.0));
    Mat4::from_axes(x, z.cross(x), z, position)
}

fn camera(camera: &Camera) -> Value {
    let json = match camera.projection {
        Projection::Perspective { fov_y, aspect, near, far } => {
            let mut view = json!({ "yfov": fov_y, "znear": near });
            if let Some(aspect) = aspect {
                view["aspectRatio"] = aspect.into();
            }
            if let Some(far) = far {
                view["zfar"] = far.into();
            }
            json!({ "type": "perspective", "perspective": view })
        }
        Projection::Orthographic { half_width, half_height, near, far } => {
            let view = json!({ "xmag": half_width, "ymag": half_height, "znear": near, "zfar": far });
            json!({ "type": "orthographic", "orthographic": view })
        }
    };
    named(json, &camera.name)
}

fn named(mut json: Value, name: &str) -> Value {
    if !name.is_empty() {
        json["name"] = name.into();
    }
    json
}
