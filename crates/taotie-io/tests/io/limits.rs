//! The limits on models: memory estimated from headers, shared images decoded once, counts, and nothing outside their
//! folder.

use crate::gltf::{one_primitive, triangle};
use base64::Engine;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::path::{Path, PathBuf};
use taotie_engine::Error;
use taotie_engine::image::Encoding;
use taotie_io::{Bytes, Limits};
use taotie_io::{
    Loaded, PngColor, PngImage, PngSamples, encode_png, load_model, load_model_within, read_bitmap_within,
    write_bytes,
};
use tempfile::TempDir;

/// A black image: a hundredth of a byte per pixel.
fn black(side: u32) -> Vec<u8> {
    let samples = vec![0; (side * side) as usize];
    let samples = PngSamples::U8(&samples);
    let image =
        PngImage { width: side, height: side, color: PngColor::Grey, samples, encoding: Encoding::Linear };
    encode_png(&image).unwrap()
}

/// The rest of a file whose materials use these images.
fn with_images(addresses: &[String]) -> String {
    let list = |each: &dyn Fn(usize) -> String| (0..addresses.len()).map(each).collect::<Vec<_>>().join(",");
    let images = list(&|i| format!(r#"{{"uri":"{}"}}"#, addresses[i]));
    let textures = list(&|i| format!(r#"{{"source":{i}}}"#));
    let materials =
        list(&|i| format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":{i}}}}}}}"#));
    let mesh = one_primitive(r#""POSITION":0"#, r#","material":0"#);
    format!(r#"{mesh},"images":[{images}],"textures":[{textures}],"materials":[{materials}]"#)
}

struct Made {
    folder: TempDir,
}

impl Made {
    fn new(rest: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("made.gltf"), triangle().text(rest)).unwrap();
        Self { folder }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("made.gltf")
    }

    fn load(&self, memory: u64) -> Result<Loaded, Error> {
        load_model_within(&self.path(), &Limits { memory: Some(Bytes(memory)), ..Limits::default() })
    }
}

fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png))
}

#[test]
fn images_of_one_source_are_decoded_once() {
    let shared = data_uri(&black(2048));
    let made = Made::new(&with_images(&vec![shared; 20]));
    let loaded = made.load(48 << 20).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((loaded.scene.textures().len(), loaded.scene.materials().len()), (1, 20));
    let file = Made::new(&with_images(&vec!["black.png".to_owned(); 20]));
    std::fs::write(file.folder.path().join("black.png"), black(2048)).unwrap();
    assert_eq!(file.load(48 << 20).unwrap().scene.textures().len(), 1);
}

#[test]
fn what_images_need_is_told_before_they_are_decoded() {
    let different: Vec<String> = (0..20).map(|i| data_uri(&black(1024 + i))).collect();
    let made = Made::new(&with_images(&different));
    let messages: Vec<String> =
        (0..3).map(|_| made.load(100 << 20).err().map_or_else(String::new, |e| e.to_string())).collect();
    assert!(
        messages[0].contains("made.gltf") && messages[0].contains("the limit is 100 MiB"),
        "{}",
        messages[0]
    );
    assert!(
        messages.iter().all(|one| *one == messages[0]),
        "the figure does not depend on threads: {messages:?}"
    );
    assert_eq!(made.load(400 << 20).unwrap().scene.textures().len(), 20);
}

#[test]
fn an_image_alone_is_foreseen_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("black.png");
    write_bytes(&path, &black(2048)).unwrap();
    let read = |limits: Limits| read_bitmap_within(&path, &limits);
    let memory = Some(Bytes(16 << 20));
    let error = read(Limits { memory, ..Limits::default() }).unwrap_err();
    assert!(matches!(&error, Error::Limit { .. }) && error.to_string().contains("black.png"), "{error}");
    let error = read(Limits { pixels: 1 << 20, ..Limits::default() }).unwrap_err().to_string();
    assert!(error.contains("2048×2048; the maximum is 1048576 pixels"), "{error}");
    assert!(read(Limits::default()).is_ok());
}

/// The decoder's own pixels use the memory of the later mip levels.
#[test]
fn a_jpeg_of_one_scan_takes_no_more_than_its_texels() {
    let (side, folder) = (1024u32, tempfile::tempdir().unwrap());
    let path = folder.path().join("grey.jpg");
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new(&mut bytes);
    encoder.write_image(&vec![128; (side * side * 3) as usize], side, side, ExtendedColorType::Rgb8).unwrap();
    write_bytes(&path, &bytes).unwrap();
    let reads = |memory: u64| {
        read_bitmap_within(&path, &Limits { memory: Some(Bytes(memory)), ..Limits::default() }).is_ok()
    };
    // The file as read, and kept, and copied once.
    let estimate = u64::from(side * side) * 7 + 3 * bytes.len() as u64;
    assert!(reads(estimate) && !reads(estimate - 1));
}

#[test]
fn counts_are_limited() {
    let nodes = ["{}"; 100].join(",");
    let mesh = one_primitive(r#""POSITION":0"#, "").replace(r#""nodes":["#, &format!(r#""nodes":[{nodes},"#));
    let made = Made::new(&mesh);
    let load = |limits: Limits| load_model_within(&made.path(), &limits);
    let error = load(Limits { nodes: 100, ..Limits::default() }).unwrap_err().to_string();
    assert!(error.contains("101 nodes") && error.contains("the maximum is 100"), "{error}");
    let error = load(Limits { triangles: 0, ..Limits::default() }).unwrap_err().to_string();
    assert!(error.contains("1 triangles") && error.contains("the maximum is 0"), "{error}");
    assert!(load(Limits::default()).is_ok());
}

/// A folder with a model in a subfolder, and a file outside it.
fn nested(model: &str, text: impl AsRef<[u8]>) -> (TempDir, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    std::fs::create_dir(place.path().join("model")).unwrap();
    std::fs::write(place.path().join("secret.png"), black(4)).unwrap();
    std::fs::write(place.path().join("secret.mtl"), "newmtl a\nKd 1 0 0\n").unwrap();
    let path = place.path().join("model").join(model);
    std::fs::write(&path, text).unwrap();
    (place, path)
}

fn warned(loaded: &Loaded, name: &str) -> bool {
    loaded.warnings.iter().any(|(what, _)| what.contains(name) && what.contains("--allow-outside"))
}

fn reads_outside(path: &Path, name: &str) {
    let kept = load_model(path).unwrap();
    assert!(warned(&kept, name) && kept.files.is_empty(), "{:?}", kept.warnings);
    assert!(kept.scene.textures().is_empty() && !kept.missing_files.is_empty());
    let allowed = load_model_within(path, &Limits { allow_outside: true, ..Limits::default() }).unwrap();
    assert!(!warned(&allowed, name) && !allowed.files.is_empty(), "{:?}", allowed.warnings);
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n";

#[test]
fn libraries_and_maps_outside_are_not_read() {
    let (_place, path) = nested("a.obj", format!("mtllib ../secret.mtl\n{OBJ}"));
    reads_outside(&path, "secret.mtl");
    for name in ["../secret.png", "..\\secret.png"] {
        let (_place, path) = nested("a.obj", format!("mtllib a.mtl\n{OBJ}"));
        std::fs::write(path.with_extension("mtl"), format!("newmtl a\nmap_Kd {name}\n")).unwrap();
        let kept = load_model(&path).unwrap();
        assert!(warned(&kept, "secret.png") && kept.scene.textures().is_empty(), "{:?}", kept.warnings);
        let limits = Limits { allow_outside: true, ..Limits::default() };
        assert_eq!(load_model_within(&path, &limits).unwrap().scene.textures().len(), 1);
    }
}

#[test]
fn absolute_names_are_not_followed_out_of_the_folder() {
    let (place, path) = nested("a.obj", "");
    let secret = place.path().join("secret.mtl");
    std::fs::write(&path, format!("mtllib {}\n{OBJ}", secret.display())).unwrap();
    reads_outside(&path, "secret.mtl");
}

#[test]
fn textures_of_ply_outside_are_not_read() {
    let header = "ply\nformat ascii 1.0\ncomment TextureFile ../secret.png\nelement vertex 3\n\
        property float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let (_place, path) = nested("a.ply", format!("{header}0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"));
    reads_outside(&path, "secret.png");
}

#[test]
fn buffers_and_images_outside_are_not_read() {
    let rest = with_images(&["../secret.png".to_owned()]);
    let (_place, path) = nested("a.gltf", triangle().text(&rest));
    let kept = load_model(&path).unwrap();
    assert!(warned(&kept, "secret.png") && kept.scene.textures().is_empty(), "{:?}", kept.warnings);
    let whole = triangle().text(&one_primitive(r#""POSITION":0"#, ""));
    let start = whole.find("data:").unwrap();
    let end = start + whole[start..].find('"').unwrap();
    for name in ["../buffer.bin", "%2E%2E/buffer.bin"] {
        let text = format!("{}{name}{}", &whole[..start], &whole[end..]);
        let (place, path) = nested("a.gltf", text);
        std::fs::write(place.path().join("buffer.bin"), triangle().bytes).unwrap();
        let error = load_model(&path).unwrap_err().to_string();
        assert!(error.contains("buffer.bin") && error.contains("--allow-outside"), "{error}");
        let limits = Limits { allow_outside: true, ..Limits::default() };
        assert!(load_model_within(&path, &limits).is_ok());
    }
}

#[cfg(unix)]
#[test]
fn links_that_leave_the_folder_are_not_followed() {
    let (place, path) = nested("a.obj", format!("mtllib a.mtl\n{OBJ}"));
    std::os::unix::fs::symlink(place.path().join("secret.mtl"), path.with_extension("mtl")).unwrap();
    reads_outside(&path, "a.mtl");
}
