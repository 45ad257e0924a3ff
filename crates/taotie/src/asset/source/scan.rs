//! The scan that is baked from: its triangles, and the other contents of its file.
//!
//! Its tree takes more memory than its triangles. It is built when rays first need it, which is after simplification.

use super::corrections::{
    ScanOptions, added_vertices, check_rounding, compute_normals, note_contradicting_normals, set_green,
    turn_triangles,
};
use super::material::{Carried, is_plain};
use super::size::ScanSize;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use taotie_engine::bake::{self, Remeshed, TexturedMesh, Visibility};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::surface::{Denoised, Noise, NoiseHandling};
use taotie_io::{FileHash, Limits, Loaded, Objects};

/// The properties of a scan besides its triangles.
#[derive(Debug)]
pub(in crate::asset) struct About {
    /// The path of its file; empty in memory.
    pub path: PathBuf,
    hash: Option<FileHash>,
    /// All files that it was read from, the model file first; empty in memory.
    pub files: Vec<PathBuf>,
    /// Bytes of all its files; 0 in memory.
    pub bytes: u64,
    pub copyright: Option<String>,
    /// The XMP metadata of the file as a whole, JSON-LD.
    pub xmp: Option<taotie_io::Json>,
    /// Problems and omissions.
    pub warnings: Warnings,
    pub size: ScanSize,
    pub carried: Carried,
    /// The objects of its instances; none if its file has no objects.
    pub objects: Objects,
    /// `true` if it specifies no colour and no material.
    pub is_plain: bool,
    /// `true` if its file has animations, skins, morph targets or material variants, none of which a baked asset has.
    pub is_rigged: bool,
    /// Why its file can have only one level of detail if it is packed: motion, or its own levels.
    pub one_level: Option<&'static str>,
    /// How it is read; the unit is the metre for glTF unless the caller specifies another.
    pub options: ScanOptions,
}

impl About {
    /// Returns the unit of the scan's coordinates; `None` if unknown.
    pub fn unit(&self) -> Option<Unit> {
        self.options.unit
    }

    /// Returns the SHA-256 of the scan's file, hexadecimal; empty in memory.
    ///
    /// # Errors
    /// [`Error::Io`] if it can no longer be read.
    pub fn sha256(&self) -> Result<String> {
        self.hash.as_ref().map_or(Ok(String::new()), FileHash::get)
    }
}

/// The noise of a scan.
pub(in crate::asset) struct ScanNoise {
    pub noise: Noise,
    /// The angle by which its removal turned the normal of each vertex, degrees; empty if it was kept.
    pub angles: Vec<f32>,
}

/// A scan as stored in its file, not yet merged into one mesh, so that the needs of a bake can be estimated.
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
    about: About,
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
    /// `true` if its noise was removed, so that it is not as in its file.
    pub(in crate::asset) is_denoised: bool,
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
        let path = path.as_ref().to_path_buf();
        let hash = FileHash::begin(&path);
        let limits = limits.or_free();
        limits.check_file(&path)?;
        progress.begin("read the scan")?.apart(move |_| {
            let loaded = taotie_io::load_model_within(&path, &limits)?;
            Self::hashed(loaded, (path, hash), limits)
        })
    }

    /// Converts the content that was read from `path`; all its instances form one scan. A model that is already
    /// loaded thus need not be read again.
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
        let path = path.as_ref().to_path_buf();
        let hash = FileHash::begin(&path);
        Self::hashed(loaded, (path, hash), limits.or_free())
    }

    fn hashed(
        mut loaded: taotie_io::Loaded,
        (path, hash): (PathBuf, FileHash),
        limits: Limits,
    ) -> Result<Self> {
        let files = all_files(&path, &mut loaded.files);
        let bytes = files.iter().map(|file| taotie_io::file_size(file)).sum::<Result<u64>>()?;
        check_extent(&loaded.scene, &path.display().to_string())?;
        left_of_scan_file(&mut loaded);
        let is_rigged = loaded.rig.is_some() || !loaded.variants.names().is_empty();
        let about = About {
            is_rigged,
            one_level: loaded.moving.or((loaded.levels > 1).then_some("its own levels")),
            hash: Some(hash),
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
            ..About::of(&loaded.scene, path)
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
        let about = About { warnings: loaded.warnings, ..About::of(&loaded.scene, PathBuf::new()) };
        Ok(Self { scene: loaded.scene, about, limits: Limits::default() })
    }

    /// Returns the scan file with these options instead of the defaults.
    pub fn with_options(mut self, options: ScanOptions) -> Self {
        self.about.options = ScanOptions { unit: options.unit.or(self.about.unit()), ..options };
        self
    }

    /// Returns all files that the scan was read from, the model file first; empty in memory.
    pub fn files(&self) -> &[PathBuf] {
        &self.about.files
    }

    /// Returns the unit of the scan's coordinates: that of [`ScanOptions`], else the metre of a glTF file; `None` if
    /// unknown.
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
            let Self { mut scene, mut about, limits } = self;
            correct(&mut scene, &mut about)?;
            let surface = Arc::new(bake::Scan::surface_of(scene)?);
            check_rounding(surface.mesh(), &mut about.warnings)?;
            Ok(Scan {
                surface,
                sorted: Arc::default(),
                remeshed: Arc::default(),
                is_denoised: false,
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

    fn made_sorted(&self) -> bake::Scan {
        bake::Scan::of(Arc::clone(&self.surface)).with_objects(Arc::clone(&self.about.objects.of_instances))
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

    /// Returns the file that it was read from; empty in memory.
    pub fn path(&self) -> &Path {
        &self.about.path
    }

    /// Returns all files that it was read from, the model file first; empty in memory.
    pub fn files(&self) -> &[PathBuf] {
        &self.about.files
    }

    /// Returns the problems with its file, and omissions.
    pub fn warnings(&self) -> &Warnings {
        &self.about.warnings
    }

    /// Returns the SHA-256 of its file, hexadecimal; empty in memory. It is computed in the background.
    ///
    /// # Errors
    /// [`Error::Io`] if the file can no longer be read.
    pub fn sha256(&self) -> Result<String> {
        self.about.sha256()
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
        let scan = Self { surface, sorted, remeshed, is_denoised: true, ..self };
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

impl About {
    fn of(scene: &Scene, path: PathBuf) -> Self {
        let carried = Carried::of(scene);
        let size = ScanSize::of(scene, carried.maps());
        Self {
            path,
            hash: None,
            files: Vec::new(),
            bytes: 0,
            copyright: None,
            xmp: None,
            warnings: Warnings::default(),
            size,
            carried,
            objects: Objects::default(),
            is_plain: is_plain(scene),
            is_rigged: false,
            one_level: None,
            options: ScanOptions::default(),
        }
    }
}

/// Corrects faults and gaps of a scan's file according to the options, and notes them.
fn correct(scene: &mut Scene, about: &mut About) -> Result<()> {
    let mut parts = std::mem::take(scene).into_data();
    let unit = about.unit();
    turn_triangles(&mut parts, unit, &mut about.warnings)?;
    compute_normals(&mut parts, &about.options, &mut about.warnings)?;
    note_contradicting_normals(&parts, unit, &mut about.warnings);
    set_green(&mut parts, &about.options, &mut about.warnings);
    *scene = Scene::new(parts)?;
    about.size = ScanSize::of(scene, about.carried.maps());
    Ok(())
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
    others.sort();
    others.dedup();
    let others = others.iter().filter(|other| *other != path).cloned();
    std::iter::once(path.to_path_buf()).chain(others).collect()
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
fn left_of_scan_file(loaded: &mut Loaded) {
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
