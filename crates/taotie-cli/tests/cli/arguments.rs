//! Refused arguments: their messages, and that nothing is written.

use super::models::{TRIANGLE, gltf};
use super::place::Place;
use snapbox::data::Inline;
use snapbox::str;

/// Runs a line in `place` that must be refused with `stderr`, and checks that no file was created or removed.
fn refused(place: &Place, line: &str, stderr: Inline) {
    let before = place.files();
    place.taotie(line).assert().code(2).stdout_eq("").stderr_eq(stderr);
    assert_eq!(place.files(), before, "{line}");
}

/// Like [`refused`], next to a valid model `a.obj`.
fn refused_beside_a_model(line: &str, stderr: Inline) {
    refused(&Place::with("a.obj", TRIANGLE), line, stderr);
}

#[test]
fn unknown_shading() {
    refused_beside_a_model(
        "render a.obj -o a.png --shading gxx",
        str![[r#"
error: invalid value 'gxx' for '--shading <SHADING>': unknown shading model `gxx`: expected one of: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, cook-torrance-printed, blinn-phong-printed, ggx-printed

For more information, try '--help'.

"#]],
    );
}

#[test]
fn unknown_surface() {
    refused_beside_a_model(
        "render a.obj -o a.png --surface rough",
        str![[r#"
error: invalid value 'rough' for '--surface <SURFACE>': unknown surface method `rough`: expected one of: facet, smooth, bump, bump-printed, object-normal, tangent-normal

For more information, try '--help'.

"#]],
    );
}

#[test]
fn unknown_preset() {
    refused_beside_a_model(
        "render a.obj -o a.png --material unobtainium",
        str![[r#"
taotie: error: --material unobtainium: no such preset; use a .toml file or one of: guo-wang-2025, bronze, bronze-patina, copper, cu85zn15, brass, gold, silver, clay, plaster, marble

"#]],
    );
}

#[test]
fn unknown_key_of_a_material_file() {
    let place = Place::with("a.obj", TRIANGLE);
    place.write("m.toml", "roughness = 0.5\nshinyness = 3\n");
    refused(
        &place,
        "render a.obj -o a.png --material m.toml",
        str![[r#"
taotie: error: m.toml: line 2: unknown field `shinyness`, expected one of `preset`, `base_color`, `alpha`, `metallic`, `roughness`, `f0`, `f82`, `ambient`, `diffuse`, `specular`, `shininess`, `slope`, `emissive`, `alpha_mode`, `alpha_cutoff`, `double_sided`, `unlit`, `maps`

"#]],
    );
}

#[test]
fn paths_without_the_integrator_that_follows_them() {
    refused_beside_a_model(
        "render a.obj -o a.png --spp 16",
        str![[r#"
taotie: error: --spp: the rasteriser traces no paths; add --integrator reference or leave it out

"#]],
    );
    refused_beside_a_model(
        "render a.obj -o a.png --integrator raster --bounces 2",
        str![[r#"
taotie: error: --bounces: the rasteriser traces no paths; add --integrator reference or leave it out

"#]],
    );
    refused_beside_a_model(
        "render a.obj -o a.png --seed 2",
        str![[r#"
taotie: error: --seed: the rasteriser traces no paths; add --integrator reference or leave it out

"#]],
    );
}

#[test]
fn a_way_of_normal_mapping_that_the_rasteriser_lacks() {
    refused_beside_a_model(
        "render a.obj -o a.png --normal-mapping microfacet",
        str![[r#"
taotie: error: --normal-mapping: the rasteriser traces no paths; add --integrator reference or leave it out

"#]],
    );
    refused_beside_a_model(
        "render a.obj -o a.png --integrator reference --normal-mapping deep",
        str![[r#"
error: invalid value 'deep' for '--normal-mapping <HOW>': unknown normal mapping mode `deep`: expected one of: classic, microfacet

For more information, try '--help'.

"#]],
    );
}

#[test]
fn samples_with_the_integrator_that_follows_paths() {
    refused_beside_a_model(
        "render a.obj -o a.png --integrator reference --samples 4",
        str![[r#"
taotie: error: --samples: --integrator reference takes the number of paths per pixel from --spp N

"#]],
    );
}

#[test]
fn an_absurd_number_of_paths() {
    refused_beside_a_model(
        "render a.obj -o a.png --integrator reference --spp 100000",
        str![[r#"
error: invalid value '100000' for '--spp <N>': 100000 is not in 1..=65536

For more information, try '--help'.

"#]],
    );
}

#[test]
fn unknown_camera() {
    refused_beside_a_model(
        "render a.obj -o a.png --camera front",
        str![[r#"
taotie: error: --camera front: the file has no camera; use --orbit

"#]],
    );
}

#[test]
fn a_size_that_is_none() {
    refused_beside_a_model(
        "render a.obj -o a.png --size huge",
        str![[r#"
error: invalid value 'huge' for '--size <N|WxH>': expected WIDTHxHEIGHT, such as 1920x1080, or one number for both

For more information, try '--help'.

"#]],
    );
}

#[test]
fn an_empty_size() {
    refused_beside_a_model(
        "render a.obj -o a.png --size 0x10",
        str![[r#"
error: invalid value '0x10' for '--size <N|WxH>': size 0x10: both sides must be at least 1, such as 1024x1024

For more information, try '--help'.

"#]],
    );
}

#[test]
fn an_absurd_size() {
    refused_beside_a_model(
        "render a.obj -o a.png --size 100000x100000",
        str![[r#"
error: invalid value '100000x100000' for '--size <N|WxH>': an image of 100000x100000 is too large: at most 16384x16384

For more information, try '--help'.

"#]],
    );
}

#[test]
fn unknown_samples() {
    refused_beside_a_model(
        "render a.obj -o a.png --samples 5",
        str![[r#"
taotie: error: 5 samples per pixel: expected 1, 4 or 16

"#]],
    );
}

#[test]
fn unknown_light() {
    let place = Place::with("a.obj", TRIANGLE);
    let arguments = ["render", "a.obj", "-o", "a.png", "--light", "sun from=0,0"];
    place.taotie_with(&arguments).assert().code(2).stdout_eq("").stderr_eq(str![[r#"
taotie: error: --light "sun from=0,0": unknown light `sun`; expected point, spot or directional

"#]]);
    assert_eq!(place.files(), ["a.obj"]);
}

#[test]
fn unknown_background() {
    refused_beside_a_model(
        "render a.obj -o a.png --background mauve-ish",
        str![[r#"
taotie: error: --background: `mauve-ish` is not a colour; use a CSS colour such as #d0c8b0 or a linear grey such as 0.5

"#]],
    );
}

#[test]
fn unknown_picture_format() {
    refused_beside_a_model(
        "render a.obj -o a.bmp",
        str![[r#"
taotie: error: a.bmp: pictures are written as .png or .exr, animations as .png or .gif

"#]],
    );
}

#[test]
fn unknown_output_variable() {
    refused_beside_a_model(
        "render a.obj -o a.png --aov normals,curvature",
        str![[r#"
taotie: error: --aov curvature: unknown output variable; expected one of: normals, depth, albedo, uv, triangle, position

"#]],
    );
}

#[test]
fn unknown_simd_level() {
    refused_beside_a_model(
        "render a.obj -o a.png --simd mmx",
        str![[r#"
error: invalid value 'mmx' for '--simd <SIMD>': unknown SIMD level `mmx`: expected one of: auto, scalar, sse2, avx2, avx512, neon, simd128

For more information, try '--help'.

"#]],
    );
}

#[test]
fn no_threads() {
    refused_beside_a_model(
        "render a.obj -o a.png --threads 0",
        str![[r#"
error: invalid value '0' for '--threads <N>': at least one thread is needed; leave it out for all of the machine's

For more information, try '--help'.

"#]],
    );
}

#[test]
fn no_angle_of_view() {
    refused_beside_a_model(
        "render a.obj -o a.png --fov-deg 180",
        str![[r#"
taotie: error: --fov-deg 180: the angle must be between 0 and 180 degrees

"#]],
    );
}

#[test]
fn unknown_subcommand() {
    refused_beside_a_model(
        "paint a.obj",
        str![[r#"
error: unrecognized subcommand 'paint'

Usage: taotie [OPTIONS] <COMMAND>

For more information, try '--help'.

"#]],
    );
}

#[test]
fn a_model_that_is_not_there() {
    refused(
        &Place::new(),
        "render none.glb -o a.png",
        str![[r#"
taotie: error: none.glb: [..] (os error 2)

"#]],
    );
    refused(
        &Place::new(),
        "inspect none.glb",
        str![[r#"
taotie: error: none.glb: [..] (os error 2)

"#]],
    );
}

#[test]
fn a_model_of_an_unknown_format() {
    refused(
        &Place::with("a.usd", "PXR-USDC"),
        "render a.usd -o a.png",
        str![[r#"
taotie: error: a.usd: the file extension 'usd' is not supported: use .gltf, .glb, .obj, .ply, .stl or .fbx

"#]],
    );
}

#[test]
fn a_model_that_is_a_folder() {
    let place = Place::new();
    std::fs::create_dir(place.path("a.obj")).unwrap();
    refused(
        &place,
        "render a.obj -o a.png",
        str![[r#"
taotie: error: a.obj: not a regular file

"#]],
    );
}

#[test]
fn a_normal_map_that_is_not_there() {
    refused_beside_a_model(
        "render a.obj -o a.png --normal-map none.png",
        str![[r#"
taotie: error: none.png: [..] (os error 2)

"#]],
    );
}

#[test]
fn an_empty_mesh() {
    refused(
        &Place::with("a.obj", ""),
        "render a.obj -o a.png",
        str![[r#"
taotie: error: a.obj: whole file: no faces (0 vertices); export triangles or polygons

"#]],
    );
    refused(
        &Place::with("a.gltf", gltf(&[], &[])),
        "render a.gltf -o a.png",
        str![[r#"
taotie: error: a.gltf: scene: nothing to draw: no node shows a triangle

"#]],
    );
}

const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

#[test]
fn an_index_out_of_range() {
    refused(
        &Place::with("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
        "render a.obj -o a.png",
        str![[r#"
taotie: error: a.obj: line 3: vertex index 9 is out of range: the count is 2; fix the file

"#]],
    );
    refused(
        &Place::with("a.gltf", gltf(&CORNERS, &[0, 1, 9])),
        "render a.gltf -o a.png",
        str![[r#"
taotie: error: a.gltf: mesh 0, primitive 0: indices: index 2 refers to vertex 9, but there are only 3

"#]],
    );
}

#[test]
fn a_position_that_is_nan() {
    refused(
        &Place::with("a.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
        "render a.obj -o a.png",
        str![[r#"
taotie: error: a.obj: line 2: vertex position '1 nan 0' is infinite or NaN; fix the file

"#]],
    );
    let mut corners = CORNERS;
    corners[1][2] = f32::NAN;
    refused(
        &Place::with("a.gltf", gltf(&corners, &[0, 1, 2])),
        "render a.gltf -o a.png",
        str![[r#"
taotie: error: a.gltf: mesh 0, primitive 0: POSITION: vertex 1 is infinite or NaN

"#]],
    );
}

#[test]
fn a_model_in_one_point() {
    let place = Place::with("a.gltf", gltf(&[[0.5; 3]; 3], &[0, 1, 2]));
    refused(
        &place,
        "render a.gltf -o a.png",
        str![[r#"
taotie: error: a.gltf: all its triangles are at one point; there is nothing to see

"#]],
    );
}

#[test]
fn an_output_folder_that_is_not_there() {
    refused_beside_a_model(
        "render a.obj -o no/such/a.png",
        str![[r#"
taotie: error: no/such: the folder does not exist; create it first

"#]],
    );
}

#[test]
fn an_output_that_is_a_folder() {
    let place = Place::with("a.obj", TRIANGLE);
    std::fs::create_dir(place.path("a.png")).unwrap();
    refused(
        &place,
        "render a.obj -o a.png --size 8x8",
        str![[r#"
taotie: error: a.png: expected a file, found a folder

"#]],
    );
}

#[test]
fn diff_of_other_sizes() {
    let place = Place::new();
    super::models::write_ball(&place.path("ball.png"));
    place.write("one.tga", [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 32, 1, 2, 3]);
    refused(
        &place,
        "diff ball.png one.tga",
        str![[r#"
taotie: error: ball.png is 192x192, one.tga is 1x1: images must have the same size; resample one of them

"#]],
    );
    refused(
        &place,
        "diff one.tga one.tga --metric angle",
        str![[r#"
taotie: error: one.tga: it does not look like a normal map; if it is one, specify --encoding unit or signed

"#]],
    );
    refused(
        &place,
        "diff one.tga one.tga --metric ssim",
        str![[r#"
taotie: error: pictures of 1x1: SSIM uses windows of 11x11 pixels; both sides must be at least that large

"#]],
    );
    refused(
        &place,
        "diff one.tga one.tga --encoding unit",
        str![[r#"
taotie: error: no texel holds a normal in both files; there is nothing to compare

"#]],
    );
}

#[test]
fn diff_with_options_that_contradict() {
    let place = Place::new();
    refused(
        &place,
        "diff a.png b.png --metric angle --encoding color",
        str![[r#"
taotie: error: --metric angle compares normals, but --encoding color specifies colours

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --metric flip --encoding unit",
        str![[r#"
taotie: error: --metric flip compares colours, but --encoding specifies normals

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --threshold 1",
        str![[r#"
error: the following required arguments were not provided:
  --metric <METRIC>

Usage: taotie diff --metric <METRIC> --threshold <X> <A> <B>

For more information, try '--help'.

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --heat heat.jpg",
        str![[r#"
taotie: error: heat.jpg: heat maps are written as .png

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --heat none/heat.png",
        str![[r#"
taotie: error: none: the folder does not exist; create it first

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --heat heat.png --heat-top 0",
        str![[r#"
taotie: error: --heat-top: the top of the scale must be above 0

"#]],
    );
    refused(
        &place,
        "diff a.png b.png --threads 0",
        str![[r#"
error: invalid value '0' for '--threads <N>': at least one thread is needed; leave it out for all of the machine's

For more information, try '--help'.

"#]],
    );
    refused(
        &place,
        "diff a.png b.png",
        str![[r#"
taotie: error: a.png: No such file or directory (os error 2)

"#]],
    );
}

#[test]
fn negative_numbers_are_values_of_any_option() {
    let place = Place::with("a.obj", TRIANGLE);
    for (line, words) in [
        ("bake a.obj -o b.glb --error -1", "--error"),
        ("photometric a.lp -o b --pixel-size -1", "--pixel-size"),
    ] {
        let assert = place.taotie(line).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words) && !said.contains("unexpected argument"), "{line}: {said}");
    }
}

#[test]
fn empty_files_are_called_empty() {
    let place = Place::with("a.glb", "");
    place.write("b.png", "");
    for line in ["inspect a.glb", "render a.glb -o c.png", "diff b.png b.png"] {
        let assert = place.taotie(line).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains("empty"), "{line}: {said}");
    }
}
