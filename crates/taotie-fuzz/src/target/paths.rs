//! The paths behind the readers: a small bake (read, bake, write, read back, prove) and a small render.

use super::read::{Held, Subject, either, error_is_told_well, is_consistent, limits};
use fastrand::Rng;
use std::path::Path;
use taotie::asset::{BakeOptions, Baker, Lod, MeshSource, Packing, RayDistance, Scan, VerifyOptions};
use taotie::studio::{self, MaterialOptions};
use taotie::{Picture, Progress, RenderSettings, Result};
use taotie_engine::bake::MapKind;
use taotie_engine::mesh::Mesh;
use taotie_engine::names::Named;
use taotie_engine::scene::NormalSpace;
use taotie_engine::shade::Shading;
use taotie_io::{CodecSet, ImageCodec, load_levels};

/// Bakes the file with options chosen by its variant. Everything that is written must be readable again.
pub fn bake(subject: &Subject<'_>) -> Held {
    let mut rng = Rng::with_seed(subject.variant);
    let options = options(&mut rng, subject.path);
    let packing = packing(&mut rng);
    let extension = if rng.bool() { "glb" } else { "gltf" };
    let path = subject.path.with_file_name("out").join("asset").with_extension(extension);
    match baked(options, subject.path, &path, &packing) {
        Ok(()) => is_readable(&path),
        Err(error) => error_is_told_well(&error),
    }
}

/// Bakes, writes, and proves.
fn baked(options: BakeOptions, from: &Path, to: &Path, packing: &Packing) -> Result<()> {
    let scan = match &options.low {
        Some(_) => Scan::from_mesh(Mesh::sphere(1.0, 16, 8), Progress::SILENT)?,
        None => Scan::read(from, &limits(), Progress::SILENT)?,
    };
    let asset = Baker::new(options).with_limits(limits()).bake(&scan, Progress::SILENT)?;
    let written = asset.write(to, packing, Progress::SILENT)?;
    let few = VerifyOptions { points: 100, map: 16, view: 16, ..VerifyOptions::default() };
    written.verify(scan, &few, Progress::SILENT).map(drop)
}

/// Reads back every level of the written file.
fn is_readable(path: &Path) -> Held {
    match load_levels(path) {
        Ok(levels) => levels.iter().try_for_each(is_consistent),
        Err(error) => Err(format!("the written file cannot be read: {error}")),
    }
}

/// Chooses coarser levels of detail below `triangles` triangles.
fn lods(rng: &mut Rng, triangles: u32) -> Vec<Lod> {
    match rng.u32(..6) {
        0 => vec![Lod::Pixels(rng.u32(32..512))],
        1 | 2 if triangles > 60 => vec![Lod::Triangles(triangles / 2), Lod::Triangles(triangles / 4)],
        _ => Vec::new(),
    }
}

/// Chooses options for a small bake of the scan `path`, or onto it.
fn options(rng: &mut Rng, path: &Path) -> BakeOptions {
    let triangles = rng.u32(4..200);
    let onto = rng.u8(..4) == 0;
    BakeOptions {
        low: onto.then(|| MeshSource::File(path.to_path_buf())),
        triangles,
        lods: lods(rng, triangles),
        keep_uvs: rng.u8(..4) == 0,
        size: 16 << rng.u32(..3),
        maps: maps(rng),
        carry: rng.bool(),
        space: if rng.u8(..8) == 0 { NormalSpace::Object } else { NormalSpace::Tangent },
        side: rng.u32(1..3),
        bits: if rng.bool() { 8 } else { 16 },
        dilation: rng.bool().then_some(2),
        ao_rays: 4,
        ray_distance: if rng.u8(..4) == 0 { RayDistance::Uniform(0.1) } else { RayDistance::Auto },
        ..BakeOptions::default()
    }
}

/// Chooses maps, usually including the normal map.
fn maps(rng: &mut Rng) -> Vec<MapKind> {
    let all = MapKind::NAMES.iter().map(|(_, map)| *map);
    let mut maps: Vec<MapKind> = all.filter(|map| *map != MapKind::Normal && rng.u8(..4) == 0).collect();
    if maps.is_empty() || rng.u8(..8) > 0 {
        maps.push(MapKind::Normal);
    }
    maps
}

/// Chooses a packing; KTX2 rarely, since it takes longest.
fn packing(rng: &mut Rng) -> Packing {
    let images = match rng.u8(..16) {
        0 => ImageCodec::Ktx2(0),
        1..3 => ImageCodec::WebP,
        3..5 => ImageCodec::Jpeg(80),
        5 => ImageCodec::Avif(80),
        _ => ImageCodec::Png,
    };
    let codecs = if rng.bool() { CodecSet::Portable } else { CodecSet::WebLatest };
    Packing { images: images.into(), meshopt: rng.u8(..4) == 0, codecs, ..Packing::default() }
}

/// Pixels along each side.
const SIDE: u32 = 16;

/// Renders the file with settings chosen by its variant.
pub fn render(subject: &Subject<'_>) -> Held {
    let loaded = match studio::load(subject.path, &MaterialOptions::default(), &limits()) {
        Ok(loaded) => loaded,
        Err(error) => return error_is_told_well(&error),
    };
    let settings = settings(&mut Rng::with_seed(subject.variant));
    match (Picture { settings, ..Picture::default() }).render(&loaded.scene) {
        Ok(frame) if frame.color.pixels().as_flattened().iter().any(|v| v.is_nan()) => {
            Err("a NaN pixel".into())
        }
        rendered => either(rendered),
    }
}

/// Chooses settings.
fn settings(rng: &mut Rng) -> RenderSettings {
    let shading = rng.choice(Shading::NAMES).map_or(Shading::Ggx, |(_, shading)| *shading);
    RenderSettings {
        width: SIDE,
        height: SIDE,
        samples: if rng.bool() { 1 } else { 4 },
        shading: if rng.bool() { shading } else { Shading::Ggx },
        specular_aa: rng.bool(),
        shadows: rng.bool(),
        ground: rng.u8(..4) == 0,
        aovs: rng.bool(),
        ..RenderSettings::default()
    }
}
