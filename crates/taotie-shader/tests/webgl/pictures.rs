//! The same scene rendered by WebGL and by the renderer, for all models and methods.

use crate::node::Node;
use crate::studio::{SIDE, camera, clip_from_world, eye, lighting, patch, texture};
use crate::variants::{Case, everything, mapped, rich, shadings};
use serde_json::{Map, Value, json};
use std::path::Path;
use taotie_engine::image::Texture;
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::pixel::{LightSource, Turn};
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, SurfaceSettings, render};
use taotie_engine::scene::{Instance, Material, Scene, SceneData};
use taotie_engine::shade::environment::{EnvironmentMaps, HalfPicture};
use taotie_engine::shade::{Shading, dfg};
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{
    FrameFactors, Language, MOST_LEVELS, MOST_LIGHTS, SurfaceFactors, VariantOptions, light_numbers,
    pixel_shader,
};

fn scene(material: &Material) -> Scene {
    let instance = Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY };
    let data = SceneData {
        meshes: vec![patch()],
        materials: vec![material.clone()],
        textures: vec![texture()],
        instances: vec![instance],
        ..SceneData::default()
    };
    Scene::new(data).expect("the scene is valid")
}

/// The options with everything enabled, on a material with every layer.
fn case(shading: Shading, method: SurfaceMethod) -> Case {
    let material = mapped(method, Material { double_sided: true, ..rich() });
    Case { name: format!("{shading:?}, {method:?}"), material, options: everything(shading, method) }
}

/// `ggx` by every method except a normal map in tangent space, and a mirror, which shows the environment's image.
fn methods() -> Vec<Case> {
    let others = SurfaceMethod::ALL.into_iter().filter(|method| *method != SurfaceMethod::TangentNormal);
    let mirror = Material { roughness: 0.03, metallic: 1.0, double_sided: true, ..Material::default() };
    let options = VariantOptions { specular_aa: false, ..everything(Shading::Ggx, SurfaceMethod::Smooth) };
    let mirror = Case { name: "mirror".into(), material: mirror, options };
    others.map(|method| case(Shading::Ggx, method)).chain([mirror]).collect()
}

/// The renderer's image.
fn rendered(case: &Case, lighting: &Lighting) -> Vec<[f32; 4]> {
    let settings = RenderSettings {
        width: SIDE,
        height: SIDE,
        samples: 1,
        shading: case.options.shading,
        surface: SurfaceSettings { method: Some(case.options.method), ..SurfaceSettings::default() },
        specular_aa: case.options.specular_aa,
        ..RenderSettings::default()
    };
    let camera = camera();
    let shot = Shot { camera: &camera, lighting, settings: &settings };
    render(&scene(&case.material), &shot).expect("it renders").color.pixels().to_vec()
}

/// The value of a half float that is neither negative nor infinite.
fn half(bits: u16) -> f32 {
    // 2¹¹²: the difference of the exponents' biases.
    f32::from_bits(u32::from(bits) << 13) * f32::from_bits((112 + 127) << 23)
}

/// An image of one level, and images stacked below one another.
fn stacked(pictures: &[HalfPicture<'_>]) -> Value {
    let width = pictures.iter().map(|picture| picture.width).max().unwrap_or_default();
    let mut texels = Vec::new();
    for picture in pictures {
        for row in picture.texels.chunks(picture.width) {
            texels.extend(row.iter().flat_map(|[r, g, b]| [half(*r), half(*g), half(*b), 1.0]));
            texels.extend(std::iter::repeat_n(0.0, 4 * (width - picture.width)));
        }
    }
    let height: usize = pictures.iter().map(|picture| picture.height).sum();
    json!({ "filtered": false, "levels": [{ "size": [width, height], "texels": texels }] })
}

/// The table of levels for stacked maps.
fn levels(maps: &EnvironmentMaps<'_>) -> Vec<u8> {
    let mut table = vec![[0.0f32; 4]; MOST_LEVELS];
    let mut top = 0;
    for (entry, map) in table.iter_mut().zip(&maps.levels) {
        *entry = [0.0, top as f32, (map.width - 2) as f32, map.factor];
        top += map.height;
    }
    table[MOST_LEVELS - 1][3] = maps.picture.factor;
    bytes(table.as_flattened())
}

fn bytes(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn mipmapped(texture: &Texture) -> Value {
    let level = |level: usize| {
        let (width, height) = texture.level_size(level);
        let texel = |i: u32| texture.texel(level, (i % width) as usize, (i / width) as usize);
        let texels: Vec<f32> = (0..width * height).flat_map(texel).collect();
        json!({ "size": [width, height], "texels": texels })
    };
    json!({ "filtered": true, "levels": (0..texture.levels()).map(level).collect::<Vec<_>>() })
}

fn vertices(mesh: &Mesh) -> Value {
    let column = |numbers: usize, data: Vec<f32>| json!({ "numbers": numbers, "data": data });
    let vectors = |values: &[Vec3]| column(3, values.iter().flat_map(|v| v.to_array()).collect());
    let uvs = |set: usize| column(2, mesh.uvs()[set].iter().flat_map(|uv| [uv.x, uv.y]).collect());
    json!({
        "position": vectors(mesh.positions()),
        "normal": vectors(mesh.normals()),
        "tangent": column(4, mesh.tangents().as_flattened().to_vec()),
        "uv0": uvs(0),
        "uv1": uvs(1),
        "color": column(4, mesh.colors().as_flattened().to_vec()),
    })
}

/// The blocks of the frame.
fn blocks(lighting: &Lighting, light: &EnvironmentLight, maps: &EnvironmentMaps<'_>) -> Map<String, Value> {
    let angle = light.rotation;
    let frame = FrameFactors {
        clip_from_world: clip_from_world(),
        eye: eye(),
        ambient: lighting.ambient,
        spacing: 1.0,
        turn: Turn { sin: scalar::sin(angle) as f32, cos: scalar::cos(angle) as f32 },
        intensity: light.intensity,
        levels: maps.levels.len(),
        smoothest_alpha: maps.smoothest_alpha,
        lights: lighting.lights.len(),
    };
    let mut numbers: Vec<f32> =
        lighting.lights.iter().flat_map(|light| light_numbers(&LightSource::new(light))).collect();
    numbers.resize(16 * MOST_LIGHTS, 0.0);
    let blocks =
        [("FrameBlock", frame.bytes()), ("LightBlock", bytes(&numbers)), ("EnvironmentBlock", levels(maps))];
    blocks.into_iter().map(|(name, bytes)| (name.to_owned(), json!(bytes))).collect()
}

fn shader(case: &Case) -> Value {
    let shader = pixel_shader(&case.variant(), Language::GlslEs);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from_array);
    // The height of the material, and the smaller factor of Guo and Wang 2025.
    let printed = case.options.method == SurfaceMethod::BumpPrinted;
    let surface = SurfaceFactors {
        material: &case.material,
        normal_matrix: axes,
        bump: if printed { 5.0 } else { 0.1 },
        height_levels: texture().levels(),
    };
    json!({
        "vertex": shader.vertex_text,
        "fragment": shader.text,
        "blocks": { "MaterialBlock": shader.interface.material_bytes(&surface) },
    })
}

fn described(cases: &[Case], lighting: &Lighting) -> Value {
    let light = lighting.environment.as_ref().expect("there is a sky");
    let maps = light.environment.maps();
    let texels: Vec<f32> = dfg::tables().into_iter().flatten().collect();
    let rows = dfg::tables().len() / dfg::COLUMNS;
    let tables = json!({ "filtered": false, "levels": [{ "size": [dfg::COLUMNS, rows], "texels": texels }] });
    let mesh = patch();
    json!({
        "size": [SIDE, SIDE],
        "vertices": vertices(&mesh),
        "triangles": mesh.triangles(),
        "blocks": blocks(lighting, light, &maps),
        "textures": {
            "map": mipmapped(&texture()),
            "albedo_tables": tables,
            "environment_maps": stacked(&maps.levels),
            "environment_picture": stacked(&[maps.picture]),
        },
        "shaders": cases.iter().map(shader).collect::<Vec<_>>(),
    })
}

/// The largest and the mean difference of two images at pixels that, with their neighbours, show the surface in both,
/// relative for values brighter than 0.01.
fn difference(ours: &[[f32; 4]], theirs: &[f32]) -> (f32, f32) {
    let side = SIDE as usize;
    let covered = |i: usize| ours[i][3] == 1.0 && theirs[4 * i + 3] == 1.0;
    let (mut largest, mut sum, mut count) = (0.0f32, 0.0, 0);
    for i in side + 1..side * (side - 1) - 1 {
        if ![i, i - 1, i + 1, i - side, i + side].into_iter().all(covered) {
            continue;
        }
        for channel in 0..3 {
            let (a, b) = (ours[i][channel], theirs[4 * i + channel]);
            let off = (a - b).abs() / a.abs().max(0.01);
            (largest, sum, count) = (largest.max(off), sum + off, count + 1);
        }
    }
    assert!(count > side * side, "the surface is visible");
    (largest, sum / count as f32)
}

/// Every n-th model.
fn models(step: usize) -> Vec<Case> {
    shadings().step_by(step).map(|shading| case(shading, SurfaceMethod::TangentNormal)).collect()
}

#[test]
fn webgl_shows_every_fifth_model_as_the_renderer() {
    draw("webgl-some-models", &models(5));
}

#[test]
#[ignore = "takes a minute"]
fn webgl_shows_every_model_as_the_renderer() {
    draw("webgl-models", &models(1));
}

#[test]
#[ignore = "takes half a minute"]
fn webgl_shows_every_method_as_the_renderer() {
    draw("webgl-methods", &methods());
}

/// Draws cases in Chromium, and fails if one differs from the renderer's image.
fn draw(folder: &str, cases: &[Case]) {
    let Some(node) = Node::find() else { return };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    let lighting = lighting();
    let scene = described(cases, &lighting).to_string();
    std::fs::write(folder.join("scene.json"), scene).expect("it is writable");
    node.run(&["shader_pictures.mjs"], &folder);
    let mut faults = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let text = std::fs::read_to_string(folder.join(format!("{number}.json"))).expect("it was drawn");
        let theirs: Vec<f32> = serde_json::from_str(&text).expect("it is an image");
        let (largest, mean) = difference(&rendered(case, &lighting), &theirs);
        println!("{}: largest {largest:.4}, mean {mean:.5}", case.name);
        if mean.is_nan() || mean > 1e-3 {
            faults.push(format!("{}: {mean}", case.name));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
