//! Laws of normal maps and bumps, and of guesses about a map from its pixels.

use crate::angle::angle;
use crate::common::absent;
use crate::files::data_files;
use crate::random::Random;

use std::path::Path;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::surface::*;

#[test]
fn a_flat_map_is_no_map() {
    let mut random = Random(1);
    let flat = decode_normal(Vec3::new(127.5 / 255.0, 127.5 / 255.0, 1.0), 1.0, 1.0);
    assert_eq!(flat, Vec3::new(0.0, 0.0, 1.0));
    for _ in 0..1000 {
        let n = random.unit() * (0.3 + random.next());
        let mapped = tangent_normal(n, random.vector(), 1.0, flat);
        assert!((mapped - n.normalize()).length() < 1e-15);
    }
    // The usual 8-bit flat value is not quite flat, since 127.5 is not a code.
    let usual = decode_normal(Vec3::new(128.0 / 255.0, 128.0 / 255.0, 1.0), 1.0, 1.0);
    let tilt = angle(usual, flat).to_degrees();
    assert!((tilt - 0.32).abs() < 0.005, "{tilt}");
}

#[test]
fn a_tilted_map_is_a_tilted_frame() {
    let mut random = Random(2);
    for _ in 0..1000 {
        let n = random.unit();
        let t = (random.vector() - n * 0.1).cross(n).normalize();
        let w = if random.next() < 0.5 { -1.0 } else { 1.0 };
        let b = n.cross(t) * w;
        let (tilt, turn) = (random.next() * 1.5, random.next() * std::f64::consts::TAU);
        let map = Vec3::new(
            scalar::sin(tilt) * scalar::cos(turn),
            scalar::sin(tilt) * scalar::sin(turn),
            scalar::cos(tilt),
        );
        let mapped = tangent_normal(n, t, w, map);
        assert!((mapped.length() - 1.0).abs() < 1e-12);
        assert!((angle(mapped, n) - tilt).abs() < 1e-7, "tilted by its angle");
        assert!((mapped.dot(t) - map.x).abs() < 1e-12 && (mapped.dot(b) - map.y).abs() < 1e-12);
    }
}

#[test]
fn tangent_space_has_a_true_inverse() {
    let mut random = Random(5);
    for _ in 0..2000 {
        // As interpolated between vertices: neither unit nor perpendicular.
        let n = random.unit() * (0.4 + random.next());
        let t = random.unit() * (0.4 + random.next());
        let w = if random.next() < 0.5 { -1.0 } else { 1.0 };
        let sine = n.normalize().cross(t.normalize()).length();
        if sine < 0.05 {
            continue;
        }
        let v = random.unit();
        let there = tangent_space_normal(n, t, w, v);
        assert!((there.length() - 1.0).abs() < 1e-12);
        assert!(angle(tangent_normal(n, t, w, there), v) < 1e-10, "{n:?} {t:?} {v:?}");
        let back = tangent_space_normal(n, t, w, tangent_normal(n, t, w, v));
        assert!(angle(back, v) < 1e-10);
    }
    let n = random.unit();
    assert_eq!(tangent_space_normal(n, n, 1.0, random.unit()), Vec3::new(0.0, 0.0, 1.0));
}

#[test]
fn relief_has_the_normal_of_the_displaced_surface() {
    // The ball (cos a cos b, sin b, −sin a cos b) raised by h(a, b); b points up, so a × b is outward.
    let ball = |a: f64, b: f64| {
        let (ca, sa) = (scalar::cos(a), scalar::sin(a));
        let (cb, sb) = (scalar::cos(b), scalar::sin(b));
        [
            Vec3::new(ca * cb, sb, -sa * cb),
            Vec3::new(-sa * cb, 0.0, -ca * cb),
            Vec3::new(-ca * sb, cb, sa * sb),
        ]
    };
    let mut random = Random(9);
    for _ in 0..1000 {
        let [p, by_a, by_b] = ball(random.next() * 6.0, random.next() * 2.4 - 1.2);
        let (radius, length) = (0.5 + random.next(), 0.3 + random.next());
        let relief =
            Relief { height: random.next() - 0.3, by_u: random.next() - 0.5, by_v: random.next() - 0.5 };
        // A point of the ball with its unit normal scaled, as interpolation does.
        let base = ReliefBase {
            n: p * length,
            dp: [by_a * radius, by_b * radius],
            dn: [by_a * length, by_b * length],
        };
        let across = by_a * (radius + relief.height) + p * relief.by_u;
        let up = by_b * (radius + relief.height) + p * relief.by_v;
        let expected = across.cross(up).normalize();
        assert!((relief_normal(base, relief) - expected).length() < 1e-12);
        // Mirrored and reversed parameters mean the same surface.
        let turned = ReliefBase { n: base.n, dp: [base.dp[1], base.dp[0]], dn: [base.dn[1], base.dn[0]] };
        let relief = Relief { height: relief.height, by_u: relief.by_v, by_v: relief.by_u };
        assert!((relief_normal(turned, relief) - expected).length() < 1e-12);
    }
}

#[test]
fn scale_and_green_work_on_x_and_y_alone() {
    let rgb = Vec3::new(0.75f32, 0.625, 0.875);
    let plain = decode_normal(rgb, 1.0, 1.0);
    assert_eq!(plain, Vec3::new(0.5, 0.25, 0.75));
    assert_eq!(decode_normal(rgb, 2.0, -1.0), Vec3::new(1.0, -0.5, 0.75));
    assert_eq!(decode_normal(rgb, 0.0, 1.0), Vec3::new(0.0, 0.0, 0.75));
    for blue in [0.5f32, 0.2, 0.0] {
        let z = decode_normal(Vec3::new(0.5, 0.5, blue), 1.0, 1.0).z;
        assert!(z > 0.0 && z < 1e-4, "{blue}: {z}");
    }
    assert_eq!(decode_object_normal(Vec3::new(0.5f32, 0.5, 0.0)).z, -1.0);
}

#[test]
fn decode_undoes_encode() {
    let mut random = Random(3);
    for _ in 0..2000 {
        let n = random.unit();
        for top in [255.0, 65535.0] {
            let stored = encode_normal(n).map(|c| (c * top).round() / top);
            let back = decode_object_normal(stored);
            let worst = (back - n).to_array().iter().fold(0.0f64, |w, d| w.max(d.abs()));
            assert!(worst <= 1.0 / top + 1e-12, "{worst}");
            if n.z > 0.01 {
                assert_eq!(decode_normal(stored, 1.0, 1.0), back);
            }
        }
        let up = Vec3::new(n.x, n.y, n.z.abs());
        assert!((rebuild_z(up.x, up.y) - up.z).abs() < 1e-12 / up.z.max(1e-6));
    }
    assert_eq!(rebuild_z(0.9f32, 0.9), 0.0);
}

#[test]
fn bump_of_a_ramp_is_the_tilted_plane() {
    let mut random = Random(4);
    for _ in 0..1000 {
        let (dp_du, dp_dv) = (random.vector(), random.vector());
        let n = dp_du.cross(dp_dv).normalize();
        let gradient = random.vector().cross(n) * 4.0;
        // A ramp whose height at p is gradient · p; the raised plane is spanned by its own derivatives.
        let (dh_du, dh_dv) = (gradient.dot(dp_du), gradient.dot(dp_dv));
        let raised = (dp_du + n * dh_du).cross(dp_dv + n * dh_dv).normalize();
        let found = surface_gradient(n, [dp_du, dp_dv], [dh_du, dh_dv]);
        assert!((found - gradient).length() < 1e-9);
        assert!((bump(n, found) - raised).length() < 1e-9);
        // Mirrored and reversed parameters mean the same relief.
        assert!((surface_gradient(n, [dp_dv, dp_du], [dh_dv, dh_du]) - gradient).length() < 1e-9);
    }
}

#[test]
fn bump_agrees_with_the_normal_map_of_the_same_height() {
    // u along x, v down the picture (−y), 3 model units per uv unit: slopes to map by n = (−∂h/∂x, −∂h/∂y, 1).
    let (n, t) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0));
    let (dp_du, dp_dv) = (Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, -3.0, 0.0));
    let mut random = Random(6);
    for _ in 0..1000 {
        let (u, v) = (random.next() * 9.0, random.next() * 9.0);
        // h = sin(u) cos(2 v)
        let (dh_du, dh_dv) =
            (scalar::cos(u) * scalar::cos(2.0 * v), -2.0 * scalar::sin(u) * scalar::sin(2.0 * v));
        let map = Vec3::new(-dh_du / 3.0, dh_dv / 3.0, 1.0).normalize();
        let mapped = tangent_normal(n, t, 1.0, decode_normal(encode_normal(map), 1.0, 1.0));
        let bumped = bump(n, surface_gradient(n, [dp_du, dp_dv], [dh_du, dh_dv]));
        assert!((mapped - bumped).length() < 1e-12);
    }
}

#[test]
fn an_object_map_turns_with_the_object() {
    let columns = [Vec3::new(0.0, 1.0, 0.0), Vec3::new(-1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 2.0)];
    assert_eq!(object_normal(Vec3::new(1.0, 0.0, 0.0), columns), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(object_normal(Vec3::new(0.0, 0.0, -1.0), columns), Vec3::new(0.0, 0.0, -1.0));
}

/// The normal map of a few round bumps, green up.
fn bumpy(side: u32) -> Bitmap {
    let texel = |i: u32| {
        let (x, y) = (f64::from(i % side) * 0.2, -f64::from(i / side) * 0.2);
        let slope = (0.4 * scalar::cos(x) * scalar::sin(y + 0.3 * x), 0.0);
        let dx = slope.0 + 0.12 * scalar::sin(x) * scalar::cos(y + 0.3 * x);
        let dy = 0.4 * scalar::sin(x) * scalar::cos(y + 0.3 * x);
        let n = encode_normal(Vec3::new(-dx, -dy, 1.0).normalize());
        let [r, g, b] = n.map(|c| (c * 255.0).round() as u8).to_array();
        [r, g, b, 255]
    };
    Bitmap::new(side, side, 3, Texels::U8((0..side * side).map(texel).collect())).unwrap()
}

/// Returns the same texels, each changed.
fn changed(bitmap: &Bitmap, change: impl Fn([u8; 4]) -> [u8; 4]) -> Bitmap {
    let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits") };
    let texels = texels.iter().map(|t| change(*t)).collect();
    Bitmap::new(bitmap.width(), bitmap.height(), 3, Texels::U8(texels)).unwrap()
}

fn green_down(bitmap: &Bitmap) -> Bitmap {
    changed(bitmap, |[r, g, b, a]| [r, 255 - g, b, a])
}

#[test]
fn the_curl_tells_green_up_from_down() {
    let up = bumpy(256);
    assert_eq!(is_normal_map(&up), NormalMapKind::Tangent);
    assert_eq!(invalid_texels(&up), 0);
    let guess = green_direction(&up);
    assert_eq!(guess.verdict, GreenVerdict::Up);
    assert!(guess.confidence > 0.97, "{}", guess.confidence);
    assert_eq!(green_direction(&green_down(&up)).verdict, GreenVerdict::Down);
    let flat = changed(&up, |_| [128, 128, 255, 255]);
    assert_eq!(is_normal_map(&flat), NormalMapKind::Tangent);
    assert_eq!(green_direction(&flat), GreenGuess { verdict: GreenVerdict::Unclear, confidence: 0.0 });
    let one = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 128, 255, 255]])).unwrap();
    assert_eq!(green_direction(&one).verdict, GreenVerdict::Unclear);
}

#[test]
fn an_object_space_map_and_a_photograph_are_told_apart() {
    let mut random = Random(9);
    let mut texels = |f: fn(&mut Random) -> Vec3<f64>| {
        let code = |c: f64| (c * 255.0).round() as u8;
        (0..4096).map(|_| f(&mut random)).map(|c| [code(c.x), code(c.y), code(c.z), 255]).collect()
    };
    let object = texels(|random| encode_normal(random.unit()));
    let noise = texels(|random| Vec3::new(random.next(), random.next(), random.next()));
    let bitmap = |texels| Bitmap::new(64, 64, 3, Texels::U8(texels)).unwrap();
    assert_eq!(is_normal_map(&bitmap(object)), NormalMapKind::Object);
    assert_eq!(is_normal_map(&bitmap(noise)), NormalMapKind::No);
    let codes = Texels::U8([[0, 0, 127, 255], [9, 9, 128, 255], [0; 4], [1, 1, 255, 255]].to_vec());
    assert_eq!(invalid_texels(&Bitmap::new(2, 2, 3, codes).unwrap()), 2);
    let codes =
        Texels::U8([[0, 128, 127, 255], [255, 128, 120, 255], [128, 248, 80, 255], [128; 4]].to_vec());
    assert_eq!(
        invalid_texels(&Bitmap::new(2, 2, 3, codes).unwrap()),
        1,
        "the first two are nearly in the surface"
    );
    let floats = Texels::F32(vec![[0.5, 0.5, 0.5, 1.0], [0.5, 0.5, f32::NAN, 1.0], [0.5, 0.5, 0.51, 1.0]]);
    assert_eq!(invalid_texels(&Bitmap::new(3, 1, 3, floats).unwrap()), 2);
}

fn load(path: &Path) -> Bitmap {
    let image = image::open(path).unwrap().to_rgba8();
    let (width, height) = image.dimensions();
    Bitmap::new(width, height, 4, Texels::U8(image.pixels().map(|p| p.0).collect())).unwrap()
}

/// Every normal map in the data is recognised as one, none is taken for green-down, flipping flips the verdict, and
/// no other texture is taken for a normal map.
#[test]
fn real_maps_are_known_for_what_they_are() {
    let (mut clear, mut maps) = (0, 0);
    for sub in [
        "threedscans-keijiro",
        "smithsonian-bronze-gong-textures",
        "khronos-gltf-sample-assets",
        "polyhaven-models",
    ] {
        for path in data_files(sub, &["png", "jpg"]) {
            if path.components().any(|c| c.as_os_str() == "screenshot") {
                continue;
            }
            let name = path.file_stem().unwrap().to_string_lossy().to_lowercase();
            let is_map =
                ["normals", "_normal", "normal map", "_nor_gl"].iter().any(|part| name.contains(part));
            let bitmap = load(&path);
            let expected = if is_map { NormalMapKind::Tangent } else { NormalMapKind::No };
            assert_eq!(is_normal_map(&bitmap), expected, "{}", path.display());
            if !is_map {
                continue;
            }
            let (guess, flipped) = (green_direction(&bitmap), green_direction(&green_down(&bitmap)));
            println!("{name}: {:?} {:.3}", guess.verdict, guess.confidence);
            assert_ne!(guess.verdict, GreenVerdict::Down, "{}", path.display());
            assert_ne!(flipped.verdict, GreenVerdict::Up, "{}, flipped", path.display());
            maps += 1;
            clear += usize::from(guess.verdict == GreenVerdict::Up && flipped.verdict == GreenVerdict::Down);
        }
    }
    if maps == 0 {
        return absent("no texture is named like a normal map");
    }
    assert!(clear * 10 >= maps * 8, "{clear} of {maps} clear");
}
