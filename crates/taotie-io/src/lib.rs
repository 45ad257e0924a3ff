//! Reads and writes models, images and sets of files. The only crate of the library that accesses files, the clock and
//! environment variables.
//!
//! ```no_run
//! let model = taotie_io::load_model("vase.ply")?;
//! println!("{} triangles", model.scene.triangle_count());
//! # Ok::<(), taotie_engine::Error>(())
//! ```

mod bitmap;
#[cfg(all(feature = "fbx", not(target_family = "wasm")))]
mod fbx;
mod file;
mod gltf;
mod json;
mod limits;
mod loaded;
mod obj;
pub mod parse;
mod ply;
mod polygon;
mod reading;
mod stl;
mod text;
mod write;
mod xmp;

pub use gltf::{ContentSize, GLTF_EXTENSIONS, GltfSizes, GltfSource, ImageSize, StoredImage, StoredParts};

pub use bitmap::{
    decode_bitmap, decode_environment, decode_environment_within, read_bitmap, read_bitmap_within,
    read_photograph_within,
};
pub use file::{FileHash, cache_file, cached_file, file_size, read as read_bytes, sha256, sha256_of};
pub use json::Json;
pub use limits::{Bytes, Limits, Stopwatch, Used, free_memory, limits_note, most_threads};
pub use loaded::{GltfStructure, Loaded, Objects, RootNode, Variants};
pub use reading::names_network;
pub use text::{HIGH_MARK, LOW_MARK, decode_text, listed, name_before, quote};
#[cfg(feature = "exr")]
pub use write::encode_exr;
pub use write::{
    AnimatedImage, AnimationFormat, AnimationSpec, CodecKind, CodecSet, EncodedModel, FileBytes, FileSet,
    GltfAsset, GltfDraft, GltfFormat, GltfGraft, GltfImage, GltfMaterial, GltfPacker, GraftedMaterial,
    ImageCodec, ImageFormat, LossyTexture, MapFormat, PackedGeometry, PackedImage, PngColor, PngImage,
    PngSamples, Stopper, TextureCodecs, VertexBits, WrittenScene, encode_glb, encode_gltf, encode_graft,
    encode_jpeg_bitmap, encode_map, encode_png, encode_png_bitmap, encode_scene, encode_scene_as,
    encode_tiff_floats, encode_webp_bitmap, gltf_files, gltf_sampler, join_levels, sampler_constants,
    write_bytes, write_gltf, write_image, write_png, write_png_bitmap, write_scene, write_text,
};
#[cfg(feature = "exr")]
pub use write::{ExrLayer, write_exr};
pub use xmp::{Provenance, XmpEvent, XmpProperties, xmp_history, xmp_rights, xmp_sources};

use reading::Reading;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Error, Result};

/// Reads a model by its extension: `gltf`, `glb`, `obj`, `ply`, `stl` or `fbx`, in any case; its finest level of detail. If
/// the first bytes of the file contradict the extension, the bytes take precedence.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Unsupported`] for another extension or an unsupported feature,
/// [`Error::Parse`] if the content is invalid and nothing can be drawn, [`Error::Limit`] if it does not fit
/// [`Limits::default`].
pub fn load_model(path: impl AsRef<Path>) -> Result<Loaded> {
    load_model_within(path.as_ref(), &Limits::default())
}

/// Reads a model like [`load_model`], within limits: on memory, as far as headers reveal it before anything is
/// decoded, on pixels, triangles and nodes, and on the files that it may refer to.
///
/// # Errors
/// As [`load_model`]; [`Error::Limit`] if a limit is exceeded.
pub fn load_model_within(path: &Path, limits: &Limits) -> Result<Loaded> {
    load(path, limits, read)
}

/// Reads a model like [`load_model_within`], and the sizes of a glTF file's contents like [`GltfSizes::read`], which
/// would read it again; `None` for other formats.
///
/// # Errors
/// As [`load_model_within`].
pub fn load_model_and_sizes(path: &Path, limits: &Limits) -> Result<(Loaded, Option<GltfSizes>)> {
    let mut sizes = None;
    let loaded = load(path, limits, |format, reading| match format {
        Format::Gltf => gltf::read_with_sizes(reading).map(|(loaded, found)| {
            sizes = Some(found);
            loaded
        }),
        other => read(other, reading),
    });
    Ok((loaded?, sizes))
}

fn read(format: Format, reading: &Arc<Reading>) -> Result<Loaded> {
    match format {
        Format::Gltf => gltf::read(reading),
        Format::Obj => obj::read(reading),
        Format::Ply => ply::read(reading),
        Format::Stl => stl::read(reading),
        #[cfg(all(feature = "fbx", not(target_family = "wasm")))]
        Format::Fbx => fbx::read(reading),
        #[cfg(not(all(feature = "fbx", not(target_family = "wasm"))))]
        Format::Fbx => Err(Error::needs_feature(format!("{}: FBX", reading.path().display()), "fbx")),
    }
}

/// Lets `read` read a model, within limits.
fn load(
    path: &Path,
    limits: &Limits,
    read: impl FnOnce(Format, &Arc<Reading>) -> Result<Loaded>,
) -> Result<Loaded> {
    let format = format_of(path)?;
    let reading = Arc::new(Reading::new(path, limits));
    if let Some(unpacked) = format.unpacked() {
        reading.count_file(path, unpacked)?;
    }
    let loaded = read(format, &reading);
    // Content that readers reduce to a warning, such as a skipped image, still counts towards the limits.
    reading.check()?;
    let loaded = with_size(loaded?, path)?;
    limits.check_triangles(path.display(), loaded.scene.triangle_count() as u64)?;
    Ok(loaded)
}

/// Reads the bytes of a GLB that refers to no files, at its finest level of detail, within limits.
///
/// # Errors
/// As [`load_model_within`], except for files that cannot be read.
pub fn load_glb(content: Vec<u8>, limits: &Limits) -> Result<Loaded> {
    let reading = Arc::new(Reading::new(GltfSource::Glb(&[]).path(), limits));
    let loaded = gltf::read_glb(&reading, content);
    reading.check()?;
    loaded
}

/// Reads a model at all its levels of detail, the finest first, like [`load_model`]. Levels are those of glTF's
/// MSFT_lod: a node with fewer levels shows its coarsest. Other formats have one. Files are read and textures decoded
/// once, and all levels share them; notes on the file as a whole are attached to the finest.
///
/// # Errors
/// As [`load_model`], for any level; [`Error::Parse`] if a file has more than 64 levels.
pub fn load_levels(path: &Path) -> Result<Vec<Loaded>> {
    load_levels_within(path, &Limits::default())
}

/// Reads a model at all its levels of detail like [`load_levels`], within limits.
///
/// # Errors
/// As [`load_levels`] and [`load_model_within`].
pub fn load_levels_within(path: &Path, limits: &Limits) -> Result<Vec<Loaded>> {
    match format_of(path)? {
        Format::Gltf => {
            let reading = Arc::new(Reading::new(path, limits));
            let levels = gltf::read_levels(&reading);
            reading.check()?;
            levels?.into_iter().map(|level| with_size(level, path)).collect()
        }
        _ => Ok(vec![load_model_within(path, limits)?]),
    }
}

/// Reads only the XMP packet for a glTF file as a whole; returns `None` if it has none, or is another format.
///
/// # Errors
/// [`Error::Io`], [`Error::Parse`] and [`Error::Limit`] as for [`load_model_within`].
pub fn read_xmp(path: &Path, limits: &Limits) -> Result<Option<Json>> {
    match format_of(path)? {
        Format::Gltf => Ok(gltf::read_xmp(path, limits)?.into_iter().next().map(Json)),
        _ => Ok(None),
    }
}

/// Returns the model with the total size of its file and the further files it was read from; each counts once.
fn with_size(loaded: Loaded, path: &Path) -> Result<Loaded> {
    let others: BTreeSet<&Path> = loaded.files.iter().map(PathBuf::as_path).collect();
    let sizes = others.into_iter().chain([path]).map(file_size);
    let bytes = sizes.sum::<Result<u64>>()?;
    Ok(Loaded { bytes: Some(bytes), ..loaded })
}

/// Returns `true` if a file is glTF according to its first bytes or its extension.
///
/// # Errors
/// [`Error::Io`] if it cannot be read, [`Error::Unsupported`] if it is not a model.
pub fn is_gltf(path: &Path) -> Result<bool> {
    Ok(format_of(path)? == Format::Gltf)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Gltf,
    Obj,
    Ply,
    Stl,
    Fbx,
}

impl Format {
    /// Returns the total bytes needed per byte of the file; `None` if this depends on the content.
    fn unpacked(self) -> Option<u64> {
        match self {
            Self::Gltf | Self::Stl | Self::Fbx => None,
            Self::Obj | Self::Ply => Some(4),
        }
    }
}

fn format_of(path: &Path) -> Result<Format> {
    let start = file::read_start(path, 512)?;
    if let Some(format) = format_from_content(&start) {
        return Ok(format);
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "gltf" | "glb" => Ok(Format::Gltf),
        "obj" => Ok(Format::Obj),
        "ply" => Ok(Format::Ply),
        "stl" => Ok(Format::Stl),
        "fbx" => Ok(Format::Fbx),
        _ => Err(Error::unsupported(
            format!("{}: the file extension '{extension}'", path.display()),
            "use .gltf, .glb, .obj, .ply, .stl or .fbx",
        )),
    }
}

/// Returns the format whose signature `start` has. OBJ and binary STL have none.
fn format_from_content(start: &[u8]) -> Option<Format> {
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
    if start.starts_with(b"glTF") || text.starts_with(b"{") {
        return Some(Format::Gltf);
    }
    if start.starts_with(b"ply\n") || start.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if start.starts_with(b"Kaydara FBX Binary") || text.starts_with(b"; FBX ") {
        return Some(Format::Fbx);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_goes_before_extension() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            format_of(&path)
        };
        assert_eq!(write("a.obj", b"glTF\x02\0\0\0").unwrap(), Format::Gltf);
        assert_eq!(write("b.STL", b"ply\nformat ascii 1.0\n").unwrap(), Format::Ply);
        assert_eq!(write("c.GLTF", b"").unwrap(), Format::Gltf);
        assert_eq!(write("d.Obj", b"v 0 0 0").unwrap(), Format::Obj);
        assert_eq!(write("e.obj", b"Kaydara FBX Binary  \0").unwrap(), Format::Fbx);
        assert_eq!(write("f.txt", b"; FBX 7.4.0 project file\n").unwrap(), Format::Fbx);
        assert_eq!(write("g.FBX", b"").unwrap(), Format::Fbx);
        let error = write("h.usd", b"PXR-USDC").unwrap_err().to_string();
        assert!(error.contains("'usd'") && error.contains(".glb"), "{error}");
    }

    #[test]
    fn loose_triangles_take_more_than_four_times_their_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        let corners = [[0.0f32, 0.0, 1.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let corners = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        let bytes: Vec<u8> = [0; 80].into_iter().chain([1, 0, 0, 0]).chain(corners).chain([0; 2]).collect();
        std::fs::write(&path, &bytes).unwrap();
        let read = |most: usize| {
            let limits = Limits { memory: Some(Bytes(most as u64)), ..Limits::default() };
            load_model_within(&path, &limits).map(|loaded| loaded.scene.triangle_count())
        };
        assert_eq!(read(5 * bytes.len()).unwrap(), 1);
        assert!(matches!(read(5 * bytes.len() - 1), Err(Error::Limit { .. })));
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = load_model(Path::new("no/such/model.glb")).unwrap_err();
        assert!(matches!(&error, Error::Io { path, .. } if path.ends_with("model.glb")), "{error}");
    }
}
