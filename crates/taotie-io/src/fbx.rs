//! FBX, binary and ASCII, read by `ufbx`: meshes with their transforms and materials, at rest.
//!
//! The scene is in metres, with y up, whatever the file's unit and axes. `ufbx` opens no files: textures are found like
//! those of OBJ files, unless they are embedded.

use super::limits::Bytes;
use super::loaded::{Loaded, Objects, checked};
use super::obj::{Map, Mtl, Textures, material, neutral};
use super::polygon::{Cutter, Outline};
use super::reading::Reading;
use super::text::{is_for_baking, quote};
use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry};
use std::iter::successors;
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Classic, Instance, Material, Scene, SceneData, UvTransform};
use taotie_engine::surface::{Classes, bits};
use ufbx::{AllocatorOpts, ElementType, ErrorType, MaterialMap, SubdivisionDisplayMode, WarningType};

/// Bytes needed per corner of a polygon: those of its vertex and triangles, and of finding equal corners.
const CORNER: u64 = 120;
/// Maximum number of uv sets read per mesh.
const MAX_UV_SETS: usize = 8;

/// Reads an FBX file and its textures.
///
/// The scene has one mesh for each mesh of the file and material in use, and an instance for each node that shows it.
/// Normals are those of the file, or follow from its smoothing; they are absent if it has neither. Colours are taken as
/// in OBJ and MTL files: those of vertices as sRGB-encoded, those of materials as linear.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Parse`] if it is damaged or shows no mesh, [`Error::Limit`] if it
/// needs more memory than allowed. Anything that is not read is noted in the warnings.
pub(super) fn read(reading: &Reading) -> Result<Loaded> {
    let path = reading.path();
    let file = parse(reading)?;
    reading.check_nodes(file.nodes.len() as u64)?;
    let mut loaded = Loaded::new(Scene::default(), Warnings::default(), "FBX");
    loaded.generator = Some(file.metadata.creator.to_string()).filter(|creator| !creator.is_empty());
    note_repairs(&file, &mut loaded.warnings);
    note_ignored(&file, &mut loaded.warnings);
    let scene = assemble(reading, &file, &mut loaded)?;
    loaded.scene = checked(path, scene)?;
    Ok(loaded)
}

/// Lets `ufbx` read the file within the memory that is left, half of it for the result.
fn parse(reading: &Reading) -> Result<ufbx::SceneRoot> {
    let bytes = reading.read_own(reading.path())?;
    let most = (reading.left() / 2).clamp(1, isize::MAX as u64 / 2);
    let memory = || AllocatorOpts { memory_limit: most as usize, ..AllocatorOpts::default() };
    let options = ufbx::LoadOpts {
        temp_allocator: memory(),
        result_allocator: memory(),
        file_format: ufbx::FileFormat::Fbx,
        target_axes: ufbx::CoordinateAxes::right_handed_y_up(),
        target_unit_meters: 1.0,
        generate_missing_normals: true,
        use_blender_pbr_material: true,
        skip_skin_vertices: true,
        node_depth_limit: 1024,
        ..ufbx::LoadOpts::default()
    };
    let file = ufbx::load_memory(&bytes, options).map_err(|error| failure(reading.path(), &error, most))?;
    if !reading.take(file.metadata.result_memory_used as u64) {
        reading.check()?;
    }
    Ok(file)
}

fn failure(path: &Path, error: &ufbx::Error, most: u64) -> Error {
    let why = error.description.to_lowercase();
    match error.type_ {
        ErrorType::MemoryLimit | ErrorType::AllocationLimit | ErrorType::OutOfMemory => Error::limit(
            path.display().to_string(),
            format!(
                "it needs more than {} of memory, half of what is left; raise the limit with --memory-limit, free \
                 memory, or simplify the model",
                Bytes(most)
            ),
        ),
        ErrorType::UnsupportedVersion => {
            Error::unsupported(format!("{}: its version of FBX", path.display()), "save it as FBX 7.4")
        }
        _ => Error::parse(path, "whole file", format!("not valid FBX ({why}); re-export the model")),
    }
}

/// Notes invalid content that `ufbx` repaired or skipped.
fn note_repairs(file: &ufbx::Scene, warnings: &mut Warnings) {
    for warning in &file.metadata.warnings {
        let what = match warning.type_ {
            WarningType::TruncatedArray => "filled up arrays with too few values",
            WarningType::MissingGeometryData => "skipped attributes of meshes without values",
            WarningType::MissingPolygonMapping => "skipped attributes of meshes with an unsupported mapping",
            WarningType::IndexClamped => "limited indices to the values that exist",
            WarningType::BadUnicode => "replaced text that is not UTF-8",
            WarningType::UnsupportedVersion => "a version of FBX that may be read incompletely",
            _ => "skipped damaged or duplicate objects",
        };
        warnings.note(what, warning.count);
    }
    let is_unscaled = file.settings.unit_meters <= 0.0;
    warnings.note("no valid unit; taken as metres", usize::from(is_unscaled));
}

/// Notes content that is not read.
fn note_ignored(file: &ufbx::Scene, warnings: &mut Warnings) {
    let is_animated = !file.anim_curves.is_empty();
    warnings.note("ignored animations", if is_animated { file.anim_stacks.len() } else { 0 });
    warnings.note("ignored skins; their meshes are at rest", file.skin_deformers.len());
    warnings.note("ignored blend shapes; their meshes are at rest", file.blend_deformers.len());
    warnings.note("ignored point caches; their meshes are at rest", file.cache_deformers.len());
    warnings.note("ignored cameras", file.cameras.len() + file.stereo_cameras.len());
    warnings.note("ignored lights", file.lights.len());
    let curved = file.nurbs_surfaces.len() + file.nurbs_curves.len() + file.line_curves.len();
    warnings.note("ignored curves and curved surfaces", curved + file.procedural_geometries.len());
    let is_coarse = |mesh: &&ufbx::Mesh| mesh.subdivision_display_mode != SubdivisionDisplayMode::Disabled;
    let coarse = file.meshes.into_iter().filter(is_coarse).count();
    warnings.note("subdivision surfaces read as their control meshes", coarse);
}

/// Returns the nodes that show a mesh, in the order of the file.
fn shown<'a>(file: &'a ufbx::Scene, warnings: &mut Warnings) -> Vec<(&'a ufbx::Node, &'a ufbx::Mesh)> {
    let with_mesh = |node: &'a ufbx::Node| Some((node, node.mesh.as_deref()?));
    let mut nodes: Vec<_> = file.nodes.into_iter().filter_map(with_mesh).collect();
    nodes.sort_by_key(|(node, _)| node.element.element_id);
    let mut leave_out = |what: &str, is_out: fn(&ufbx::Node) -> bool| {
        let before = nodes.len();
        nodes.retain(|(node, _)| !is_out(node));
        warnings.note(what, before - nodes.len());
    };
    leave_out("skipped hidden meshes", is_hidden);
    leave_out("skipped meshes of coarser levels of detail", is_coarser_level);
    nodes
}

/// Returns `true` for hidden nodes, and for those below them unless they do not inherit visibility.
fn is_hidden(node: &ufbx::Node) -> bool {
    let inherits = |node: &ufbx::Node| {
        let inherits = ufbx::find_prop(&node.element.props, "Visibility Inheritance");
        inherits.is_none_or(|inherits| inherits.value_int != 0)
    };
    let mut above = successors(Some(node), |node| node.parent.as_deref().filter(|_| inherits(node)));
    above.any(|node| !node.visible)
}

/// Returns `true` for nodes in a group of levels of detail, except those of its first level.
fn is_coarser_level(node: &ufbx::Node) -> bool {
    let is_later = |below: &ufbx::Node, group: &ufbx::Node| {
        let first = group.children.first().map(|child| child.element.element_id);
        group.attrib_type == ElementType::LodGroup && first != Some(below.element.element_id)
    };
    let mut above = successors(Some(node), |node| node.parent.as_deref());
    above.any(|below| below.parent.as_deref().is_some_and(|group| is_later(below, group)))
}

/// Returns the name of a node, or of the nearest one above it that is named for baking, if it is not itself.
fn object_name(node: &ufbx::Node) -> String {
    let mut above = successors(Some(node), |node| node.parent.as_deref());
    above.find(|node| is_for_baking(&node.element.name)).unwrap_or(node).element.name.to_string()
}

fn assemble(reading: &Reading, file: &ufbx::Scene, loaded: &mut Loaded) -> Result<SceneData> {
    let shown = shown(file, &mut loaded.warnings);
    let meshes: BTreeMap<u32, &ufbx::Mesh> =
        shown.iter().map(|(_, mesh)| (mesh.element.element_id, *mesh)).collect();
    if !reading.take(meshes.values().map(|mesh| CORNER * mesh.num_indices as u64).sum()) {
        reading.check()?;
    }
    let mut scene = SceneData::default();
    let mut parts: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
    let mut materials = Materials::new(reading, file);
    let mut objects = Vec::new();
    for (node, mesh) in shown {
        let id = mesh.element.element_id;
        let of_mesh = match parts.entry(id) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let added = add_parts(reading.path(), mesh, &mut scene, &mut loaded.warnings)?;
                let name = [&mesh.element.name, &node.element.name].into_iter().find(|name| !name.is_empty());
                let name = name.map_or_else(String::new, |name| name.to_string());
                loaded.mesh_names.resize(scene.meshes.len(), name);
                new.insert(added)
            }
        };
        for (slot, part) in of_mesh.iter() {
            let is_colored = !scene.meshes[*part].colors().is_empty();
            let material = node.materials.get(*slot).or(mesh.materials.get(*slot));
            let material = materials.add((material.map(|m| &**m), is_colored), &mut loaded.warnings);
            let world_from_object = rounded(&node.geometry_to_world);
            scene.instances.push(Instance { mesh: *part, material, world_from_object });
            objects.push((node.element.element_id, object_name(node)));
        }
    }
    if scene.instances.is_empty() {
        return Err(Error::parse(reading.path(), "whole file", "it shows no polygons; re-export the model"));
    }
    loaded.objects = Objects::joined(objects);
    materials.finish(&mut scene, loaded);
    let lacks = |instance: &&Instance| {
        let sets = scene.meshes[instance.mesh].uvs().len();
        scene.materials[instance.material].textures().iter().any(|texture| texture.uv_set >= sets)
    };
    let without = scene.instances.iter().filter(lacks).count();
    loaded.warnings.note("meshes lack the uv set of a texture, which shows a single texel there", without);
    Ok(scene)
}

/// Returns a matrix rounded to 32 bits after the point of its largest element, and its translation to as many of its
/// own: sines of the system's C library, from which `ufbx` makes rotations, differ in the last bits.
fn rounded(m: &ufbx::Matrix) -> Mat4 {
    let linear = [[m.m00, m.m10, m.m20], [m.m01, m.m11, m.m21], [m.m02, m.m12, m.m22]];
    let grid = |values: &[f64]| {
        let largest = values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        // The power of two below.
        f64::from_bits(largest.to_bits() & (0x7FF << 52)) / f64::from(1u32 << 31)
    };
    let snap = |v: f64, grid: f64| if grid > 0.0 { (v / grid).round() * grid } else { v };
    let (turn, place) = (grid(linear.as_flattened()), [m.m03, m.m13, m.m23]);
    let [x, y, z] = linear.map(|column| column.map(|v| snap(v, turn)));
    let [px, py, pz] = place.map(|v| snap(v, grid(&place)));
    Mat4 {
        columns: [
            [x[0], x[1], x[2], 0.0],
            [y[0], y[1], y[2], 0.0],
            [z[0], z[1], z[2], 0.0],
            [px, py, pz, 1.0],
        ],
    }
}

/// Adds a mesh for each material of the file's mesh. Returns their materials, as numbers of the mesh's list, and their
/// indices.
fn add_parts(
    path: &Path,
    mesh: &ufbx::Mesh,
    scene: &mut SceneData,
    warnings: &mut Warnings,
) -> Result<Vec<(usize, usize)>> {
    let mut added = Vec::new();
    for part in &mesh.material_parts {
        let corners = triangulated(mesh, &part.face_indices, warnings);
        if corners.is_empty() {
            continue;
        }
        let part_mesh = Part { mesh, corners }.build(warnings).map_err(|error| match error {
            Error::Invalid { what, why } => {
                Error::parse(path, format!("mesh {}: {what}", quote(&mesh.element.name)), why)
            }
            other => other,
        })?;
        warnings.note("triangles without area", part_mesh.degenerate_triangles());
        added.push((part.index as usize, scene.meshes.len()));
        scene.meshes.push(part_mesh);
    }
    Ok(added)
}

/// Returns the corners of the triangles of some faces, as numbers of the mesh's corners.
fn triangulated(mesh: &ufbx::Mesh, faces: &[u32], warnings: &mut Warnings) -> Vec<u32> {
    let positions = Attribute::new(&mesh.vertex_position.values, &mesh.vertex_position.indices);
    let (mut corners, mut triangles, mut cutter) = (Vec::new(), Vec::new(), Cutter::default());
    for face in faces {
        let Some(ufbx::Face { index_begin, num_indices }) = mesh.faces.get(*face as usize).copied() else {
            continue;
        };
        let problem = match num_indices as usize {
            0..3 => Some("skipped faces with fewer than 3 corners"),
            count if count > Cutter::MAX_CORNERS => Some("skipped faces with too many corners"),
            _ if mesh.face_hole.get(*face as usize) == Some(&true) => Some("skipped faces that are holes"),
            _ => None,
        };
        if let Some(problem) = problem {
            warnings.note(problem, 1);
            continue;
        }
        let points: Vec<Vec3> = (index_begin..index_begin.saturating_add(num_indices))
            .map(|corner| vec3(positions.at(corner)))
            .collect();
        triangles.clear();
        if cutter.cut(&points, &mut triangles) == Outline::Crossing {
            warnings.note("self-intersecting polygons, triangulated approximately", 1);
        }
        corners.extend(triangles.as_flattened().iter().map(|corner| index_begin.saturating_add(*corner)));
    }
    corners
}

/// Values at the corners of a mesh.
#[derive(Clone, Copy)]
struct Attribute<'a, T> {
    values: &'a [T],
    /// The value of each corner.
    indices: &'a [u32],
}

impl<'a, T: Copy + Default> Attribute<'a, T> {
    fn new(values: &'a [T], indices: &'a [u32]) -> Self {
        Self { values, indices }
    }

    fn at(&self, corner: u32) -> T {
        let index = self.indices.get(corner as usize).copied().unwrap_or_default();
        self.values.get(index as usize).copied().unwrap_or_default()
    }
}

fn vec3(v: ufbx::Vec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// The triangles of a mesh with one material.
struct Part<'a> {
    mesh: &'a ufbx::Mesh,
    /// Three for each triangle, as numbers of the mesh's corners.
    corners: Vec<u32>,
}

impl Part<'_> {
    /// Makes a mesh in which corners of one point with equal attributes are one vertex.
    fn build(&self, warnings: &mut Warnings) -> Result<Mesh> {
        let (mesh, corners) = (self.mesh, &self.corners[..]);
        if corners.len() > u32::MAX as usize {
            return Err(Error::limit("a mesh of more than 2^32 - 1 corners", "split it"));
        }
        let positions = Attribute::new(&mesh.vertex_position.values, &mesh.vertex_position.indices);
        let points: &[u32] = &mesh.vertex_indices;
        let mut classes = Classes::by(corners.len(), |i| points.get(corners[i] as usize).copied());
        let normals = self.normals(warnings);
        if !normals.is_empty() {
            classes = classes.split_by(|i| bits(normals[i].to_array()));
        }
        let uvs = self.uvs(warnings);
        for set in &uvs {
            classes = classes.split_by(|i| bits([set[i].x, set[i].y]));
        }
        let colors = self.colors();
        if !colors.is_empty() {
            classes = classes.split_by(|i| bits(colors[i]));
        }
        let firsts: Vec<usize> = classes.firsts.iter().map(|first| *first as usize).collect();
        let positions = corners.iter().map(|corner| vec3(positions.at(*corner))).collect();
        let all = MeshData { positions, normals, uvs, colors, ..MeshData::default() };
        Mesh::new(MeshData { triangles: classes.of.as_chunks::<3>().0.to_vec(), ..all.gathered(&firsts) })
    }

    /// Returns unit normals; none if the file has neither normals nor smoothing.
    fn normals(&self, warnings: &mut Warnings) -> Vec<Vec3> {
        let mesh = self.mesh;
        let has_smoothing = !mesh.face_smoothing.is_empty() || !mesh.edge_smoothing.is_empty();
        if !mesh.vertex_normal.exists || (mesh.generated_normals && !has_smoothing) {
            return Vec::new();
        }
        let normals = Attribute::new(&mesh.vertex_normal.values, &mesh.vertex_normal.indices);
        let mut bad = Vec::new();
        let corners = self.corners.iter().enumerate();
        let normals = corners.map(|(i, corner)| {
            let ufbx::Vec3 { x, y, z } = normals.at(*corner);
            unit(Vec3 { x, y, z }).unwrap_or_else(|| {
                bad.push(*corner);
                self.facet(i / 3).unwrap_or(Vec3::new(0.0, 1.0, 0.0))
            })
        });
        let normals = normals.collect();
        if !mesh.generated_normals {
            warnings
                .note("replaced unusable normals (zero, infinite or NaN) by those of triangles", count(bad));
        }
        normals
    }

    /// Returns the normal of a triangle; `None` if it has no area.
    fn facet(&self, triangle: usize) -> Option<Vec3> {
        let values = &self.mesh.vertex_position;
        let positions = Attribute::new(&values.values, &values.indices);
        let [a, b, c] = [0, 1, 2].map(|i| vec3(positions.at(self.corners[3 * triangle + i])).to_f64());
        unit((b - a).cross(c - a))
    }

    /// Returns the uv sets with their origin at the top left.
    fn uvs(&self, warnings: &mut Warnings) -> Vec<Vec<Vec2>> {
        let sets = &self.mesh.uv_sets;
        warnings.note("ignored uv sets beyond the first 8", sets.len().saturating_sub(MAX_UV_SETS));
        let mut bad = Vec::new();
        let mut read = |set: &ufbx::UvSet| {
            let uvs = Attribute::new(&set.vertex_uv.values, &set.vertex_uv.indices);
            let uv = |corner: &u32| {
                let ufbx::Vec2 { x, y } = uvs.at(*corner);
                let uv = Vec2::new(x as f32, (1.0 - y) as f32);
                let is_usable = uv.x.is_finite() && uv.y.is_finite();
                if is_usable {
                    return uv;
                }
                bad.push(*corner);
                Vec2::default()
            };
            self.corners.iter().map(uv).collect()
        };
        let uvs = sets.iter().take(MAX_UV_SETS).map(&mut read).collect();
        warnings.note("replaced unusable uvs (infinite or NaN) by 0", count(bad));
        uvs
    }

    /// Returns the colours of the first set.
    fn colors(&self) -> Vec<[f32; 4]> {
        let Some(set) = self.mesh.color_sets.first() else { return Vec::new() };
        let colors = Attribute::new(&set.vertex_color.values, &set.vertex_color.indices);
        let within = |v: f64| if v > 0.0 { v.min(1.0) } else { 0.0 };
        let decoded = |v: f64| linear_from_srgb(within(v)) as f32;
        let color = |corner: &u32| {
            let ufbx::Vec4 { x, y, z, w } = colors.at(*corner);
            [decoded(x), decoded(y), decoded(z), within(w) as f32]
        };
        self.corners.iter().map(color).collect()
    }
}

/// Returns the number of different corners.
fn count(mut corners: Vec<u32>) -> usize {
    corners.sort_unstable();
    corners.dedup();
    corners.len()
}

fn unit(v: Vec3<f64>) -> Option<Vec3> {
    let length = v.length();
    (length > 1e-20 && length.is_finite()).then(|| (v * (1.0 / length)).to_f32())
}

/// The materials of a scene under construction.
struct Materials<'a> {
    file: &'a ufbx::Scene,
    folder: &'a Path,
    textures: Textures<'a>,
    list: Vec<Material>,
    /// The index in `list` by the file's material; `None` and whether vertices have colours if there is none.
    known: BTreeMap<(Option<u32>, bool), usize>,
    /// The textures of the file that the current material refers to and that are read.
    used: BTreeSet<u32>,
}

impl<'a> Materials<'a> {
    fn new(reading: &'a Reading, file: &'a ufbx::Scene) -> Self {
        let (textures, known) = (Textures::new(reading), BTreeMap::new());
        Self { file, folder: reading.folder(), textures, list: Vec::new(), known, used: BTreeSet::new() }
    }

    /// Returns the index of a material; without one, of grey, or white for colours of vertices.
    fn add(
        &mut self,
        (of_file, is_colored): (Option<&'a ufbx::Material>, bool),
        warnings: &mut Warnings,
    ) -> usize {
        let key = (of_file.map(|m| m.element.element_id), is_colored && of_file.is_none());
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let read = match of_file {
            Some(of_file) => {
                self.used.clear();
                let mtl = self.mtl(of_file, warnings);
                let unused =
                    of_file.textures.iter().filter(|t| !self.used.contains(&t.texture.element.element_id));
                warnings.note("ignored textures of properties that are not read", unused.count());
                let read = material(&mtl, &mut self.textures, warnings);
                // Physically based materials have no parameters of classic models.
                let classic = if of_file.features.pbr.enabled { Classic::default() } else { read.classic };
                Material { classic, ..read }
            }
            None if is_colored => Material { base_color: [1.0; 4], ..neutral("") },
            None => neutral(""),
        };
        self.list.push(read);
        self.known.insert(key, self.list.len() - 1);
        self.list.len() - 1
    }

    /// Returns the statements of an MTL file for a material.
    fn mtl(&mut self, of_file: &'a ufbx::Material, warnings: &mut Warnings) -> Mtl {
        let (fbx, pbr) = (&of_file.fbx, &of_file.pbr);
        let mut mtl = Mtl { name: of_file.element.name.to_string(), ..Mtl::default() };
        mtl.folder = self.folder.to_path_buf();
        let has_pbr = of_file.features.pbr.enabled;
        let [base, emission] = match has_pbr {
            true => [(&pbr.base_color, &pbr.base_factor), (&pbr.emission_color, &pbr.emission_factor)],
            false => [(&fbx.diffuse_color, &fbx.diffuse_factor), (&fbx.emission_color, &fbx.emission_factor)],
        };
        (mtl.diffuse, mtl.diffuse_map) = self.color(base, warnings);
        (mtl.emissive, mtl.emissive_map) = self.color(emission, warnings);
        if has_pbr {
            let glossy = number(&pbr.glossiness).map(|glossiness| 1.0 - glossiness);
            (mtl.roughness, mtl.metallic) = (number(&pbr.roughness).or(glossy), number(&pbr.metalness));
            mtl.roughness_map = self.map(&pbr.roughness, warnings);
            mtl.metallic_map = self.map(&pbr.metalness, warnings);
            (mtl.dissolve, mtl.dissolve_map) = (number(&pbr.opacity), self.map(&pbr.opacity, warnings));
        } else {
            mtl.ambient = self.color((&fbx.ambient_color, &fbx.ambient_factor), warnings).0;
            mtl.specular = self.color((&fbx.specular_color, &fbx.specular_factor), warnings).0;
            let is_matte = of_file.shader_type == ufbx::ShaderType::FbxLambert;
            mtl.shininess = number(&fbx.specular_exponent).filter(|_| !is_matte);
            let transparency = [&fbx.transparency_color, &fbx.transparency_factor];
            mtl.dissolve_map = transparency.into_iter().find_map(|of| self.map(of, warnings));
            mtl.dissolve = opacity(of_file).filter(|_| mtl.dissolve_map.is_none());
        }
        mtl.normal_map = [&pbr.normal_map, &fbx.normal_map].into_iter().find_map(|of| self.map(of, warnings));
        mtl.bump_map = self.map(&fbx.bump, warnings);
        if let Some(bump) = &mut mtl.bump_map {
            // Heights are in the file's unit.
            let height = number(&fbx.bump_factor).unwrap_or(1.0);
            bump.bump = (f64::from(height) * self.file.metadata.root_scale) as f32;
        }
        mtl
    }

    /// Returns a colour times its factor, and the texture that replaces the colour.
    fn color(
        &mut self,
        (color, factor): (&'a MaterialMap, &'a MaterialMap),
        warnings: &mut Warnings,
    ) -> (Option<[f32; 3]>, Option<Map>) {
        let factor = number(factor).unwrap_or(1.0);
        match self.map(color, warnings) {
            Some(map) if factor > 0.0 => (Some([factor; 3]), Some(map)),
            _ if color.has_value => {
                let ufbx::Vec4 { x, y, z, .. } = color.value_vec4;
                (Some([x, y, z].map(|v| usable(v * f64::from(factor)))), None)
            }
            _ => (None, None),
        }
    }

    /// Returns the texture of a property.
    fn map(&mut self, of: &'a MaterialMap, warnings: &mut Warnings) -> Option<Map> {
        let texture = of.texture.as_deref().filter(|_| of.texture_enabled)?;
        self.used.insert(texture.element.element_id);
        let is_made = texture.type_ != ufbx::TextureType::File;
        warnings.note("layered or procedural textures; using their first image", usize::from(is_made));
        let image = if is_made { texture.file_textures.first()? } else { texture };
        let names = [&image.relative_filename, &image.absolute_filename, &image.filename];
        let name = names.into_iter().find(|name| !name.is_empty()).map(|name| name.to_string());
        let name = name.unwrap_or_else(|| format!("texture {}", image.element.typed_id));
        if !image.content.is_empty() {
            self.textures.embedded.entry(name.clone()).or_insert(&image.content);
        }
        let m = &image.uv_to_texture;
        let (scale, offset) = ([m.m00, m.m11].map(|v| v as f32), [m.m03, m.m13].map(|v| v as f32));
        let is_turned = m.m01.abs() > 1e-9 || m.m10.abs() > 1e-9;
        warnings.note("ignored rotations of textures", usize::from(image.has_uv_transform && is_turned));
        let is_usable = [scale, offset].as_flattened().iter().all(|v| v.abs() <= UvTransform::MOST / 4.0);
        let clamp = image.wrap_u == ufbx::WrapMode::Clamp && image.wrap_v == ufbx::WrapMode::Clamp;
        let map = Map { clamp, uv_set: self.uv_set(&image.uv_set), ..Map::new(name) };
        Some(if is_usable && image.has_uv_transform && !is_turned {
            Map { scale, offset, ..map }
        } else {
            map
        })
    }

    /// Returns the index of the uv set with this name in the first mesh that has one; 0 if none has.
    fn uv_set(&self, name: &str) -> usize {
        let place =
            |mesh: &ufbx::Mesh| mesh.uv_sets.iter().take(MAX_UV_SETS).position(|set| &*set.name == name);
        self.file.meshes.into_iter().find_map(place).unwrap_or(0)
    }

    fn finish(self, scene: &mut SceneData, loaded: &mut Loaded) {
        scene.materials = self.list;
        scene.textures = self.textures.list;
        loaded.texture_names = self.textures.names;
        loaded.files = self.textures.files;
        loaded.missing_files = self.textures.missing_files;
    }
}

/// Returns a value of the file as a usable number; `None` if it has none.
fn number(of: &MaterialMap) -> Option<f32> {
    of.has_value.then(|| usable(of.value_vec4.x))
}

/// Returns a finite number of at least 0.
fn usable(v: f64) -> f32 {
    let v = v as f32;
    if v.is_finite() { v.max(0.0) } else { 0.0 }
}

/// Returns the opacity of a Lambert or Phong material: as stated, else from its transparent colour, as the FBX SDK
/// defines it.
fn opacity(of: &ufbx::Material) -> Option<f32> {
    let stated = ufbx::find_prop(&of.element.props, "Opacity").map(|property| property.value_vec4.x);
    let color = &of.fbx.transparency_color;
    let ufbx::Vec4 { x, y, z, .. } = color.value_vec4;
    let factor = number(&of.fbx.transparency_factor).unwrap_or(1.0);
    let transparent = color.has_value.then(|| 1.0 - f64::from(factor) * (x + y + z) / 3.0);
    stated.or(transparent).map(usable)
}
