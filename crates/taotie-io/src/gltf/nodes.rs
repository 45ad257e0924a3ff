//! The node hierarchy: world matrices, levels of detail (MSFT_lod), the nodes that the scene shows
//! (KHR_node_visibility), the instances (EXT_mesh_gpu_instancing), cameras and lights (KHR_lights_punctual) that these place in the world, and the animations
//! that move nodes.

use super::accessor::Accessor;
use super::document::Document;
use super::raw::{INSTANCING, VISIBILITY};
use crate::reading::{Reason, no_such};
use crate::text::is_for_baking;
use gltf::json::animation::{Interpolation as JsonInterpolation, Property};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type as LightType};
use gltf::json::validation::Checked;
use gltf::json::{self, Value};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::animation::{
    Animation, Channel, Interpolation, Node, Path, Sampler, Transform, world_matrices,
};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Projection, rigid};

/// Bytes per node in addition to those for parsing its text: transforms, and what shows its mesh.
const NODE: u64 = 512;

/// The extension of levels of detail.
const LEVELS: &str = "MSFT_lod";

/// The hierarchy, resolved.
pub(super) struct Nodes {
    /// Every node of the file, without morph weights, followed by one for each instance of a node's mesh.
    pub nodes: Vec<Node>,
    /// The nodes of the instances of each node that has any.
    pub instances: HashMap<usize, Range<usize>>,
    /// World matrix of each of [`Self::nodes`].
    pub world: Vec<Mat4>,
    /// The visible nodes of the shown scene, parents before children.
    pub shown: Vec<usize>,
    /// The same, with the hidden ones.
    pub placed: Vec<usize>,
    /// The number of levels of detail, at least 1.
    pub levels: usize,
    /// The screen coverage at which this level is first shown; `None` for the finest.
    pub coverage: Option<f32>,
}

impl Nodes {
    /// Resolves the hierarchy of `document` at a level of detail; 0 is the finest.
    ///
    /// # Errors
    /// Fails if a node is its own ancestor, a referenced node does not exist, a transform is not finite, instances
    /// cannot be read, or all nodes with a mesh are hidden.
    pub fn resolve(document: &Document, level: usize, warnings: &mut Warnings) -> Result<Self> {
        if !document.reading.take(document.root.nodes.len() as u64 * NODE) {
            document.reading.check()?;
        }
        let mut parents = parents(document, warnings)?;
        let levels = Levels::read(document, level, warnings);
        levels.hang(&mut parents);
        let mut nodes = (0..parents.len())
            .map(|n| {
                let local = local_transform(document, n, warnings)?;
                Ok(Node { parent: parents[n], local, weights: Vec::new() })
            })
            .collect::<Result<Vec<_>>>()?;
        let Placed { all: placed, shown } = Placed::of(document, &parents, &levels)?;
        warnings.note("ignored scenes other than the default", document.root.scenes.len().saturating_sub(1));
        warnings.note("nodes hidden by KHR_node_visibility: left out", placed.len() - shown.len());
        let instances = add_instances(document, &shown, &mut nodes, warnings)?;
        let world = world_matrices(&nodes).map_err(|error| match error {
            Error::Invalid { what, why } => document.error(what, why),
            other => other,
        })?;
        Ok(Self { nodes, instances, world, shown, placed, levels: levels.count, coverage: levels.coverage })
    }

    /// Returns for each node of the file the nearest one that is named for baking: itself or an ancestor.
    pub fn named_for_baking(&self, document: &Document) -> Vec<Option<usize>> {
        let all = &document.root.nodes;
        let mut named = vec![None; all.len()];
        for node in &self.placed {
            let is_named = all[*node].name.as_deref().is_some_and(is_for_baking);
            let of_parent = || self.nodes[*node].parent.and_then(|parent| named[parent]);
            named[*node] = is_named.then_some(*node).or_else(of_parent);
        }
        named
    }
}

type Parents = Vec<Option<usize>>;

fn at(node: usize) -> String {
    format!("node {node}")
}

fn children(document: &Document, node: usize) -> impl Iterator<Item = usize> {
    document.root.nodes[node].children.iter().flatten().map(|c| c.value())
}

/// Returns the parent of each node; the first if there are several.
fn parents(document: &Document, warnings: &mut Warnings) -> Result<Parents> {
    let count = document.root.nodes.len();
    let mut parents = vec![None; count];
    for node in 0..count {
        for child in children(document, node) {
            match parents.get_mut(child) {
                None => return Err(document.error(at(node), no_such("child", child))),
                Some(parent @ None) => *parent = Some(node),
                Some(Some(_)) => warnings.note("nodes with two parents; using the first", 1),
            }
        }
    }
    Ok(parents)
}

fn local_transform(document: &Document, index: usize, warnings: &mut Warnings) -> Result<Transform> {
    let node = &document.root.nodes[index];
    let local = match &node.matrix {
        Some(m) => Transform::Matrix(from_columns(m, warnings)),
        None => from_parts(node, warnings),
    };
    let finite = local.matrix().is_finite();
    if finite { Ok(local) } else { Err(document.error(at(index), "the transform is not finite")) }
}

/// Converts a column-major matrix; projective parts are dropped.
pub(super) fn from_columns(m: &[f32; 16], warnings: &mut Warnings) -> Mat4 {
    let mut columns = [[0.0; 4]; 4];
    for (i, v) in m.iter().enumerate() {
        columns[i / 4][i % 4] = f64::from(*v);
    }
    let last_row = columns.map(|c| c[3]);
    if last_row != [0.0, 0.0, 0.0, 1.0] {
        warnings.note("matrices with a last row other than 0 0 0 1; row ignored", 1);
        columns.iter_mut().zip([0.0, 0.0, 0.0, 1.0]).for_each(|(c, v)| c[3] = v);
    }
    Mat4 { columns }
}

fn from_parts(node: &json::Node, warnings: &mut Warnings) -> Transform {
    let vector = |v: [f32; 3]| Vec3::from_array(v).to_f64();
    let translation = vector(node.translation.unwrap_or_default());
    let scale = vector(node.scale.unwrap_or([1.0; 3]));
    let rotation = node.rotation.unwrap_or_default().0.map(f64::from);
    let zero = rotation == [0.0; 4];
    warnings.note("zero-length rotations; treated as identity", usize::from(zero));
    Transform::parts(translation, rotation, scale)
}

/// Adds a node for each instance of the meshes of the `shown` nodes; returns those of each node.
///
/// Source: EXT_mesh_gpu_instancing.
fn add_instances(
    document: &Document,
    shown: &[usize],
    nodes: &mut Vec<Node>,
    warnings: &mut Warnings,
) -> Result<HashMap<usize, Range<usize>>> {
    let mut ranges = HashMap::new();
    for node in shown.iter().copied() {
        let json = &document.root.nodes[node];
        let extension = json.extensions.as_ref().and_then(|extensions| extensions.others.get(INSTANCING));
        let Some(extension) = extension.filter(|_| json.mesh.is_some()) else { continue };
        if json.skin.is_some() {
            warnings.note("skinned meshes with instances; drawn once", 1);
            continue;
        }
        let wrong = |why: String| document.error(at(node), format!("{INSTANCING}: {why}"));
        let Some(instances) = Instances::open(document, extension).map_err(wrong)? else { continue };
        let first = nodes.len();
        document.reading.check_nodes((first + instances.count) as u64)?;
        if !document.reading.take(instances.count as u64 * NODE) {
            document.reading.check()?;
        }
        for i in 0..instances.count {
            let local = instances.transform(i);
            if !local.matrix().is_finite() {
                return Err(wrong(format!("the transform of instance {i} is not finite")));
            }
            nodes.push(Node { parent: Some(node), local, weights: Vec::new() });
        }
        ranges.insert(node, first..nodes.len());
    }
    Ok(ranges)
}

/// The transforms of the instances of a mesh; `None` for parts that are the same in all.
struct Instances<'a> {
    count: usize,
    translation: Option<Accessor<'a>>,
    rotation: Option<Accessor<'a>>,
    scale: Option<Accessor<'a>>,
}

impl<'a> Instances<'a> {
    /// Opens the attributes; returns `None` if there are none about transforms.
    fn open(document: &'a Document, extension: &Value) -> Reason<Option<Self>> {
        let attributes =
            extension.get("attributes").and_then(Value::as_object).ok_or("missing attributes")?;
        let mut count = None;
        let mut open = |name: &str, width: usize| -> Reason<Option<Accessor<'a>>> {
            let Some(index) = attributes.get(name) else { return Ok(None) };
            let index = index.as_u64().ok_or_else(|| format!("{name} is not an accessor"))?;
            let accessor =
                Accessor::open(document, index as usize).map_err(|why| format!("{name}: {why}"))?;
            if accessor.width != width {
                return Err(format!("{name} must have {width} numbers per instance, not {}", accessor.width));
            }
            match count.replace(accessor.count) {
                Some(other) if other != accessor.count => {
                    Err(format!("{name} has {} elements, but other attributes {other}", accessor.count))
                }
                _ => Ok(Some(accessor)),
            }
        };
        let (translation, rotation, scale) =
            (open("TRANSLATION", 3)?, open("ROTATION", 4)?, open("SCALE", 3)?);
        Ok(count.map(|count| Self { count, translation, rotation, scale }))
    }

    /// Returns the transform of instance `i`.
    fn transform(&self, i: usize) -> Transform {
        let vector = |of: &Accessor<'_>| Vec3::from_array(of.floats(i)).to_f64();
        let rotation = self.rotation.as_ref().map(|of| of.floats(i).map(f64::from));
        Transform::parts(
            self.translation.as_ref().map_or(Vec3::splat(0.0), vector),
            rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            self.scale.as_ref().map_or(Vec3::splat(1.0), vector),
        )
    }
}

/// The nodes of a scene, parents before children.
struct Placed {
    all: Vec<usize>,
    /// Those that are not hidden.
    shown: Vec<usize>,
}

impl Placed {
    /// Collects the nodes of the default scene, else of the first, else of all trees, replaced according to the level
    /// of detail. A hidden node hides all below it.
    ///
    /// Source: KHR_node_visibility.
    ///
    /// # Errors
    /// Fails if the scene or one of its nodes does not exist, or all nodes with a mesh are hidden.
    fn of(document: &Document, parents: &Parents, levels: &Levels) -> Result<Self> {
        let mut waiting: Vec<(usize, bool)> =
            roots(document, parents)?.into_iter().rev().map(|node| (node, false)).collect();
        let mut seen = vec![false; parents.len()];
        let (mut all, mut shown) = (Vec::new(), Vec::new());
        while let Some((replaced, is_below_hidden)) = waiting.pop() {
            let node = levels.stand_in(replaced);
            if std::mem::replace(&mut seen[node], true) {
                continue;
            }
            let is_hidden = is_below_hidden || hides(document, replaced) || hides(document, node);
            all.push(node);
            shown.extend((!is_hidden).then_some(node));
            let below: Vec<usize> = children(document, node).filter(|c| parents[*c] == Some(node)).collect();
            waiting.extend(below.into_iter().rev().map(|node| (node, is_hidden)));
        }
        let has_mesh = |nodes: &[usize]| nodes.iter().any(|n| document.root.nodes[*n].mesh.is_some());
        if has_mesh(&all) && !has_mesh(&shown) {
            let why = format!(
                "all that have a mesh are hidden ({VISIBILITY}); make them visible, and export again"
            );
            return Err(document.error("nodes", why));
        }
        Ok(Self { all, shown })
    }
}

/// Returns the root nodes of the default scene, else of the first, else of all trees.
fn roots(document: &Document, parents: &Parents) -> Result<Vec<usize>> {
    let root = &document.root;
    let scene = root.scene.map_or(0, |s| s.value());
    let roots: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None if root.scene.is_some() => return Err(document.error("scene", no_such("scene", scene))),
        None => (0..parents.len()).filter(|n| parents[*n].is_none()).collect(),
    };
    match roots.iter().find(|n| **n >= parents.len()) {
        Some(node) => Err(document.error(format!("scene {scene}"), no_such("node", *node))),
        None => Ok(roots),
    }
}

/// Returns `true` if a node states that it is hidden, with all below it.
fn hides(document: &Document, node: usize) -> bool {
    let extensions = document.root.nodes[node].extensions.as_ref();
    let visible = extensions.and_then(|all| all.others.get(VISIBILITY)?.get("visible")?.as_bool());
    visible == Some(false)
}

/// The nodes shown at one level of detail.
struct Levels {
    /// The number of levels of the file, at least 1.
    count: usize,
    /// The largest screen coverage of the object at which this level is shown; `None` for the finest.
    coverage: Option<f32>,
    /// The node shown instead of each node.
    stand_ins: Vec<usize>,
}

impl Levels {
    /// Selects a level; 0 is the finest. A node with fewer levels shows its coarsest; invalid node indices are
    /// skipped with a warning.
    fn read(document: &Document, level: usize, warnings: &mut Warnings) -> Self {
        let lists: Vec<Vec<usize>> =
            (0..document.root.nodes.len()).map(|node| coarser(document, node, warnings)).collect();
        let count = 1 + lists.iter().map(Vec::len).max().unwrap_or(0);
        let stand_in = |(node, coarser): (usize, &Vec<usize>)| match level.min(coarser.len()) {
            0 => node,
            level => coarser[level - 1],
        };
        let stand_ins = lists.iter().enumerate().map(stand_in).collect();
        let above = level.checked_sub(1);
        let of_node = |node: usize| document.coverages.get(&node)?.get(above?).copied();
        let has_levels = (0..lists.len()).filter(|node| !lists[*node].is_empty());
        Self { count, coverage: has_levels.filter_map(of_node).reduce(f32::max), stand_ins }
    }

    /// Returns the node shown instead of `node`.
    fn stand_in(&self, node: usize) -> usize {
        self.stand_ins[node]
    }

    /// Gives each replacement the parent of the node that it replaces.
    fn hang(&self, parents: &mut [Option<usize>]) {
        for (node, stand_in) in self.stand_ins.iter().enumerate() {
            if *stand_in != node {
                parents[*stand_in] = parents[node];
            }
        }
    }
}

/// Returns the coarser replacements of a node that exist, the finest first.
fn coarser(document: &Document, node: usize, warnings: &mut Warnings) -> Vec<usize> {
    let nodes = &document.root.nodes;
    let extension = nodes[node].extensions.as_ref().and_then(|extensions| extensions.others.get(LEVELS));
    let ids = extension.and_then(|extension| extension.get("ids")).and_then(Value::as_array);
    let ids = ids.map_or(&[][..], Vec::as_slice);
    let named = |id: &Value| Some(id.as_u64()? as usize).filter(|id| *id < nodes.len());
    let found: Vec<usize> = ids.iter().filter_map(named).collect();
    warnings.note("skipped levels of detail that are not nodes", ids.len() - found.len());
    found
}

/// Returns the cameras of all nodes, hidden ones too, with the nodes. One that cannot be used is skipped with a warning.
pub(super) fn cameras(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Vec<(usize, Camera)> {
    let mut cameras = Vec::new();
    for node in &nodes.placed {
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

fn projection(camera: &json::Camera) -> Reason<Projection> {
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
fn unplaced_light(light: &JsonLight) -> Reason<Light> {
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
fn cone(inner: f32, outer: f32) -> Reason<(f32, f32)> {
    let outer = outer.min(std::f32::consts::FRAC_PI_2);
    if inner >= 0.0 && inner < outer {
        Ok((inner, outer))
    } else {
        Err(format!("empty cone from {inner} to {outer} radians"))
    }
}

/// Maximum number of values in all keyframes together, per byte of the buffers, plus a constant for small files.
/// Sharing keyframes between channels is common; a small file that requests gigabytes is not.
const MAX_NUMBERS_PER_BYTE: usize = 8;
const MAX_NUMBERS_OF_SMALL: usize = 1 << 22;

/// Returns the animations of the file. Each channel is checked separately: one that cannot be used is skipped with a
/// warning; an animation without any is kept, so that it can be chosen. `nodes` have their morph weights.
pub(super) fn animations(document: &Document, nodes: &[Node], warnings: &mut Warnings) -> Vec<Animation> {
    let mut budget = MAX_NUMBERS_OF_SMALL + MAX_NUMBERS_PER_BYTE * document.total_bytes();
    // Those of instances are not the file's.
    let nodes = &nodes[..document.root.nodes.len()];
    let mut animations = Vec::new();
    for (i, json) in document.animations.iter().enumerate() {
        let name = json.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        let animation = Animation { name, ..Animation::default() };
        let mut reader = AnimationReader {
            document,
            nodes,
            json,
            budget,
            animation,
            samplers: HashMap::new(),
            seen: HashSet::new(),
        };
        let (mut left_out, mut first_reason) = (0, None);
        for channel in json.get("channels").and_then(Value::as_array).into_iter().flatten() {
            if let Err(why) = reader.channel(channel) {
                left_out += 1;
                first_reason.get_or_insert(why);
            }
        }
        if let Some(why) = first_reason {
            warnings.note(format!("animation {i}: skipped channels, the first because: {why}"), left_out);
        }
        budget = reader.budget;
        animations.push(reader.animation);
    }
    animations
}

/// Reads the channels of one animation.
struct AnimationReader<'a> {
    document: &'a Document,
    nodes: &'a [Node],
    json: &'a Value,
    budget: usize,
    animation: Animation,
    /// Maps the file's samplers to those of `animation`.
    samplers: HashMap<usize, usize>,
    seen: HashSet<(usize, Path)>,
}

impl AnimationReader<'_> {
    fn channel(&mut self, json: &Value) -> Reason<()> {
        let path = json.get("target").and_then(|target| target.get("path")).and_then(Value::as_str);
        if path == Some("pointer") {
            return Err("KHR_animation_pointer is not supported".into());
        }
        let channel: json::animation::Channel =
            json::deserialize::from_value(json.clone()).map_err(|e| malformed("channel", &e))?;
        let Checked::Valid(property) = channel.target.path else {
            return Err(format!("unknown path '{}'", path.unwrap_or_default()));
        };
        let path = match property {
            Property::Translation => Path::Translation,
            Property::Rotation => Path::Rotation,
            Property::Scale => Path::Scale,
            Property::MorphTargetWeights => Path::Weights,
        };
        let node = channel.target.node.value();
        let sampler = self.sampler(channel.sampler.value())?;
        let channel = Channel { node, path, sampler };
        self.animation.check_channel(&channel, self.nodes)?;
        if !self.seen.insert((node, path)) {
            return Err("an earlier channel has the same target".into());
        }
        self.animation.channels.push(channel);
        Ok(())
    }

    /// Returns the index in `animation` of a sampler of the file.
    fn sampler(&mut self, index: usize) -> Reason<usize> {
        if let Some(known) = self.samplers.get(&index) {
            return Ok(*known);
        }
        let json = self.json.get("samplers").and_then(|samplers| samplers.get(index));
        let json = json.ok_or_else(|| no_such("sampler", index))?.clone();
        let json = json::deserialize::from_value(json).map_err(|e| malformed("sampler", &e))?;
        let sampler = keyframes(self.document, &json, &mut self.budget);
        let sampler = sampler.map_err(|why| format!("sampler {index}: {why}"))?;
        self.animation.samplers.push(sampler);
        self.samplers.insert(index, self.animation.samplers.len() - 1);
        Ok(self.animation.samplers.len() - 1)
    }
}

/// Reads the keyframes of a sampler. `budget` is the number of times and values that may still be read.
pub(super) fn keyframes(
    document: &Document,
    json: &json::animation::Sampler,
    budget: &mut usize,
) -> Reason<Sampler> {
    let interpolation = match json.interpolation {
        Checked::Valid(JsonInterpolation::Step) => Interpolation::Step,
        Checked::Valid(JsonInterpolation::Linear) => Interpolation::Linear,
        Checked::Valid(JsonInterpolation::CubicSpline) => Interpolation::CubicSpline,
        Checked::Invalid => return Err("unknown interpolation".into()),
    };
    let input = Accessor::open(document, json.input.value())?;
    if input.width != 1 {
        return Err("times must be scalars".into());
    }
    let output = Accessor::open(document, json.output.value())?;
    let numbers = output.count.saturating_mul(output.width).saturating_add(input.count);
    *budget = budget.checked_sub(numbers).ok_or("too many keyframes for the size of the file")?;
    let times = (0..input.count).map(|i| input.floats::<1>(i)[0]).collect();
    let element = |i| output.floats::<16>(i).into_iter().take(output.width);
    let values = (0..output.count).flat_map(element).collect();
    Sampler::new(interpolation, times, values).map_err(|error| error.to_string())
}

fn malformed(what: &str, error: &json::Error) -> String {
    format!("malformed {what}: {error}")
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
