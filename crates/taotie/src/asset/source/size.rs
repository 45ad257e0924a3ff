//! The files of a scan, with the contents that no bake reads, and its size: the memory that its triangles and textures
//! take, and the size of a map that preserves its detail.

use super::material::is_plain;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use taotie_engine::bake::{Maps, lacks_tangents, texel_width};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Texture;
use taotie_engine::math::scalar;
use taotie_engine::mesh::Mesh;
use taotie_engine::proof::{Footprint, edges};
use taotie_engine::scene::{Instance, Scene};
use taotie_engine::surface::tangent_bytes;
use taotie_io::{FileHash, HIGH_MARK, Json, Loaded, Objects, name_before, xmp_rights};

/// A model file of a scan.
#[derive(Debug)]
pub(in crate::asset) struct ModelFile {
    pub path: PathBuf,
    hash: FileHash,
}

impl ModelFile {
    /// Starts to hash the file.
    pub(super) fn begin(path: &Path) -> Self {
        Self { path: path.to_path_buf(), hash: FileHash::begin(path) }
    }

    /// Returns its SHA-256, hexadecimal.
    ///
    /// # Errors
    /// [`Error::Io`] if it can no longer be read.
    pub fn sha256(&self) -> Result<String> {
        self.hash.get()
    }

    /// Returns its name without folders.
    pub fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Returns its name without folders and without its extension.
    pub(super) fn stem(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// The number of triangles and vertices of a scan, their attributes, and the maps that its materials need.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, ScanSize};
///
/// let baker = Baker::new(BakeOptions::default());
/// let size = |triangles| ScanSize { triangles, vertices: triangles / 2, ..ScanSize::default() };
/// let need = |triangles: u64| baker.need(size(triangles)).bytes();
/// assert!(need(20_000_000) > need(1_000_000));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ScanSize {
    /// Triangles, over all instances.
    pub triangles: u64,
    /// Vertices, over all instances.
    pub vertices: u64,
    /// Bytes of vertex attributes other than positions and normals: uvs, tangents and colours.
    pub attribute_bytes: u64,
    /// Bytes of its textures with their mip chains.
    pub texture_bytes: u64,
    /// Triangles of the largest mesh that gets tangents, because a normal map needs them and its file has none.
    pub framed_triangles: u64,
    /// Vertices of that mesh.
    pub framed_vertices: u64,
    /// The maps of properties that vary in its materials, which a bake carries over if requested.
    pub carries: Maps,
    /// The side of the smallest square map, a power of two, that preserves its detail; see
    /// [`BakeOptions::AUTO_SIZE`](crate::asset::BakeOptions::AUTO_SIZE).
    pub detail_side: u32,
    /// `true` if it specifies a material, so that images in full material are compared too.
    pub has_material: bool,
}

impl ScanSize {
    /// Counts the contents of a scene.
    pub(super) fn of(scene: &Scene, carries: Maps) -> Self {
        let (meshes, lacks) = (scene.meshes(), lacks_tangents(scene));
        let framed = meshes.iter().zip(&lacks).filter(|(_, lacks)| **lacks).map(|(mesh, _)| mesh);
        let largest = framed.max_by_key(|mesh| mesh.triangles().len());
        let shown = || scene.instances().iter().map(|instance| instance.mesh);
        let made = |mesh: usize| if lacks[mesh] { vertices(&meshes[mesh]) * TANGENT } else { 0 };
        Self {
            triangles: scene.triangle_count() as u64,
            vertices: shown().map(|mesh| vertices(&meshes[mesh])).sum(),
            attribute_bytes: shown().map(|mesh| attribute_bytes(&meshes[mesh]) + made(mesh)).sum(),
            texture_bytes: scene.textures().iter().map(Texture::bytes).sum(),
            framed_triangles: largest.map_or(0, |mesh| mesh.triangles().len() as u64),
            framed_vertices: largest.map_or(0, vertices),
            carries,
            detail_side: detail_side(scene),
            has_material: !is_plain(scene),
        }
    }

    /// Returns the size with additional vertices, which have normals and positions, and may have uvs and colours.
    pub(super) fn with_vertices_added(self, added: u64) -> Self {
        let attributes = self.attribute_bytes.div_ceil(self.vertices.max(1));
        Self {
            vertices: self.vertices + added,
            attribute_bytes: self.attribute_bytes + added * attributes,
            ..self
        }
    }

    /// Returns the bytes of the scan, sorted for rays.
    pub(in crate::asset) fn bytes(self) -> u64 {
        /// The corners, order and boxes of the tree.
        const TREE: u64 = 41;
        self.mesh_bytes() + self.triangles * TREE
    }

    /// Returns the peak bytes of the scan while its tangents are computed, which is before it is merged; 0 if none
    /// are.
    pub(in crate::asset) fn framing_bytes(self) -> u64 {
        match self.framed_triangles {
            0 => 0,
            triangles => self.mesh_bytes() + tangent_bytes(triangles, self.framed_vertices),
        }
    }

    /// Returns the bytes of the scan while it is rendered: its tree is freed, and its triangles are placed.
    pub(in crate::asset) fn viewing_bytes(self) -> u64 {
        const PLACED_VERTEX: u64 = 72;
        const PLACED_TRIANGLE: u64 = 60;
        self.mesh_bytes() + self.vertices * PLACED_VERTEX + self.triangles * PLACED_TRIANGLE
    }

    /// Returns the size without the cost of computing tangents: they exist once it is merged.
    pub(in crate::asset) fn joined(self) -> Self {
        Self { framed_triangles: 0, framed_vertices: 0, ..self }
    }

    /// Returns the bytes of the scan as one mesh, before it is sorted for rays.
    pub(in crate::asset) fn mesh_bytes(self) -> u64 {
        /// Position and normal.
        const VERTEX: u64 = 24;
        const TRIANGLE: u64 = 12;
        self.triangles * TRIANGLE + self.vertices * VERTEX + self.attribute_bytes + self.texture_bytes
    }
}

/// Bytes of a tangent.
const TANGENT: u64 = 16;

fn vertices(mesh: &Mesh) -> u64 {
    mesh.positions().len() as u64
}

/// Returns the bytes of a mesh's uvs, tangents and colours.
fn attribute_bytes(mesh: &Mesh) -> u64 {
    const UV: u64 = 8;
    const COLOR: u64 = 16;
    let [uvs, tangents, colors] =
        [mesh.uvs().iter().map(Vec::len).sum(), mesh.tangents().len(), mesh.colors().len()];
    uvs as u64 * UV + tangents as u64 * TANGENT + colors as u64 * COLOR
}

/// The share of a map that UV islands cover in a generated atlas.
const COVERED: f64 = 0.6;
/// The share of the surface whose detail may be finer than the map's texels.
const LOST: f64 = 0.01;
/// The largest side considered.
const MOST: f64 = 65_536.0;

/// A piece of the scan.
struct Piece {
    /// Its area, square model units.
    area: f64,
    /// The width of its finest texel, model units.
    texel: Option<f32>,
}

/// Returns the side of the smallest square map, a power of two, whose texels are at most as wide as the scan's finest
/// detail on all but one per cent of its area: a texel of its textures, or half its median edge, but at least 1/4096
/// of its diagonal.
fn detail_side(scene: &Scene) -> u32 {
    let (mut pieces, mut lengths) = (Vec::new(), Vec::new());
    let mut first = 0;
    let count = scene.triangle_count();
    let mut looked_at = Footprint::looked_at(count).peekable();
    let looked = Footprint::looked_at(count).count();
    for instance in scene.instances() {
        let placed = Placed::of(scene, instance);
        let end = first + placed.mesh.triangles().len();
        while let Some(t) = looked_at.next_if(|t| *t < end) {
            lengths.extend(placed.edges(t - first));
            pieces.push(placed.piece(t - first));
        }
        first = end;
    }
    let footprint = Footprint::of_edges(lengths, scene.bounds().map_or(0.0, |bounds| bounds.diagonal()));
    let mut widths: Vec<(f32, f64)> =
        pieces.into_iter().map(|piece| (footprint.of_texel(piece.texel), piece.area)).collect();
    widths.sort_by(|a, b| a.0.total_cmp(&b.0));
    let seen: f64 = widths.iter().map(|(_, area)| area).sum();
    let mut finer = 0.0;
    let is_preserved = |(_, area): &&(f32, f64)| {
        finer += area;
        finer >= seen * LOST
    };
    let Some((width, _)) = widths.iter().find(is_preserved) else { return 1 };
    let area = seen * count as f64 / looked.max(1) as f64;
    let side = (area / COVERED).sqrt() / f64::from(*width);
    (side.min(MOST).ceil() as u32).next_power_of_two()
}

/// An instance of a mesh.
struct Placed<'a> {
    scene: &'a Scene,
    instance: &'a Instance,
    mesh: &'a Mesh,
    /// The scale of its lengths.
    scale: f64,
}

impl<'a> Placed<'a> {
    fn of(scene: &'a Scene, instance: &'a Instance) -> Self {
        let scale = scalar::cbrt(instance.world_from_object.determinant3().abs());
        Self { scene, instance, mesh: &scene.meshes()[instance.mesh], scale }
    }

    fn edges(&self, triangle: usize) -> [f32; 3] {
        edges(self.mesh, triangle).map(|length| length * self.scale as f32)
    }

    fn piece(&self, triangle: usize) -> Piece {
        let [a, b, c] = self.mesh.corners(triangle).map(|corner| corner.to_f64());
        let material = &self.scene.materials()[self.instance.material];
        let textures = self.scene.textures();
        let widths = material
            .textures()
            .into_iter()
            .filter_map(|used| texel_width((self.mesh, triangle as u32), textures, &used));
        Piece {
            area: (b - a).cross(c - a).length() * 0.5 * self.scale * self.scale,
            texel: widths.reduce(f32::min).map(|width| width * self.scale as f32),
        }
    }
}

/// Returns `true` if a model of this format, as [`taotie_io::Loaded`] names it, is glTF.
pub(in crate::asset) fn is_gltf(format: &str) -> bool {
    ["glTF", "GLB"].contains(&format)
}

/// Returns how a format states the unit of lengths, which are then read as metres; `None` if it does not.
pub(in crate::asset) fn stated_unit(format: &str) -> Option<&'static str> {
    match format {
        "glTF" | "GLB" => Some("glTF is in metres"),
        "FBX" => Some("FBX states its unit"),
        _ => None,
    }
}

/// Returns a model's file and all others that it was read from, without duplicates.
pub(in crate::asset) fn all_files(path: &Path, others: &mut Vec<PathBuf>) -> Vec<PathBuf> {
    first_of(vec![path.to_path_buf()], std::mem::take(others))
}

/// Returns `first` and then the others, sorted, without duplicates.
pub(super) fn first_of(first: Vec<PathBuf>, mut others: Vec<PathBuf>) -> Vec<PathBuf> {
    others.sort();
    others.dedup();
    others.retain(|other| !first.contains(other));
    [first, others].concat()
}

/// Returns where files would be that a model names and that could not be found: relative to its folder, or in it.
pub(super) fn missing_files(model: &Path, names: &[String]) -> Vec<PathBuf> {
    let folder = model.parent().unwrap_or(Path::new(""));
    let places = |name: &String| {
        let name = name.replace('\\', "/");
        let last = name.rsplit('/').next().unwrap_or_default().to_owned();
        [folder.join(name), folder.join(last)]
    };
    first_of(Vec::new(), names.iter().flat_map(places).filter(|path| path != folder).collect())
}

/// Returns the distinct rights notices of models, as stated in their files or their metadata.
pub(super) fn rights<'a>(
    all: impl Iterator<Item = (&'a Option<String>, &'a Option<Json>)>,
) -> Option<String> {
    let mut known: Vec<String> = Vec::new();
    for (copyright, xmp) in all {
        let own = copyright.clone().or_else(|| xmp.as_ref().and_then(xmp_rights));
        known.extend(own.filter(|own| !known.contains(own)));
    }
    (!known.is_empty()).then(|| known.join("; "))
}

/// Returns the total size of files.
pub(super) fn sizes(files: &[PathBuf]) -> Result<u64> {
    files.iter().map(|file| taotie_io::file_size(file)).sum()
}

/// Refuses files of a scan that are the same.
pub(super) fn check_distinct<'a>(paths: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    let mut known: BTreeMap<PathBuf, &PathBuf> = BTreeMap::new();
    for path in paths {
        // Reading reports the error of a file that does not exist.
        let real = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(other) = known.insert(real, path) {
            let why = format!("it is the same file as {}; give each file of the scan once", other.display());
            return Err(Error::invalid(path.display().to_string(), why));
        }
    }
    Ok(())
}

/// Returns the objects of a file as part of a scan of several, given its name without extension and its number of
/// instances. Those without a name have that of the file; if the file's name has the mark of a high-poly object, and none
/// of theirs does, it is before all of theirs.
pub(super) fn named_by_file(mut objects: Objects, stem: &str, instances: usize) -> Objects {
    if objects.of_instances.is_empty() {
        objects = Objects { names: vec![String::new()], of_instances: vec![0; instances].into() };
    }
    let is_high = |name: &str| name_before(name, HIGH_MARK).is_some();
    let is_marked = is_high(stem) && !objects.names.iter().any(|name| is_high(name));
    for name in &mut objects.names {
        match name.is_empty() {
            true => stem.clone_into(name),
            false if is_marked => *name = format!("{stem}_{name}"),
            false => {}
        }
    }
    objects
}

/// The minimum and maximum diagonal of a baked model, model units. Outside this range, fourth powers of edge lengths
/// leave single precision, and distances become meaningless.
const LEAST_SIZE: f64 = 1e-6;
const MOST_SIZE: f64 = 1e9;

/// Refuses a model that is only a point, or whose distances cannot be measured.
pub(super) fn check_extent(scene: &Scene, name: &str) -> Result<()> {
    let mut positions = scene.meshes().iter().flat_map(|mesh| mesh.positions());
    let first = positions.next();
    if !positions.any(|position| Some(position) != first) {
        return Err(Error::invalid(name, "all its triangles are at one point; there is nothing to bake"));
    }
    let size = scene.bounds().map_or(0.0, |bounds| bounds.diagonal());
    if !(LEAST_SIZE..=MOST_SIZE).contains(&size) {
        let why = format!("it measures {size:.1e} model units; scale it to between 1e-6 and 1e9");
        return Err(Error::invalid(name, why));
    }
    Ok(())
}

/// Contents of a scan's file that no bake reads, but that a packed scan keeps.
const LEFT_OF_FILE: [&str; 3] = [
    "XMP metadata of the scan other than the whole asset's, left out",
    "animations of the scan, which is baked at rest",
    "material variants of the scan, left out: it is baked without any",
];

/// Notes the contents of a scan's file that no bake reads.
pub(super) fn left_of_scan_file(loaded: &mut Loaded) {
    let Loaded { warnings, xmp, rig, variants, .. } = loaded;
    let counts = [xmp.len().saturating_sub(1), usize::from(rig.is_some()), variants.names().len()];
    LEFT_OF_FILE.into_iter().zip(counts).for_each(|(what, count)| warnings.note(what, count));
}

/// Returns the warnings except those about contents that a packed scan keeps.
pub(in crate::asset) fn warnings_of_packed_scan(warnings: &Warnings) -> Warnings {
    let mut left = Warnings::default();
    let others = warnings.iter().filter(|(what, _)| !LEFT_OF_FILE.contains(what));
    others.for_each(|(what, count)| left.note(what, count));
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels};
    use taotie_engine::math::Mat4;
    use taotie_engine::scene::{
        GreenChannel, Material, NormalMap, NormalSpace, SceneData, TextureRef, UvTransform,
    };

    /// Two instances of a ball without tangents under a normal map of 4×2 texels.
    fn scene(space: NormalSpace, tangents: bool) -> Scene {
        let mut data = Mesh::sphere(1.0, 8, 4).into_data();
        let count = data.positions.len();
        data.tangents = if tangents { vec![[1.0, 0.0, 0.0, 1.0]; count] } else { Vec::new() };
        data.colors.clear();
        let texture = TextureRef {
            texture: 0,
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        };
        let normal = NormalMap { texture, scale: 1.0, space, green: GreenChannel::Up };
        let bitmap = Bitmap::new(4, 2, 3, Texels::U8(vec![[128, 128, 255, 255]; 8])).unwrap();
        let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
        Scene::new(SceneData {
            meshes: vec![Mesh::new(data).unwrap()],
            materials: vec![Material { normal: Some(normal), ..Material::default() }],
            textures: vec![Texture::new(bitmap, Encoding::Linear)],
            instances: vec![instance; 2],
            ..SceneData::default()
        })
        .unwrap()
    }

    #[test]
    fn tangents_count_where_they_are_made() {
        let of = |space, tangents| ScanSize::of(&scene(space, tangents), Maps::default());
        let made = of(NormalSpace::Tangent, false);
        assert_eq!((made.triangles, made.framed_triangles), (2 * made.framed_triangles, 48));
        assert_eq!(made.vertices, 2 * made.framed_vertices, "each instance gets its own vertices");
        assert_eq!(made.attribute_bytes, made.vertices * (8 + 16), "uvs and tangents");
        let framing = made.framing_bytes();
        assert!(framing > 300 * made.framed_triangles + made.mesh_bytes(), "{framing}");
        assert_eq!(made.joined().framing_bytes(), 0);
        assert_eq!(made.joined().bytes(), made.bytes());
        let there = of(NormalSpace::Tangent, true);
        assert_eq!((there.framing_bytes(), there.attribute_bytes), (0, made.attribute_bytes));
        let object = of(NormalSpace::Object, false);
        assert_eq!((object.framing_bytes(), object.attribute_bytes), (0, object.vertices * 8));
    }

    #[test]
    fn textures_count_with_their_levels() {
        let size = ScanSize::of(&scene(NormalSpace::Object, false), Maps::default());
        assert_eq!(size.texture_bytes, (4 * 2 + 2 + 1) * 4);
        assert_eq!(size.bytes() - ScanSize { texture_bytes: 0, ..size }.bytes(), size.texture_bytes);
    }
}
