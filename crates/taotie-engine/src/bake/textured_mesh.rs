//! A surface with its materials: all meshes of a scene as one in world space, with the material at each of its
//! points; and the low-poly mesh of a scene, joined likewise, without materials.

use super::appearance::{Appearance, MaterialSample, Part, common_mode, leading_textures, map_places};
use super::texture_lookup::{LookupPoint, MappedNormal};
use crate::error::Result;
use crate::image::Texture;
use crate::math::{Mat4, Vec2, Vec3};
use crate::mesh::{Mesh, MeshData, Point};
use crate::pixel::NormalSource;
use crate::scene::{AlphaMode, Instance, Material, Scene, SceneData, TextureRef};
use crate::surface;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

/// All triangles of a scene as one mesh in world space, each with its own material: normal, height and all other
/// maps.
#[derive(Debug, Clone)]
pub struct TexturedMesh {
    mesh: Mesh,
    appearance: Appearance,
}

/// Opacity, or its difference from 1, that is hardly noticeable.
const NOTICEABLE_ALPHA: f32 = 0.02;

impl TexturedMesh {
    /// Takes over a scene, with smooth normals if it had none, and with tangents where its normal maps need them: the
    /// file's, else MikkTSpace's.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] if the scene has more than 2^32 − 1 vertices.
    pub fn new(scene: Scene) -> Result<Self> {
        let mut scene = scene.into_data();
        let mut instances = std::mem::take(&mut scene.instances);
        give_frames(&mut scene, &mut instances)?;
        let parts = Part::of(&scene, &instances);
        let keep = Keep { uv_sets: uv_sets(&scene, &instances), tangents: reads_tangents(&parts) };
        let mesh = joined(&mut scene.meshes, &instances, keep)?;
        let mesh = if keep.tangents { mesh } else { without_tangents(mesh)? };
        Ok(Self { mesh, appearance: Appearance::new(parts, scene.materials, scene.textures) })
    }

    /// Returns the triangles, world space, with normals.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Returns the surface in another shape: a mesh of the same triangles and vertices, of which some were moved.
    pub fn in_shape(&self, mesh: Mesh) -> Self {
        Self { mesh, appearance: self.appearance.clone() }
    }

    /// Returns true if a material is blended with what is behind it.
    pub fn is_blended(&self) -> bool {
        self.appearance
            .parts
            .iter()
            .any(|part| self.appearance.materials[part.material].alpha == AlphaMode::Blend)
    }

    /// Returns the material of a triangle.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn material(&self, triangle: u32) -> &Material {
        self.appearance.material(triangle)
    }

    /// Returns the index of a triangle's material, among those of the scene.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn material_number(&self, triangle: u32) -> usize {
        self.appearance.material_number(triangle)
    }

    /// Returns the names of its materials.
    pub fn material_names(&self) -> Vec<String> {
        self.appearance.materials.iter().map(|material| material.name.clone()).collect()
    }

    /// Returns the index of the object that a triangle belongs to, among the instances of the scene.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn part_number(&self, triangle: u32) -> usize {
        self.appearance.part_number(triangle)
    }

    /// Returns the number of its parts, one for each instance of the scene.
    pub fn part_count(&self) -> usize {
        self.appearance.part_count()
    }

    /// Returns the factors of the first instance's material, used if no surface is found.
    pub(super) fn first_factors(&self) -> MaterialSample {
        self.appearance.first_factors()
    }

    /// Returns the alpha mode of one material that shows all triangles: blended if any of them is; else a mask, with
    /// the cutoff 0.5 if cutoffs differ; else opaque.
    pub fn alpha_mode(&self) -> AlphaMode {
        let Appearance { parts, materials, .. } = &self.appearance;
        common_mode(parts.iter().map(|part| materials[part.material].alpha))
    }

    /// Returns the distinct alpha modes of all triangles; masks count as one, with the cutoff 0.5 if cutoffs differ.
    pub fn alpha_modes(&self) -> Vec<AlphaMode> {
        let Appearance { parts, materials, .. } = &self.appearance;
        let modes = || parts.iter().map(|part| materials[part.material].alpha);
        let is_mask = |mode: &AlphaMode| matches!(mode, AlphaMode::Mask(_));
        let mask = common_mode(modes().filter(is_mask));
        let mut found = Vec::new();
        for mode in modes().map(|mode| if is_mask(&mode) { mask } else { mode }) {
            if !found.contains(&mode) {
                found.push(mode);
            }
        }
        found
    }

    /// Makes lookups of textures with alpha beyond their finest level average visible colours, each weighted by its
    /// alpha. Such textures are then in memory twice.
    ///
    /// # Errors
    /// Only those of [`crate::image::Bitmap::new`], which validates again.
    pub(super) fn with_visible_means(self) -> Result<Self> {
        Ok(Self { appearance: self.appearance.with_visible_means()?, ..self })
    }

    /// Returns the normal at a point as a renderer shades it: `smooth`, the interpolated one, bent by the normal or
    /// height map there; `smooth` itself without a map.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn normal(&self, at: LookupPoint, smooth: Vec3) -> MappedNormal {
        self.appearance.normal(&self.mesh, at, smooth)
    }

    /// Returns `true` if the surface can be seen at a point: alpha reaches a mask's cutoff, or is noticeable if blended.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_shown_at(&self, point: Point) -> bool {
        self.has_alpha(point, NOTICEABLE_ALPHA)
    }

    /// Returns `true` if nothing can be seen through the surface at a point: it transmits no noticeable light, and alpha
    /// reaches a mask's cutoff, or is hardly below 1 if blended.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn is_solid_at(&self, point: Point) -> bool {
        let passed = self.appearance.passed(&self.mesh, LookupPoint::finest(point));
        passed <= NOTICEABLE_ALPHA && self.has_alpha(point, 1.0 - NOTICEABLE_ALPHA)
    }

    /// Returns `true` if alpha reaches a mask's cutoff, or is above `least` if blended.
    fn has_alpha(&self, point: Point, least: f32) -> bool {
        let alpha = || self.sample(LookupPoint::finest(point)).alpha;
        match self.material(point.triangle).alpha {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => alpha() >= cutoff,
            AlphaMode::Blend => alpha() > least,
        }
    }

    /// Returns the width of the finest texel of all textures at a point, in model units; `None` without textures.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn texel_size(&self, point: Point) -> Option<f32> {
        self.appearance.texel_size(&self.mesh, point)
    }

    /// Returns the width and height, in texels, of the texture that defines the layout of error maps: the largest
    /// [`leading_texture`](super::leading_texture) of its materials; `None` without textures.
    pub fn map_size(&self) -> Option<[u32; 2]> {
        let Appearance { textures, parts, materials, .. } = &self.appearance;
        let size = |lead: TextureRef| [textures[lead.texture].width(), textures[lead.texture].height()];
        let sizes = leading_textures(parts, materials).flatten().map(size);
        sizes.max_by_key(|[width, height]| u64::from(*width) * u64::from(*height))
    }

    /// Returns the position of each vertex on the maps of its material: the transformed uvs of the
    /// [`leading_texture`](super::leading_texture), or the first uv set if there is none. Empty if the surface has no
    /// uvs.
    pub fn map_places(&self) -> Cow<'_, [Vec2]> {
        let Appearance { parts, materials, .. } = &self.appearance;
        let leads: Vec<Option<TextureRef>> = leading_textures(parts, materials).collect();
        map_places(&self.mesh, parts, &leads)
    }

    /// Returns the textures of its materials.
    pub fn textures(&self) -> &[Texture] {
        &self.appearance.textures
    }

    /// Returns a flag per material: `true` if it uses one of some textures.
    pub(crate) fn materials_with(&self, textures: &[usize]) -> Vec<bool> {
        let shows = |used: &TextureRef| textures.contains(&used.texture);
        self.appearance.materials.iter().map(|material| material.textures().iter().any(shows)).collect()
    }

    /// Returns its materials with a texture replacing others.
    pub(super) fn retextured(&self, textures: &[usize], with: &Texture) -> Result<Appearance> {
        let mut appearance = self.appearance.clone();
        textures.iter().for_each(|texture| appearance.textures[*texture] = with.clone());
        appearance.renew_visible_means(textures)?;
        Ok(appearance)
    }

    /// Returns the material values at a point.
    ///
    /// # Panics
    /// If the mesh has no such triangle.
    pub fn sample(&self, at: LookupPoint) -> MaterialSample {
        self.appearance.sample(&self.mesh, at)
    }

    /// Returns a scene of the same triangles and materials, with one instance for each of the original scene. Nothing
    /// is copied if there was one instance, unless its normals are in object space.
    ///
    /// # Errors
    /// Only those of [`Scene::new`], which validates again.
    pub fn into_scene(self) -> Result<Scene> {
        let Self { mesh, appearance: Appearance { parts, materials, textures, .. } } = self;
        let meshes = match parts.len() {
            1 => vec![mesh],
            _ => cut(&mesh, &parts)?,
        };
        let mut scene = SceneData { materials, textures, ..SceneData::default() };
        for (i, (part, mesh)) in parts.iter().zip(meshes).enumerate() {
            let m = object_space(part);
            scene.meshes.push(if m == Mat4::IDENTITY { mesh } else { moved_back(mesh, &m)? });
            scene.instances.push(Instance { mesh: i, material: part.material, world_from_object: m });
        }
        Scene::new(scene)
    }
}

/// Returns a flag per mesh of a scene: `true` if a [`TexturedMesh`] makes tangents for it, which takes memory: it has
/// a tangent-space normal map and no tangents.
pub fn lacks_tangents(scene: &Scene) -> Vec<bool> {
    let mut lacks = vec![false; scene.meshes().len()];
    for instance in scene.instances() {
        let mesh = &scene.meshes()[instance.mesh];
        let source = NormalSource::best(&scene.materials()[instance.material]).on_mesh(mesh.uvs().len());
        lacks[instance.mesh] |= source.tangent_set().is_some() && mesh.tangents().is_empty();
    }
    lacks
}

/// Gives each instance whose normal map is in tangent space a mesh with tangents, and drops meshes that are no longer
/// used.
fn give_frames(scene: &mut SceneData, instances: &mut [Instance]) -> Result<()> {
    let mut framed: HashMap<(usize, usize), usize> = HashMap::new();
    for instance in instances.iter_mut() {
        let mesh = &scene.meshes[instance.mesh];
        let source = NormalSource::best(&scene.materials[instance.material]).on_mesh(mesh.uvs().len());
        let Some(set) = source.tangent_set() else { continue };
        let key = (instance.mesh, set);
        instance.mesh = match framed.get(&key) {
            Some(made) => *made,
            None => {
                let made = surface::with_frames(mesh, set, None)?.0.into_owned();
                scene.meshes.push(made);
                scene.meshes.len() - 1
            }
        };
        framed.insert(key, instance.mesh);
    }
    let mut is_shown = vec![false; scene.meshes.len()];
    instances.iter().for_each(|instance| is_shown[instance.mesh] = true);
    for (mesh, _) in scene.meshes.iter_mut().zip(is_shown).filter(|(_, is_shown)| !is_shown) {
        *mesh = Mesh::default();
    }
    Ok(())
}

/// Returns the number of uv sets up to the last that a texture uses, and at least one.
fn uv_sets(scene: &SceneData, instances: &[Instance]) -> usize {
    let mut is_used = vec![false; scene.materials.len()];
    instances.iter().for_each(|instance| is_used[instance.material] = true);
    let used = scene.materials.iter().zip(is_used).filter(|(_, is_used)| *is_used);
    let sets = used.flat_map(|(material, _)| material.textures()).map(|texture| texture.uv_set + 1);
    sets.max().unwrap_or(1)
}

fn reads_tangents(parts: &[Part]) -> bool {
    parts.iter().any(|part| part.normal_source.tangent_set().is_some())
}

fn without_tangents(mesh: Mesh) -> Result<Mesh> {
    Mesh::new(MeshData { tangents: Vec::new(), ..mesh.into_data() })
}

/// Returns the transform from the space of a part's normal map to world space, if they differ.
fn object_space(part: &Part) -> Mat4 {
    match part.normal_source {
        NormalSource::ObjectMap(_) if part.world_from_object.inverse_affine().is_some() => {
            part.world_from_object
        }
        _ => Mat4::IDENTITY,
    }
}

/// Returns the mesh of each part.
fn cut(mesh: &Mesh, parts: &[Part]) -> Result<Vec<Mesh>> {
    let ends = |of: fn(&Part) -> u32, all: usize| {
        let later = parts.iter().skip(1).map(move |part| of(part) as usize);
        later.chain(std::iter::once(all))
    };
    let vertices = ends(|part| part.vertex, mesh.positions().len());
    let triangles = ends(|part| part.triangle, mesh.triangles().len());
    parts
        .iter()
        .zip(vertices.zip(triangles))
        .map(|(part, (vertex_end, triangle_end))| {
            let vertices = part.vertex as usize..vertex_end;
            let mut data = with_vertices(mesh, &vertices, part.uv_sets);
            let triangles = &mesh.triangles()[part.triangle as usize..triangle_end];
            data.triangles = triangles.iter().map(|t| t.map(|v| v - part.vertex)).collect();
            if part.normal_source.tangent_set().is_none() {
                data.tangents.clear();
            }
            Mesh::new(data)
        })
        .collect()
}

/// Returns the arrays of some vertices, without triangles.
fn with_vertices(mesh: &Mesh, vertices: &Range<usize>, uv_sets: usize) -> MeshData {
    fn some<T: Copy>(values: &[T], which: &Range<usize>) -> Vec<T> {
        values.get(which.clone()).unwrap_or_default().to_vec()
    }
    MeshData {
        positions: some(mesh.positions(), vertices),
        normals: some(mesh.normals(), vertices),
        tangents: some(mesh.tangents(), vertices),
        uvs: mesh.uvs().iter().take(uv_sets).map(|uvs| some(uvs, vertices)).collect(),
        colors: some(mesh.colors(), vertices),
        triangles: Vec::new(),
    }
}

/// Returns the low-poly mesh of a scene: all its instances as one mesh in world space, with normals. A single
/// instance that is not moved is kept as it is, tangents included.
///
/// # Errors
/// [`crate::Error::Limit`] if the scene has more than 2^32 − 1 vertices.
pub fn low_poly_mesh(scene: Scene) -> Result<Mesh> {
    let mut scene = scene.into_data();
    joined(&mut scene.meshes, &scene.instances, Keep { uv_sets: 1, tangents: false })
}

/// Returns the low-poly mesh of a scene as viewers shade each of its meshes: all instances as one mesh in world
/// space, with normals and with the tangents that each mesh has in its own space: the file's, else MikkTSpace's of uv
/// set 0.
///
/// # Errors
/// As [`low_poly_mesh`]; [`crate::Error::Invalid`] if a mesh has no uvs.
pub fn framed_low_poly_mesh(scene: Scene) -> Result<Mesh> {
    let mut scene = scene.into_data();
    let shown: BTreeSet<usize> = scene.instances.iter().map(|instance| instance.mesh).collect();
    for mesh in shown {
        scene.meshes[mesh] = surface::with_frames(&scene.meshes[mesh], 0, None)?.0.into_owned();
    }
    joined(&mut scene.meshes, &scene.instances, Keep { uv_sets: 1, tangents: true })
}

/// The vertex arrays kept when meshes are moved or joined, in addition to positions, normals and colours.
#[derive(Debug, Clone, Copy)]
struct Keep {
    /// The maximum number of uv sets.
    uv_sets: usize,
    tangents: bool,
}

/// Returns one mesh of all instances in world space, with normals. A single instance that is not moved is kept as it
/// is.
fn joined(meshes: &mut [Mesh], instances: &[Instance], keep: Keep) -> Result<Mesh> {
    if let [only] = instances
        && only.world_from_object == Mat4::IDENTITY
    {
        return with_normals(std::mem::take(&mut meshes[only.mesh]));
    }
    let mut all = MeshData::default();
    let colored = instances.iter().any(|i| !meshes[i.mesh].colors().is_empty());
    let uv_sets = instances.iter().map(|i| meshes[i.mesh].uvs().len()).max().unwrap_or(0);
    all.uvs = vec![Vec::new(); uv_sets.min(keep.uv_sets)];
    for instance in instances {
        let mesh = &meshes[instance.mesh];
        add(&mut all, mesh, instance.world_from_object);
        if colored {
            pad(&mut all.colors, mesh.colors(), mesh.positions().len(), [1.0; 4]);
        }
        if keep.tangents {
            add_tangents(&mut all.tangents, mesh, instance.world_from_object);
        }
    }
    Mesh::new(all)
}

/// Returns a mesh moved back by the inverse of a transform, without tangents; unchanged if there is no inverse.
fn moved_back(mesh: Mesh, m: &Mat4) -> Result<Mesh> {
    let Some(inverse) = m.inverse_affine() else { return Ok(mesh) };
    let mut moved = MeshData { uvs: vec![Vec::new(); mesh.uvs().len()], ..MeshData::default() };
    add(&mut moved, &mesh, inverse);
    moved.colors = mesh.colors().to_vec();
    Mesh::new(moved)
}

fn with_normals(mesh: Mesh) -> Result<Mesh> {
    if !mesh.normals().is_empty() {
        return Ok(mesh);
    }
    let normals = surface::vertex_normals(&mesh);
    Mesh::new(MeshData { normals, ..mesh.into_data() })
}

/// Appends positions, normals, triangles and the uv sets that `all` has.
fn add(all: &mut MeshData, mesh: &Mesh, m: Mat4) {
    let (first, count) = (all.positions.len() as u32, mesh.positions().len());
    let made = if mesh.normals().is_empty() { surface::vertex_normals(mesh) } else { Vec::new() };
    let normals = if made.is_empty() { mesh.normals() } else { &made };
    let matrix = m.normal_matrix();
    let turn = |n: &Vec3| matrix.transform_vector(n.to_f64()).normalize_or(n.to_f64()).to_f32();
    all.positions.extend(mesh.positions().iter().map(|p| m.transform_point(p.to_f64()).to_f32()));
    all.normals.extend(normals.iter().map(turn));
    for (set, uvs) in all.uvs.iter_mut().enumerate() {
        pad(uvs, mesh.uvs().get(set).map_or(&[][..], Vec::as_slice), count, Vec2::default());
    }
    // Mirroring flips the winding; normals define which side is out, so triangles keep theirs unless mirrored.
    let mirrored = m.determinant3() < 0.0;
    all.triangles.extend(mesh.triangles().iter().map(|[a, b, c]| {
        let [b, c] = if mirrored { [c, b] } else { [b, c] };
        [a + first, b + first, c + first]
    }));
}

/// Appends `values`, then pads with `fill` up to `count`.
fn pad<T: Copy>(all: &mut Vec<T>, values: &[T], count: usize, fill: T) {
    all.extend(values);
    all.extend(std::iter::repeat_n(fill, count - values.len()));
}

/// Appends the tangents of a mesh, or placeholders. Mirroring reverses the cross product of normal and tangent, so
/// handedness flips with it.
fn add_tangents(all: &mut Vec<[f32; 4]>, mesh: &Mesh, m: Mat4) {
    let sign = if m.determinant3() < 0.0 { -1.0 } else { 1.0 };
    let turn = |[x, y, z, w]: [f32; 4]| {
        let t = Vec3::new(x, y, z).to_f64();
        let [x, y, z] = m.transform_vector(t).normalize_or(t).to_f32().to_array();
        [x, y, z, w * sign]
    };
    let turned: Vec<[f32; 4]> = mesh.tangents().iter().map(|t| turn(*t)).collect();
    pad(all, &turned, mesh.positions().len(), [1.0, 0.0, 0.0, 1.0]);
}
