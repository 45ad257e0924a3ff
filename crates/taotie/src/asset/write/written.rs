//! Writes an asset to files.

use super::map_files::{MapNote, PackedChannels, encoding_of, hides_maps, name_of, note_unlit, turned_green};
use super::{maps_alone, provenance};
use crate::asset::ask::{BakeOptions, Channels, Packing, screen_coverage};
use crate::asset::bake::{Asset, Coarser, LevelLook, Made, Part, SeparateMap, Textures, labeled};
use crate::asset::source::{Document, KeptTextures, root_scale};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use taotie_engine::bake::MapKind;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Encoding;
use taotie_engine::names::Named;
use taotie_engine::progress::Progress;
use taotie_engine::scene::{AlphaMode, GreenChannel};
use taotie_io::{
    EncodedModel, FileBytes, FileSet, GltfAsset, GltfFormat, GltfGraft, GltfImage, GltfMaterial, GltfSource,
    GraftedMaterial, ImageCodec, Json, Limits, TextureCodecs,
};

/// An asset after writing.
///
/// ```
/// use taotie::asset::{Asset, Packing, WrittenAsset};
/// use taotie::{Progress, Result};
///
/// /// Writes an asset with its textures next to it.
/// fn write(asset: &Asset) -> Result<WrittenAsset> {
///     let written = asset.write("scan.gltf", &Packing::default(), Progress::SILENT)?;
///     assert_eq!(written.path(), written.files()[0]);
///     Ok(written)
/// }
/// ```
#[derive(Debug, Clone)]
pub struct WrittenAsset {
    pub(in crate::asset) asset: Asset,
    pub(in crate::asset) packing: Packing,
    /// The requested path, which standalone maps of several materials extend by the names of these.
    pub(in crate::asset) requested: PathBuf,
    pub(in crate::asset) files: Vec<PathBuf>,
    pub(in crate::asset) set: FileSet,
    pub(in crate::asset) warnings: Warnings,
}

impl Asset {
    /// Writes the asset as `.glb`, or as `.gltf` with its files next to it. Maps that glTF has no slot for are
    /// written as separate files, such as `scan.height.png`. A path ending in `.png`, `.tiff`, `.exr`, `.tga` or `.webp` gets
    /// standalone maps: the first in that file, all others next to it, such as `out.ao.png`, with the green direction
    /// of the packing; if the low-poly mesh has several materials, a set for each, such as `out.wood.png` and
    /// `out.wood.ao.png`. All files appear together at the end; a failed or cancelled write leaves none. The same asset
    /// gives the same bytes.
    ///
    /// The listener receives the stage `write`.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::Error::Cancelled); those of [`taotie_io::write_gltf`];
    /// [`Error::Invalid`](crate::Error::Invalid) for standalone maps with generated uvs or the packing of a model;
    /// [`Error::Io`](crate::Error::Io) if the scan's file or that of the XMP properties can no longer be read.
    pub fn write(
        &self,
        path: impl AsRef<Path>,
        packing: &Packing,
        progress: Progress<'_>,
    ) -> Result<WrittenAsset> {
        FileSet::one(|set| self.write_in(set, path.as_ref(), packing, progress))
    }

    /// Writes the asset like [`Asset::write`], but as files of a set. They appear together with its other files, such
    /// as a report of [`WrittenAsset::verify`], when the caller commits it.
    ///
    /// # Errors
    /// Those of [`Asset::write`], and [`Error::Invalid`](crate::Error::Invalid) if an input file would be
    /// overwritten.
    pub fn write_in(
        &self,
        set: &FileSet,
        path: &Path,
        packing: &Packing,
        progress: Progress<'_>,
    ) -> Result<WrittenAsset> {
        let progress = progress.begin("write")?;
        set.protect(self.made.about.files.iter().chain(&self.made.low_files).chain(&packing.provenance))?;
        let options = &self.made.options;
        Channels::check_all(&packing.channels, &options.maps, options.carry)?;
        let is_overruled = self.made.rounding.is_some() && packing.format() != Packing::default().format();
        let packing = self.made.packing(packing);
        let requested = path.to_path_buf();
        let (asset, packed, path) = (self.clone(), packing.clone(), requested.clone());
        let is_alone = maps_alone::is_alone(&path);
        if !is_alone && options.bits == 32 {
            let why = "no model format stores them; write standalone maps";
            return Err(Error::invalid("32 bits per channel", why));
        }
        let encode = move |_: Progress<'_>| match is_alone {
            true => maps_alone::encoded(&asset.made, &path, &packed).map(EncodedModel::from),
            false => encoded(&asset.made, &path, &packed),
        };
        let EncodedModel { files, warnings: left_out } = progress.part(0.0, 0.8).apart(encode)?;
        set.write_files(&files, progress.part(0.8, 1.0))?;
        let mut warnings = match is_alone {
            true => maps_alone::warnings(&self.made),
            false => Warnings::default(),
        };
        warnings.absorb(left_out);
        warnings
            .note("the search chose the packing; the requested one has no effect", usize::from(is_overruled));
        let files = files.into_iter().map(|file| file.path).collect();
        Ok(WrittenAsset { asset: self.clone(), packing, requested, files, set: set.clone(), warnings })
    }
}

/// Returns every file that an asset at `path` may be written to, the model first; except for those named after
/// materials of a low-poly file, which has not been read yet.
pub(in crate::asset) fn possible_files(
    path: &Path,
    options: &BakeOptions,
    packing: &Packing,
) -> Vec<PathBuf> {
    if maps_alone::is_alone(path) {
        return maps_alone::possible_files(path, packing);
    }
    let names = options.maps.iter().map(|map| map.name()).chain(packing.channels.iter().map(Channels::name));
    let separate = names.map(|name| path.with_extension(format!("{name}.png")));
    let given = packing.images.all().map(ImageCodec::kind);
    let kinds = match options.searches() {
        true if options.images.is_empty() => options.codecs.images(),
        true => &options.images,
        false => &given,
    };
    taotie_io::gltf_files(path, kinds, options.lods.len()).into_iter().chain(separate).collect()
}

/// Returns all files, the model first, with notes on the model.
fn encoded(made: &Made, path: &Path, packing: &Packing) -> Result<EncodedModel> {
    let xmp = provenance::packet(made, packing)?;
    let rights = taotie_io::xmp_rights(&xmp);
    let sets = made.parts.iter().map(|part| BesideMaps::of(made, part, packing));
    let sets = sets.collect::<Result<Vec<_>>>()?;
    let extras = extras(&sets, path, packing)?;
    let name = name(made);
    let about = About {
        name: &name,
        copyright: made.about.copyright.as_deref().or(rights.as_deref()),
        xmp: &xmp,
        extras: extras.as_ref(),
    };
    let target = Target { path, format: &packing.format() };
    let mut model = match made.coarser.iter().all(|level| matches!(level.look, LevelLook::Shared)) {
        true => one(made, &about, target)?,
        false => joined(made, &about, target)?,
    };
    let mut warnings = notes(made, packing, &model.files);
    warnings.absorb(std::mem::take(&mut model.warnings));
    model.warnings = warnings;
    for set in &sets {
        for own in set.all() {
            let bytes = taotie_io::encode_png_bitmap(&own.bitmap, encoding_of(&[own.map]))?;
            model.files.push(FileBytes { path: own.file(set.label, path), bytes });
        }
        for packed in set.packed(packing) {
            let bytes = taotie_io::encode_png_bitmap(&packed.bitmap()?, Encoding::Linear)?;
            model.files.push(FileBytes { path: packed_file(&packed, path), bytes });
        }
    }
    Ok(model)
}

/// Returns the files of an asset whose levels all show the same materials, the model first.
fn one(made: &Made, about: &About<'_>, target: Target<'_>) -> Result<EncodedModel> {
    match &made.document {
        Some(document) => grafted(made, document, about, target),
        None => {
            let levels: Vec<_> = made.levels().collect();
            let coverages = coverages(made);
            let of_asset = single(made, about);
            let alpha_modes = &made.alpha_modes;
            let model = GltfAsset { levels: &levels, coverages: &coverages, alpha_modes, ..of_asset };
            taotie_io::encode_gltf(target.path, &model, target.format).map(EncodedModel::from)
        }
    }
}

/// Returns the files of an asset whose levels are encoded separately and then joined, the model first.
fn joined(made: &Made, about: &About<'_>, target: Target<'_>) -> Result<EncodedModel> {
    let glb = Target { path: Path::new("level.glb"), ..target };
    let finest = finest(made, about, glb)?;
    let coarser = (0..made.coarser.len()).map(|i| encoded_level(made, i, glb)).collect::<Result<Vec<_>>>()?;
    let coarser: Vec<&[u8]> = coarser.iter().map(Vec::as_slice).collect();
    let files = taotie_io::join_levels(target.path, (&model_of(finest.files), &coarser), &coverages(made))?;
    Ok(EncodedModel { files, warnings: finest.warnings })
}

/// Returns the GLB of only the finest level.
fn finest(made: &Made, about: &About<'_>, glb: Target<'_>) -> Result<EncodedModel> {
    match &made.document {
        Some(document) => grafted(made, document, about, glb),
        None => {
            let levels = [&made.parts[0].low.mesh];
            let alpha_modes = made.alpha_modes.get(..1).unwrap_or_default();
            let model = GltfAsset { levels: &levels, alpha_modes, ..single(made, about) };
            taotie_io::encode_gltf(glb.path, &model, glb.format).map(EncodedModel::from)
        }
    }
}

/// Returns the GLB of one of the coarser levels.
fn encoded_level(made: &Made, number: usize, glb: Target<'_>) -> Result<Vec<u8>> {
    let Coarser { mesh, look, .. } = &made.coarser[number];
    let Part { low, maps } = &made.parts[0];
    let (material, format) = match look {
        LevelLook::Packed(packed) => {
            let graft = GltfGraft::unchanged(GltfSource::Glb(packed), Limits::of_own_files());
            let scaled = GltfGraft { root_scale: scale_of(made), ..graft };
            return taotie_io::encode_graft(glb.path, &scaled, glb.format).map(|model| model_of(model.files));
        }
        LevelLook::Shared => (maps.textures.material(&low.material, &low.kept), *glb.format),
        LevelLook::Rebaked(own) => {
            let normal_map = own.textures.normal.as_ref().map(GltfImage::from);
            (GltfMaterial { normal_map, ..maps.textures.material(&low.material, &low.kept) }, *glb.format)
        }
        LevelLook::Own(own) => {
            (own.maps.textures.material(&own.low.material, &own.low.kept), own.rounding.format())
        }
    };
    let alpha_modes = made.alpha_modes.get(number + 1..number + 2).unwrap_or_default();
    let name = name(made);
    let levels = [mesh];
    let root_scale = root_scale(made.about.unit());
    let model =
        GltfAsset { name: &name, levels: &levels, root_scale, material, alpha_modes, ..GltfAsset::default() };
    taotie_io::encode_glb(&model, &format)
}

/// Returns the bytes of the model, which is the first of its files.
fn model_of(files: Vec<FileBytes>) -> Vec<u8> {
    files.into_iter().next().map(|file| file.bytes).unwrap_or_default()
}

/// Returns the name of nodes and meshes: not that of the output file, since the same asset must give the same bytes
/// under any name.
fn name(made: &Made) -> Cow<'_, str> {
    made.about.path().file_stem().map_or("asset".into(), |stem| stem.to_string_lossy())
}

/// Returns the contents of an asset with one mesh and one material, without its levels.
fn single<'a>(made: &'a Made, about: &About<'a>) -> GltfAsset<'a> {
    let Part { low, maps } = &made.parts[0];
    GltfAsset {
        name: about.name,
        root_scale: root_scale(made.about.unit()),
        material: maps.textures.material(&low.material, &low.kept),
        copyright: about.copyright,
        xmp: Some(about.xmp),
        extras: about.extras,
        ..GltfAsset::default()
    }
}

/// Returns the files of the low-poly file `document` with the baked maps of its materials, the model first.
fn grafted(made: &Made, document: &Document, about: &About<'_>, target: Target<'_>) -> Result<EncodedModel> {
    // Kept textures are already in the file.
    let none = KeptTextures::default();
    let mut materials = Vec::with_capacity(made.parts.len());
    for Part { low, maps } in &made.parts {
        let Some(own) = &low.own else { continue };
        materials.push(GraftedMaterial {
            number: own.number,
            label: &own.label,
            material: maps.textures.material(&low.material, &none),
            said: &own.said,
            sampler: taotie_io::gltf_sampler([&low.mesh]),
            drops_colors: own.drops_colors,
        });
    }
    let graft = GltfGraft {
        source: document.source.gltf(),
        limits: document.limits,
        root_scale: scale_of(made),
        materials: &materials,
        copyright: about.copyright,
        xmp: Some(about.xmp),
        extras: about.extras,
    };
    taotie_io::encode_graft(target.path, &graft, target.format)
}

/// Returns the metres by which a kept file is scaled; `None` if it is in metres.
fn scale_of(made: &Made) -> Option<f32> {
    let is_in_metres = made.document.as_ref().is_some_and(|document| document.is_in_metres);
    root_scale(made.about.unit()).filter(|_| !is_in_metres)
}

/// A model file and its format.
#[derive(Clone, Copy)]
struct Target<'a> {
    path: &'a Path,
    format: &'a GltfFormat,
}

/// The metadata of an asset.
struct About<'a> {
    name: &'a str,
    copyright: Option<&'a str>,
    xmp: &'a Json,
    extras: Option<&'a Json>,
}

/// The maps of a material in separate files next to the model.
struct BesideMaps<'a> {
    part: &'a Part,
    label: &'a str,
    kept: Vec<&'a SeparateMap>,
    /// Those with green down.
    turned: Vec<SeparateMap>,
}

impl<'a> BesideMaps<'a> {
    fn of(made: &Made, part: &'a Part, packing: &Packing) -> Result<Self> {
        let textures = &part.maps.textures;
        let turned = turned_green(made.options.space, textures, packing)?;
        let is_turned = |own: &&SeparateMap| turned.iter().any(|turned| turned.map == own.map);
        let kept = textures.separate.iter().filter(|own| !is_turned(own)).collect();
        Ok(Self { part, label: part.low.label(), kept, turned })
    }

    /// Returns the textures that pack channels.
    fn packed<'b>(&'b self, packing: &'b Packing) -> impl Iterator<Item = PackedChannels<'b>> {
        let Self { part, turned, .. } = self;
        packing.channels.iter().map(|channels| PackedChannels { part, channels, turned })
    }

    fn all(&self) -> impl Iterator<Item = &SeparateMap> {
        self.kept.iter().copied().chain(&self.turned)
    }
}

/// The maximum size of metadata that a search does not count, bytes.
const METADATA: u64 = 4096;

/// Notes requested packing that was not applied, and an asset that is larger than its scan.
fn notes(made: &Made, packing: &Packing, files: &[FileBytes]) -> Warnings {
    let mut warnings = Warnings::default();
    let mut materials = Vec::with_capacity(made.parts.len());
    for Part { low, maps } in &made.parts {
        materials.push(maps.textures.material(&low.material, &low.kept));
    }
    let has_alpha = materials.iter().any(has_alpha);
    warnings.absorb(note_unlit(materials.iter().filter(|material| hides_maps(material))));
    warnings.note(
        "meshes are not compressed: the low-poly mesh's file is kept as is",
        usize::from(made.document.is_some() && made.rounding.is_none() && packing.meshopt),
    );
    let rebaked = made.coarser.iter().filter(|level| matches!(level.look, LevelLook::Rebaked(_))).count();
    warnings.note(
        "levels of detail with their own normal map, which is written only with green up",
        if packing.green == GreenChannel::Down { rebaked } else { 0 },
    );
    let colors = packing.images.colors;
    warnings.note(
        format!("the base colour's texture has alpha, which {} does not support: it is PNG", colors.kind()),
        usize::from(has_alpha && !colors.holds_alpha()),
    );
    if made.rounding.is_none() {
        warnings.absorb(unpacked(&materials, packing.images));
    }
    // The result of a search exceeds its target by at most that.
    let of_metadata = if made.rounding.is_some() { METADATA } else { 0 };
    let advice = match (made.rounding.is_some(), packing.meshopt) {
        (true, _) => "",
        (false, true) => "; use smaller maps",
        (false, false) => "; use smaller maps, or compress its geometry",
    };
    let (of_scan, all) = (made.about.bytes, files.iter().map(|file| file.bytes.len() as u64).sum::<u64>());
    warnings.note(
        format!("the asset is larger than its scan: {all} bytes instead of {of_scan}{advice}"),
        usize::from(of_scan > 0 && all > of_scan + of_metadata),
    );
    warnings
}

/// Returns true if the alpha of the base colour texture is written.
fn has_alpha(material: &GltfMaterial<'_>) -> bool {
    let has = |image| matches!(image, GltfImage::Bitmap(bitmap) if matches!(bitmap.channels(), 2 | 4));
    material.alpha != AlphaMode::Opaque && material.base_color_map.is_some_and(has)
}

/// Returns `true` if the loss of any format has an effect: on colours, or on numbers with a lossy format.
fn is_lossy(material: &GltfMaterial<'_>, images: TextureCodecs) -> bool {
    let GltfMaterial { base_color_map, emissive_map, metallic_roughness_map, occlusion_map, .. } = material;
    let has_numbers = metallic_roughness_map.is_some() || occlusion_map.is_some();
    let holds_color = images.colors.holds_alpha() || !has_alpha(material);
    (base_color_map.is_some() && holds_color)
        || emissive_map.is_some()
        || (has_numbers && images.numbers.number().is_some())
}

/// Returns notes on formats for textures that the asset does not have.
fn unpacked(materials: &[GltfMaterial<'_>], images: TextureCodecs) -> Warnings {
    let mut warnings = Warnings::default();
    let has_any = |material: &GltfMaterial<'_>| {
        let GltfMaterial { metallic_roughness_map, occlusion_map, normal_map, .. } = material;
        let others = [material.base_color_map, material.emissive_map];
        others.iter().chain([metallic_roughness_map, occlusion_map, normal_map]).any(Option::is_some)
    };
    let has_any = materials.iter().any(has_any);
    warnings.note(
        format!("the asset has no textures; the image format {images} has no effect"),
        usize::from(images != TextureCodecs::default() && !has_any),
    );
    let is_unread = has_any && !materials.iter().any(|material| is_lossy(material, images));
    warnings.note(
        format!("the asset has no texture that the loss of {images} applies to: normals have their own"),
        usize::from(images.colors.number().is_some() && is_unread),
    );
    warnings
}

/// Returns the minimum screen coverage of the object while each level is shown: where the next one meets the limits
/// and takes over.
fn coverages(made: &Made) -> Vec<f32> {
    made.coarser.iter().map(|level| screen_coverage(level.across)).chain([0.0]).collect()
}

/// Returns the asset's notes on the files next to it; `None` if there are none.
fn extras(sets: &[BesideMaps<'_>], path: &Path, packing: &Packing) -> Result<Option<Json>> {
    let entry = |label: &str, own: &SeparateMap| {
        let note = MapNote::separate(own, label, path);
        let name = note.file?.file_name()?.to_string_lossy().into_owned();
        let mut about = json!({ "file": name, "black": note.black, "white": note.white, "unit": note.unit });
        if let Some(origin) = note.origin {
            about["origin"] = json!(origin);
        }
        if !note.legend.is_empty() {
            about["legend"] = json!(note.legend);
        }
        Some((labeled(label, note.map.name()), about))
    };
    let entries = sets.iter().flat_map(|set| set.all().filter_map(|own| entry(set.label, own)));
    let mut maps: serde_json::Map<String, Value> = entries.collect();
    for packed in sets.iter().flat_map(|set| set.packed(packing)) {
        let file = packed_file(&packed, path);
        let mut about = json!({ "file": name_of(&file) });
        for note in packed.notes(&file)? {
            let channel = note.channel.unwrap_or_default();
            about[&*channel] =
                json!({ "map": note.map, "black": note.black, "white": note.white, "unit": note.unit });
            if let Some(origin) = note.origin {
                about[&*channel]["origin"] = json!(origin);
            }
        }
        maps.insert(packed.name(), about);
    }
    Ok((!maps.is_empty()).then(|| Json(json!({ "maps": maps }))))
}

/// Returns the file of a texture that packs channels, next to the model `path`.
fn packed_file(packed: &PackedChannels<'_>, path: &Path) -> PathBuf {
    path.with_extension(format!("{}.png", packed.name()))
}

impl WrittenAsset {
    /// Returns the files, the model or the main map first.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Returns deviations from the request, and whether the asset is larger than its scan.
    pub fn warnings(&self) -> &Warnings {
        &self.warnings
    }

    /// Returns the asset.
    pub fn asset(&self) -> &Asset {
        &self.asset
    }

    /// Returns the model file, or the first of standalone maps.
    pub fn path(&self) -> &Path {
        self.files.first().map_or(Path::new(""), PathBuf::as_path)
    }

    /// Returns where the model can be read now: its files may still be waiting for others of their set.
    pub(in crate::asset) fn current(&self) -> PathBuf {
        self.set.current(self.path())
    }

    /// Returns each map's kind and location, material by material.
    pub fn maps(&self) -> Vec<MapNote> {
        self.asset.made.parts.iter().flat_map(|part| self.maps_of_part(part)).collect()
    }

    /// Returns the notes of a part of the finest level.
    pub(in crate::asset) fn maps_of_part(&self, part: &Part) -> Vec<MapNote> {
        if self.is_alone() {
            return maps_alone::notes(part, &self.requested, &self.packing);
        }
        let packed = self.packing.channels.iter().flat_map(|channels| {
            let packed = PackedChannels { part, channels, turned: &[] };
            // They were written, so no map is missing.
            packed.notes(&packed_file(&packed, self.path())).unwrap_or_default()
        });
        self.maps_of(part.low.label(), &part.maps.textures).chain(packed).collect()
    }

    fn maps_of(&self, label: &str, textures: &Textures) -> impl Iterator<Item = MapNote> {
        let separate = textures.separate.iter().map(|own| MapNote::separate(own, label, self.path()));
        let inside = textures.inside().map(|(map, bitmap)| MapNote::inside(label, map, bitmap));
        inside.chain(self.turned_normal(label, textures)).chain(separate)
    }

    /// Returns `true` if maps were written without a model.
    pub(in crate::asset) fn is_alone(&self) -> bool {
        maps_alone::is_alone(self.path())
    }

    /// Returns the note on the normal map with green down.
    fn turned_normal(&self, label: &str, textures: &Textures) -> Option<MapNote> {
        let normal = textures.normal.as_ref().filter(|_| self.packing.green == GreenChannel::Down)?;
        let file = Some(self.path().with_extension(labeled(label, "normal.png")));
        Some(MapNote { file, ..MapNote::inside(label, MapKind::Normal, normal) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::Bitmap;

    #[test]
    fn a_packing_without_textures_is_told() {
        let bitmap = Bitmap::new(1, 1, 3, taotie_engine::image::Texels::U8(vec![[255; 4]])).unwrap();
        let map = || Some(GltfImage::from(&bitmap));
        let bare = GltfMaterial::default();
        let normal = GltfMaterial { normal_map: map(), ..GltfMaterial::default() };
        let color = GltfMaterial { base_color_map: map(), ..GltfMaterial::default() };
        let count = |material: &GltfMaterial<'_>, format: &str| {
            unpacked(&[*material], format.parse().unwrap()).iter().count()
        };
        assert_eq!([&bare, &normal, &color].map(|material| count(material, "jpeg:85")), [1, 1, 0]);
        assert_eq!(count(&bare, "png"), 0);
        let glowing = GltfMaterial { emissive_map: map(), ..GltfMaterial::default() };
        for format in ["webp:80", "ktx2:2"] {
            let materials = [&bare, &normal, &color, &glowing];
            assert_eq!(materials.map(|material| count(material, format)), [1, 1, 0, 0]);
        }
    }
}
