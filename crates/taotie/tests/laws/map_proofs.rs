//! The errors that a proof states for packed channels and for occlusion inside a model: small for the files as written,
//! and as large as the fault for files that were changed afterwards.

use crate::pairs::{ball, mesh};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie::asset::{Asset, BakeOptions, Baker, MeshSource, Packing, Scan, VerifyOptions, WrittenAsset};
use taotie_engine::Progress;
use taotie_engine::bake::MapKind;
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::math::scalar;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{Material, Scene};

const SIDE: usize = 128;

/// A ball with deep bumps and colours, of rough metal.
fn scan() -> Scan {
    let wave = |x: f64| scalar::sin(x * std::f64::consts::TAU);
    let mut data = ball([192, 96], |u, v| 0.1 * wave(7.0 * u) * wave(5.0 * v));
    data.colors = data.positions.iter().map(|p| [p.x * 0.3 + 0.4, 0.5, 0.2, 1.0]).collect();
    let material = Material { metallic: 0.7, roughness: 0.3, ..Material::default() };
    Scan::from_scene(Scene::of_mesh(mesh(data), material).unwrap(), Progress::SILENT).unwrap()
}

fn options(maps: &[MapKind]) -> BakeOptions {
    BakeOptions {
        low: Some(MeshSource::Mesh(Arc::new(Mesh::sphere(1.0, 64, 32)))),
        size: SIDE as u32,
        ao_rays: 64,
        maps: maps.to_vec(),
        ..BakeOptions::default()
    }
}

fn baked(scan: &Scan, options: BakeOptions) -> Asset {
    Baker::new(options).bake(scan, Progress::SILENT).unwrap()
}

/// Returns the mean error and the unit of each measured map, by its title.
fn errors(written: &WrittenAsset, scan: &Scan) -> BTreeMap<String, (f64, String)> {
    let options = VerifyOptions { points: 100, map: 0, view: 16, ..VerifyOptions::default() };
    let proof = written.verify(scan, &options, Progress::SILENT).unwrap();
    let found = proof.maps.iter().filter_map(|note| {
        let error = note.error.as_ref()?;
        Some((note.title(), (error.summary.mean, error.unit.clone())))
    });
    found.collect()
}

/// Returns a texel of a picture, given all of them and its index.
type Texel<'a> = &'a dyn Fn(&[[u16; 4]], usize) -> [u16; 4];

/// Replaces the texels of a written picture of 16 bits.
fn repaint(path: &Path, texel: Texel<'_>) {
    let bitmap = taotie_io::read_bitmap(path).unwrap();
    let Texels::U16(all) = bitmap.texels() else { panic!("16 bits") };
    let texels = Texels::U16((0..all.len()).map(|i| texel(all, i)).collect());
    let changed = Bitmap::new(bitmap.width(), bitmap.height(), bitmap.channels(), texels).unwrap();
    std::fs::write(path, taotie_io::encode_png_bitmap(&changed, Encoding::Linear).unwrap()).unwrap();
}

/// A folder with a scan's asset, and its packed texture.
struct Made {
    scan: Scan,
    written: WrittenAsset,
    packed: PathBuf,
    folder: tempfile::TempDir,
}

fn made(name: &str, packing: &Packing) -> Made {
    use MapKind::{Albedo, Height, Normal, Occlusion, Position, Roughness};
    let (scan, folder) = (scan(), tempfile::tempdir().unwrap());
    let asset = baked(&scan, options(&[Normal, Occlusion, Albedo, Roughness, Height, Position]));
    let written = asset.write(folder.path().join(name), packing, Progress::SILENT).unwrap();
    let packed = folder.path().join("out.dirt.png");
    Made { scan, written, packed, folder }
}

fn packing(channels: &[&str]) -> Packing {
    let channels = channels.iter().map(|text| text.parse().unwrap()).collect();
    Packing { channels, ..Packing::default() }
}

const DIRT: &str = "dirt:R=1-ao,G=height,B=position.g,A=normal.g";

#[test]
fn packed_channels_are_compared_with_what_they_hold() {
    let channels = ["orm", DIRT, "tint:R=1-albedo.r,G=0.5,B=metallic"];
    for name in ["out.glb", "out.png"] {
        let Made { scan, written, folder: _folder, .. } = made(name, &packing(&channels));
        let found = errors(&written, &scan);
        let own = |title: &str| {
            let (mean, unit) = found.get(title).unwrap_or_else(|| panic!("no {title} in {found:?}"));
            println!("{name}: {title} {mean:.5} {unit}");
            *mean
        };
        let alike = |a: f64, b: f64| (a - b).abs() < 2e-5;
        let occlusion = own("ao");
        assert!(occlusion < 0.01 && alike(own("orm R (ao)"), occlusion), "{found:?}");
        assert!(alike(own("dirt R (1-ao)"), occlusion) && alike(own("dirt G (height)"), own("height")));
        assert!(own("dirt B (position.g)") < own("position"));
        assert!(own("dirt A (normal.g)") < 0.03 && own("orm G (roughness)") < 0.05);
        assert!(own("orm B (metallic)") < 0.002 && own("tint R (1-albedo.r)") < 0.005);
        assert_eq!(found["dirt G (height)"].1, "model units");
        let unproved = taotie::asset::Report::of(&written).unwrap().bake.unwrap().unproved_maps;
        assert!(unproved.contains(&"dirt A (normal.g)".to_owned()), "before the proof: {unproved:?}");
    }
}

#[test]
fn green_down_and_object_space_change_no_error() {
    let found = |packing: Packing, space| {
        let scan = scan();
        let maps = [MapKind::Normal, MapKind::Bent, MapKind::Bevel];
        let asset = baked(&scan, BakeOptions { space, ..options(&maps) });
        let folder = tempfile::tempdir().unwrap();
        let written = asset.write(folder.path().join("out.png"), &packing, Progress::SILENT).unwrap();
        errors(&written, &scan)
    };
    let way = || packing(&["way:R=normal.g,G=1-normal.g,B=bent.g"]);
    let down = Packing { green: taotie_engine::scene::GreenChannel::Down, ..way() };
    use taotie_engine::scene::NormalSpace::{Object, Tangent};
    let (up, down, object) = (found(way(), Tangent), found(down, Tangent), found(way(), Object));
    for (title, (mean, unit)) in &up {
        println!(
            "{title}: {mean:.5} {}, down {:.5}, object space {:.5}",
            unit, down[title].0, object[title].0
        );
        assert!((mean - down[title].0).abs() < 1e-3, "{title}");
        assert!((0.2..3.0).contains(&(object[title].0 / mean)), "{title}");
    }
    assert!(
        up["way R (normal.g)"].0 < 0.03
            && (up["way R (normal.g)"].0 - up["way G (1-normal.g)"].0).abs() < 1e-3
    );
}

/// Each fault of a packed texture must multiply the error of the channels that it concerns.
#[test]
fn packed_channels_that_were_changed_are_found() {
    let Made { scan, written, packed, folder: _folder } = made("out.glb", &packing(&[DIRT]));
    let original = std::fs::read(&packed).unwrap();
    let before = errors(&written, &scan);
    let titles = ["dirt R (1-ao)", "dirt G (height)", "dirt B (position.g)", "dirt A (normal.g)"];
    let grown = |what: &str, texel: Texel<'_>| {
        std::fs::write(&packed, &original).unwrap();
        repaint(&packed, texel);
        let after = errors(&written, &scan);
        let ratios = titles.map(|title| after[title].0 / before[title].0);
        println!("{what}: {ratios:.1?}");
        ratios
    };
    assert_eq!(grown("as it was", &|all, i| all[i]), [1.0; 4]);
    let [ao, height, position, normal] = grown("swapped", &|all, i| {
        let [r, g, b, a] = all[i];
        [g, r, b, a]
    });
    assert!(ao > 10.0 && height > 10.0 && position == 1.0 && normal == 1.0);
    let [ao, height, position, normal] = grown("inverted", &|all, i| {
        let [r, g, b, a] = all[i];
        [65535 - r, g, b, 65535 - a]
    });
    assert!(ao > 10.0 && height == 1.0 && position == 1.0 && normal > 5.0);
    let moved = grown("moved by four texels", &|all, i| {
        let (x, y) = (i % SIDE, i / SIDE);
        all[y * SIDE + (x + 4) % SIDE]
    });
    // The height along the axis does not change around it; the height of the bumps does.
    assert!(moved[0] > 3.0 && moved[1] > 3.0 && moved[3] > 3.0, "{moved:?}");
    let moved = grown("moved by four rows", &|all, i| all[(i + 4 * SIDE) % all.len()]);
    assert!(moved.iter().all(|ratio| *ratio > 2.5), "{moved:?}");
    let white = grown("white", &|_, _| [65535; 4]);
    assert!(white.iter().all(|ratio| *ratio > 5.0), "{white:?}");
}

#[test]
fn occlusion_inside_a_model_is_that_of_its_file() {
    let scan = scan();
    let folder = tempfile::tempdir().unwrap();
    let write = |options: BakeOptions, name: &str, packing: &Packing| {
        baked(&scan, options).write(folder.path().join(name), packing, Progress::SILENT).unwrap()
    };
    let maps = [MapKind::Normal, MapKind::Occlusion];
    let mean = |written: &WrittenAsset| errors(written, &scan)["ao"].0;
    let written = write(options(&maps), "out.glb", &Packing::default());
    let own = mean(&written);
    let separate = mean(&write(options(&maps), "separate.png", &Packing::default()));
    println!("in the model {own:.5}, as a file {separate:.5}");
    assert!(own < 0.01 && (own - separate).abs() < 1e-5, "the same codes, by the same measurement");
    // The loss of the format counts: WebP of low quality.
    let packed = Packing { images: "webp:90/webp/webp:20".parse().unwrap(), ..Packing::default() };
    let lossy = mean(&write(options(&maps), "lossy.glb", &packed));
    assert!(lossy > own + 1e-4, "{lossy}");
    // Nothing occludes at this distance, so the map is white.
    write(BakeOptions { ao_distance: Some(1e-4), ..options(&maps) }, "white.glb", &Packing::default());
    std::fs::copy(folder.path().join("white.glb"), folder.path().join("out.glb")).unwrap();
    let white = mean(&written);
    // And without any texture, a viewer shows the same.
    write(options(&[MapKind::Normal]), "none.glb", &Packing::default());
    std::fs::copy(folder.path().join("none.glb"), folder.path().join("out.glb")).unwrap();
    let none = mean(&written);
    println!("white {white:.5}, none {none:.5}");
    assert!(white > 10.0 * own && (white - none).abs() < 0.002);
}
