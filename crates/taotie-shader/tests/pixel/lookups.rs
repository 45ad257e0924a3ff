//! The formulas of fetched values match the library bit for bit.

use crate::random::Random;
use taotie_engine::math::{Lane, Vec3};
use taotie_engine::pixel::{
    Cone, Falloff, Frame, LightSource, Place, Turn, coat_normal, height_derivative, height_step, log2_texels,
    turned_uv,
};
use taotie_engine::scene::Material;
use taotie_engine::shade::dfg::between_entries;
use taotie_engine::shade::environment::{
    LevelPosition, PicturePosition, bilinear, linear, octahedral_place, octahedral_taps, picture_uv,
    share_of_smoothest,
};
use taotie_engine::shade::fresnel::f_schlick_f90;
use taotie_shader::{Kind, PixelProgram, Variant, VariantOptions, evaluate};

const NAMES: [&str; 17] = [
    "mixed",
    "fresnel_schlick",
    "towards_viewer",
    "log2_texels",
    "between_entries",
    "height_derivative",
    "turned",
    "height_step",
    "bilinear",
    "to_environment",
    "octahedral_place",
    "octahedral_taps",
    "level_position",
    "share_of_smoothest",
    "picture_position",
    "incidence_without_falloff",
    "incidence_with_falloff",
];

fn v<L: Lane>(x: &[L], at: usize) -> Vec3<L> {
    Vec3::new(x[at], x[at + 1], x[at + 2])
}

fn flat<L: Lane, const N: usize>(vectors: [Vec3<L>; N]) -> Vec<L> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

/// The result of the library's own function.
fn direct<L: Lane>(name: &str, x: &[L]) -> Vec<L> {
    match name {
        "mixed" => flat([linear(v(x, 0), v(x, 3), x[6])]),
        "fresnel_schlick" => {
            let f = f_schlick_f90(v(x, 0), Vec3::splat(x[3]), x[4]);
            flat([f.map(|channel| channel.clamp(0.0, 1.0))])
        }
        "towards_viewer" => {
            let frame = Frame { n: v(x, 0), smooth: v(x, 3), v: v(x, 6) };
            flat([coat_normal(v(x, 0), &frame)])
        }
        "log2_texels" => vec![log2_texels([x[0], x[1]], [x[2], x[3]], [x[4], x[5]])],
        "between_entries" => vec![between_entries([x[0], x[1], x[2], x[3]], [x[4], x[5]])],
        "height_derivative" => vec![height_derivative(x[0], x[1], x[2])],
        "turned" => vec![turned_uv([[x[0], x[1]]; 2], [x[2], x[3]])[0]],
        "height_step" => vec![height_step(x[0], x[1])],
        "bilinear" => flat([bilinear([v(x, 0), v(x, 3), v(x, 6), v(x, 9)], [x[12], x[13]])]),
        "to_environment" => flat([Turn { sin: x[0], cos: x[1] }.to_environment(v(x, 2))]),
        "octahedral_place" => octahedral_place(v(x, 0)).to_vec(),
        "octahedral_taps" => {
            let (first, share) = octahedral_taps(x[0], x[1]);
            vec![first, share]
        }
        "level_position" => {
            let LevelPosition { below, share } = LevelPosition::of(x[0]);
            vec![below, share]
        }
        "share_of_smoothest" => vec![share_of_smoothest(x[0], x[1])],
        "picture_position" => {
            let at = PicturePosition::of(picture_uv(x[0], x[1]), [x[2], x[3]]);
            vec![at.left, at.right, at.top, at.bottom, at.across, at.down]
        }
        name => incidence(name, x),
    }
}

fn incidence<L: Lane>(name: &str, x: &[L]) -> Vec<L> {
    let windowed = name == "incidence_with_falloff";
    // The parameters in the order in which they were recorded.
    let (range, x) = if windowed { (Falloff::Windowed(x[0]), &x[1..]) } else { (Falloff::None, x) };
    let cone = Cone { axis: v(x, 0), cos_inner: x[3], cos_outer: x[4] };
    let light = LightSource { color: v(x, 5), place: Place::At(v(x, 8)), falloff: range, cone: Some(cone) };
    let incidence = light.incidence(v(x, 11));
    flat([incidence.l, incidence.irradiance])
}

#[test]
fn lookups_have_the_bits_of_the_library() {
    let options = VariantOptions { environment: true, ..VariantOptions::default() };
    let pixel = PixelProgram::new(&Variant::new(&Material::default(), &options));
    let (program, mut random) = (pixel.program(), Random(37));
    for name in NAMES {
        let formula = program.find(name).unwrap_or_else(|| panic!("{name} is missing"));
        let count = |kind| if kind == Kind::Vector { 3 } else { 1 };
        let all = formula.graph.parameters().iter().map(|parameter| count(parameter.kind)).sum();
        for _ in 0..200 {
            let x: Vec<f64> = (0..all).map(|_| 0.01 + 0.98 * random.next()).collect();
            let found = evaluate(&formula.graph, program, &x).expect("the graph is sound");
            let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&found), bits(&direct(name, &x)), "{name} of {x:?}");
            let x: Vec<f32> = x.iter().map(|x| *x as f32).collect();
            let found = evaluate(&formula.graph, program, &x).expect("the graph is sound");
            let bits = |x: &[f32]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&found), bits(&direct(name, &x)), "{name} of {x:?}");
        }
    }
}

#[test]
fn a_light_without_range_or_cone_is_as_bright_as_one_that_has_none() {
    let options = VariantOptions::default();
    let pixel = PixelProgram::new(&Variant::new(&Material::default(), &options));
    let formula = pixel.program().find("incidence_with_falloff").expect("it exists");
    let position = Vec3::new(0.4, -1.0, 2.5);
    let light = LightSource {
        color: Vec3::new(3.0f32, 2.0, 1.0),
        place: Place::At(Vec3::new(-2.0, 4.0, 0.5)),
        falloff: Falloff::InverseSquare,
        cone: None,
    };
    let numbers = taotie_shader::light_numbers(&light);
    let at = |path: &str| match path {
        "light.place" => numbers[..3].to_vec(),
        "light.color" => numbers[4..7].to_vec(),
        "light.range" => vec![numbers[7]],
        "light.axis" => numbers[8..11].to_vec(),
        "light.cos_inner" => vec![numbers[11]],
        "light.cos_outer" => vec![numbers[12]],
        _ => position.to_array().to_vec(),
    };
    let x: Vec<f32> = formula.graph.parameters().iter().flat_map(|parameter| at(parameter.path)).collect();
    let found = evaluate(&formula.graph, pixel.program(), &x).expect("the graph is sound");
    let wanted = light.incidence(position);
    assert_eq!(found, flat([wanted.l, wanted.irradiance]));
}
