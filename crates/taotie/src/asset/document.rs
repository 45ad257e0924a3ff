//! The glTF file of a low-poly mesh that stays as it is, but for what is baked into its materials.

use super::low_file::Read;
use super::options::{BakeOptions, MeshSource};
use crate::bake::MapKind;
use crate::error::{Error, Result, Warnings};
use crate::io::{self, GltfFormat, GltfGraft, GltfSource, Limits};
use crate::math::{Mat4, Vec3};
use crate::mesh::Mesh;
use crate::scene::{Material, NormalSpace, Scene};
use crate::surface::with_normals;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file of a low-poly mesh that an asset keeps: its nodes, meshes, skins, morph targets and animations.
#[derive(Debug, Clone)]
pub(super) struct Document {
    /// The file.
    pub source: Source,
    /// All of its triangles, where it has several materials.
    pub whole: Option<Mesh>,
    /// The limits within which it is read.
    pub limits: Limits,
    /// `true` if its lengths are in metres, as glTF requires, and not in the scan's unit.
    pub is_in_metres: bool,
}

/// The place of the glTF file that is kept.
#[derive(Debug, Clone)]
pub(super) enum Source {
    File(PathBuf),
    /// The bytes of a GLB made of a file of another format.
    Made(Arc<Vec<u8>>),
}

impl Document {
    /// Takes a packed scan, which is in the scan's unit.
    pub fn of_packed(glb: Vec<u8>, limits: Limits) -> Self {
        Self { source: Source::Made(Arc::new(glb)), whole: None, limits, is_in_metres: false }
    }
}

impl Source {
    /// Returns it as a source of glTF.
    pub fn gltf(&self) -> GltfSource<'_> {
        match self {
            Self::File(path) => GltfSource::File(path),
            Self::Made(bytes) => GltfSource::Glb(bytes),
        }
    }
}

/// A material of that file.
#[derive(Debug, Clone, Default)]
pub(super) struct KeptMaterial {
    /// Its number in the file.
    pub number: usize,
    /// A word that tells it from the file's other materials, fit for the name of a file; empty where it is the only one.
    pub label: String,
    /// The material as the file says it.
    pub said: Material,
    /// `true` where colours of vertices go.
    pub drops_colors: bool,
    /// Its triangles among all that the file shows.
    pub triangles: Vec<Range<usize>>,
}

/// Returns the numbers of the materials that are shown, in order.
pub(super) fn shown_materials(scene: &Scene) -> BTreeSet<usize> {
    scene.instances().iter().map(|instance| instance.material).collect()
}

/// Returns the triangles of each material among all that are shown.
pub(super) fn triangles_by_material(scene: &Scene) -> BTreeMap<usize, Vec<Range<usize>>> {
    let mut ranges: BTreeMap<usize, Vec<Range<usize>>> = BTreeMap::new();
    let mut first = 0;
    for instance in scene.instances() {
        let end = first + scene.meshes()[instance.mesh].triangles().len();
        ranges.entry(instance.material).or_default().push(first..end);
        first = end;
    }
    ranges
}

/// Returns the file that an asset keeps; `None` where the mesh is made one with one material: in memory, of a single mesh
/// or material, without uvs, or where levels of detail or maps alone are made of it. Files of other formats that have
/// several materials are made glTF.
///
/// # Errors
/// [`Error::Unsupported`] where the file would lose motion or materials that way, and [`Error::Parse`] where it cannot be
/// written anew.
pub(super) fn kept(
    source: &MeshSource,
    read: &mut Read,
    options: &BakeOptions,
    warnings: &mut Warnings,
) -> Result<Option<Document>> {
    let MeshSource::File(path) = source else { return Ok(None) };
    let shape = Shape::of(read);
    let is_one = shape.is_plain() && !(options.keep_uvs && shape.turns);
    if is_one || (!read.is_gltf && !shape.becomes_gltf(options)) {
        return Ok(None);
    }
    if let Some((what, why)) = shape.hindrance(options) {
        return Err(Error::unsupported(format!("{}: {what}", path.display()), why));
    }
    if shape.is_alone(options) {
        note_motion(read, warnings);
        return Ok(None);
    }
    if shape.uvs != Uvs::All || !options.lods.is_empty() {
        warnings.note("nodes of the low-poly mesh made one mesh: the asset has levels or uvs of its own", 1);
        return Ok(None);
    }
    let source = match read.is_gltf {
        true => Source::File(path.clone()),
        false => Source::Made(Arc::new(made(read, warnings)?)),
    };
    check(source.gltf(), read.limits)?;
    note(read, options, warnings);
    Ok(Some(Document { source, whole: None, limits: read.limits, is_in_metres: read.is_in_metres }))
}

/// Returns a GLB of a file of another format, whose meshes get normals where they have none.
fn made(read: &mut Read, warnings: &mut Warnings) -> Result<Vec<u8>> {
    let mut meshes = Vec::with_capacity(read.scene.meshes().len());
    for mesh in read.scene.meshes() {
        meshes.push(with_normals(mesh)?.into_owned());
    }
    read.scene.edit(|scene| scene.meshes = meshes)?;
    io::encode_scene(&read.scene, &read.names, warnings)
}

/// Tries whether the file can be written anew, before anything is baked.
fn check(source: GltfSource<'_>, limits: Limits) -> Result<()> {
    let graft = GltfGraft::unchanged(source, limits);
    io::encode_graft(Path::new("a.glb"), &graft, &GltfFormat::default()).map(drop)
}

fn note_motion(read: &Read, warnings: &mut Warnings) {
    if let Some(moving) = read.moving {
        warnings.note(format!("the low-poly mesh moves ({moving}): it is baked and measured at rest"), 1);
    }
}

fn note(read: &Read, options: &BakeOptions, warnings: &mut Warnings) {
    note_motion(read, warnings);
    warnings.note(
        "XMP metadata of the low-poly mesh's whole file, in whose place the scan's stands",
        usize::from(read.has_xmp),
    );
    let is_tangent = options.space == NormalSpace::Tangent && options.bakes(&[MapKind::Normal]);
    let lacks = |mesh: &usize| read.scene.meshes()[*mesh].tangents().is_empty();
    let meshes: BTreeSet<usize> = read.scene.instances().iter().map(|instance| instance.mesh).collect();
    warnings.note(
        "meshes of the low-poly mesh without tangents: those that MikkTSpace splits no vertex of are given them, viewers \
         make the others",
        meshes.iter().filter(|mesh| is_tangent && lacks(mesh)).count(),
    );
}

/// The part of the meshes that has uvs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Uvs {
    All,
    Some,
    None,
}

/// The shape of a file.
struct Shape {
    moving: Option<&'static str>,
    materials: usize,
    instances: usize,
    uvs: Uvs,
    /// `true` where some node is turned or scaled.
    turns: bool,
}

impl Shape {
    fn of(read: &Read) -> Self {
        let (scene, moving) = (&read.scene, read.moving);
        let instances = scene.instances().len();
        let has_uvs = |mesh: usize| !scene.meshes()[mesh].uvs().is_empty();
        let with = scene.instances().iter().filter(|instance| has_uvs(instance.mesh)).count();
        let uvs = match with {
            0 => Uvs::None,
            _ if with == instances => Uvs::All,
            _ => Uvs::Some,
        };
        let turns = scene.instances().iter().any(|instance| turns(instance.world_from_object));
        Self { moving, materials: shown_materials(scene).len(), instances, uvs, turns }
    }

    /// Says whether one mesh of one material loses nothing.
    fn is_plain(&self) -> bool {
        self.moving.is_none() && self.materials == 1 && self.instances == 1
    }

    /// Says whether maps alone are baked for one material, so that no file is written anew.
    fn is_alone(&self, options: &BakeOptions) -> bool {
        options.keep_uvs && self.materials == 1
    }

    /// Says whether viewers go on to show the meshes through nodes of their own.
    fn keeps_nodes(&self, options: &BakeOptions) -> bool {
        let stays = !self.is_plain() && self.uvs == Uvs::All && options.lods.is_empty();
        options.keep_uvs || stays
    }

    /// Says whether a file of another format is made glTF, so that its materials stay.
    fn becomes_gltf(&self, options: &BakeOptions) -> bool {
        self.materials > 1 && self.uvs == Uvs::All && options.lods.is_empty()
    }

    /// Returns what cannot be done with it, and why.
    fn hindrance(&self, options: &BakeOptions) -> Option<(String, &'static str)> {
        let what = match self.moving {
            Some(moving) => format!("a low-poly mesh with {moving}"),
            None if self.materials == 1 => format!("a low-poly mesh of {} parts", self.instances),
            None => format!("a low-poly mesh of {} materials", self.materials),
        };
        let (moves, several) = (self.moving.is_some(), self.materials > 1);
        let hindrances = [
            (
                moves && self.uvs != Uvs::All,
                "some of it has no uvs, and making them would break its motion; unwrap it",
            ),
            (self.uvs == Uvs::Some, "some of it has no uvs; unwrap all of it, or none"),
            (
                (moves || several && self.uvs == Uvs::All) && !options.lods.is_empty(),
                "its file stays as it is, and levels of detail would need one of their own; leave them out",
            ),
            (
                several && options.keep_uvs,
                "maps alone are for one material; give a mesh of one, or write a .glb",
            ),
            (
                moves && options.space == NormalSpace::Object,
                "normals in object space do not follow its motion; bake them in tangent space",
            ),
            (
                self.turns && options.space == NormalSpace::Object && self.keeps_nodes(options),
                "its nodes are turned or scaled, and normals in object space would be so twice; apply their transforms, or \
                 bake tangent space",
            ),
        ];
        hindrances.into_iter().find(|(is, _)| *is).map(|(_, why)| (what, why))
    }
}

/// Returns a word for each of the materials of these numbers that tells it from the others; none where it is alone.
pub(super) fn labels(scene: &Scene, numbers: &BTreeSet<usize>) -> BTreeMap<usize, String> {
    if numbers.len() < 2 {
        return numbers.iter().map(|number| (*number, String::new())).collect();
    }
    let mut taken = BTreeSet::new();
    let label = |number: &usize| {
        let name = scene.materials().get(*number).map_or("", |material| material.name.as_str());
        let mut label = word(name);
        if label.is_empty() || taken.contains(&label.to_lowercase()) {
            label.push_str(&number.to_string());
        }
        while !taken.insert(label.to_lowercase()) {
            label.push('_');
        }
        (*number, label)
    };
    numbers.iter().map(label).collect()
}

/// Returns `true` if a transform turns normals: it does more than move, and scale all axes alike.
fn turns(world_from_object: Mat4) -> bool {
    let axes = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let scale = world_from_object.columns[0][0];
    scale <= 0.0 || axes.into_iter().any(|axis| world_from_object.transform_vector(axis) != axis * scale)
}

/// Returns the name without what the name of a file cannot hold everywhere.
fn word(name: &str) -> String {
    let fits = |c: char| c.is_alphanumeric() || c == '-';
    name.chars().take(40).map(|c| if fits(c) { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::lod::Lod;
    use crate::mesh::MeshData;
    use crate::scene::{Instance, SceneData};

    /// A file of one ball for each material, with uvs where it is said.
    fn file(names: &[&str], uvs: &[bool]) -> Read {
        let material = |name: &&str| Material { name: (*name).into(), ..Material::default() };
        let mesh = |has_uvs: &bool| {
            let data = Mesh::sphere(1.0, 8, 4).into_data();
            let uvs = if *has_uvs { data.uvs } else { Vec::new() };
            Mesh::new(MeshData { uvs, ..data }).unwrap()
        };
        let world_from_object = Mat4::IDENTITY;
        let instances = (0..names.len()).map(|i| Instance { mesh: i, material: i, world_from_object });
        let scene = Scene::new(SceneData {
            meshes: uvs.iter().map(mesh).collect(),
            materials: names.iter().map(material).collect(),
            instances: instances.collect(),
            ..SceneData::default()
        });
        let (scene, limits) = (scene.unwrap(), Limits::default());
        let (names, files) = (Vec::new(), Vec::new());
        Read { scene, moving: None, is_gltf: true, is_in_metres: false, has_xmp: false, names, limits, files }
    }

    fn hindrance(read: &Read, options: &BakeOptions) -> String {
        Shape::of(read).hindrance(options).map_or("", |(_, why)| why).to_owned()
    }

    #[test]
    fn what_would_be_lost_is_refused() {
        let (plain, lods) = (
            BakeOptions::default(),
            BakeOptions { lods: vec![Lod::Triangles(10)], ..BakeOptions::default() },
        );
        let object = BakeOptions { space: NormalSpace::Object, ..BakeOptions::default() };
        let alone = BakeOptions { keep_uvs: true, ..BakeOptions::default() };
        let (two, one) = (file(&["a", "b"], &[true, true]), file(&["a"], &[true]));
        let moving = Read { moving: Some("a skin"), ..file(&["a"], &[true]) };
        let bare = Read { moving: Some("a skin"), ..file(&["a"], &[false]) };
        assert_eq!([&two, &one, &moving].map(|read| hindrance(read, &plain)), ["", "", ""]);
        assert!(hindrance(&two, &lods).contains("levels of detail"));
        assert_eq!(hindrance(&one, &lods), "");
        assert!(hindrance(&two, &alone).contains("maps alone are for one material"));
        assert!(Shape::of(&moving).is_alone(&alone) && !Shape::of(&two).is_alone(&alone));
        assert!(hindrance(&bare, &plain).contains("no uvs"));
        assert!(hindrance(&file(&["a", "b"], &[true, false]), &plain).contains("no uvs"));
        assert_eq!(hindrance(&file(&["a", "b"], &[false, false]), &plain), "", "they are made one");
        assert!(hindrance(&moving, &object).contains("object space"));
        assert_eq!(hindrance(&two, &object), "");
        assert!(hindrance(&file(&["a", "a"], &[true, false]), &plain).contains("no uvs"));
    }

    #[test]
    fn object_space_of_turned_nodes_is_refused_where_they_stay() {
        let object = BakeOptions { space: NormalSpace::Object, ..BakeOptions::default() };
        let turned = |names: &[&str]| {
            let mut read = file(names, &vec![true; names.len()]);
            let turn = Mat4::rotation_about(Vec3::new(1.0, 0.0, 0.0), -1.5);
            read.scene.edit(|scene| scene.instances[0].world_from_object = turn).unwrap();
            read
        };
        assert!(hindrance(&turned(&["a", "b"]), &object).contains("turned or scaled"));
        assert_eq!(hindrance(&turned(&["a"]), &object), "", "it is written anew");
        let alone = BakeOptions { keep_uvs: true, ..object };
        assert!(hindrance(&turned(&["a"]), &alone).contains("turned or scaled"));
    }

    #[test]
    fn labels_are_words_and_differ() {
        let of = |names: &[&str]| {
            let scene = file(names, &vec![true; names.len()]).scene;
            labels(&scene, &shown_materials(&scene)).into_values().collect::<Vec<_>>()
        };
        assert_eq!(of(&["wood"]), [""]);
        assert_eq!(of(&["old wood", "old/wood", "", "Brass"]), ["old_wood", "old_wood1", "2", "Brass"]);
        assert_eq!(of(&["a", "a", "a1"]), ["a", "a1", "a12"]);
        assert_eq!(of(&["", "x", "0"]), ["0", "x", "02"]);
    }
}
