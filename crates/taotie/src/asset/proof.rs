//! The proof: an asset as it was written, read back and held against the scan.

use super::level_figures::{LevelFigures, Measured, PointCounts, chained, stacked};
use super::made::{Asset, Made, Part};
use super::map_note::MapNote;
use super::map_numbers;
use super::maps_alone;
use super::material_figures::MaterialFigures;
use super::part_figures::PartFigures;
use super::scan::Scan;
use super::shown::{Shown, ShownPart, Subject, normal_map};
use super::unseen::unseen;
use super::views::{self, Looks, ViewFigures, Views};
use super::write::Written;
use crate::bake::{Cage, Fit, MapKind, ShownNormals, low_poly_mesh};
use crate::compare::{Field, Summary};
use crate::error::{Error, Result, Warnings};
use crate::image::{Encoding, Texture};
use crate::io::{self, GltfImages, Limits, Loaded};
use crate::progress::Progress;
use crate::scene::{NormalSpace, Scene};
use std::path::Path;

/// The options of a proof. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Proof, Scan, VerifyOptions, Written};
/// use taotie::{Progress, Result};
///
/// /// Measures at five times as many points as by default.
/// fn verify_thoroughly(written: &Written, scan: Scan) -> Result<Proof> {
///     let options = VerifyOptions { points: 1_000_000, ..VerifyOptions::default() };
///     written.verify(scan, &options, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct VerifyOptions {
    /// Points of the low-poly mesh at which normals are compared, at least 10.
    pub points: usize,
    /// Points of each surface from which the distance to the other is measured, at least 1.
    pub distance_points: usize,
    /// Texels along a side of the map of errors, at most; no more than the maps have.
    pub map: u32,
    /// Pixels along a side of the images from all sides, at least 11.
    pub view: u32,
}

impl Default for VerifyOptions {
    /// Normals at 200,000 points, distances at 100,000, a map of 1024² and images of 384².
    fn default() -> Self {
        Self { points: 200_000, distance_points: 100_000, map: 1024, view: 384 }
    }
}

/// The mean and the largest angle, degrees, between unit vectors and what eight bits store of them.
///
/// ```
/// use taotie::asset::{FLOOR_8_BIT, Figures};
///
/// /// Returns `true` where more bits would gain more than a finer map.
/// fn is_near_floor(figures: &Figures) -> bool {
///     figures.floor_8_bit.is_some() && figures.angles.is_some_and(|angles| angles.mean < 1.1 * FLOOR_8_BIT[0])
/// }
/// ```
pub const FLOOR_8_BIT: [f64; 2] = [0.17, 0.38];

/// The differences of an asset from its scan, in numbers. Where there are several levels of detail these are the finest
/// one's; `levels` holds those of each.
///
/// ```
/// use taotie::asset::{BIN_WIDTH, Figures};
///
/// /// Returns the mean angle by which the map improves on vertex normals alone, degrees.
/// fn gain(figures: &Figures) -> Option<f64> {
///     Some(figures.without_map?.mean - figures.angles?.mean)
/// }
///
/// /// Returns the number of points whose normal is off by less than `degrees`.
/// fn below(figures: &Figures, degrees: f64) -> u64 {
///     figures.histogram.iter().take((degrees / BIN_WIDTH) as usize).sum()
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Figures {
    /// Degrees between the normals shown and the scan's, over points spread evenly; `None` where no point was found.
    pub angles: Option<Summary>,
    /// Their histogram, [`BIN_WIDTH`](super::BIN_WIDTH) a bin; the last is open.
    pub histogram: Vec<u64>,
    /// The same angles without the map: what vertex normals alone would give.
    pub without_map: Option<Summary>,
    /// Mean and largest angle that 8 bits cost at least, degrees; `None` where no normals are stored so.
    pub floor_8_bit: Option<[f64; 2]>,
    /// The part of the texels with a sample that missed the scan.
    pub missed_texels: f64,
    /// The part of the samples that missed and took the closest point.
    pub fallback: f64,
    /// The part of the samples for which that failed too.
    pub lost: f64,
    /// The largest distance between the surfaces, model units.
    pub hausdorff: f64,
    /// The same as a part of the diagonal.
    pub hausdorff_of_diagonal: f64,
    /// The root mean square distance, model units.
    pub rms: f64,
    /// The same as a part of the diagonal.
    pub rms_of_diagonal: f64,
    /// The scan's diagonal, model units.
    pub diagonal: f64,
    /// Texels a model unit over the triangles of the low-poly mesh.
    pub density: Option<Summary>,
    /// The part of the map that UV islands cover.
    pub uv_use: f64,
    /// Of the images from all sides in one grey material, each against that of the scan.
    pub views: Vec<ViewFigures>,
    /// The fit of the meshes to one another; `None` where the low-poly mesh has no area.
    pub fit: Option<FitFigures>,
    /// Bytes of the scan's file; 0 in memory.
    pub bytes_in: u64,
    /// Bytes of the asset, with its files.
    pub bytes_out: u64,
    /// Of each level of detail, the finest first.
    pub levels: Vec<LevelFigures>,
    /// The differences of colour and material.
    pub material: MaterialFigures,
    /// As `views`, in full material; empty where the scan says nothing of its material.
    pub full_views: Vec<ViewFigures>,
    /// Of each material of the asset, where it has several.
    pub parts: Vec<PartFigures>,
    /// What no figure and no image looks at.
    pub unseen: Vec<String>,
}

/// The fit of two meshes to one another; see [`Fit`].
///
/// ```
/// use taotie::asset::FitFigures;
///
/// /// Returns `true` where the meshes hardly belong together.
/// fn lie_apart(fit: &FitFigures) -> bool {
///     fit.away > 0.1 || fit.turned > 0.1
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct FitFigures {
    /// The part of the low-poly mesh far from the scan.
    pub away: f64,
    /// The part that faces the other way.
    pub turned: f64,
    /// The mean distance as a part of the diagonal.
    pub distance_of_diagonal: f64,
}

impl From<Fit> for FitFigures {
    fn from(fit: Fit) -> Self {
        Self { away: fit.away, turned: fit.turned, distance_of_diagonal: fit.distance }
    }
}

/// The differences of an asset from its scan: figures and images.
///
/// ```
/// use taotie::asset::{Proof, Requirement};
///
/// /// Returns `true` where an asset is as good as is wanted.
/// fn is_good(proof: &Proof) -> bool {
///     let wanted = [Requirement::mean_angle_deg(1.0), Requirement::missed(0.001)];
///     proof.require(&wanted).iter().all(|met| met.met)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Proof {
    /// The figures.
    pub figures: Figures,
    /// Angles between the normals of asset and scan at the texels of a map, degrees; NaN between UV islands. Where there
    /// are several materials their maps stand one below the other, in the order of [`Figures::parts`].
    pub error_map: Field,
    /// CIEDE2000 between the base colours of asset and scan at the same texels; `None` where the scan says nothing of its
    /// material.
    pub color_map: Option<Field>,
    /// Scan and asset from all sides, in one grey material.
    pub views: Views,
    /// The same in full material; `None` where the scan says nothing of its own.
    pub full_views: Option<Views>,
    /// As `views`, for each coarser level of detail.
    pub coarser_views: Vec<Views>,
    /// The faults of the file as it was read back.
    pub warnings: Warnings,
}

impl Written {
    /// Reads the asset back and measures how far it is from the scan. Maps alone are measured on the low-poly mesh.
    ///
    /// Each level of detail is measured, the coarser ones at a quarter of the points. A scan that is given up, not
    /// borrowed, has its tree freed before images of it are taken. The listener hears the stages `read back`,
    /// `measure normals`, `map errors`, `measure levels` where there are several, and `compare views`.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; those of reading, where the files are not as they were written;
    /// [`Error::Invalid`] where an option is out of range.
    pub fn verify(
        &self,
        scan: impl Into<Scan>,
        options: &VerifyOptions,
        progress: Progress<'_>,
    ) -> Result<Proof> {
        check(options)?;
        let (written, scan, options) = (self.clone(), scan.into(), *options);
        progress.apart(move |progress| written.prove(scan, &options, progress))
    }

    fn prove(&self, scan: Scan, options: &VerifyOptions, progress: Progress<'_>) -> Result<Proof> {
        progress.begin("read back")?;
        let mut levels = self.levels_read_back()?;
        let loaded = levels.remove(0);
        let object_maps = self.object_maps()?;
        let object_maps = self.object_normals(&object_maps);
        let subject = self.subject(&loaded.scene, &object_maps, &scan)?;
        progress.begin("measure normals")?;
        let mut figures = self.measure(&subject, options)?;
        progress.begin("map errors")?;
        let surface = subject.surface();
        let size = within(self.asset.made.size, options.map);
        let errors =
            surface.parts.iter().map(|part| part.mapped.error_map(size)).collect::<Result<Vec<_>>>()?;
        let error_map = stacked(&errors)?;
        let colors =
            surface.parts.iter().filter_map(|part| Some(part.mapped.color_map(part.material?, size)));
        let colors = colors.collect::<Result<Vec<_>>>()?;
        let color_map = (!colors.is_empty()).then(|| stacked(&colors)).transpose()?;
        if !levels.is_empty() {
            progress.begin("measure levels")?;
        }
        let mut scenes: Vec<Scene> = levels.into_iter().map(|level| level.scene).collect();
        for scene in &scenes {
            let shown = Shown::of(scene, object_maps[0], self.path())?;
            let cage = Cage::automatic(&shown.mesh, scan.sorted());
            let parts = vec![ShownPart { shown, cage }];
            let subject = Subject { parts, whole: None, scan: &scan, has_material: self.has_material() };
            let (surface, points) = (subject.surface(), PointCounts::from(options).quarter());
            let found = surface.measured(points)?;
            figures.levels.push(surface.figures(&found, points, scan.mesh().diagonal())?);
        }
        let levels = loaded.levels;
        scenes.insert(0, loaded.scene);
        let views = progress.begin("compare views")?;
        let scan = scan.into_scene()?;
        let maps: Vec<MapKind> = self.maps().iter().map(|note| note.map).collect();
        figures.unseen = unseen(&maps, self.asset.made.options.space, [&scan, &scenes[0]]);
        figures.unseen.extend(self.unseen_of_document(levels));
        figures.unseen.extend(maps_alone::unseen(&self.asset.made).filter(|_| self.is_alone()));
        let mut looks = views::take(scan, scenes, options.view, views)?;
        if !self.has_material() {
            looks.full.clear();
        }
        Ok(Proof { color_map, warnings: loaded.warnings, ..Proof::new(figures, error_map, looks) })
    }

    /// Says whether the files say what their material is.
    fn has_material(&self) -> bool {
        !self.is_alone() || maps_alone::has_material(&self.asset.made)
    }

    /// Returns what is measured of the asset as it was read back.
    fn subject<'a>(
        &self,
        scene: &'a Scene,
        object_maps: &[Option<ShownNormals<'a>>],
        scan: &'a Scan,
    ) -> Result<Subject<'a>> {
        let parts = self.asset.made.parts.iter().zip(object_maps);
        let parts = parts.map(|(part, map)| self.shown(part, scene, *map));
        let parts = parts.collect::<Result<Vec<_>>>()?;
        let whole = (parts.len() > 1).then(|| low_poly_mesh(scene.clone())).transpose()?;
        Ok(Subject { parts, whole, scan, has_material: self.has_material() })
    }

    fn shown<'a>(
        &self,
        part: &Part,
        scene: &'a Scene,
        object_map: Option<ShownNormals<'a>>,
    ) -> Result<ShownPart<'a>> {
        let has_map = part.maps.textures.normal.is_some();
        let shown = match &part.low.own {
            Some(own) if !self.is_alone() => {
                // A normal map of the low-poly mesh itself, which may have uvs of its own, is not judged.
                let inside = has_map.then(|| normal_map(scene, own.number)).flatten();
                let shown = Shown::of_material(scene, own.number, self.path())?;
                Shown { normal: object_map.or(inside), ..shown }
            }
            _ => Shown::of(scene, object_map, self.path())?,
        };
        if shown.normal.is_none() && has_map {
            let why = "read back, it shows no normal map";
            return Err(Error::invalid(self.path().display().to_string(), why));
        }
        // Packing sorts vertices anew.
        let cage = part.maps.cage.carried_over(&part.low.mesh, &shown.mesh);
        Ok(ShownPart { shown, cage })
    }

    /// Returns what is not looked at of a file that stays as it is.
    fn unseen_of_document(&self, levels: usize) -> Vec<String> {
        let Some(document) = &self.asset.made.document else { return Vec::new() };
        let moving = document
            .moving
            .map(|moving| format!("poses: the asset, which has {moving}, is compared at rest"));
        let coarser = (levels > 1).then(|| "levels of detail of the low-poly mesh's own file".to_owned());
        let keeps_relief =
            |part: &Part| part.low.material.normal.is_some() && part.maps.textures.normal.is_none();
        let relief = self.asset.made.parts.iter().any(keeps_relief);
        let relief = relief.then(|| "the low-poly mesh's own normal map, which no figure counts".to_owned());
        moving.into_iter().chain(coarser).chain(relief).collect()
    }

    /// Reads all levels back, the finest first; of a file that stays that alone; maps alone onto the low-poly mesh. Maps
    /// are decoded and in memory once.
    fn levels_read_back(&self) -> Result<Vec<Loaded>> {
        let made = &self.asset.made;
        if self.is_alone() {
            return Ok(vec![maps_alone::read_back(made, self.packing.green, &self.current())?]);
        }
        if made.document.is_some() {
            return Ok(vec![io::load_model_within(&self.current(), &Limits::of_own_files())?]);
        }
        let levels = io::load_levels_within(&self.current(), &Limits::of_own_files())?;
        let wanted = self.asset.levels().count();
        if levels.len() == wanted {
            return Ok(levels);
        }
        let why = format!("read back, it has {} levels of detail and not {wanted}", levels.len());
        Err(Error::invalid(self.path().display().to_string(), why))
    }

    /// Returns the maps in object space of all parts as they are looked up: as the textures that the file holds.
    fn object_normals<'a>(&self, maps: &'a [Option<Texture>]) -> Vec<Option<ShownNormals<'a>>> {
        let Made { parts, coarser, .. } = &*self.asset.made;
        let shown = |(part, map): (&Part, &'a Option<Texture>)| {
            let sampler = io::gltf_sampler(std::iter::once(&part.low.mesh).chain(coarser));
            map.as_ref().map(|texture| ShownNormals { texture, space: NormalSpace::Object, sampler })
        };
        parts.iter().zip(maps).map(shown).collect()
    }

    /// Reads the normal map in object space of each part, which stands beside the asset.
    fn object_maps(&self) -> Result<Vec<Option<Texture>>> {
        let is_object = self.asset.made.options.space == NormalSpace::Object;
        let notes = self.maps();
        let read = |part: &Part| {
            let is_it = |note: &&MapNote| {
                is_object
                    && note.map == MapKind::Normal
                    && note.material.as_deref().unwrap_or("") == part.low.label()
            };
            let file = notes.iter().find(is_it).and_then(|note| note.file.as_ref());
            file.map(|path| self.read_normals(path)).transpose()
        };
        self.asset.made.parts.iter().map(read).collect()
    }

    fn read_normals(&self, path: &Path) -> Result<Texture> {
        let codes = io::read_bitmap_within(&self.set.current(path), &Limits::of_own_files())?;
        let codes = map_numbers::codes_of_normals(codes)?;
        Ok(Texture::new(codes, Encoding::Normal))
    }

    fn measure(&self, subject: &Subject<'_>, options: &VerifyOptions) -> Result<Figures> {
        let (surface, diagonal) = (subject.surface(), subject.scan.mesh().diagonal());
        let found = surface.measured(options.into())?;
        let finest = surface.figures(&found, options.into(), diagonal)?;
        let Asset { made } = &self.asset;
        let (counts, size) = (self.asset.counts(), made.size);
        let part = |of: usize, all: usize| of as f64 / all.max(1) as f64;
        let densities = surface.parts.iter().map(|part| part.mapped.density(size));
        let densities = densities.collect::<Result<Vec<_>>>()?;
        let texels = size.map(|side| side as usize).iter().product::<usize>() * made.parts.len();
        Ok(Figures {
            histogram: finest.histogram.clone(),
            angles: finest.angles,
            without_map: finest.without_map,
            floor_8_bit: self.stores_8_bits().then_some(FLOOR_8_BIT),
            missed_texels: part(counts.missed_texels, counts.texels),
            fallback: part(counts.missed, counts.samples),
            lost: part(counts.lost, counts.samples),
            hausdorff: finest.hausdorff,
            hausdorff_of_diagonal: finest.hausdorff_of_diagonal,
            rms: finest.rms,
            rms_of_diagonal: finest.rms_of_diagonal,
            diagonal,
            density: chained(densities.iter())?.summary(),
            uv_use: part(counts.texels, texels),
            views: Vec::new(),
            fit: subject.whole().fit(options.points / 10, diagonal).map(FitFigures::from),
            parts: self.part_figures(subject, &found),
            bytes_in: made.about.bytes,
            bytes_out: self
                .files
                .iter()
                .map(|path| io::file_size(&self.set.current(path)))
                .sum::<Result<u64>>()?,
            material: finest.material,
            full_views: Vec::new(),
            unseen: Vec::new(),
            levels: vec![finest],
        })
    }

    /// Returns the figures of each material where there are several.
    fn part_figures(&self, subject: &Subject<'_>, found: &[Measured]) -> Vec<PartFigures> {
        let parts = self.asset.made.parts.iter().zip(&subject.parts).zip(found);
        let parts = parts.filter(|((part, _), _)| !part.low.label().is_empty());
        let figures = |((part, own), found): ((&Part, &ShownPart<'_>), &Measured)| {
            PartFigures::of(part.low.label(), own.shown.mesh.triangles().len(), found)
        };
        parts.map(figures).collect()
    }

    /// Returns `true` where the file holds normals in 8 bits. KTX2 packs them smaller still, and WebP has no more.
    fn stores_8_bits(&self) -> bool {
        let Some(note) = self.maps().into_iter().find(|note| note.map == MapKind::Normal) else {
            return false;
        };
        match (note.file.is_some(), self.packing.images) {
            (false, GltfImages::Ktx2) => false,
            (false, GltfImages::WebP) => true,
            _ => note.bits == 8,
        }
    }
}

impl Proof {
    /// Puts the figures of the views, the finest level's first, to those of their levels.
    fn new(mut figures: Figures, error_map: Field, looks: Looks) -> Self {
        for (level, views) in figures.levels.iter_mut().zip(&looks.grey) {
            level.views.clone_from(&views.figures);
        }
        for (level, views) in figures.levels.iter_mut().zip(&looks.full) {
            level.full_views.clone_from(&views.figures);
        }
        let mut grey = looks.grey.into_iter();
        let (views, full_views) = (grey.next().unwrap_or_default(), looks.full.into_iter().next());
        figures.views.clone_from(&views.figures);
        figures.full_views = full_views.as_ref().map_or_else(Vec::new, |views| views.figures.clone());
        let (coarser_views, warnings) = (grey.collect(), Warnings::default());
        Self { figures, error_map, color_map: None, views, full_views, coarser_views, warnings }
    }
}

impl From<&VerifyOptions> for PointCounts {
    fn from(options: &VerifyOptions) -> Self {
        Self { normals: options.points, distances: options.distance_points }
    }
}

/// Returns a size of the same shape with at most so many texels along its longer side.
fn within(size: [u32; 2], most: u32) -> [u32; 2] {
    let longer = size[0].max(size[1]);
    let scaled = |side: u32| (u64::from(side) * u64::from(most) / u64::from(longer)).max(1) as u32;
    if longer <= most { size } else { size.map(scaled) }
}

fn check(options: &VerifyOptions) -> Result<()> {
    let wrong = |what: &str, why: &str| Err(Error::invalid(what, why));
    match options {
        VerifyOptions { points: 0..10, .. } => {
            wrong("points at which normals are compared", "give at least 10")
        }
        VerifyOptions { distance_points: 0, .. } => wrong("points for distances", "give at least one"),
        VerifyOptions { map: 0, .. } => wrong("the map of errors", "give at least one texel"),
        VerifyOptions { view: 0..11, .. } => wrong("pictures from all sides", "give at least 11 pixels"),
        _ => Ok(()),
    }
}
