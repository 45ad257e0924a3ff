//! Formats whose feature is disabled give an error that names the feature; with the feature they are read.

use std::path::{Path, PathBuf};
use taotie_engine::{Error, Result};
use taotie_io::{decode_bitmap, load_model, read_bitmap};

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name)
}

fn assert_said<T>(what: &str, result: Result<T>, (feature, there): (&str, bool)) {
    match result {
        Ok(_) => assert!(there, "{what} is read without {feature}"),
        Err(Error::Unsupported { why, .. }) => {
            assert!(!there && why.contains(&format!("feature `{feature}`")), "{what}: {why}");
        }
        Err(error) => panic!("{what}: {error}"),
    }
}

#[test]
fn pictures_name_the_feature_that_reads_them() {
    let avif = ("avif", cfg!(feature = "avif"));
    let (webp, basis) = (("webp", cfg!(feature = "webp")), ("basis", cfg!(feature = "basis")));
    assert_said("AVIF", read_bitmap(&own("pictures/avif-444.avif")), avif);
    assert_said("WebP", read_bitmap(&own("pictures/lossless.webp")), webp);
    assert_said("KTX2", read_bitmap(&own("pictures/etc1s.ktx2")), basis);
}

#[test]
fn open_exr_names_its_feature() {
    let bytes = b"\x76\x2f\x31\x01\x02\0\0\0";
    let error = decode_bitmap(bytes, "a.exr", Path::new("a.exr")).unwrap_err();
    let named = error.to_string().contains("feature `exr`");
    assert_eq!(named, !cfg!(feature = "exr"), "{error}");
}

#[test]
fn required_extensions_name_their_feature() {
    let draco = ("draco", cfg!(feature = "draco"));
    assert_said("Draco", load_model(own("meshes/patch-draco-sequential.glb")), draco);
}

#[test]
fn fbx_names_its_feature() {
    assert_said("FBX", load_model(own("meshes/panel.fbx")), ("fbx", cfg!(feature = "fbx")));
}

/// Formats without a feature are read in every build.
#[test]
fn the_rest_is_read_always() {
    assert!(load_model(own("meshes/patch.glb")).is_ok());
    assert!(read_bitmap(&own("pictures/waves.png")).is_ok());
}
