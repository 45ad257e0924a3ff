//! glTF: the choice among the images that extensions offer for a texture.

use crate::gltf;
use crate::gltf::{Maker, one_primitive, warned};
use taotie_engine::image::{Bitmap, Texels};
use taotie_io::{Loaded, read_bitmap};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/pictures");

fn own(name: &str) -> Vec<u8> {
    std::fs::read(format!("{FOLDER}/{name}")).unwrap()
}

fn bitmap(name: &str) -> Bitmap {
    read_bitmap(format!("{FOLDER}/{name}").as_ref()).unwrap()
}

/// A triangle whose base colour is `texture`; `images` are in buffer views.
fn with_texture(texture: &str, images: &[&[u8]], more: &str) -> Result<Loaded, String> {
    let mut maker = Maker::default();
    maker.floats(&gltf::TRIANGLE, "VEC3");
    maker.floats(&[0.0; 6], "VEC2");
    let views: Vec<usize> = images.iter().map(|bytes| maker.view(bytes, "")).collect();
    let images: Vec<String> =
        views.iter().map(|v| format!(r#"{{"bufferView":{v},"mimeType":"image/x"}}"#)).collect();
    maker.try_load(&format!(
        r#"{},"images":[{}],"textures":[{texture}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}]{more}"#,
        one_primitive(r#""POSITION":0,"TEXCOORD_0":1"#, r#","material":0"#),
        images.join(",")
    ))
}

/// The image of the base colour.
#[cfg(any(feature = "webp", feature = "basis"))]
fn shown(loaded: &Loaded) -> &Bitmap {
    loaded.scene.textures()[loaded.scene.materials()[0].base_color_texture.unwrap().texture].bitmap()
}

#[cfg(feature = "webp")]
const WEBP: &str = r#""extensions":{"EXT_texture_webp":{"source":1}}"#;

#[cfg(feature = "webp")]
#[test]
fn webp_goes_before_the_image_for_other_programs() {
    let images: [&[u8]; 2] = [&own("lossy.png"), &own("lossless.webp")];
    let both = with_texture(&format!(r#"{{"source":0,{WEBP}}}"#), &images, "").unwrap();
    assert_eq!(shown(&both), &bitmap("waves.png"));
    let required = r#","extensionsUsed":["EXT_texture_webp"],"extensionsRequired":["EXT_texture_webp"]"#;
    let only = with_texture(&format!("{{{WEBP}}}"), &images, required).unwrap();
    assert_eq!(shown(&only), &bitmap("waves.png"));
    assert!(both.warnings.is_empty() && only.warnings.is_empty());
}

#[cfg(feature = "basis")]
#[test]
fn basis_universal_goes_before_the_image_for_other_programs() {
    let images: [&[u8]; 2] = [&own("waves.png"), &own("uastc-alpha.ktx2")];
    let basisu = r#""extensions":{"KHR_texture_basisu":{"source":1}}"#;
    let both = with_texture(&format!(r#"{{"source":0,{basisu}}}"#), &images, "").unwrap();
    let required = r#","extensionsUsed":["KHR_texture_basisu"],"extensionsRequired":["KHR_texture_basisu"]"#;
    let only = with_texture(&format!("{{{basisu}}}"), &images, required).unwrap();
    for loaded in [&both, &only] {
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        assert_eq!(shown(loaded), &bitmap("uastc-alpha.png"));
    }
    let damaged: [&[u8]; 2] = [&own("waves.png"), &own("uastc-alpha.ktx2")[..200]];
    let loaded = with_texture(&format!(r#"{{"source":0,{basisu}}}"#), &damaged, "").unwrap();
    assert_eq!(shown(&loaded), &bitmap("waves.png"));
}

#[cfg(feature = "webp")]
#[test]
fn the_image_for_other_programs_stands_for_a_damaged_one() {
    let png = own("waves.png");
    let damaged = &own("lossless.webp")[..60];
    let loaded = with_texture(&format!(r#"{{"source":0,{WEBP}}}"#), &[&png, damaged], "").unwrap();
    assert_eq!(shown(&loaded), &bitmap("waves.png"));
    assert_eq!(
        (warned(&loaded, "skipped image 1"), warned(&loaded, "used image 0 instead of image 1")),
        (1, 1)
    );
    let nowhere = r#"{"source":0,"extensions":{"EXT_texture_webp":{"source":7}}}"#;
    assert_eq!(shown(&with_texture(nowhere, &[&png], "").unwrap()), &bitmap("waves.png"));
    let loaded = with_texture(&format!("{{{WEBP}}}"), &[&png, damaged], "").unwrap();
    assert!(loaded.scene.materials()[0].base_color_texture.is_none());
    assert_eq!(warned(&loaded, "skipped image 1"), 1);
}

#[test]
fn an_image_that_is_not_there_is_named() {
    for (texture, part) in [
        (r#"{"extensions":{"EXT_texture_webp":{"source":7}}}"#, "image 7"),
        (r#"{"extensions":{"XX_texture":{"source":0}}}"#, "has no image"),
        (r#"{"source":9}"#, "image 9"),
    ] {
        let loaded = with_texture(texture, &[&own("waves.png")], "").unwrap();
        assert_eq!(warned(&loaded, part), 1, "{texture}: {:?}", loaded.warnings);
    }
}

/// The texels of the fixture follow the formula in `data/README.md`.
#[test]
fn the_picture_is_what_its_formula_says() {
    let picture = bitmap("waves.png");
    let Texels::U8(texels) = picture.texels() else { panic!("8 bits") };
    for (i, [.., blue, alpha]) in texels.iter().enumerate() {
        let (x, y) = (i % 40, i / 40);
        assert_eq!(usize::from(*alpha), 255 - 5 * x);
        assert_eq!(*blue, if (x / 8 + y / 8) % 2 == 1 { 230 } else { 40 });
    }
}
