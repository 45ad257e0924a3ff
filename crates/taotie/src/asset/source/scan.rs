//! The scan that is baked from: its triangles, and the other contents of its file.
//!
//! Its tree takes more memory than its triangles. It is built when rays first need it, which is after simplification.

use super::corrections::{
    FileUnit, ScanOptions, added_vertices, check_rounding, corrected, has_green_down, into_metres,
    to_one_unit,
};
use super::material::{Carried, has_finish, is_plain};
use super::size::{
    ModelFile, ScanSize, all_files, check_distinct, check_extent, first_of, is_gltf, left_of_scan_file,
    missing_files, named_by_file, rights, sizes, stated_unit,
};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use taotie_engine::bake::{self, RayDevice, Remeshed, TexturedMesh, Visibility};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Material, Scene, SceneData};
use taotie_engine::surface::{Denoised, Noise, NoiseHandling};
use taotie_io::{Bytes, Limits, Objects, Used};

/// The properties of a scan besides its triangles.
#[derive(Debug)]
pub(in crate::asset) struct About {
    /// Its model files, which are one scan together; none in memory.
    pub models: Vec<ModelFile>,
    /// All files that it was read from, the model files first; empty in memory.
    pub files: Vec<PathBuf>,
    /// Files that they name and that could not be found.
    pub missing: Vec<PathBuf>,
    /// Bytes of all its files; 0 in memory.
    pub bytes: u64,
    pub copyright: Option<String>,
    /// The XMP metadata of the file as a whole, JSON-LD.
    pub xmp: Option<taotie_io::Json>,
    /// Problems and omissions.
    pub warnings: Warnings,
    pub size: ScanSize,
    pub carried: Carried,
    /// The objects of its instances; none if its only file has no objects.
    pub objects: Objects,
    /// `true` if it specifies no colour and no material.
    pub is_plain: bool,
    /// `true` if a file states roughness, as glTF does, or it is in memory.
    pub states_material: bool,
    /// `true` if its only file has animations, skins, morph targets or variants, which a baked asset lacks.
    pub is_rigged: bool,
    /// Why its only file can have only one level of detail if it is packed: motion, or its own levels.
    pub one_level: Option<&'static str>,
    /// How it is read; the unit is the metre for glTF unless the caller specifies another.
    pub options: ScanOptions,
    /// `true` if it was changed after reading, such as its materials.
    pub is_edited: bool,
}

impl About {
    /// Returns the properties of a scan in memory.
    pub(super) fn of(scene: &Scene) -> Self {
        let carried = Carried::of(scene);
        let size = ScanSize::of(scene, carried.maps());
        Self {
            models: Vec::new(),
            files: Vec::new(),
            missing: Vec::new(),
            bytes: 0,
            copyright: None,
            xmp: None,
            warnings: Warnings::default(),
            size,
            carried,
            objects: Objects::default(),
            is_plain: is_plain(scene),
            states_material: true,
            is_rigged: false,
            one_level: None,
            options: ScanOptions::default(),
            is_edited: false,
        }
    }

    /// Returns the unit of the scan's coordinates; `None` if unknown.
    pub fn unit(&self) -> Option<Unit> {
        self.options.unit
    }

    /// Returns the path of the first model file; empty in memory.
    pub fn path(&self) -> &Path {
        self.models.first().map_or(Path::new(""), |model| &model.path)
    }
}

/// The noise of a scan.
pub(in crate::asset) struct ScanNoise {
    pub noise: Noise,
    /// The angle by which its removal turned the normal of each vertex, degrees; empty if it was kept.
    pub angles: Vec<f32>,
}

/// A scan as stored in its files, not yet merged into one mesh, so that the needs of a bake can be estimated.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{BakeOptions, Baker, ScanFile};
/// use taotie::Limits;
///
/// let limits = Limits::default();
/// let file = ScanFile::read("scan.ply", &limits, Progress::SILENT)?;
/// let baker = Baker::new(BakeOptions::default());
/// println!("a bake needs about {} of memory", baker.need(file.size()).bytes());
/// let scan = file.into_scan(Progress::SILENT)?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug)]
pub struct ScanFile {
    scene: Scene,
    pub(super) about: About,
    limits: Limits,
}

/// A scan: one mesh with its materials, sorted for rays once a bake needs them. Clones share all data.
///
/// ```
/// use taotie::asset::Scan;
/// use taotie::{Mesh, Progress};
///
/// let scan = Scan::from_mesh(Mesh::sphere(1.0, 32, 16), Progress::SILENT)?;
/// assert_eq!(scan.mesh().triangles().len(), 960);
/// assert_eq!(scan.sha256()?, "", "it has no file");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Clone)]
pub struct Scan {
    surface: Arc<TexturedMesh>,
    /// The surface sorted for rays; empty until needed.
    sorted: Arc<OnceLock<bake::Scan>>,
    /// `true` if it is not as in its file: it was edited, or its noise was removed.
    pub(in crate::asset) is_changed: bool,
    /// The device that casts the rays of bakes; `None` for the CPU.
    pub(in crate::asset) device: Option<Arc<dyn RayDevice>>,
    /// Its watertight outer surface; empty until needed.
    remeshed: Arc<OnceLock<Remeshed>>,
    pub(in crate::asset) about: Arc<About>,
    /// The limits within which it was read, and for other inputs of a bake of it.
    pub(in crate::asset) limits: Limits,
}

impl ScanFile {
    /// Reads a model: glTF, GLB, OBJ, PLY, STL or FBX.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; those of [`taotie_io::load_model`]; [`Error::Limit`] if the file does not fit in memory;
    /// [`Error::Invalid`] if all its triangles are at one point.
    pub fn read(path: impl AsRef<Path>, limits: &Limits, progress: Progress<'_>) -> Result<Self> {
        Self::read_all(&[path], ScanOptions::default(), limits, progress)
    }

    /// Reads one or more models that are one scan together, as [`Self::joined`] does, each within the memory that the
    /// ones before leave.
    ///
    /// ```no_run
    /// use taotie::{Limits, Progress};
    /// use taotie::asset::{ScanFile, ScanOptions};
    ///
    /// let (files, limits) = (["lid_high.ply", "body_high.ply"], Limits::default());
    /// let file = ScanFile::read_all(&files, ScanOptions::default(), &limits, Progress::SILENT)?;
    /// let scan = file.into_scan(Progress::SILENT)?;
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`Self::read`] and [`Self::joined`].
    pub fn read_all(
        paths: &[impl AsRef<Path>],
        options: ScanOptions,
        limits: &Limits,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let paths: Vec<PathBuf> = paths.iter().map(|path| path.as_ref().to_path_buf()).collect();
        let limits = limits.or_free();
        check_distinct(&paths)?;
        progress.begin("read the scan")?.apart(move |_| {
            let (mut files, mut left) = (Vec::with_capacity(paths.len()), limits);
            for path in &paths {
                let model = ModelFile::begin(path);
                left.check_file(path)?;
                let loaded = taotie_io::load_model_within(path, &left)?;
                let file = Self::hashed(loaded, model, limits)?;
                left.used = left.used.and(file.used());
                files.push(file);
            }
            Self::joined(files, options)
        })
    }

    /// Joins files to one scan, read with `options`; see [`ScanOptions::unit`] for their unit. Instances without a name
    /// get that of their file, such as `lid_high`, which matches `lid_low` of a low-poly mesh.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no file, if one occurs twice, or if their units are ambiguous.
    pub fn joined(mut files: Vec<Self>, options: ScanOptions) -> Result<Self> {
        match files.pop() {
            Some(only) if files.is_empty() => Ok(only.with_options(options)),
            Some(last) => {
                files.push(last);
                join(files, options)
            }
            None => Err(Error::invalid("the scan", "it has no files")),
        }
    }

    /// Returns the path of its model file, for messages.
    fn name(&self) -> String {
        let name = |model: &ModelFile| model.path.display().to_string();
        self.about.models.first().map_or_else(|| "a model in memory".into(), name)
    }

    /// Returns the resources that count against the limits of further files.
    fn used(&self) -> Used {
        let size = &self.about.size;
        Used { memory: Bytes(size.mesh_bytes()), triangles: size.triangles }
    }

    /// Converts the content that was read from `path`, which is not read again; all its instances form one scan.
    ///
    /// ```no_run
    /// use taotie::Progress;
    /// use taotie::asset::ScanFile;
    /// use taotie::Limits;
    ///
    /// let loaded = taotie::load_model("scan.ply")?;
    /// let scan = ScanFile::from_loaded(loaded, "scan.ply", &Limits::default())?.into_scan(Progress::SILENT)?;
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Io`] if one of its files is gone; [`Error::Invalid`] if all its triangles are at one point.
    pub fn from_loaded(loaded: taotie_io::Loaded, path: impl AsRef<Path>, limits: &Limits) -> Result<Self> {
        Self::hashed(loaded, ModelFile::begin(path.as_ref()), limits.or_free())
    }

    fn hashed(mut loaded: taotie_io::Loaded, model: ModelFile, limits: Limits) -> Result<Self> {
        let files = all_files(&model.path, &mut loaded.files);
        let bytes = sizes(&files)?;
        check_extent(&loaded.scene, &model.path.display().to_string())?;
        left_of_scan_file(&mut loaded);
        let about = About {
            is_rigged: loaded.rig.is_some() || !loaded.variants.names().is_empty(),
            is_edited: loaded.is_edited,
            missing: missing_files(&model.path, &loaded.missing_files),
            states_material: loaded.is_edited || is_gltf(loaded.format) || has_finish(&loaded.scene),
            one_level: loaded.moving.or((loaded.levels > 1).then_some("its own levels")),
            models: vec![model],
            files,
            bytes,
            copyright: loaded.copyright,
            objects: loaded.objects,
            xmp: (!loaded.xmp.is_empty()).then(|| loaded.xmp.swap_remove(0)),
            warnings: loaded.warnings,
            options: ScanOptions {
                unit: stated_unit(loaded.format).map(|_| Unit::Metre),
                ..ScanOptions::default()
            },
            ..About::of(&loaded.scene)
        };
        Ok(Self { scene: loaded.scene, about, limits })
    }

    /// Converts a scene; all its instances form one scan.
    ///
    /// # Errors
    /// [`Error::Invalid`] if all its triangles are at one point.
    pub fn from_scene(scene: Scene) -> Result<Self> {
        check_extent(&scene, "the scan")?;
        let mut loaded = taotie_io::Loaded::new(scene, Warnings::default(), "");
        left_of_scan_file(&mut loaded);
        let about = About { warnings: loaded.warnings, ..About::of(&loaded.scene) };
        Ok(Self { scene: loaded.scene, about, limits: Limits::default() })
    }

    /// Returns the scan file with these options instead of the defaults.
    pub fn with_options(mut self, options: ScanOptions) -> Self {
        self.about.options = ScanOptions { unit: options.unit.or(self.about.unit()), ..options };
        self
    }

    /// Returns all files that the scan was read from, the model files first; empty in memory.
    pub fn files(&self) -> &[PathBuf] {
        &self.about.files
    }

    /// Returns the scan file in the space of its assets: in metres if its unit is known.
    ///
    /// # Errors
    /// [`Error::Invalid`] if its transforms are no longer finite.
    pub fn into_metres(mut self) -> Result<Self> {
        let unit = &mut self.about.options.unit;
        into_metres(&mut self.scene, *unit)?;
        *unit = unit.map(|_| Unit::Metre);
        Ok(self)
    }

    /// Returns its surfaces as stored, in [`Self::unit`].
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the unit of the coordinates: that of [`ScanOptions`], or a glTF file's metre; `None` if unknown.
    pub fn unit(&self) -> Option<Unit> {
        self.about.unit()
    }

    /// Returns the number of triangles and vertices of the scan, and its other memory needs.
    pub fn size(&self) -> ScanSize {
        let added = added_vertices(&self.scene, &self.about.options);
        self.about.size.with_vertices_added(added)
    }

    /// Merges the scan into one mesh. Reversed triangles are flipped if there is no doubt about them; meshes without
    /// normals, or with one per facet, get smooth ones with the hard edges of modelled shapes; normal maps with green
    /// pointing down are read as such. Each of these causes a warning, and [`ScanOptions`] can override it.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Limit`] if the scene has more than 2^32 − 1 vertices; those of
    /// [`ScanOptions::check`].
    pub fn into_scan(self, progress: Progress<'_>) -> Result<Scan> {
        progress.begin("join the scan")?.apart(move |_| {
            let Self { scene, mut about, limits } = self;
            let scene = corrected(scene, &about.options, &mut about.warnings)?;
            about.size = ScanSize::of(&scene, about.carried.maps());
            let is_changed = about.is_edited || has_green_down(&scene);
            let surface = Arc::new(bake::Scan::surface_of(scene)?);
            let path = about.path().to_path_buf();
            check_rounding((surface.mesh(), &path), &mut about.warnings)?;
            Ok(Scan {
                surface,
                sorted: Arc::default(),
                device: None,
                remeshed: Arc::default(),
                is_changed,
                about: Arc::new(about),
                limits,
            })
        })
    }
}

impl Scan {
    /// Reads a scan: [`ScanFile::read`] and [`ScanFile::into_scan`].
    ///
    /// # Errors
    /// Those of both.
    pub fn read(path: impl AsRef<Path>, limits: &Limits, progress: Progress<'_>) -> Result<Self> {
        ScanFile::read(path, limits, progress)?.into_scan(progress)
    }

    /// Converts a mesh to a scan with the default material.
    ///
    /// # Errors
    /// Those of [`ScanFile::from_scene`] and [`ScanFile::into_scan`].
    pub fn from_mesh(mesh: Mesh, progress: Progress<'_>) -> Result<Self> {
        Self::from_scene(Scene::of_mesh(mesh, Material::default())?, progress)
    }

    /// Converts a scene; all its instances form one scan.
    ///
    /// # Errors
    /// Those of [`ScanFile::from_scene`] and [`ScanFile::into_scan`].
    pub fn from_scene(scene: Scene, progress: Progress<'_>) -> Result<Self> {
        ScanFile::from_scene(scene)?.into_scan(progress)
    }

    /// Returns its triangles sorted for rays; the first call sorts them.
    pub fn sorted(&self) -> &bake::Scan {
        match self.sorted.get() {
            Some(sorted) => sorted,
            // Not built by `get_or_init`: a thread waiting for others' part of the work may pick up a bake of this
            // scan.
            None => {
                let made = self.made_sorted();
                self.sorted.get_or_init(|| made)
            }
        }
    }

    /// Returns the scan with a device that casts the rays of its bakes instead of the CPU.
    pub fn cast_by(self, device: Arc<dyn RayDevice>) -> Self {
        Self { device: Some(device), sorted: Arc::default(), ..self }
    }

    fn made_sorted(&self) -> bake::Scan {
        let objects = Arc::clone(&self.about.objects.of_instances);
        bake::Scan::of(Arc::clone(&self.surface)).with_objects(objects).cast_by(self.device.clone())
    }

    /// Calls `work` with the triangles sorted for rays. If they were not sorted before, the tree is dropped
    /// afterwards, so that its memory is available to later stages.
    pub(super) fn with_sorted<T>(&self, work: impl FnOnce(&bake::Scan) -> T) -> T {
        match self.sorted.get() {
            Some(sorted) => work(sorted),
            None => work(&self.made_sorted()),
        }
    }

    /// Sorts it for rays, as a separate stage, unless that is done.
    pub(in crate::asset) fn sort(&self, progress: Progress<'_>) -> Result<()> {
        if !self.is_sorted() {
            progress.begin("sort the scan")?;
            self.sorted();
        }
        Ok(())
    }

    /// Returns its watertight outer surface; the first call builds it, as a separate stage, and sorts the scan if
    /// necessary.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Invalid`] for an interior; those of [`bake::remesh`].
    pub(in crate::asset) fn remeshed(&self, progress: Progress<'_>) -> Result<&Remeshed> {
        if let Some(remeshed) = self.remeshed.get() {
            return Ok(remeshed);
        }
        self.sort(progress)?;
        let progress = progress.begin("remesh the scan")?;
        if Visibility::of(self.sorted()).is_interior() {
            let why = "it is seen from within, as a room is, and its outer surface would show nothing of that; bake \
                       it without remeshing";
            return Err(Error::invalid("the scan to remesh", why));
        }
        let remeshed = bake::remesh(self.sorted(), progress)?;
        Ok(self.remeshed.get_or_init(|| remeshed))
    }

    /// Returns true if it is already sorted for rays.
    pub(in crate::asset) fn is_sorted(&self) -> bool {
        self.sorted.get().is_some()
    }

    /// Returns the bytes that it currently takes.
    pub(in crate::asset) fn held(&self) -> u64 {
        let size = self.about.size;
        if self.is_sorted() { size.bytes() } else { size.mesh_bytes() }
    }

    /// Returns its triangles with their materials.
    pub(in crate::asset) fn surface(&self) -> &TexturedMesh {
        &self.surface
    }

    /// Returns its triangles, in world space, with normals.
    pub fn mesh(&self) -> &Mesh {
        self.surface.mesh()
    }

    /// Returns the unit of its coordinates; see [`ScanFile::unit`].
    pub fn unit(&self) -> Option<Unit> {
        self.about.unit()
    }

    /// Returns the file that it was read from, the first if there are several; empty in memory.
    pub fn path(&self) -> &Path {
        self.about.path()
    }

    /// Returns the file whose whole content a packed scan has: its only one, unless it was changed since.
    pub(in crate::asset) fn packed_file(&self) -> Option<&Path> {
        let is_kept = self.about.models.len() == 1 && !self.is_changed;
        self.about.models.first().filter(|_| is_kept).map(|model| &*model.path)
    }

    /// Returns all files that it was read from, the model files first; empty in memory.
    pub fn files(&self) -> &[PathBuf] {
        &self.about.files
    }

    /// Returns the problems with its file, and omissions.
    pub fn warnings(&self) -> &Warnings {
        &self.about.warnings
    }

    /// Returns the SHA-256 of the file at [`Self::path`], hexadecimal; empty in memory. It is computed in the
    /// background.
    ///
    /// # Errors
    /// [`Error::Io`] if the file can no longer be read.
    pub fn sha256(&self) -> Result<String> {
        self.about.models.first().map_or(Ok(String::new()), ModelFile::sha256)
    }

    /// Measures its noise, and removes it if requested; returns the scan to make the asset from.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(in crate::asset) fn settle_noise(
        self,
        handling: NoiseHandling,
        warnings: &mut Warnings,
        progress: Progress<'_>,
    ) -> Result<(Self, Option<ScanNoise>)> {
        let progress = progress.begin("measure the noise")?;
        let Some(noise) = Noise::of(self.mesh()) else {
            let what = match handling {
                NoiseHandling::Keep => {
                    "noise not measured: the scan has too few vertices with enough neighbours"
                }
                NoiseHandling::Remove => {
                    "noise neither measured nor removed: the scan has too few vertices with enough neighbours"
                }
            };
            warnings.note(what, 1);
            return Ok((self, None));
        };
        if handling == NoiseHandling::Keep {
            return Ok((self, Some(ScanNoise { noise, angles: Vec::new() })));
        }
        let Denoised { mesh, change, angles } =
            noise.remove(self.mesh(), progress.begin("remove the noise")?)?;
        let surface = Arc::new(self.surface.in_shape(mesh));
        let noise = Noise { removed: Some(change), ..noise };
        let (sorted, remeshed) = (Arc::default(), Arc::default());
        let scan = Self { surface, sorted, remeshed, is_changed: true, ..self };
        Ok((scan, Some(ScanNoise { noise, angles })))
    }

    /// Frees the tree, and moves the triangles out unless a clone of this scan still holds them.
    pub(in crate::asset) fn into_scene(self) -> Result<Scene> {
        let Self { surface, sorted, remeshed, .. } = self;
        drop((sorted, remeshed));
        Arc::unwrap_or_clone(surface).into_scene()
    }
}

impl From<&Scan> for Scan {
    fn from(scan: &Scan) -> Self {
        scan.clone()
    }
}

impl std::fmt::Debug for Scan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scan").field("about", &self.about).finish_non_exhaustive()
    }
}

/// Joins several files to one scan.
fn join(mut files: Vec<ScanFile>, options: ScanOptions) -> Result<ScanFile> {
    check_distinct(files.iter().flat_map(|file| &file.about.models).map(|model| &model.path))?;
    let of_files = files.iter_mut().map(|file| FileUnit {
        name: file.name(),
        stated: file.unit(),
        scene: &mut file.scene,
    });
    let unit = to_one_unit(of_files.collect(), options.unit)?;
    let limits = files.first().map_or_else(Limits::default, |file| file.limits);
    let objects = files.iter().map(|ScanFile { scene, about, .. }| {
        let stem = about.models.first().map(ModelFile::stem).unwrap_or_default();
        named_by_file(about.objects.clone(), &stem, scene.instances().len())
    });
    let objects = Objects::of_all(objects);
    let copyright = rights(files.iter().map(|file| (&file.about.copyright, &file.about.xmp)));
    let states_material = files.iter().any(|file| file.about.states_material);
    let is_in_memory = files.iter().any(|file| file.about.models.is_empty());
    let (mut parts, mut warnings) = (SceneData::default(), Warnings::default());
    let [mut others, mut missing] = [Vec::new(), Vec::new()];
    let (mut models, mut packets) = (Vec::new(), Vec::new());
    for ScanFile { scene, about, .. } in files {
        parts.append(scene.into_data());
        let label = about.models.first().map_or_else(String::new, |model| format!("{}: ", model.name()));
        about.warnings.iter().for_each(|(what, count)| warnings.note(format!("{label}{what}"), count));
        models.extend(about.models);
        others.extend(about.files);
        missing.extend(about.missing);
        packets.extend(about.xmp);
    }
    let what = "XMP metadata of further files of the scan, left out except for rights";
    warnings.note(what, packets.len().saturating_sub(1));
    let scene = Scene::new(parts)?;
    check_extent(&scene, "the scan")?;
    let files = first_of(models.iter().map(|model| model.path.clone()).collect(), others);
    models.retain(|_| !is_in_memory);
    let about = About {
        bytes: sizes(&files)?,
        models,
        files,
        missing,
        copyright,
        xmp: packets.into_iter().next(),
        warnings,
        objects,
        states_material,
        options: ScanOptions { unit, ..options },
        ..About::of(&scene)
    };
    Ok(ScanFile { scene, about, limits })
}
