//! Converts primitives to meshes, each built once for all nodes that show it identically, with the skins that pose
//! them and their materials in each variant (KHR_materials_variants).

use super::accessor::Accessor;
use super::document::Document;
use super::nodes::{Nodes, from_columns};
use super::primitives::{Built, NOT_TRIANGLES, Pose, Primitives, Stop};
use super::raw::extension;
use crate::loaded::{Mapping, Variants};
use crate::reading::{Reason, no_such};
use gltf::json::mesh::Primitive;
use gltf::json::{self, Index, Value};
use std::collections::{BTreeMap, HashMap};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::Instance;
use taotie_engine::scene::animation::{Deformed, Skin};

/// The extension of variants.
const VARIANTS: &str = "KHR_materials_variants";

/// The meshes of the scene with their placement.
#[derive(Default)]
pub(super) struct Meshes {
    /// The meshes.
    pub meshes: Vec<Mesh>,
    /// Their names, in the same order.
    pub names: Vec<String>,
    /// The placement of the meshes. `material` is the index in the file, or the number of the file's materials for
    /// the default.
    pub instances: Vec<Instance>,
    /// The node of each instance; `None` for those placed by a skin or by nothing.
    pub nodes: Vec<Option<usize>>,
    /// The document's node that shows each instance; `None` if the file has no nodes.
    pub shown_by: Vec<Option<usize>>,
    /// The shapes that animations deform; empty if the file has none.
    pub deformed: Vec<Deformed>,
    /// The skins of the shown meshes.
    pub skins: Vec<Skin>,
    /// The weights at rest, one per morph target, of nodes that show a mesh with targets.
    pub weights: Vec<(usize, Vec<f32>)>,
    /// The materials of the instances in each variant.
    pub variants: Variants,
}

/// A mesh of the file, and the node that poses it if the pose is not shared.
type Key = (usize, Option<usize>);

/// Builds the meshes of the shown nodes. A primitive that cannot be read is skipped with a warning.
///
/// # Errors
/// The error of the first primitive if none can be read, or that there is nothing to draw.
pub(super) fn build(document: &Document, nodes: &Nodes, warnings: &mut Warnings) -> Result<Meshes> {
    let mut builder = Builder {
        document,
        nodes,
        reader: Primitives::new(document, warnings),
        built: HashMap::new(),
        skins: HashMap::new(),
        mappings: Mappings::new(document),
        out: Meshes::default(),
        failures: Vec::new(),
    };
    for node in &nodes.shown {
        builder.show(*node)?;
    }
    if document.root.nodes.is_empty() {
        builder.show_library()?;
    }
    builder.finish()
}

struct Builder<'a> {
    document: &'a Document,
    nodes: &'a Nodes,
    reader: Primitives<'a>,
    built: HashMap<Key, Vec<(usize, usize)>>,
    /// The indices in `out` of the file's skins.
    skins: HashMap<usize, usize>,
    mappings: Mappings,
    out: Meshes,
    failures: Vec<(String, String)>,
}

impl Builder<'_> {
    /// Shows every mesh of a file that has no nodes at all, such as a library of parts.
    fn show_library(&mut self) -> Result<()> {
        for mesh in 0..self.document.root.meshes.len() {
            self.reader.warnings.note("meshes drawn at the origin, since the file has no nodes", 1);
            for (mesh, material) in self.build_mesh(mesh, None)? {
                self.out.instances.push(Instance { mesh, material, world_from_object: Mat4::IDENTITY });
                self.out.nodes.push(None);
                self.out.shown_by.push(None);
            }
        }
        Ok(())
    }

    fn show(&mut self, node: usize) -> Result<()> {
        let json = &self.document.root.nodes[node];
        let Some(mesh) = json.mesh.map(|m| m.value()) else { return Ok(()) };
        let posed =
            json.skin.is_some() || json.weights.is_some() || (self.reader.moves && self.targets(mesh) > 0);
        let key = (mesh, posed.then_some(node));
        if !self.built.contains_key(&key) {
            let parts = self.build_mesh(mesh, Some(node))?;
            self.built.insert(key, parts);
        }
        // A skin places the mesh in the world: the node's own transform is ignored (glTF 2.0, 3.7.3.3).
        let is_placed = json.skin.is_none();
        let placed = self.nodes.instances.get(&node).cloned().unwrap_or(node..node + 1);
        let parts = &self.built[&key];
        let reading = &self.document.reading;
        if !reading.take((placed.len() * parts.len() * size_of::<(Instance, Option<usize>)>()) as u64) {
            reading.check()?;
        }
        for place in placed {
            let hangs_on = is_placed.then_some(place);
            let world = hangs_on.map_or(Mat4::IDENTITY, |node| self.nodes.world[node]);
            for (mesh, material) in parts {
                let instance = Instance { mesh: *mesh, material: *material, world_from_object: world };
                self.out.instances.push(instance);
                self.out.nodes.push(hangs_on);
                self.out.shown_by.push(Some(node));
            }
        }
        Ok(())
    }

    /// Returns the number of morph targets of a mesh of the file.
    fn targets(&self, mesh: usize) -> usize {
        let primitives = self.document.root.meshes.get(mesh).map_or(&[][..], |mesh| &mesh.primitives);
        primitives.iter().flat_map(|p| &p.targets).map(Vec::len).max().unwrap_or(0)
    }

    /// Returns the meshes and materials of the primitives of mesh `index` as `node` shows them.
    fn build_mesh(&mut self, index: usize, node: Option<usize>) -> Result<Vec<(usize, usize)>> {
        let posed = match self.document.root.meshes.get(index) {
            Some(mesh) => self.pose(mesh, node).map(|pose| (mesh, pose)),
            None => Err(no_such("mesh", index)),
        };
        let (mesh, pose) = match posed {
            Ok(posed) => posed,
            Err(why) => {
                self.failures.push((node.map_or("scene".into(), |n| format!("node {n}")), why));
                return Ok(Vec::new());
            }
        };
        if let (true, Some(node)) = (self.reader.moves, node) {
            let mut weights = pose.weights.clone();
            weights.resize(self.targets(index), 0.0);
            self.out.weights.push((node, weights));
        }
        let mut parts = Vec::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let place = place_of(mesh.name.as_deref(), index, p);
            match self.reader.build(primitive, &pose, &place) {
                Ok(Some(built)) => {
                    let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {index}"));
                    parts.push((self.add(built, name, &pose, node), self.material_of(primitive, &place)));
                    let at = PrimitiveIndex { mesh: index, primitive: p };
                    self.mappings.add(at, primitive, &place, self.reader.warnings);
                }
                Ok(None) => {}
                Err(Stop::Here(why)) => self.failures.push((place, why)),
                Err(Stop::Everything(error)) => return Err(error),
            }
        }
        Ok(parts)
    }

    /// Adds a mesh shown by `node` and returns its index.
    fn add(&mut self, built: Built, name: String, pose: &Pose, node: Option<usize>) -> usize {
        let mesh = self.out.meshes.len();
        self.out.meshes.push(built.mesh);
        self.out.names.push(name);
        if let (Some(shape), Some(node)) = (built.shape, node) {
            let skin = pose.skin.as_ref().map(|(skin, _)| *skin);
            self.out.deformed.push(Deformed { mesh, node, skin, shape });
        }
        mesh
    }

    fn pose(&mut self, mesh: &json::Mesh, node: Option<usize>) -> Reason<Pose> {
        let node = node.map(|n| &self.document.root.nodes[n]);
        let weights = node.and_then(|n| n.weights.as_ref()).or(mesh.weights.as_ref());
        let mut weights = weights.cloned().unwrap_or_default();
        for weight in weights.iter_mut().filter(|w| !w.is_finite()) {
            self.reader.warnings.note("infinite or NaN morph weights; set to 0", 1);
            *weight = 0.0;
        }
        let skin = node.and_then(|n| n.skin).map(|s| self.skin(s.value())).transpose()?;
        let skin = skin.map(|skin| (skin, self.out.skins[skin].joint_matrices(&self.nodes.world)));
        Ok(Pose { weights, skin })
    }

    /// Returns the index in [`Meshes::skins`] of a skin of the file.
    fn skin(&mut self, index: usize) -> Reason<usize> {
        if let Some(known) = self.skins.get(&index) {
            return Ok(*known);
        }
        let skin = read_skin(self.document, index, self.reader.warnings)?;
        self.out.skins.push(skin);
        self.skins.insert(index, self.out.skins.len() - 1);
        Ok(self.out.skins.len() - 1)
    }

    fn material_of(&mut self, primitive: &Primitive, place: &str) -> usize {
        let count = self.document.root.materials.len();
        let index = primitive.material.map_or(count, |m| m.value());
        if index > count || (index == count && primitive.material.is_some()) {
            self.reader
                .warnings
                .note(format!("{place}: {}; using the default", no_such("material", index)), 1);
        }
        index.min(count)
    }

    fn why_empty(&self) -> &'static str {
        if self.reader.warnings.iter().any(|(what, _)| what == NOT_TRIANGLES) {
            "nothing to draw: the file has only points or lines"
        } else {
            "nothing to draw: no node shows a triangle"
        }
    }

    fn finish(mut self) -> Result<Meshes> {
        if self.out.instances.is_empty() {
            return Err(match self.failures.first() {
                Some((place, why)) => self.document.error(place, why),
                None => self.document.error("scene", self.why_empty()),
            });
        }
        for (place, why) in self.failures {
            self.reader.warnings.note(format!("skipped {place}: {why}"), 1);
        }
        let authored = self.out.instances.iter().map(|instance| instance.material).collect();
        self.out.variants = Variants { authored, ..self.mappings.variants };
        Ok(self.out)
    }
}

fn place_of(name: Option<&str>, mesh: usize, primitive: usize) -> String {
    let name: String = name.unwrap_or_default().chars().filter(|c| !c.is_control()).take(60).collect();
    if name.is_empty() {
        format!("mesh {mesh}, primitive {primitive}")
    } else {
        format!("mesh {mesh} '{name}', primitive {primitive}")
    }
}

/// Reads skin `index`, checking that its joints are nodes of the file.
fn read_skin(document: &Document, index: usize, warnings: &mut Warnings) -> Reason<Skin> {
    let skin = document.root.skins.get(index).ok_or_else(|| no_such("skin", index))?;
    let within = |why: String| format!("skin {index}: {why}");
    let joints: Vec<usize> = skin.joints.iter().map(Index::value).collect();
    if let Some(node) = joints.iter().find(|node| **node >= document.root.nodes.len()) {
        return Err(within(no_such("node", *node)));
    }
    let Some(binds) = skin.inverse_bind_matrices else {
        return Ok(Skin { inverse_bind_matrices: vec![Mat4::IDENTITY; joints.len()], joints });
    };
    let binds = Accessor::open(document, binds.value()).map_err(within)?;
    if binds.width != 16 || binds.count < joints.len() {
        return Err(within("expected one 4×4 inverse bind matrix per joint".into()));
    }
    let bind = |j: usize| from_columns(&binds.floats(j), warnings);
    let inverse_bind_matrices = (0..joints.len()).map(bind).collect();
    Ok(Skin { joints, inverse_bind_matrices })
}

/// The index of a mesh in the file, and of a primitive in that mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct PrimitiveIndex {
    mesh: usize,
    primitive: usize,
}

/// Collects the variant mappings of primitives while meshes are built.
struct Mappings {
    /// The mappings collected so far; `authored` is still empty.
    variants: Variants,
    materials: usize,
    known: BTreeMap<PrimitiveIndex, usize>,
}

impl Mappings {
    /// Makes an empty collection for the variants of `document`.
    fn new(document: &Document) -> Self {
        let variants = Variants { names: variant_names(document), ..Variants::default() };
        Self { variants, materials: document.root.materials.len(), known: BTreeMap::new() }
    }

    /// Notes that the next mesh of the scene is the primitive `at` of the file. Mappings to anything that does not
    /// exist are skipped with a warning that starts with `place`.
    fn add(&mut self, at: PrimitiveIndex, primitive: &Primitive, place: &str, warnings: &mut Warnings) {
        let json = extension(primitive, VARIANTS).filter(|_| !self.variants.names.is_empty());
        let mapping = json.map(|json| match self.known.get(&at) {
            Some(known) => *known,
            None => {
                let mapping =
                    self.read(json, |why| warnings.note(format!("{place}: variant mapping: {why}"), 1));
                self.variants.mappings.push(mapping);
                self.known.insert(at, self.variants.mappings.len() - 1);
                self.variants.mappings.len() - 1
            }
        });
        self.variants.mapping_of_mesh.push(mapping);
    }

    /// Reads the mapping; if a variant has several materials, the first is used.
    fn read(&self, json: &Value, mut note: impl FnMut(String)) -> Mapping {
        let mut materials = BTreeMap::new();
        let list =
            |json: &Value, key: &str| json.get(key).and_then(Value::as_array).cloned().unwrap_or_default();
        for mapping in list(json, "mappings") {
            let Some(material) = index(mapping.get("material"), self.materials) else {
                note(no_such_value("material", mapping.get("material")));
                continue;
            };
            for variant in list(&mapping, "variants") {
                match index(Some(&variant), self.variants.names.len()) {
                    Some(variant) => drop(materials.entry(variant).or_insert(material)),
                    None => note(no_such_value("variant", Some(&variant))),
                }
            }
        }
        materials.into_iter().collect()
    }
}

fn index(value: Option<&Value>, count: usize) -> Option<usize> {
    let index = usize::try_from(value?.as_u64()?).ok()?;
    (index < count).then_some(index)
}

fn no_such_value(what: &str, value: Option<&Value>) -> String {
    match value.and_then(Value::as_u64) {
        Some(index) => no_such(what, index as usize),
        None => format!("missing {what}"),
    }
}

/// Returns the names of the file's variants. A variant without a name is named by its number.
fn variant_names(document: &Document) -> Vec<String> {
    let extensions = document.root.extensions.as_ref();
    let variants = extensions.and_then(|e| e.others.get(VARIANTS)).and_then(|json| json.get("variants"));
    let name = |(i, variant): (usize, &Value)| match variant.get("name").and_then(Value::as_str) {
        Some(name) => name.to_owned(),
        None => i.to_string(),
    };
    variants.and_then(Value::as_array).into_iter().flatten().enumerate().map(name).collect()
}
