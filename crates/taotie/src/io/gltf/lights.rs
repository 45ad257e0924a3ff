//! Cameras and the lights of KHR_lights_punctual, placed in the world by their nodes.

use super::document::{Document, no_such};
use super::nodes::Nodes;
use crate::error::Warnings;
use crate::math::{Mat4, Vec3};
use crate::scene::{Camera, Falloff, Light, LightKind, Projection};
use gltf::json;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type as LightType};
use gltf::json::validation::Checked;

/// The cameras of the shown nodes. One that cannot be used is left out with a warning.
pub(super) fn cameras(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Vec<Camera> {
    let mut cameras = Vec::new();
    for node in &nodes.shown {
        let json = &document.root.nodes[*node];
        let Some(index) = json.camera.map(|c| c.value()) else { continue };
        let camera = document.root.cameras.get(index).ok_or_else(|| no_such("camera", index));
        match camera.and_then(|c| projection(c).map(|p| (c, p))) {
            Ok((camera, projection)) => cameras.push(Camera {
                name: camera.name.clone().or(json.name.clone()).unwrap_or_default(),
                world_from_view: rigid(&nodes.world[*node]),
                projection,
            }),
            Err(why) => warnings.note(format!("camera of node {node} is left out: {why}"), 1),
        }
    }
    cameras
}

/// The transform without scale, shear and mirroring: it keeps where the camera looks and which way is up.
fn rigid(world: &Mat4) -> Mat4 {
    let fallback = Vec3::new(0.0, 0.0, 1.0);
    let z = world.axis(2).normalize_or(fallback);
    let up = world.axis(1);
    let side = up.cross(z);
    let any = if z.x.abs() < 0.9 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let x = side.normalize_or((any - z * z.dot(any)).normalize());
    Mat4::from_axes(x, z.cross(x), z, world.axis(3))
}

fn projection(camera: &json::Camera) -> Result<Projection, String> {
    if let Some(p) = &camera.perspective {
        let (fov_y, near) = (f64::from(p.yfov), f64::from(p.znear));
        let far = p.zfar.map(f64::from);
        let aspect = p.aspect_ratio.map(f64::from).filter(|a| *a > 0.0 && a.is_finite());
        let usable = fov_y > 0.0 && fov_y < std::f64::consts::PI && near > 0.0 && near.is_finite();
        if !usable || far.is_some_and(|f| f.is_nan() || f <= near) {
            return Err(format!("yfov {fov_y}, znear {near} and zfar {far:?} make no view"));
        }
        return Ok(Projection::Perspective { fov_y, aspect, near, far });
    }
    let Some(o) = &camera.orthographic else { return Err("it has no projection".into()) };
    let (half_width, half_height) = (f64::from(o.xmag).abs(), f64::from(o.ymag).abs());
    let (near, far) = (f64::from(o.znear), f64::from(o.zfar));
    if half_width > 0.0 && half_height > 0.0 && far > near && (half_width + half_height + far).is_finite() {
        Ok(Projection::Orthographic { half_width, half_height, near, far })
    } else {
        Err(format!("xmag {half_width}, ymag {half_height}, znear {near} and zfar {far} make no view"))
    }
}

/// The lights of the shown nodes. One that cannot be used is left out with a warning.
pub(super) fn lights(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Vec<Light> {
    let extension = document.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let all = extension.map_or(&[][..], |e| &e.lights);
    let mut lights = Vec::new();
    for node in &nodes.shown {
        let json = &document.root.nodes[*node];
        let used = json.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(index) = used.map(|u| u.light.value()) else { continue };
        let light = all.get(index).ok_or_else(|| no_such("light", index));
        match light.and_then(|l| place_light(l, &nodes.world[*node])) {
            Ok(mut light) => {
                light.name = all[index].name.clone().or(json.name.clone()).unwrap_or_default();
                lights.push(light);
            }
            Err(why) => warnings.note(format!("light of node {node} is left out: {why}"), 1),
        }
    }
    lights
}

/// Candela for points and spots, lux for directions; it shines along the node's −z axis.
fn place_light(light: &JsonLight, world: &Mat4) -> Result<Light, String> {
    let color = Vec3::from_array(light.color) * light.intensity;
    if !color.is_finite() || color.to_array().iter().any(|v| *v < 0.0) {
        return Err(format!("its colour {:?} times {} is no light", light.color, light.intensity));
    }
    let position = world.axis(3).to_f32();
    let direction = (-world.axis(2)).normalize_or(Vec3::new(0.0, 0.0, -1.0)).to_f32();
    let kind = match light.type_ {
        Checked::Valid(LightType::Directional) => LightKind::Directional { direction },
        Checked::Valid(LightType::Point) => LightKind::Point { position },
        Checked::Valid(LightType::Spot) => {
            let spot = light.spot.clone().unwrap_or(json::extensions::scene::khr_lights_punctual::Spot {
                inner_cone_angle: 0.0,
                outer_cone_angle: std::f32::consts::FRAC_PI_4,
            });
            let (inner, outer) = cone(spot.inner_cone_angle, spot.outer_cone_angle)?;
            LightKind::Spot { position, direction, inner, outer }
        }
        Checked::Invalid => return Err("its type is unknown".into()),
    };
    let falloff = match light.range {
        Some(range) if range > 0.0 && range.is_finite() => Falloff::Windowed(range),
        _ => Falloff::InverseSquare,
    };
    Ok(Light { name: String::new(), kind, color, falloff })
}

/// Cone angles with 0 ≤ inner < outer ≤ π/2.
fn cone(inner: f32, outer: f32) -> Result<(f32, f32), String> {
    let outer = outer.min(std::f32::consts::FRAC_PI_2);
    if inner >= 0.0 && inner < outer {
        Ok((inner, outer))
    } else {
        Err(format!("its cone from {inner} to {outer} radians is empty"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_transforms_become_rigid() {
        let turned = Mat4::rotation_about(Vec3::new(0.0, 0.6, 0.8), 1.1);
        let world =
            Mat4::translation(Vec3::new(1.0, 2.0, 3.0)) * turned * Mat4::scale(Vec3::new(-2.0, 3.0, 4.0));
        let m = rigid(&world);
        assert!((m.determinant3() - 1.0).abs() < 1e-12);
        assert!((m.axis(2) - turned.axis(2)).length() < 1e-12);
        assert!((m.axis(1) - turned.axis(1)).length() < 1e-12);
        assert!((m.axis(3) - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
        assert!((rigid(&Mat4::scale(Vec3::splat(0.0))).determinant3() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn cones() {
        assert_eq!(cone(0.0, 9.0), Ok((0.0, std::f32::consts::FRAC_PI_2)));
        assert!(cone(0.5, 0.5).is_err() && cone(f32::NAN, 1.0).is_err() && cone(-0.1, 1.0).is_err());
    }
}
