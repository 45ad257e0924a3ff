//! Options as JSON: files of them state what a program sets.

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{from_str, json, to_string, to_value};
use std::fmt::Debug;
use std::sync::Arc;
use taotie::asset::{BakeOptions, Baker, Figure, Packing, Requirement, Scan, ScanOptions, VerifyOptions};
use taotie::comparison::diff::{self, DiffOptions, Metric};
use taotie::comparison::{ComparisonOptions, Matching, Method, SamplePoints};
use taotie::inspection::{Check, CheckStatus};
use taotie::studio::{
    CameraOptions, EnvironmentOptions, LightForm, LightOptions, LightSpec, MapOptions, MaterialFactors,
    MaterialOptions,
};
use taotie::{Limits, Mesh, Progress};
use taotie_engine::bake::MapKind;
use taotie_engine::compare::NormalEncoding;
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::image::{Image, Wrap};
use taotie_engine::length::Unit;
use taotie_engine::math::{Mat4, SimdLevel, Vec3};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{ConversionOptions, MapContent, Storage};
use taotie_engine::render::{
    EnvironmentLight, GrazingNormals, Lighting, NormalMapping, ReferenceSettings, RenderSettings,
    SurfaceSettings,
};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, NormalSpace, Projection};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::surface::{SurfaceMethod, TangentMethod};

/// Asserts that a value is read back as written. Numbers are printed in full, so that equal text means an equal
/// value.
fn assert_survives<T: Debug + Serialize + DeserializeOwned>(value: &T) {
    let json = to_string(value).unwrap();
    let read: T = from_str(&json).unwrap();
    assert_eq!(format!("{read:?}"), format!("{value:?}"), "{json}");
}

/// Asserts that the defaults survive, and that they replace omitted options.
fn assert_options<T: Default + Debug + Serialize + DeserializeOwned>() {
    assert_survives(&T::default());
    let empty: T = from_str("{}").unwrap();
    assert_eq!(format!("{empty:?}"), format!("{:?}", T::default()));
}

/// Asserts that values have the same names in JSON as everywhere else.
fn assert_names<T: Named + Debug + Serialize + DeserializeOwned>() {
    for (name, value) in T::NAMES {
        assert_eq!(to_value(value).unwrap(), json!(name));
        assert_survives(value);
    }
}

#[test]
fn all_options_survive_json() {
    assert_options::<BakeOptions>();
    assert_options::<ScanOptions>();
    assert_options::<VerifyOptions>();
    assert_options::<Packing>();
    assert_options::<Limits>();
    assert_options::<ComparisonOptions>();
    assert_options::<DiffOptions>();
    assert_options::<ConversionOptions>();
    assert_options::<CameraOptions>();
    assert_options::<MaterialFactors>();
    assert_options::<EnvironmentOptions>();
    assert_options::<LightOptions>();
    assert_options::<MapOptions>();
    assert_options::<MaterialOptions>();
    assert_options::<Lighting>();
    assert_options::<SurfaceSettings>();
    assert_options::<RenderSettings>();
    assert_options::<ReferenceSettings>();
    assert_options::<Development>();
}

#[test]
fn the_size_of_maps_may_be_chosen() {
    let options: BakeOptions = from_str("{\"size\": \"auto\"}").unwrap();
    assert_eq!(
        (options.size, &to_value(&options).unwrap()["size"]),
        (BakeOptions::AUTO_SIZE, &json!("auto"))
    );
    assert_eq!(to_value(BakeOptions::default()).unwrap()["size"], 2048);
    let error = from_str::<BakeOptions>("{\"size\": \"large\"}").unwrap_err().to_string();
    assert!(error.contains("expected a number of texels, or \"auto\""), "{error}");
}

#[test]
fn values_have_one_name() {
    assert_names::<MapKind>();
    assert_names::<Metric>();
    assert_names::<Matching>();
    assert_names::<Shading>();
    assert_names::<Energy>();
    assert_names::<SurfaceMethod>();
    assert_names::<TangentMethod>();
    assert_names::<GrazingNormals>();
    assert_names::<NormalMapping>();
    assert_names::<ToneCurve>();
    assert_names::<SimdLevel>();
    assert_names::<Check>();
    assert_names::<CheckStatus>();
    assert_names::<Unit>();
}

fn light(kind: LightKind) -> Light {
    Light { name: "a lamp".into(), kind, color: Vec3::new(3.0, 2.5, 2.0), falloff: Falloff::Windowed(4.0) }
}

#[test]
fn what_is_not_the_default_survives_too() {
    let [position, direction] = [Vec3::new(0.5, 2.0, -1.0), Vec3::new(0.0, -1.0, 0.0)];
    let lights = vec![
        light(LightKind::Point { position }),
        light(LightKind::Directional { direction }),
        light(LightKind::Spot { position, direction, inner: 0.25, outer: 0.5 }),
    ];
    let projections = [
        Projection::Perspective { fov_y: 0.5, aspect: Some(1.5), near: 0.1, far: None },
        Projection::Orthographic { half_width: 2.0, half_height: 1.0, near: 0.0, far: 9.0 },
    ];
    for projection in projections {
        let world_from_view = Mat4::translation(Vec3::new(1.0, 2.0, 3.5));
        assert_survives(&ComparisonOptions {
            methods: vec![Method { surface: SurfaceMethod::Bump, factor: Some(5.0) }],
            points: SamplePoints::Pixels(vec![[3, 4]]),
            camera: Some(Camera { name: "front".into(), world_from_view, projection }),
            lighting: Some(Lighting { lights: lights.clone(), ..Lighting::default() }),
            ..ComparisonOptions::default()
        });
    }
    let encoding = diff::Encoding::Normals(NormalEncoding::Signed);
    assert_survives(&DiffOptions { metric: Some(Metric::Angle), encoding, ..DiffOptions::default() });
    assert_survives(&ConversionOptions {
        border: Wrap::Mirror,
        bits: Some(8),
        ..ConversionOptions::default()
    });
    assert_survives(&[MapContent::Heights, MapContent::Normals(NormalSpace::Object)]);
    assert_survives(&Storage { bits: 16, dither: true });
}

#[test]
fn light_of_an_image_is_refused() {
    let environment = Arc::new(Environment::new(Image::new(2, 1, [1.0; 4]).unwrap()).unwrap());
    let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: true };
    let lighting = Lighting { environment: Some(light), ..Lighting::default() };
    let error = to_string(&lighting).unwrap_err().to_string();
    assert!(error.contains("EnvironmentOptions"), "{error}");
    assert!(from_str::<Lighting>(r#"{"environment":{"rotation":1}}"#).is_err());
    assert!(from_str::<Lighting>(r#"{"environment":null}"#).unwrap().environment.is_none());
}

#[test]
fn lights_survive_json() {
    let form = LightForm::FromView { azimuth: 0.5, elevation: 0.25 };
    let lamp: LightSpec = "point at=1,2,3 strength=2".parse().unwrap();
    assert_survives(&LightSpec { form, ..lamp });
    assert_survives(&lamp);
}

#[test]
fn channels_need_their_maps() {
    let scan = Scan::from_mesh(Mesh::sphere(1.0, 24, 12), Progress::SILENT).unwrap();
    let options = BakeOptions { triangles: 100, size: 64, ..BakeOptions::default() };
    let asset = Baker::new(options).bake(scan, Progress::SILENT).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let refused = |channels: &[&str]| {
        let channels = channels.iter().map(|text| text.parse().unwrap()).collect();
        let packing = Packing { channels, ..Packing::default() };
        asset.write(folder.path().join("a.glb"), &packing, Progress::SILENT).unwrap_err().to_string()
    };
    assert!(refused(&["R=ao,G=0,B=0"]).contains("ao is not baked; add it to the maps"));
    assert!(refused(&["x:R=world-normal.r,G=0,B=0"]).contains("world-normal is not baked"));
    assert!(refused(&["a:R=0,G=0,B=0", "A:R=1,G=1,B=1"]).contains("named A"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is written");
}

/// `docs/bake.md` defines the named sets of requirements, and lists every figure.
#[test]
fn the_page_defines_all_requirements() {
    let page = include_str!("../../../docs/bake.md");
    let row = |start: &str| {
        let line = page.lines().find(|line| line.starts_with(start)).expect(start);
        line.split('|').map(|cell| cell.trim().trim_matches('`')).collect::<Vec<_>>()
    };
    for (name, set) in
        [("standard", Requirement::standard()), ("visually-lossless", Requirement::visually_lossless())]
    {
        let cells = row(&format!("| `{name}` |"));
        let (always, mut of_colors) =
            (Requirement::read(cells[2]).unwrap(), Requirement::read(cells[3]).unwrap());
        of_colors.iter_mut().for_each(|requirement| requirement.if_compared = true);
        assert_eq!([always, of_colors].concat(), set, "{name}");
    }
    let rows = page.lines().skip_while(|line| !line.starts_with("| figure | unit")).skip(2);
    let names: Vec<&str> = rows
        .take_while(|line| line.starts_with("| `"))
        .flat_map(|line| line.split('|').nth(1).unwrap_or("").split(','))
        .map(|name| name.trim().trim_matches('`'))
        .collect();
    let figures = names.iter().map(|name| {
        let limit = if *name == "texel" { "50um" } else { "1" };
        format!("{name}={limit}").parse::<Requirement>().expect(name).figure
    });
    let listed: Vec<Figure> = figures.collect();
    let missing: Vec<&str> =
        Figure::NAMES.iter().filter(|(_, figure)| !listed.contains(figure)).map(|(name, _)| *name).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
