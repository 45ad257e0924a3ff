//! The nodes of a scene: instances of meshes with their materials, lights (KHR_lights_punctual) and cameras, each of
//! them on a separate node.

use super::super::edit::short;
use super::super::mesh::{self, Grid, MeshPart, PackedMesh};
use super::{Writer, placed};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use taotie_engine::error::Result;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Camera, Falloff, Instance, Light, LightKind, Projection};

const LIGHTS: &str = "KHR_lights_punctual";

/// Maximum deviation of two axes of a transform from a right angle, as a cosine, for it to count as orthogonal.
const SQUARE: f64 = 1e-4;

/// The written parts of a mesh of the scene.
struct Shape {
    primitives: Vec<Value>,
    grid: Option<Grid>,
}

impl Writer<'_> {
    /// Writes the instances, and each mesh once per material used with it; its data is shared.
    pub(super) fn meshes(&mut self) -> Result<()> {
        let scene = self.scene;
        let mut shapes: HashMap<usize, Shape> = HashMap::new();
        let mut numbers: HashMap<(usize, usize), usize> = HashMap::new();
        let mut meshes = Vec::new();
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        for instance in scene.instances().iter().filter(seen) {
            let shape = match shapes.entry(instance.mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(self.shape(&scene.meshes()[instance.mesh])?),
            };
            let number = *numbers.entry((instance.mesh, instance.material)).or_insert_with(|| {
                let mut primitives = shape.primitives.clone();
                primitives.iter_mut().for_each(|p| p["material"] = instance.material.into());
                meshes.push(json!({ "primitives": primitives }));
                meshes.len() - 1
            });
            self.instance(number, shape.grid.as_ref(), &instance.world_from_object)?;
        }
        self.draft.json["meshes"] = meshes.into();
        self.note("dropped meshes without triangles or instances", scene.meshes().len() - shapes.len());
        Ok(())
    }

    /// Names meshes, and the nodes that show them, after the scene's meshes.
    pub(super) fn name_meshes(&mut self, names: &[String]) {
        let scene = self.scene;
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        let nodes = self.nodes.iter_mut().filter(|node| node.get("mesh").is_some());
        for (node, instance) in nodes.zip(scene.instances().iter().filter(seen)) {
            let Some(name) = names.get(instance.mesh).filter(|name| !name.is_empty()) else { continue };
            node["name"] = name.as_str().into();
            let mesh = node["mesh"].as_u64().unwrap_or_default();
            if let Some(mesh) = self.draft.json.pointer_mut(&format!("/meshes/{mesh}")) {
                mesh["name"] = name.as_str().into();
            }
        }
    }

    fn shape(&mut self, mesh: &Mesh) -> Result<Shape> {
        self.note("meshes without normals, which glTF shows faceted", usize::from(mesh.normals().is_empty()));
        let lost = mesh.normals().is_empty() && !mesh.tangents().is_empty();
        self.note("dropped tangents of meshes without normals", usize::from(lost));
        let grid =
            self.format.meshopt.then(|| Grid::around(std::iter::once(mesh), self.format.bits.positions));
        let parts = [MeshPart::whole(mesh)];
        let primitives = match &grid {
            Some(grid) => mesh::add_packed(
                &mut self.draft,
                PackedMesh { mesh, parts: &parts, grid, bits: self.format.bits },
            )?,
            None => mesh::add(&mut self.draft, mesh, &parts),
        };
        Ok(Shape { primitives, grid })
    }

    /// Adds a node that shows a mesh, with a separate node below it if the mesh is packed and the node is
    /// transformed.
    fn instance(&mut self, mesh: usize, grid: Option<&Grid>, world: &Mat4) -> Result<()> {
        self.note(
            "sheared transforms, which not every program reads correctly",
            usize::from(is_sheared(world)),
        );
        let mut shown = json!({ "mesh": mesh });
        if let Some(grid) = grid {
            grid.place(&mut shown);
            if *world != Mat4::IDENTITY {
                self.nodes.push(shown);
                shown = json!({ "children": [self.nodes.len() - 1] });
            }
        }
        self.show(placed(shown, world)?);
        Ok(())
    }
}

/// Returns `true` if the axes are not at right angles. Source: glTF 2.0, 3.5.3, which requires decomposable matrices.
fn is_sheared(m: &Mat4) -> bool {
    let pair = |a: usize, b: usize| {
        let (a, b) = (m.axis(a), m.axis(b));
        a.dot(b).abs() > SQUARE * a.length() * b.length()
    };
    pair(0, 1) || pair(1, 2) || pair(2, 0)
}

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
