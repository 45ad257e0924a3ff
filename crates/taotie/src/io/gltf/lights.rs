//! Cameras and the lights of KHR_lights_punctual, placed in the world by their nodes.

use super::document::Document;
use super::nodes::Nodes;
use super::reason::no_such;
use crate::error::Warnings;
use crate::math::Vec3;
use crate::scene::{Camera, Falloff, Light, LightKind, Projection, rigid};
use gltf::json;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type as LightType};
use gltf::json::validation::Checked;

/// Returns the cameras of the shown nodes, with the nodes. One that cannot be used is skipped with a warning.
pub(super) fn cameras(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Vec<(usize, Camera)> {
    let mut cameras = Vec::new();
    for node in &nodes.shown {
        let json = &document.root.nodes[*node];
        let Some(index) = json.camera.map(|c| c.value()) else { continue };
        let camera = document.root.cameras.get(index).ok_or_else(|| no_such("camera", index));
        match camera.and_then(|c| projection(c).map(|p| (c, p))) {
            Ok((camera, projection)) => {
                let name = camera.name.clone().or(json.name.clone()).unwrap_or_default();
                let world_from_view = rigid(&nodes.world[*node]);
                cameras.push((*node, Camera { name, world_from_view, projection }));
            }
            Err(why) => warnings.note(format!("skipped camera of node {node}: {why}"), 1),
        }
    }
    cameras
}

fn projection(camera: &json::Camera) -> Result<Projection, String> {
    if let Some(p) = &camera.perspective {
        let (fov_y, near) = (f64::from(p.yfov), f64::from(p.znear));
        let far = p.zfar.map(f64::from);
        let aspect = p.aspect_ratio.map(f64::from).filter(|a| *a > 0.0 && a.is_finite());
        let usable = fov_y > 0.0 && fov_y < std::f64::consts::PI && near > 0.0 && near.is_finite();
        if !usable || far.is_some_and(|f| f.is_nan() || f <= near) {
            return Err(format!("invalid yfov {fov_y}, znear {near} and zfar {far:?}"));
        }
        return Ok(Projection::Perspective { fov_y, aspect, near, far });
    }
    let Some(o) = &camera.orthographic else { return Err("no projection".into()) };
    let (half_width, half_height) = (f64::from(o.xmag).abs(), f64::from(o.ymag).abs());
    let (near, far) = (f64::from(o.znear), f64::from(o.zfar));
    if half_width > 0.0 && half_height > 0.0 && far > near && (half_width + half_height + far).is_finite() {
        Ok(Projection::Orthographic { half_width, half_height, near, far })
    } else {
        Err(format!("invalid xmag {half_width}, ymag {half_height}, znear {near} and zfar {far}"))
    }
}

/// Returns the lights of the shown nodes, with the nodes. One that cannot be used is skipped with a warning.
pub(super) fn lights(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Vec<(usize, Light)> {
    let extension = document.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let all = extension.map_or(&[][..], |e| &e.lights);
    let mut lights = Vec::new();
    for node in &nodes.shown {
        let json = &document.root.nodes[*node];
        let used = json.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(index) = used.map(|u| u.light.value()) else { continue };
        let light = all.get(index).ok_or_else(|| no_such("light", index));
        match light.and_then(unplaced_light) {
            Ok(mut light) => {
                light.name = all[index].name.clone().or(json.name.clone()).unwrap_or_default();
                light.place(&nodes.world[*node]);
                lights.push((*node, light));
            }
            Err(why) => warnings.note(format!("skipped light of node {node}: {why}"), 1),
        }
    }
    lights
}

/// Makes a light, in candela for points and spots and lux for directional lights, not yet placed by its node.
fn unplaced_light(light: &JsonLight) -> Result<Light, String> {
    let color = Vec3::from_array(light.color) * light.intensity;
    if !Light::is_strength(color) {
        return Err(format!("invalid colour {:?} with intensity {}", light.color, light.intensity));
    }
    let (position, direction) = (Vec3::splat(0.0), Vec3::new(0.0, 0.0, -1.0));
    let kind = match light.type_ {
        Checked::Valid(LightType::Directional) => LightKind::Directional { direction },
        Checked::Valid(LightType::Point) => LightKind::Point { position },
        Checked::Valid(LightType::Spot) => {
            let spot = light.spot.clone().unwrap_or(json::extensions::scene::khr_lights_punctual::Spot {
                inner_cone_angle: 0.0,
                outer_cone_angle: std::f32::consts::FRAC_PI_4,
            });
            let (inner, outer) = cone(spot.inner_cone_angle, spot.outer_cone_angle)?;
            LightKind::Spot { position, direction, inner: f64::from(inner), outer: f64::from(outer) }
        }
        Checked::Invalid => return Err("unknown type".into()),
    };
    let falloff = match light.range {
        Some(range) if range > 0.0 && range.is_finite() => Falloff::Windowed(range),
        _ => Falloff::InverseSquare,
    };
    Ok(Light { name: String::new(), kind, color, falloff })
}

/// Returns cone angles with 0 ≤ inner < outer ≤ π/2.
fn cone(inner: f32, outer: f32) -> Result<(f32, f32), String> {
    let outer = outer.min(std::f32::consts::FRAC_PI_2);
    if inner >= 0.0 && inner < outer {
        Ok((inner, outer))
    } else {
        Err(format!("empty cone from {inner} to {outer} radians"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones() {
        assert_eq!(cone(0.0, 9.0), Ok((0.0, std::f32::consts::FRAC_PI_2)));
        assert!(cone(0.5, 0.5).is_err() && cone(f32::NAN, 1.0).is_err() && cone(-0.1, 1.0).is_err());
    }
}
