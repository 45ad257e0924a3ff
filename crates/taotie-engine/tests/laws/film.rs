//! Laws of every tone curve, of the encoding and of development, for all values.

use taotie_engine::film::{
    Developer, Development, ToneCurve, develop_pixel, develop8, develop8_into, develop16, round_to_codes,
    srgb_from_linear,
};
use taotie_engine::image::Image;
use taotie_engine::math::{SimdLevel, Vec3, srgb};
use taotie_engine::names::Named;

/// An increasing sequence from black to far beyond any light.
fn rising() -> impl Iterator<Item = f32> {
    std::iter::once(0.0).chain((0..4000).map(|i| f32::from_bits(0x3800_0000 + i * 0x1_1000)))
}

fn picture(width: u32, height: u32) -> Image {
    let mut image = Image::new(width, height, [0.0; 4]).unwrap();
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1u32 << 24) as f32
    };
    for pixel in image.pixels_mut() {
        let alpha = (random() * 1.5 - 0.25).clamp(0.0, 1.0);
        let light = random() * random() * 8.0;
        *pixel = [light * random() * alpha, light * random() * alpha, light * random() * alpha, alpha];
    }
    image
}

#[test]
fn greys_rise_from_black_to_at_most_one() {
    for (name, curve) in ToneCurve::NAMES.iter().copied() {
        let mut last = Vec3::splat(0.0);
        assert_eq!(curve.apply(last).to_array(), [0.0; 3], "{name}: black");
        for grey in rising() {
            let shown = curve.apply(Vec3::splat(grey));
            for (now, before) in shown.to_array().into_iter().zip(last.to_array()) {
                // Rounding and, for AgX, the polynomial's own flat end.
                assert!(now >= before - 2e-6, "{name}: {grey} gives {now}, less than {before}");
                assert!((0.0..=1.0).contains(&now), "{name}: {grey} gives {now}");
            }
            last = shown;
        }
        assert!(last.x > 0.9, "{name}: the brightest light is shown as {last:?}");
    }
}

#[test]
fn nonsense_stays_in_range() {
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, f32::MAX, f32::MIN_POSITIVE, 1e-45];
    for (name, curve) in ToneCurve::NAMES.iter().copied() {
        for (a, b) in odd.into_iter().flat_map(|a| odd.map(|b| (a, b))) {
            let shown = curve.apply(Vec3::new(a, b, 0.5));
            assert!(
                shown.to_array().iter().all(|v| (0.0..=1.0).contains(v)),
                "{name}: {a}, {b} give {shown:?}"
            );
            let pixel = develop_pixel([a, b, 0.5, b], 1.0, curve, None);
            assert!(pixel.iter().all(|v| (0.0..=1.0).contains(v)), "{name}: {a}, {b} give {pixel:?}");
        }
    }
}

#[test]
fn neutral_leaves_moderate_saturated_colours_alone() {
    for color in [[0.0, 0.3, 0.76], [0.5, 0.0, 0.2], [0.0, 0.0, 0.1], [0.7, 0.75, 0.0]] {
        let color = Vec3::from_array(color);
        assert_eq!(ToneCurve::Neutral.apply(color), color);
    }
}

#[test]
fn neutral_takes_four_hundredths_off_greys_up_to_its_start() {
    for grey in [0.08f32, 0.18, 0.5, 0.79] {
        let shown = ToneCurve::Neutral.apply(Vec3::splat(grey)).x;
        assert!((shown - (grey - 0.04)).abs() < 1e-7, "{grey}: {shown}");
    }
    let toe = ToneCurve::Neutral.apply(Vec3::splat(0.04f32)).x;
    assert!((toe - 6.25 * 0.04 * 0.04).abs() < 1e-7, "{toe}");
}

#[test]
fn neutral_has_no_jump_where_compression_starts() {
    let below = ToneCurve::Neutral.apply(Vec3::new(0.759_999f32, 0.3, 0.0));
    let above = ToneCurve::Neutral.apply(Vec3::new(0.760_001f32, 0.3, 0.0));
    assert!((below - above).length() < 1e-5, "{below:?}, {above:?}");
}

#[test]
fn neutral_keeps_the_order_of_channels() {
    for scale in rising().step_by(40) {
        let shown = ToneCurve::Neutral.apply(Vec3::new(scale, scale * 0.6, scale * 0.2));
        assert!(shown.x >= shown.y && shown.y >= shown.z, "{scale}: {shown:?}");
    }
}

#[test]
fn encoding_is_close() {
    let worst = (0..=1_000_000).fold(0.0f64, |worst, i| {
        let linear = i as f32 / 1e6;
        let truth = srgb::srgb_from_linear(f64::from(linear));
        worst.max((f64::from(srgb_from_linear(linear)) - truth).abs())
    });
    println!(
        "encoding: {worst:e}, {:.1e} of an 8-bit code, {:.1e} of a 16-bit one",
        worst * 255.0,
        worst * 65535.0
    );
    assert!(worst < 3e-7, "{worst:e}");
}

#[test]
fn codes_come_back_from_their_light() {
    let mut image = Image::new(256, 1, [0.0; 4]).unwrap();
    for (code, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let linear = srgb::linear_from_srgb(code as f64 / 255.0) as f32;
        *pixel = [linear, linear, linear, 1.0];
    }
    let development = Development { tone: ToneCurve::Linear, ..Development::default() };
    for (code, pixel) in develop8(&image, &development).unwrap().into_iter().enumerate() {
        assert_eq!(pixel, [code as u8, code as u8, code as u8, 255]);
    }
    for (code, pixel) in develop16(&image, &development).unwrap().into_iter().enumerate() {
        assert_eq!(pixel[0], code as u16 * 257);
    }
}

#[test]
fn every_level_gives_the_same_bits() {
    // A width that leaves a remainder after packs of eight and after bands.
    let image = picture(1031, 7);
    for (name, tone) in ToneCurve::NAMES.iter().copied() {
        for background in [None, Some(Vec3::new(0.2, 0.5, 0.9))] {
            let at = |simd| Development { exposure_stops: 0.7, tone, background, simd };
            let expected = develop16(&image, &at(SimdLevel::Scalar)).unwrap();
            let narrow = develop8(&image, &at(SimdLevel::Scalar)).unwrap();
            for level in SimdLevel::available() {
                assert!(develop16(&image, &at(level)).unwrap() == expected, "{name} at {}", level.name());
                assert!(develop8(&image, &at(level)).unwrap() == narrow, "{name} at {}", level.name());
            }
        }
    }
}

/// Runs that are wholly transparent, wholly opaque, and mixed, on both sides of where curves bend.
fn covered_in_part() -> Image {
    let mut image = picture(640, 4);
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let [r, g, b, a] = *pixel;
        *pixel = match i / 100 % 4 {
            0 => [r, g, b, 0.0],
            1 => [r * 0.05, g * 0.05, b * 0.05, 1.0],
            2 => [r, g, b, a.max(1.0)],
            _ => [r, g, b, a],
        };
    }
    image
}

#[test]
fn pictures_have_the_codes_of_their_pixels() {
    let image = covered_in_part();
    for (name, tone) in ToneCurve::NAMES.iter().copied() {
        for background in [None, Some(Vec3::new(0.2, 0.5, 0.9))] {
            let development = Development { tone, background, ..Development::default() };
            let (narrow, wide) = (develop8(&image, &development), develop16(&image, &development));
            let (narrow, wide) = (narrow.unwrap(), wide.unwrap());
            for (i, pixel) in image.pixels().iter().enumerate() {
                let value = develop_pixel(*pixel, 1.0, tone, background);
                assert_eq!(narrow[i], value.map(|v| round_to_codes(v, 255.0) as u8), "{name}: {pixel:?}");
                assert_eq!(wide[i], value.map(|v| round_to_codes(v, 65535.0) as u16), "{name}: {pixel:?}");
            }
        }
    }
}

#[test]
fn pieces_make_the_whole() {
    let image = covered_in_part();
    let development = Development::default();
    let whole = develop8(&image, &development).unwrap();
    let developer = Developer::new(&development).unwrap();
    for size in [1, 7, 63, 64, 65, 640] {
        let mut out = vec![[9; 4]; whole.len()];
        for (out, pixels) in out.chunks_mut(size).zip(image.pixels().chunks(size)) {
            developer.codes8(pixels, out);
        }
        assert!(out == whole, "pieces of {size}");
    }
    let mut longer = vec![[9; 4]; 5];
    developer.codes8(&image.pixels()[..3], &mut longer);
    assert_eq!((&longer[..3], &longer[3..]), (&whole[..3], &[[9; 4]; 2][..]));
    let error = develop8_into(&image, &development, &mut longer).unwrap_err().to_string();
    assert!(error.contains("5 pixels; the image has 2560"), "{error}");
}

#[test]
fn exposure_is_in_stops() {
    let image = Image::new(3, 1, [0.1, 0.05, 0.02, 1.0]).unwrap();
    let brighter = Image::new(3, 1, [0.4, 0.2, 0.08, 1.0]).unwrap();
    let two_stops = Development { exposure_stops: 2.0, ..Development::default() };
    assert_eq!(
        develop16(&image, &two_stops).unwrap(),
        develop16(&brighter, &Development::default()).unwrap()
    );
}

#[test]
fn transparency_is_kept_straight_or_laid_over_the_background() {
    let half = Image::new(1, 1, [0.25, 0.0, 0.0, 0.5]).unwrap();
    let linear = Development { tone: ToneCurve::Linear, ..Development::default() };
    assert_eq!(develop8(&half, &linear).unwrap(), [[188, 0, 0, 128]]);
    let over = Development { background: Some(Vec3::new(0.0, 0.0, 1.0)), ..linear };
    assert_eq!(develop8(&half, &over).unwrap(), [[137, 0, 188, 255]]);
    let nothing = Image::new(1, 1, [0.0; 4]).unwrap();
    assert_eq!(develop8(&nothing, &linear).unwrap(), [[0, 0, 0, 0]]);
    let white =
        Development { background: Some(Vec3::splat(1.0)), exposure_stops: -5.0, ..Development::default() };
    assert_eq!(develop8(&nothing, &white).unwrap(), [[255; 4]]);
}

#[test]
fn what_is_out_of_range_is_named() {
    let image = Image::new(1, 1, [0.0; 4]).unwrap();
    for exposure_stops in [f32::NAN, 1e9, -61.0] {
        let error = develop8(&image, &Development { exposure_stops, ..Development::default() }).unwrap_err();
        assert!(error.to_string().contains("exposure"), "{error}");
    }
    let bright = Development { background: Some(Vec3::splat(2.0)), ..Development::default() };
    assert!(develop16(&image, &bright).unwrap_err().to_string().contains("background"));
    assert!(ToneCurve::from_name("filmic").unwrap_err().to_string().contains("neutral, linear"));
    for (name, curve) in ToneCurve::NAMES.iter().copied() {
        assert_eq!(ToneCurve::from_name(name).unwrap().name(), curve.name());
    }
}
