//! The inputs of a bake besides the scan, read before the work begins: the given low-poly mesh, with the kept parts
//! of its material, and the cage.

use super::low_file::{self, Document, Groups, Read};
use super::low_material::{
    LowLook, Stripped, note_samplers, show_fronts_of_cards, shown_materials, triangles_by_material,
};
use super::low_poly::{
    CageMesh, KeptMaterial, KeptTextures, LowPoly, Origin, RayLength, Rays, Skew, Tile, framed, unwrapped,
};
use super::scan::Scan;
use crate::asset::ask::{BakeOptions, MASK_NEEDS_UVS, MeshSource, NEEDS_UVS, RayDistance, SQUARE};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use taotie_engine::bake::{self, CageGroups, MapKind, MatchRule, UvIndex};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Encoding, Texture};
use taotie_engine::math::Vec2;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::progress::Progress;
use taotie_engine::scene::{AlphaMode, Instance, Material, Scene};

/// The inputs of a bake besides the scan.
pub(in crate::asset) struct Inputs {
    /// The given low-poly mesh; `None` if it is generated.
    pub given: Option<GivenMesh>,
    pub rays: Rays,
    /// The files that they were read from.
    pub files: Vec<PathBuf>,
    /// The warnings about these files.
    pub warnings: Warnings,
}

/// Reads meshes for a scan and collects their files and warnings.
struct Reader<'a> {
    scan: &'a Scan,
    files: Vec<PathBuf>,
    warnings: Warnings,
}

impl Inputs {
    /// Reads the inputs that the options name, for a scan.
    ///
    /// # Errors
    /// Those of [`GivenMesh::of`], and of reading.
    pub fn read(options: &BakeOptions, scan: &Scan, progress: Progress<'_>) -> Result<Self> {
        let mut reader = Reader { scan, files: Vec::new(), warnings: Warnings::default() };
        let given = match &options.low {
            Some(source) => {
                let reading = progress.begin("read the low-poly mesh")?;
                let mut read = reader.read(source)?;
                if !read.is_gltf {
                    read.scene = show_fronts_of_cards(read.scene, &mut reader.warnings)?;
                }
                if options.new_uvs {
                    read.without_uvs(options.ray_colors)?;
                }
                let groups = match options.matching.reads_names() {
                    true => Groups::matched([&read.objects, &scan.about.objects], &mut reader.warnings),
                    false => None,
                };
                let is_whole = options.matching == MatchRule::Isolated && groups.is_none();
                let what = "no names of objects match, so none is isolated: rays see the whole scan";
                reader.warnings.note(what, usize::from(is_whole));
                let given = GivenMesh::of(options, source, read, &mut reader.warnings)?.with_groups(groups);
                reading.at(1.0)?;
                Some(given)
            }
            None => None,
        };
        let uvs = options.matching == MatchRule::Uv;
        let uvs = uvs.then(|| UvIndex::of(scan.mesh()).map(Arc::new)).transpose()?;
        let rays = Rays { length: reader.lengths(&options.ray_distance)?, skew: reader.skew(options)?, uvs };
        if let (Some(given), RayLength::Cage(cage)) = (&given, &rays.length) {
            cage.check(given.triangle_count())?;
        }
        let Reader { files, warnings, .. } = reader;
        Ok(Self { given, rays, files, warnings })
    }
}

impl Reader<'_> {
    fn read(&mut self, source: &MeshSource) -> Result<Read> {
        let mut read = low_file::read(source, self.scan, &mut self.warnings)?;
        self.files.append(&mut read.files);
        Ok(read)
    }

    fn lengths(&mut self, distance: &RayDistance) -> Result<RayLength> {
        Ok(match distance {
            RayDistance::Auto => RayLength::Auto,
            RayDistance::Uniform(distance) => RayLength::Uniform(*distance),
            RayDistance::Cage(source) => {
                let mesh = bake::low_poly_mesh(self.read(source)?.scene)?;
                RayLength::Cage(CageMesh { mesh, source: source.clone() })
            }
        })
    }

    fn skew(&mut self, options: &BakeOptions) -> Result<Skew> {
        let Some(path) = &options.skew_mask else {
            return Ok(if options.straighten { Skew::Corrected } else { Skew::Kept });
        };
        let mask = taotie_io::read_bitmap_within(path, &self.scan.limits)?;
        self.files.push(path.clone());
        Ok(Skew::Mask(Arc::new(Texture::new(mask, Encoding::Linear))))
    }
}

/// A low-poly mesh as stored in its file.
pub(in crate::asset) struct GivenMesh {
    scene: Scene,
    /// One for each material that is kept, at least one.
    parts: Vec<GivenPart>,
    document: Option<Document>,
    groups: Option<Groups>,
}

/// The triangles of a low-poly mesh with one material.
struct GivenPart {
    /// The material, without what cannot be kept.
    material: Material,
    stripped: Stripped,
    /// The material of the kept file; `None` if all triangles use the first.
    own: Option<KeptMaterial>,
}

/// The parts of a given mesh that go into the asset.
pub(in crate::asset) struct Taken {
    pub mesh: Mesh,
    pub material: Material,
    pub kept: KeptTextures,
    pub own: Option<KeptMaterial>,
    /// The objects of the scan that its triangles show, and the names of the groups; `None` for all.
    groups: Option<(CageGroups, Vec<String>)>,
}

impl GivenMesh {
    /// Takes a mesh that was read, in its rest pose.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for parts of it that the asset could not keep; those of
    /// rewriting it.
    fn of(
        options: &BakeOptions,
        source: &MeshSource,
        mut read: Read,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let document = low_file::kept(source, &mut read, options, warnings)?;
        match document {
            Some(document) => Self::of_document(document, read.scene),
            None => Ok(Self::of_one(read.scene, warnings)),
        }
    }

    /// Makes its objects show only those of the scan with the same name.
    fn with_groups(self, groups: Option<Groups>) -> Self {
        Self { groups, ..self }
    }

    /// Merges all of a scene into one mesh with its first material.
    fn of_one(scene: Scene, warnings: &mut Warnings) -> Self {
        let used: Vec<usize> = scene.instances().iter().map(|instance| instance.material).collect();
        if used.iter().any(|material| *material != used[0]) {
            warnings.note("merged the materials of the low-poly mesh into the first", 1);
        }
        let mut material = used.first().and_then(|m| scene.materials().get(*m)).cloned().unwrap_or_default();
        let stripped = Stripped::off(&mut material, &scene);
        Self { scene, parts: vec![GivenPart { material, stripped, own: None }], document: None, groups: None }
    }

    /// Takes the materials of a kept file.
    fn of_document(document: Document, scene: Scene) -> Result<Self> {
        let numbers = shown_materials(&scene);
        let labels = low_file::labels(&scene, &numbers);
        let mut triangles = triangles_by_material(&scene);
        let part = |(number, label): (usize, String)| {
            let material = scene.materials()[number].clone();
            let triangles = triangles.remove(&number).unwrap_or_default();
            let said = material.clone();
            let own = KeptMaterial { number, label, said, triangles, ..KeptMaterial::default() };
            GivenPart { material, stripped: Stripped::default(), own: Some(own) }
        };
        let parts: Vec<GivenPart> = labels.into_iter().map(part).collect();
        let whole = match parts.len() {
            1 => None,
            _ => Some(bake::framed_low_poly_mesh(scene.clone())?),
        };
        Ok(Self { scene, parts, document: Some(Document { whole, ..document }), groups: None })
    }

    /// Returns the appearance of each material.
    pub fn looks(&self, options: &BakeOptions) -> Vec<LowLook<'_>> {
        let meshes = self.scene.meshes();
        let has_colors = |part: &GivenPart| {
            let mut own = self.scene.instances().iter().filter(|instance| part.shows(instance));
            !options.ray_colors && own.any(|instance| is_colored(&meshes[instance.mesh]))
        };
        let parts = self.parts.iter();
        parts.map(|part| LowLook { material: &part.material, has_colors: has_colors(part) }).collect()
    }

    /// Returns the number of sets of maps, at least 1: of materials, or of the UDIM tiles of each.
    pub fn set_count(&self, has_tiles: bool) -> u64 {
        if !has_tiles {
            return self.parts.len() as u64;
        }
        let instances = self.scene.instances();
        let tiles: BTreeSet<(usize, Place)> = instances
            .iter()
            .flat_map(|instance| {
                let mesh = &self.scene.meshes()[instance.mesh];
                let tiles = mesh.uvs().first().map(|uvs| triangles_by_tile(mesh, uvs).0).unwrap_or_default();
                // Without a kept file, all materials are one.
                let material = if self.document.is_some() { instance.material } else { 0 };
                tiles.into_keys().map(move |place| (material, place)).collect::<Vec<_>>()
            })
            .collect();
        tiles.len().max(1) as u64
    }

    /// Returns the total number of triangles.
    pub fn triangle_count(&self) -> usize {
        let meshes = self.scene.meshes();
        self.scene.instances().iter().map(|instance| meshes[instance.mesh].triangles().len()).sum()
    }

    /// Returns its materials, to be filled in.
    pub fn materials_mut(&mut self) -> impl Iterator<Item = &mut Material> {
        self.parts.iter_mut().map(|part| &mut part.material)
    }

    /// Takes the kept file.
    pub fn take_document(&mut self) -> Option<Document> {
        self.document.take()
    }

    /// Takes the kept contents of each part: one mesh in world space, and the material without what is replaced by
    /// baked maps. That and what cannot be kept is noted.
    ///
    /// # Errors
    /// Those of [`bake::low_poly_mesh`].
    pub fn taken(self, options: &BakeOptions, warnings: &mut Warnings) -> Result<Vec<Taken>> {
        let Self { scene, parts, groups, .. } = self;
        let groups_of = |part: &GivenPart| {
            let groups = groups.as_ref()?;
            let instances = scene.instances().iter().enumerate();
            let own = instances.filter(|(_, instance)| part.shows(instance));
            let triangles = |instance: &Instance| scene.meshes()[instance.mesh].triangles().len();
            let of_mesh = groups.of_mesh(own.map(|(i, instance)| (i, triangles(instance))));
            Some((of_mesh, groups.names.clone()))
        };
        let mut groups: Vec<_> = parts.iter().map(groups_of).collect();
        let mut scenes: Vec<Scene> = Vec::with_capacity(parts.len());
        for part in &parts {
            let mut own = scene.clone();
            if let Some(kept) = &part.own {
                own.edit(|scene| scene.instances.retain(|instance| instance.material == kept.number))?;
            }
            scenes.push(own);
        }
        // Lets a single mesh be taken without a copy.
        drop(scene);
        let taken = parts.into_iter().zip(scenes).map(|(part, scene)| part.taken(scene, options, warnings));
        let mut taken: Vec<Taken> = taken.collect::<Result<_>>()?;
        taken.iter_mut().zip(groups.drain(..)).for_each(|(taken, groups)| taken.groups = groups);
        if options.udim { tiled(taken, warnings) } else { Ok(taken) }
    }
}

/// Splits each mesh by the UDIM tiles of its uvs, which are moved into the first. A triangle belongs to the tile of its
/// centre; one without uv area to any tile that holds it, since it covers no texel.
///
/// # Errors
/// [`Error::Invalid`] for uvs outside all tiles.
fn tiled(all: Vec<Taken>, warnings: &mut Warnings) -> Result<Vec<Taken>> {
    let mut tiles = Vec::new();
    for taken in all {
        let Some(uvs) = taken.mesh.uvs().first() else {
            return Err(Error::invalid("UDIM tiles", NEEDS_UVS));
        };
        let (of_tiles, outside) = triangles_by_tile(&taken.mesh, uvs);
        if outside > 0 {
            let what = format!("{outside} triangles of the low-poly mesh");
            let why =
                "their uvs are outside all UDIM tiles, 1001 to 9999: from 0 to 10 across, and from 0 up";
            return Err(Error::invalid(what, why));
        }
        let crosses =
            |place: Place, t: usize| taken.mesh.triangles()[t].iter().any(|v| !place.holds(uvs[*v as usize]));
        let crossing =
            of_tiles.iter().map(|(place, own)| own.iter().filter(|t| crosses(*place, **t)).count());
        warnings.note(
            "triangles of the low-poly mesh cross borders of UDIM tiles: each is baked into the tile of its centre",
            crossing.sum(),
        );
        let of_file: Vec<usize> = match &taken.own {
            Some(whole) => whole.triangles.iter().cloned().flatten().collect(),
            None => (0..taken.mesh.triangles().len()).collect(),
        };
        for (place, own) in of_tiles {
            let ranges = own.iter().map(|t| of_file[*t]..of_file[*t] + 1).collect();
            tiles.push(taken.in_tile(&own, (place, ranges), tiles.len())?);
        }
    }
    Ok(tiles)
}

/// Returns the triangles of each tile, and the number of those outside all.
fn triangles_by_tile(mesh: &Mesh, uvs: &[Vec2]) -> (BTreeMap<Place, Vec<usize>>, usize) {
    let corners = |t: usize| mesh.triangles()[t].map(|v| uvs[v as usize]);
    let has_area = |t: usize| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a) != 0.0
    };
    let (with_area, without): (Vec<usize>, Vec<usize>) =
        (0..mesh.triangles().len()).partition(|t| has_area(*t));
    let (mut tiles, mut outside) = (BTreeMap::<Place, Vec<usize>>::new(), 0);
    for t in with_area {
        let [a, b, c] = corners(t);
        match Place::of((a + b + c) * (1.0 / 3.0)) {
            Some(place) => tiles.entry(place).or_default().push(t),
            None => outside += 1,
        }
    }
    for t in without {
        let holds = |place: &Place| corners(t).iter().all(|uv| place.holds(*uv));
        let place = tiles.keys().copied().find(holds).or_else(|| Place::of(corners(t)[0]));
        match place {
            Some(place) => tiles.entry(place).or_default().push(t),
            None => outside += 1,
        }
    }
    tiles.values_mut().for_each(|triangles| triangles.sort_unstable());
    (tiles, outside)
}

/// The column and row of a UDIM tile, from the bottom left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    row: u16,
    column: u16,
}

impl Place {
    /// Returns the tile at a uv; `None` outside all.
    fn of(uv: Vec2) -> Option<Self> {
        let (column, row) = (uv.x.floor(), (1.0 - uv.y).floor());
        let is_inside = (0.0..10.0).contains(&column) && (0.0..900.0).contains(&row);
        let place = Self { row: row as u16, column: column as u16 };
        (is_inside && place.number() <= 9999).then_some(place)
    }

    /// Returns the uv in the first tile.
    fn moved(self, uv: Vec2) -> Vec2 {
        Vec2::new(uv.x - f32::from(self.column), uv.y + f32::from(self.row))
    }

    /// Returns `true` if a uv is in the tile, or on its border.
    fn holds(self, uv: Vec2) -> bool {
        /// The rounding of uvs by other programs.
        const ROUNDING: f32 = 1e-4;
        let inside = |v: f32| (-ROUNDING..=1.0 + ROUNDING).contains(&v);
        let uv = self.moved(uv);
        inside(uv.x) && inside(uv.y)
    }

    fn number(self) -> u32 {
        1001 + u32::from(self.column) + 10 * u32::from(self.row)
    }
}

impl Taken {
    /// Returns some triangles as the part of a tile with this number; `ranges` are these triangles in the file.
    fn in_tile(
        &self,
        own: &[usize],
        (place, ranges): (Place, Vec<Range<usize>>),
        number: usize,
    ) -> Result<Self> {
        let (mut indices, mut which) = (BTreeMap::new(), Vec::new());
        let mut vertex = |v: u32| {
            *indices.entry(v).or_insert_with(|| {
                which.push(v as usize);
                which.len() as u32 - 1
            })
        };
        let triangles: Vec<[u32; 3]> =
            own.iter().map(|t| self.mesh.triangles()[*t].map(&mut vertex)).collect();
        let mut mesh = MeshData { triangles, ..self.mesh.gathered(&which) };
        mesh.uvs[0].iter_mut().for_each(|uv| *uv = place.moved(*uv));
        let said = || KeptMaterial { said: self.material.clone(), ..KeptMaterial::default() };
        let kept = self.own.clone().unwrap_or_else(said);
        let (tile, material) = (place.number(), kept.label.clone());
        let label = if material.is_empty() { tile.to_string() } else { format!("{material}_{tile}") };
        let tile = Some(Tile { number: tile, material });
        let groups = self.groups.as_ref().map(|(groups, names)| (groups.of_triangles(own), names.clone()));
        let own = Some(KeptMaterial { number, label, triangles: ranges, tile, ..kept });
        Ok(Self {
            mesh: Mesh::new(mesh)?,
            material: self.material.clone(),
            kept: self.kept.clone(),
            own,
            groups,
        })
    }
}

impl GivenPart {
    /// Returns `true` if an instance has its material.
    fn shows(&self, instance: &Instance) -> bool {
        self.own.as_ref().is_none_or(|own| own.number == instance.material)
    }

    fn taken(self, scene: Scene, options: &BakeOptions, warnings: &mut Warnings) -> Result<Taken> {
        let Self { mut material, stripped, own } = self;
        if let Some(own) = own {
            let kept = KeptTextures::beside_roughness(&mut material, &scene, options, warnings);
            leave_alpha(&mut material, options, warnings);
            let mesh = bake::framed_low_poly_mesh(scene)?;
            let drops_colors = !mesh.colors().is_empty() && drops_colors(options);
            return Ok(Taken {
                mesh,
                material,
                kept,
                own: Some(KeptMaterial { drops_colors, ..own }),
                groups: None,
            });
        }
        let kept = KeptTextures::of(&material, &scene);
        stripped.note(options, warnings);
        note_samplers(&material, &scene, options, warnings);
        leave_relief(&material, options, warnings);
        leave_alpha(&mut material, options, warnings);
        let mesh = joined(scene, options)?;
        Ok(Taken { mesh, material, kept, own: None, groups: None })
    }
}

/// Returns a whole scene as one mesh. Standalone maps are for the original file, so its meshes get the tangents that
/// viewers compute for it; otherwise the mesh is rewritten with its own tangents.
fn joined(scene: Scene, options: &BakeOptions) -> Result<Mesh> {
    let has_uvs = |instance: &Instance| !scene.meshes()[instance.mesh].uvs().is_empty();
    let is_for_file = options.keep_uvs && scene.instances().iter().all(has_uvs);
    if is_for_file { bake::framed_low_poly_mesh(scene) } else { bake::low_poly_mesh(scene) }
}

/// Notes that the normal map, which is relative to other tangents, is dropped.
fn leave_relief(material: &Material, options: &BakeOptions, warnings: &mut Warnings) {
    let has_relief = material.normal.is_some() && !options.bakes(&[MapKind::Normal]);
    warnings.note(
        "the low-poly mesh's normal map is left out; bake normal to replace it",
        usize::from(has_relief),
    );
}

/// Drops alpha that is in a texture replaced by baked colours without alpha.
fn leave_alpha(material: &mut Material, options: &BakeOptions, warnings: &mut Warnings) {
    let is_textured = material.alpha != AlphaMode::Opaque && material.base_color_texture.is_some();
    if is_textured && options.bakes(&[MapKind::Albedo]) && !options.bakes(&[MapKind::Alpha]) {
        warnings.note("the low-poly mesh's alpha is left out: albedo is baked without it", 1);
        material.alpha = AlphaMode::Opaque;
    }
}

/// Returns `true` if a mesh has vertex colours other than white, which programs write for unpainted meshes.
fn is_colored(mesh: &Mesh) -> bool {
    mesh.colors().iter().any(|color| *color != [1.0; 4])
}

/// Returns `true` if vertex colours are not those of the asset: baked ones replace them, or they are ray distances.
fn drops_colors(options: &BakeOptions) -> bool {
    options.ray_colors || options.bakes(&[MapKind::Albedo])
}

/// Drops vertex colours that are not those of the asset.
fn uncolored(mesh: Mesh, options: &BakeOptions, warnings: &mut Warnings) -> Result<Mesh> {
    if mesh.colors().is_empty() || !drops_colors(options) {
        return Ok(mesh);
    }
    let is_lost = is_colored(&mesh) && !options.ray_colors;
    let what = "the low-poly mesh's vertex colours are left out: baked albedo replaces them";
    warnings.note(what, usize::from(is_lost));
    Mesh::new(MeshData { colors: Vec::new(), ..mesh.into_data() })
}

impl LowPoly {
    /// Takes the given mesh, adding uvs if it has none.
    pub fn given(
        taken: Taken,
        options: &BakeOptions,
        warnings: &mut Warnings,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let Taken { mesh, material, kept, own, groups } = taken;
        let (groups, names) = groups.unzip();
        let mut origin = Origin { groups: names.unwrap_or_default(), ..Origin::default() };
        let mesh = match mesh.uvs().is_empty() {
            false => mesh,
            true if options.keep_uvs => return Err(Error::invalid("standalone maps", NEEDS_UVS)),
            true if options.skew_mask.is_some() => return Err(Error::invalid("a mask", MASK_NEEDS_UVS)),
            true if options.matching == MatchRule::Uv => {
                return Err(Error::invalid(
                    "matching by uvs",
                    "the low-poly mesh has none; give it those of the scan",
                ));
            }
            true if !options.is_square() => {
                return Err(Error::invalid(options.maps_in_words(), SQUARE));
            }
            true => unwrapped(&mesh, options.size, &mut origin, progress)?,
        };
        note_uvs(&mesh, warnings);
        let groups = groups.map(Arc::new);
        let mesh = framed(&mesh, progress)?;
        let ray_factors = if options.ray_colors { ray_factors(&mesh)? } else { Vec::new() };
        let mesh = uncolored(mesh, options, warnings)?;
        Ok(Self { mesh, origin, material, kept, own, groups, ray_factors, cage: None })
    }
}

/// Returns the red channels of the mesh's vertex colours.
fn ray_factors(mesh: &Mesh) -> Result<Vec<f32>> {
    if mesh.colors().is_empty() {
        let why = "the low-poly mesh has none; paint them, or omit the option";
        return Err(Error::invalid("ray distances from vertex colours", why));
    }
    Ok(mesh.colors().iter().map(|color| color[0].max(0.0)).collect())
}

fn note_uvs(mesh: &Mesh, warnings: &mut Warnings) {
    let inside = |v: f32| (0.0..=1.0).contains(&v);
    let outside = mesh.uvs()[0].iter().filter(|uv| !(inside(uv.x) && inside(uv.y))).count();
    warnings.note("vertices of the low-poly mesh with uvs outside the map, which is repeated there", outside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::{Mat4, Vec3};
    use taotie_io::{GltfAsset, GltfFormat, write_gltf};

    /// Returns the mesh read from a ball that is stretched by its file.
    fn taken(keep_uvs: bool, ball: &MeshData) -> (Scene, Mesh) {
        let mut scene = Scene::of_mesh(Mesh::new(ball.clone()).unwrap(), Material::default()).unwrap();
        let stretched = Mat4::scale(Vec3::new(1.0, 3.0, 1.0));
        scene.edit(|scene| scene.instances[0].world_from_object = stretched).unwrap();
        let mut warnings = Warnings::default();
        let given = GivenMesh::of_one(scene.clone(), &mut warnings);
        let options = BakeOptions { keep_uvs, ..BakeOptions::default() };
        (scene, given.taken(&options, &mut warnings).unwrap().remove(0).mesh)
    }

    #[test]
    fn maps_alone_have_the_frames_of_the_file() {
        let ball = MeshData { tangents: Vec::new(), ..Mesh::sphere(1.0, 8, 4).into_data() };
        let (scene, mesh) = taken(true, &ball);
        let own = bake::framed_low_poly_mesh(scene).unwrap();
        assert!(!own.tangents().is_empty() && mesh.tangents() == own.tangents());
        assert!(taken(false, &ball).1.tangents().is_empty(), "a rewritten mesh gets its own");
        let bare = MeshData { uvs: Vec::new(), ..ball };
        assert!(taken(true, &bare).1.uvs().is_empty(), "missing uvs are reported only if maps need them");
    }

    #[test]
    fn every_file_of_low_poly_mesh_and_cage_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let levels = [&Mesh::sphere(1.0, 8, 4)];
        let asset = GltfAsset { levels: &levels, ..GltfAsset::default() };
        let [low, cage] = ["low.gltf", "cage.gltf"].map(|name| {
            let path = folder.path().join(name);
            write_gltf(&path, &asset, &GltfFormat::default()).unwrap();
            MeshSource::File(path)
        });
        let options =
            BakeOptions { low: Some(low), ray_distance: RayDistance::Cage(cage), ..BakeOptions::default() };
        let scan = Scan::from_mesh(Mesh::sphere(1.0, 16, 8), Progress::SILENT).unwrap();
        let inputs = Inputs::read(&options, &scan, Progress::SILENT).unwrap();
        let names: Vec<_> = inputs.files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        assert_eq!(names, ["low.gltf", "low.bin", "cage.gltf", "cage.bin"]);
        assert!(inputs.given.is_some() && matches!(inputs.rays.length, RayLength::Cage(_)));
        let none = Inputs::read(&BakeOptions::default(), &scan, Progress::SILENT).unwrap();
        assert!(none.given.is_none() && none.files.is_empty());
    }
}
