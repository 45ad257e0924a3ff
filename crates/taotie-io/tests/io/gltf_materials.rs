//! glTF: the materials specified by extensions arrive in the scene.

use crate::gltf::{Maker, PIXEL, one_primitive, triangle, warned};
use taotie_engine::math::Vec2;
use taotie_engine::scene::{Material, Specular, TextureRef};
use taotie_io::Loaded;

const RED: &str = r#"{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}"#;
const GREEN: &str = r#"{"pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]}}"#;
const BLUE: &str = r#"{"pbrMetallicRoughness":{"baseColorFactor":[0,0,1,1]},
    "emissiveTexture":{"index":0,"texCoord":1}}"#;

/// Two nodes show a mesh whose first primitive is red, green or blue and whose second is always the default; a
/// third node shows another mesh. `mappings` are those of the first primitive.
fn with_variants(names: &str, mappings: &str) -> Loaded {
    let variants = format!(r#""extensions":{{"KHR_materials_variants":{{"mappings":[{mappings}]}}}}"#);
    triangle().load(&format!(
        r#""extensionsUsed":["KHR_materials_variants"],"extensionsRequired":["KHR_materials_variants"],
        "extensions":{{"KHR_materials_variants":{{"variants":[{names}]}}}},
        "nodes":[{{"mesh":0}},{{"mesh":0}},{{"mesh":1}}],"materials":[{RED},{GREEN},{BLUE}],
        "images":[{{"uri":"{PIXEL}"}}],"textures":[{{"source":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0,{variants}}},{{"attributes":{{"POSITION":0}}}}]}},
          {{"primitives":[{{"attributes":{{"POSITION":0}},"material":1}}]}}]"#
    ))
}

/// The base colours of all instances.
fn colors(loaded: &Loaded) -> Vec<[f32; 4]> {
    let scene = &loaded.scene;
    scene.instances().iter().map(|instance| scene.materials()[instance.material].base_color).collect()
}

const NAMES: &str = r#"{"name":"forest"},{"name":"sea"},{"name":"as it is"},{}"#;
const MAPPINGS: &str = r#"{"material":1,"variants":[0]},{"material":2,"variants":[1,3]}"#;

#[test]
fn variants_change_the_instances_that_they_map() {
    let mut loaded = with_variants(NAMES, MAPPINGS);
    assert_eq!(loaded.variants.names(), ["forest", "sea", "as it is", "3"]);
    let [red, green, blue, white] =
        [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0; 4]];
    let with = |first| [first, white, first, white, green];
    assert_eq!(colors(&loaded), with(red));
    for (name, first) in [("forest", green), ("sea", blue), ("as it is", red), ("3", blue), ("forest", green)]
    {
        loaded.variants.apply(name, &mut loaded.scene).unwrap();
        assert_eq!(colors(&loaded), with(first), "{name}");
    }
    // A variant's material uses a second uv set, so the mesh has it.
    let mesh = |i: usize| &loaded.scene.meshes()[loaded.scene.instances()[i].mesh];
    assert_eq!((mesh(0).uvs().len(), mesh(1).uvs().len()), (2, 0));
}

#[test]
fn an_unknown_variant_is_refused_with_the_names_of_all() {
    let mut loaded = with_variants(NAMES, MAPPINGS);
    let error = loaded.variants.apply("desert", &mut loaded.scene).unwrap_err().to_string();
    assert!(error.contains("'desert'") && error.contains("forest, sea, as it is, 3"), "{error}");
    let mut loaded = with_extensions("");
    let error = loaded.variants.apply("desert", &mut loaded.scene).unwrap_err().to_string();
    assert!(error.contains("no variants"), "{error}");
}

#[test]
fn mappings_to_what_is_not_there_are_left_out() {
    let mappings = r#"{"material":9,"variants":[0]},{"variants":[0]},{"material":2,"variants":[7,"x",1]},
        {"material":1,"variants":[1]},5"#;
    let mut loaded = with_variants(NAMES, mappings);
    for (part, count) in
        [("material 9", 1), ("missing material", 2), ("variant 7", 1), ("missing variant", 1)]
    {
        assert_eq!(warned(&loaded, part), count, "{part}: {:?}", loaded.warnings);
    }
    loaded.variants.apply("sea", &mut loaded.scene).unwrap();
    assert_eq!(colors(&loaded)[0], [0.0, 0.0, 1.0, 1.0], "the first of two materials is used");
}

/// A triangle with uvs whose only material has these extensions; textures 0 to 9 show one image.
fn with_extensions(extensions: &str) -> Loaded {
    let mut maker: Maker = triangle();
    maker.floats(&[0.0; 6], "VEC2");
    let textures = [r#"{"source":0}"#; 10].join(",");
    maker.load(&format!(
        r#"{},"images":[{{"uri":"{PIXEL}"}}],"textures":[{textures}],
        "materials":[{{"extensions":{{{extensions}}}}}]"#,
        one_primitive(r#""POSITION":0,"TEXCOORD_0":1"#, r#","material":0"#)
    ))
}

fn material(extensions: &str) -> Material {
    let loaded = with_extensions(extensions);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene.materials()[0].clone()
}

/// A texture slot with a transform that scales by `scale` and `scale` + 1.
fn slot(name: &str, scale: u32) -> String {
    let transform = format!(r#"{{"KHR_texture_transform":{{"scale":[{scale},{}]}}}}"#, scale + 1);
    format!(
        r#""{name}":{{"index":{scale},"texCoord":7,"extensions":{}}}"#,
        transform.replace("]}", r#"],"texCoord":0}"#)
    )
}

/// Asserts that a slot of [`slot`] was read completely.
fn assert_slot(texture: Option<TextureRef>, scale: f32) {
    let texture = texture.expect("the texture exists");
    assert_eq!(texture.transform.apply(Vec2::new(1.0, 1.0)), Vec2::new(scale, scale + 1.0));
    assert_eq!(texture.uv_set, 0);
}

#[test]
fn a_plain_material_has_no_layers() {
    let plain = material("");
    assert_eq!((plain.ior, plain.specular, plain.f0), (1.5, Specular::default(), None));
    assert!(plain.clearcoat.is_none() && plain.anisotropy.is_none() && plain.sheen.is_none());
}

#[test]
fn index_of_refraction_and_specular() {
    let textures = [slot("specularTexture", 1), slot("specularColorTexture", 2)].join(",");
    let read = material(&format!(
        r#""KHR_materials_ior":{{"ior":1.25}},
        "KHR_materials_specular":{{"specularFactor":0.5,"specularColorFactor":[1,0.25,3],{textures}}}"#
    ));
    // A product above 1 is limited by the renderer.
    assert_eq!((read.ior, read.specular.factor, read.specular.color), (1.25, 0.5, [1.0, 0.25, 3.0]));
    assert_slot(read.specular.factor_texture, 1.0);
    assert_slot(read.specular.color_texture, 2.0);
    assert_eq!(material(r#""KHR_materials_ior":{"ior":0}"#).ior, 0.0, "0 means total reflection");
    assert_eq!(material(r#""KHR_materials_ior":{}"#).ior, 1.5);
    assert_eq!(material(r#""KHR_materials_specular":{}"#).specular, Specular::default());
}

#[test]
fn clearcoat() {
    let textures = [
        slot("clearcoatTexture", 1),
        slot("clearcoatRoughnessTexture", 2),
        slot("clearcoatNormalTexture", 3).replace(r#""index":3"#, r#""index":3,"scale":0.5"#),
    ];
    let read = material(&format!(
        r#""KHR_materials_clearcoat":{{"clearcoatFactor":0.75,"clearcoatRoughnessFactor":0.25,{}}}"#,
        textures.join(",")
    ));
    let coat = read.clearcoat.unwrap();
    assert_eq!((coat.factor, coat.roughness), (0.75, 0.25));
    assert_slot(coat.factor_texture, 1.0);
    assert_slot(coat.roughness_texture, 2.0);
    let normal = coat.normal.unwrap();
    assert_slot(Some(normal.texture), 3.0);
    assert_eq!((normal.scale, read.normal), (0.5, None));
    let bare = material(r#""KHR_materials_clearcoat":{"clearcoatFactor":1}"#).clearcoat.unwrap();
    assert_eq!((bare.roughness, bare.normal, bare.factor_texture), (0.0, None, None));
}

#[test]
fn anisotropy() {
    let read = material(&format!(
        r#""KHR_materials_anisotropy":{{"anisotropyStrength":0.5,"anisotropyRotation":-1.5,{}}}"#,
        slot("anisotropyTexture", 4)
    ));
    let anisotropy = read.anisotropy.unwrap();
    assert_eq!((anisotropy.strength, anisotropy.rotation), (0.5, -1.5));
    assert_slot(anisotropy.texture, 4.0);
}

#[test]
fn sheen() {
    let textures = [slot("sheenColorTexture", 5), slot("sheenRoughnessTexture", 6)].join(",");
    let read = material(&format!(
        r#""KHR_materials_sheen":{{"sheenColorFactor":[0.5,0,1],"sheenRoughnessFactor":0.25,{textures}}}"#
    ));
    let sheen = read.sheen.unwrap();
    assert_eq!((sheen.color, sheen.roughness), ([0.5, 0.0, 1.0], 0.25));
    assert_slot(sheen.color_texture, 5.0);
    assert_slot(sheen.roughness_texture, 6.0);
}

/// The extensions' own rule: a factor of zero, which is the default, disables the layer.
#[test]
fn layers_that_are_switched_off_ask_for_no_texture() {
    let textures = [slot("clearcoatTexture", 1), slot("sheenColorTexture", 2), slot("anisotropyTexture", 3)];
    let [coat, sheen, anisotropy] = textures;
    let loaded = with_extensions(&format!(
        r#""KHR_materials_clearcoat":{{{coat}}},"KHR_materials_sheen":{{{sheen}}},
        "KHR_materials_anisotropy":{{"anisotropyRotation":1,{anisotropy}}}"#
    ));
    let read = &loaded.scene.materials()[0];
    assert!(read.clearcoat.is_none() && read.sheen.is_none() && read.anisotropy.is_none());
    assert!(loaded.scene.textures().is_empty());
}

#[test]
fn values_out_of_range_are_clamped_with_a_warning() {
    let loaded = with_extensions(
        r#""KHR_materials_ior":{"ior":0.5},
        "KHR_materials_specular":{"specularFactor":2,"specularColorFactor":[-1,1,1]},
        "KHR_materials_clearcoat":{"clearcoatFactor":3,"clearcoatRoughnessFactor":-1},
        "KHR_materials_anisotropy":{"anisotropyStrength":1.5,"anisotropyRotation":"x"},
        "KHR_materials_sheen":{"sheenColorFactor":[2,0,0],"sheenRoughnessFactor":[1]}"#,
    );
    let read = &loaded.scene.materials()[0];
    assert_eq!((read.ior, read.specular.factor, read.specular.color), (1.0, 1.0, [0.0, 1.0, 1.0]));
    let (coat, sheen) = (read.clearcoat.unwrap(), read.sheen.unwrap());
    assert_eq!((coat.factor, coat.roughness, sheen.color, sheen.roughness), (1.0, 0.0, [1.0, 0.0, 0.0], 0.0));
    let anisotropy = read.anisotropy.unwrap();
    assert_eq!((anisotropy.strength, anisotropy.rotation), (1.0, 0.0));
    for name in
        ["ior", "specularFactor", "specularColorFactor", "clearcoatFactor", "clearcoatRoughnessFactor"]
    {
        let start = format!("material 0: {name} ");
        let is_clamped = |what: &str| what.starts_with(&start) && what.ends_with("is out of range; clamped");
        let clamped = loaded.warnings.iter().filter(|(what, _)| is_clamped(what)).map(|(_, count)| count);
        assert_eq!(clamped.sum::<usize>(), 1, "{name}: {:?}", loaded.warnings);
    }
    for name in ["anisotropyRotation", "sheenRoughnessFactor"] {
        assert_eq!(warned(&loaded, &format!("material 0: malformed {name}")), 1, "{name}");
    }
}

#[test]
fn textures_that_cannot_be_had_are_left_out() {
    let loaded = with_extensions(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":99},"clearcoatNormalTexture":[]},
        "KHR_materials_sheen":{"sheenColorFactor":[1,1,1],"sheenColorTexture":{"index":1,"texCoord":9}}"#,
    );
    let read = &loaded.scene.materials()[0];
    let coat = read.clearcoat.unwrap();
    assert!(
        coat.factor_texture.is_none() && coat.normal.is_none() && read.sheen.unwrap().color_texture.is_none()
    );
    for part in ["texture 99", "malformed clearcoatNormalTexture", "uv set 9"] {
        assert_eq!(warned(&loaded, part), 1, "{part}: {:?}", loaded.warnings);
    }
}

/// A uv set used only by a layer is available to the renderer, and an image used only by layers is decoded once per
/// encoding.
#[test]
fn layers_count_as_uses_of_uv_sets_and_images() {
    let loaded = with_extensions(
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0,"texCoord":2},
          "clearcoatRoughnessTexture":{"index":1}},
        "KHR_materials_sheen":{"sheenColorFactor":[1,1,1],"sheenColorTexture":{"index":2}}"#,
    );
    assert_eq!(loaded.scene.meshes()[0].uvs().len(), 3);
    assert_eq!(loaded.scene.textures().len(), 2);
}

/// An unreadable image removes only its own uses, and the others keep their images.
#[test]
fn unreadable_images_go_from_every_slot() {
    let mut maker = triangle();
    maker.floats(&[0.0; 6], "VEC2");
    let slots = [
        r#""KHR_materials_specular":{"specularTexture":{"index":0},"specularColorTexture":{"index":1}}"#,
        r#""KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatTexture":{"index":0},
            "clearcoatRoughnessTexture":{"index":1},"clearcoatNormalTexture":{"index":0}}"#,
        r#""KHR_materials_anisotropy":{"anisotropyStrength":1,"anisotropyTexture":{"index":0}}"#,
        r#""KHR_materials_sheen":{"sheenColorFactor":[1,1,1],"sheenColorTexture":{"index":0},
            "sheenRoughnessTexture":{"index":1}}"#,
    ];
    let loaded = maker.load(&format!(
        r#"{},"images":[{{"uri":"gone.png"}},{{"uri":"{PIXEL}"}}],"textures":[{{"source":0}},{{"source":1}}],
        "materials":[{{"extensions":{{{}}}}}]"#,
        one_primitive(r#""POSITION":0,"TEXCOORD_0":1"#, r#","material":0"#),
        slots.join(",")
    ));
    let read = &loaded.scene.materials()[0];
    let (coat, sheen) = (read.clearcoat.unwrap(), read.sheen.unwrap());
    let gone = [read.specular.factor_texture, coat.factor_texture, sheen.color_texture];
    assert!(gone.iter().all(Option::is_none) && coat.normal.is_none());
    assert!(read.anisotropy.unwrap().texture.is_none());
    let linear = coat.roughness_texture.unwrap().texture;
    assert_eq!(sheen.roughness_texture.unwrap().texture, linear);
    assert_ne!(read.specular.color_texture.unwrap().texture, linear);
    assert_eq!((loaded.scene.textures().len(), read.textures().len()), (2, 3));
}
