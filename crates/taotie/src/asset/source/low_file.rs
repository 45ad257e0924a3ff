//! Model files given for a scan: read into its space, and kept as they are except for what is baked into their
//! materials; and groups of objects: `wheel_low` shows only `wheel_high` of the scan.
//!
//! glTF and FBX are read in metres. If the scan is in another unit, they are converted to the scan's space on reading,
//! and back in assets.

use super::corrections::{from_metres, is_in_unit, root_scale};
use super::low_material::shown_materials;
use super::scan::{Scan, ScanFile};
use super::size::{all_files, check_extent, is_gltf, stated_unit};
use crate::asset::ask::{BakeOptions, MeshSource};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::bake::{CageGroups, MapKind};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::names::Named;
use taotie_engine::scene::{Material, NormalSpace, Scene};
use taotie_engine::surface::with_normals;
use taotie_io::{GltfFormat, GltfGraft, GltfSource, HIGH_MARK, LOW_MARK, Limits, Objects};
use taotie_io::{listed, name_before, quote};

impl ScanFile {
    /// Returns the places of files that the scan names and that could not be found, such as textures.
    pub fn missing_files(&self) -> &[PathBuf] {
        &self.about.missing
    }
}

/// The contents of a mesh file.
pub(super) struct Read {
    pub scene: Scene,
    /// How it moves, if it does.
    pub moving: Option<&'static str>,
    /// `true` for glTF, which an asset can keep.
    pub is_gltf: bool,
    /// How its format states the unit, if it does.
    pub stated_unit: Option<&'static str>,
    /// `true` if it is in metres, and was converted to the space of a scan in another unit.
    pub is_in_metres: bool,
    /// `true` if it has XMP metadata.
    pub has_xmp: bool,
    /// The names of its meshes; possibly fewer than meshes.
    pub names: Vec<String>,
    /// The objects of its instances; none if its file has no objects.
    pub objects: Objects,
    /// The limits within which it was read.
    pub limits: Limits,
    /// All files that it was read from, the mesh file first; empty in memory.
    pub files: Vec<PathBuf>,
}

impl Read {
    /// Removes uvs and tangents, and the appearance, which is baked again: of materials only their sidedness stays, and
    /// colours if they are ray distances.
    pub fn without_uvs(&mut self, keeps_colors: bool) -> Result<()> {
        let mut data = std::mem::take(&mut self.scene).into_data();
        for mesh in &mut data.meshes {
            let mut bare = std::mem::take(mesh).into_data();
            (bare.uvs, bare.tangents) = (Vec::new(), Vec::new());
            bare.colors.truncate(if keeps_colors { usize::MAX } else { 0 });
            *mesh = Mesh::new(bare)?;
        }
        data.textures.clear();
        for material in &mut data.materials {
            *material = Material { double_sided: material.double_sided, ..Material::default() };
        }
        self.scene = Scene::new(data)?;
        Ok(())
    }
}

/// Reads a given mesh into the scan's space. Files that state their unit are in metres unless their size shows that they
/// are in the scan's unit, which is noted.
pub(super) fn read(source: &MeshSource, scan: &Scan, warnings: &mut Warnings) -> Result<Read> {
    let mut read = as_it_is(source, scan.limits, warnings)?;
    let Some(stated) = read.stated_unit else { return Ok(read) };
    match is_in_scan_unit(&read.scene, scan) {
        Some(unit) => {
            let name = source.name().unwrap_or_default();
            let what = format!(
                "{name}: {stated}, but its size shows that it is in {unit} like the scan; read as such"
            );
            warnings.note(what, 1);
        }
        None => {
            from_metres(&mut read.scene, scan.unit())?;
            read.is_in_metres = root_scale(scan.unit()).is_some();
        }
    }
    Ok(read)
}

fn as_it_is(source: &MeshSource, limits: Limits, warnings: &mut Warnings) -> Result<Read> {
    match source {
        MeshSource::Mesh(mesh) => {
            let scene = Scene::of_mesh(Mesh::clone(mesh), Material::default())?;
            check_extent(&scene, "the low-poly mesh")?;
            let (names, objects, files) = (Vec::new(), Objects::default(), Vec::new());
            let (is_gltf, is_in_metres, has_xmp) = (false, false, false);
            let stated_unit = None;
            Ok(Read {
                scene,
                moving: None,
                is_gltf,
                stated_unit,
                is_in_metres,
                has_xmp,
                names,
                objects,
                limits,
                files,
            })
        }
        MeshSource::File(path) => {
            let mut loaded = taotie_io::load_model_within(path, &limits)?;
            warnings.absorb(loaded.warnings);
            check_extent(&loaded.scene, &path.display().to_string())?;
            let is_gltf = is_gltf(loaded.format);
            let (moving, has_xmp) = (loaded.moving, !loaded.xmp.is_empty());
            let (names, files) = (loaded.mesh_names, all_files(path, &mut loaded.files));
            Ok(Read {
                scene: loaded.scene,
                moving,
                is_gltf,
                stated_unit: stated_unit(loaded.format),
                is_in_metres: false,
                has_xmp,
                names,
                objects: loaded.objects,
                limits,
                files,
            })
        }
    }
}

/// Returns the name of the scan's unit if a glTF scene, which should be in metres, has the size of the scan in that
/// unit: its unconverted diagonal is closer to the scan's than in metres.
pub(in crate::asset) fn is_in_scan_unit(scene: &Scene, scan: &Scan) -> Option<&'static str> {
    let unit = scan.unit()?;
    is_in_unit(scene, unit, scan.mesh().diagonal()).then(|| unit.name())
}

/// The file of a low-poly mesh that an asset keeps: its nodes, meshes, skins, morph targets and animations.
#[derive(Debug, Clone)]
pub(in crate::asset) struct Document {
    /// The file.
    pub source: Source,
    /// All of its triangles, if it has several materials.
    pub whole: Option<Mesh>,
    /// The limits within which it is read.
    pub limits: Limits,
    /// `true` if its lengths are in metres, as glTF requires, and not in the scan's unit.
    pub is_in_metres: bool,
}

/// The source of the kept glTF file.
#[derive(Debug, Clone)]
pub(in crate::asset) enum Source {
    File(PathBuf),
    /// The bytes of a GLB converted from another format.
    Made(Arc<Vec<u8>>),
}

impl Document {
    /// Creates the document of a packed scan, which is in the scan's unit.
    pub fn of_packed(glb: Vec<u8>, limits: Limits) -> Self {
        Self { source: Source::Made(Arc::new(glb)), whole: None, limits, is_in_metres: false }
    }
}

impl Source {
    /// Returns it as a glTF source.
    pub fn gltf(&self) -> GltfSource<'_> {
        match self {
            Self::File(path) => GltfSource::File(path),
            Self::Made(bytes) => GltfSource::Glb(bytes),
        }
    }
}

/// Returns the file that an asset keeps, or whose materials get standalone maps; `None` if the mesh is merged into one
/// with one material: in memory, with a single mesh, without uvs, if levels of detail are made from it, or standalone maps
/// with one material. Files in other formats with several materials are converted to glTF.
///
/// # Errors
/// [`Error::Unsupported`] if the file would lose motion or materials that way, and [`Error::Parse`] if it cannot be
/// rewritten.
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
        warnings.note("merged the nodes of the low-poly mesh: the asset has new levels or uvs", 1);
        return Ok(None);
    }
    // Warnings about a model are of no interest to standalone maps.
    let mut of_model = Warnings::default();
    let source = match read.is_gltf {
        true => Source::File(path.clone()),
        false => Source::Made(Arc::new(made(read, &mut of_model)?)),
    };
    if options.keep_uvs {
        note_motion(read, warnings);
    } else {
        warnings.absorb(of_model);
        check(source.gltf(), read.limits)?;
        note(read, options, warnings);
    }
    // A file that is converted has been transformed into the scan's space.
    let is_in_metres = read.is_in_metres && read.is_gltf;
    Ok(Some(Document { source, whole: None, limits: read.limits, is_in_metres }))
}

/// Converts a file in another format to a GLB; meshes without normals get them.
fn made(read: &mut Read, warnings: &mut Warnings) -> Result<Vec<u8>> {
    let mut meshes = Vec::with_capacity(read.scene.meshes().len());
    for mesh in read.scene.meshes() {
        meshes.push(with_normals(mesh)?.into_owned());
    }
    read.scene.edit(|scene| scene.meshes = meshes)?;
    taotie_io::encode_scene(&read.scene, &read.names, warnings)
}

/// Checks that the file can be rewritten, before anything is baked.
fn check(source: GltfSource<'_>, limits: Limits) -> Result<()> {
    let graft = GltfGraft::unchanged(source, limits);
    taotie_io::encode_graft(Path::new("a.glb"), &graft, &GltfFormat::default()).map(drop)
}

fn note_motion(read: &Read, warnings: &mut Warnings) {
    if let Some(moving) = read.moving {
        warnings.note(format!("the low-poly mesh moves ({moving}): baked and measured at rest"), 1);
    }
}

fn note(read: &Read, options: &BakeOptions, warnings: &mut Warnings) {
    note_motion(read, warnings);
    warnings.note(
        "XMP metadata of the low-poly mesh's whole file, replaced by the scan's",
        usize::from(read.has_xmp),
    );
    let is_tangent = options.space == NormalSpace::Tangent && options.bakes(&[MapKind::Normal]);
    let lacks = |mesh: &usize| read.scene.meshes()[*mesh].tangents().is_empty();
    let meshes: BTreeSet<usize> = read.scene.instances().iter().map(|instance| instance.mesh).collect();
    warnings.note(
        "meshes of the low-poly mesh without tangents: added if MikkTSpace splits no vertex, otherwise left to \
         viewers",
        meshes.iter().filter(|mesh| is_tangent && lacks(mesh)).count(),
    );
}

/// Which of the meshes have uvs.
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
    /// `true` if a node is rotated or scaled.
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

    /// Returns true if merging into one mesh with one material loses nothing.
    fn is_plain(&self) -> bool {
        self.moving.is_none() && self.materials == 1 && self.instances == 1
    }

    /// Returns true if standalone maps are baked for one material, onto all meshes as one.
    fn is_alone(&self, options: &BakeOptions) -> bool {
        options.keep_uvs && self.materials == 1
    }

    /// Returns true if viewers still show the meshes through their own nodes.
    fn keeps_nodes(&self, options: &BakeOptions) -> bool {
        let stays = !self.is_plain() && self.uvs == Uvs::All && options.lods.is_empty();
        options.keep_uvs || stays
    }

    /// Returns true if a file in another format is converted to glTF to keep its materials.
    fn becomes_gltf(&self, options: &BakeOptions) -> bool {
        self.materials > 1 && self.uvs == Uvs::All && options.lods.is_empty()
    }

    /// Returns the unsupported feature and the reason.
    fn hindrance(&self, options: &BakeOptions) -> Option<(String, &'static str)> {
        let what = match self.moving {
            Some(moving) => format!("a low-poly mesh with {moving}"),
            None if self.instances == 1 => "a low-poly mesh that a node places".to_owned(),
            None if self.materials == 1 => format!("a low-poly mesh with {} parts", self.instances),
            None => format!("a low-poly mesh with {} materials", self.materials),
        };
        let (moves, several) = (self.moving.is_some(), self.materials > 1);
        let hindrances = [
            (
                moves && self.uvs != Uvs::All,
                "parts of it have no uvs, and adding them would break its motion; unwrap it",
            ),
            (self.uvs == Uvs::Some, "parts of it have no uvs; unwrap all of it, or none"),
            (
                (moves || several && self.uvs == Uvs::All) && !options.lods.is_empty(),
                "its file is kept as is, and levels of detail would need a separate one; omit them",
            ),
            (
                moves && options.space == NormalSpace::Object,
                "object-space normals do not follow its motion; bake tangent space",
            ),
            (
                self.turns && options.space == NormalSpace::Object && self.keeps_nodes(options),
                "its nodes are rotated or scaled, which would apply twice to object-space normals; apply the \
                 transforms, or bake tangent space",
            ),
        ];
        hindrances.into_iter().find(|(is, _)| *is).map(|(_, why)| (what, why))
    }
}

/// Returns a label for each of these materials that distinguishes it from the others; empty if there is only one.
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

/// Returns `true` if a transform changes normals: it does more than translate and scale uniformly.
fn turns(world_from_object: Mat4) -> bool {
    let axes = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let scale = world_from_object.columns[0][0];
    scale <= 0.0 || axes.into_iter().any(|axis| world_from_object.transform_vector(axis) != axis * scale)
}

/// Returns the name with characters replaced that are not valid in file names everywhere.
fn word(name: &str) -> String {
    let fits = |c: char| c.is_alphanumeric() || c == '-';
    name.chars().take(40).map(|c| if fits(c) { c } else { '_' }).collect()
}

/// The objects of a scan that each object of a low-poly mesh shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::asset) struct Groups {
    /// The names of the groups, sorted.
    pub names: Vec<String>,
    /// The group of each instance of the low-poly mesh, an index into `names`; `None` if it shows the whole scan.
    of_low: Vec<Option<u32>>,
    /// The group of each instance of the scan.
    of_high: Arc<[Option<u32>]>,
}

impl Groups {
    /// Matches objects by their names; `None` if no name of the low-poly mesh has a counterpart, or if all objects
    /// are one group. Objects without a counterpart are noted.
    pub fn matched([low, high]: [&Objects; 2], warnings: &mut Warnings) -> Option<Self> {
        let of_high: Vec<Option<String>> =
            high.names.iter().map(|name| name_before(name, HIGH_MARK)).collect();
        let of_low: Vec<Option<String>> = low.names.iter().map(|name| name_before(name, LOW_MARK)).collect();
        let named: BTreeSet<&String> = of_high.iter().flatten().collect();
        let shared: BTreeSet<&String> = of_low.iter().flatten().filter(|name| named.contains(name)).collect();
        let names: Vec<String> = shared.into_iter().cloned().collect();
        let number = |name: &Option<String>| names.binary_search(name.as_ref()?).ok().map(|k| k as u32);
        let [low_groups, high_groups] =
            [&of_low, &of_high].map(|all| all.iter().map(number).collect::<Vec<Option<u32>>>());
        let is_one = names.len() == 1 && low_groups.iter().chain(&high_groups).all(Option::is_some);
        let is_any_marked = |names: &[Option<String>]| names.iter().any(Option::is_some);
        let is_none = names.is_empty() && is_any_marked(&of_low) && is_any_marked(&of_high);
        let what =
            "objects are named for baking, but no name of the low-poly mesh has a counterpart in the scan";
        warnings.note(what, usize::from(is_none));
        if names.is_empty() || is_one {
            return None;
        }
        let mut note = |what: &str, objects: &Objects, groups: &[Option<u32>]| {
            let all = objects.names.iter().zip(groups).filter(|(_, group)| group.is_none());
            let all: Vec<String> = all.map(|(name, _)| quote(name)).collect();
            warnings.note(format!("{what}: {}", listed(&all)), all.len());
        };
        let nearest =
            "objects of the low-poly mesh without a counterpart by name, which show whatever is nearest";
        note(nearest, low, &low_groups);
        let unseen = "objects of the scan without a counterpart by name, which no matched object shows";
        note(unseen, high, &high_groups);
        let of_instances = |objects: &Objects, groups: &[Option<u32>]| -> Vec<Option<u32>> {
            objects.of_instances.iter().map(|object| groups[*object as usize]).collect()
        };
        let (of_low, of_high) = (of_instances(low, &low_groups), of_instances(high, &high_groups));
        Some(Self { names, of_low, of_high: of_high.into() })
    }

    /// Returns the groups of a mesh of these instances of the low-poly mesh, each with its number of triangles.
    pub fn of_mesh(&self, instances: impl Iterator<Item = (usize, usize)>) -> CageGroups {
        let of_instance = |(instance, triangles): (usize, usize)| {
            std::iter::repeat_n(self.of_low.get(instance).copied().flatten(), triangles)
        };
        CageGroups {
            of_triangle: instances.flat_map(of_instance).collect(),
            of_object: Arc::clone(&self.of_high),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asset::ask::Lod;
    use taotie_engine::length::Unit;
    use taotie_engine::mesh::MeshData;
    use taotie_engine::scene::{Instance, SceneData};

    #[test]
    fn the_size_shows_the_unit() {
        let ball = |radius: f64| Scene::of_mesh(Mesh::sphere(radius, 16, 8), Material::default()).unwrap();
        let file = crate::asset::ScanFile::from_scene(ball(50.0)).unwrap();
        let options = crate::asset::ScanOptions { unit: Some(Unit::Millimetre), ..Default::default() };
        let scan = file.with_options(options).into_scan(taotie_engine::Progress::SILENT).unwrap();
        let found = [49.0, 5.0, 0.5, 0.05].map(|radius| is_in_scan_unit(&ball(radius), &scan));
        assert_eq!(found, [Some("mm"), Some("mm"), None, None]);
        let unknown = Scan::from_scene(ball(50.0), taotie_engine::Progress::SILENT).unwrap();
        assert_eq!(is_in_scan_unit(&ball(50.0), &unknown), None);
    }

    /// A file with one ball per material, with uvs where `uvs` is true.
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
        let (is_in_metres, has_xmp) = (false, false);
        let (names, objects, files) = (Vec::new(), Objects::default(), Vec::new());
        let (is_gltf, stated_unit) = (true, None);
        Read {
            scene,
            moving: None,
            is_gltf,
            stated_unit,
            is_in_metres,
            has_xmp,
            names,
            objects,
            limits,
            files,
        }
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
        let standalone = BakeOptions { keep_uvs: true, ..BakeOptions::default() };
        let (two, one) = (file(&["a", "b"], &[true, true]), file(&["a"], &[true]));
        let moving = Read { moving: Some("a skin"), ..file(&["a"], &[true]) };
        let bare = Read { moving: Some("a skin"), ..file(&["a"], &[false]) };
        assert_eq!([&two, &one, &moving].map(|read| hindrance(read, &plain)), ["", "", ""]);
        assert!(hindrance(&two, &lods).contains("levels of detail"));
        assert_eq!(hindrance(&one, &lods), "");
        assert_eq!(hindrance(&two, &standalone), "", "each gets its own");
        assert!(Shape::of(&moving).is_alone(&standalone) && !Shape::of(&two).is_alone(&standalone));
        assert!(hindrance(&bare, &plain).contains("no uvs"));
        assert!(hindrance(&file(&["a", "b"], &[true, false]), &plain).contains("no uvs"));
        assert_eq!(hindrance(&file(&["a", "b"], &[false, false]), &plain), "", "they are merged");
        assert!(hindrance(&moving, &object).contains("object-space"));
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
        assert!(hindrance(&turned(&["a", "b"]), &object).contains("rotated or scaled"));
        assert_eq!(hindrance(&turned(&["a"]), &object), "", "it is rewritten");
        let standalone = BakeOptions { keep_uvs: true, ..object };
        assert!(hindrance(&turned(&["a"]), &standalone).contains("rotated or scaled"));
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

    fn objects(all: &[&str]) -> Objects {
        let names = all.iter().map(|name| (*name).to_owned()).collect();
        Objects { names, of_instances: (0..all.len() as u32).collect() }
    }

    #[test]
    fn objects_are_matched_by_what_is_before_low_and_high() {
        let low = objects(&["Wheel_low", "axle_LOW.001", "wheel_low_rim", "cart"]);
        let high = objects(&["axle_high", "wheel_high_bolts", "WHEEL_high", "dust", "hook_high"]);
        let mut warnings = Warnings::default();
        let groups = Groups::matched([&low, &high], &mut warnings).unwrap();
        assert_eq!(groups.names, ["axle", "wheel"]);
        assert_eq!(groups.of_low, [Some(1), Some(0), Some(1), None]);
        assert_eq!(*groups.of_high, [Some(0), Some(1), Some(1), None, None]);
        let noted: Vec<(&str, usize)> = warnings.iter().collect();
        assert!(noted[0].0.ends_with("'cart'") && noted[0].1 == 1, "{noted:?}");
        assert!(noted[1].0.ends_with("'dust', 'hook_high'") && noted[1].1 == 2, "{noted:?}");
        let mesh = groups.of_mesh([(1, 2), (3, 1)].into_iter());
        assert_eq!(mesh.of_triangle, [Some(0), Some(0), None]);
    }

    #[test]
    fn other_names_match_nothing() {
        for (low, high, notes) in [
            (&["wheel"][..], &["wheel"][..], 0),
            (&["a_low"], &["b_high"], 1),
            (&["a_low"], &["b"], 0),
            (&["a_lower"], &["a_higher"], 0),
            (&["_low"], &["_high"], 0),
            (&["a_low", "a_low"], &["a_high"], 0),
            (&[], &[], 0),
        ] {
            let mut warnings = Warnings::default();
            assert_eq!(Groups::matched([&objects(low), &objects(high)], &mut warnings), None, "{low:?}");
            assert_eq!(warnings.iter().count(), notes, "{low:?}");
        }
    }
}
