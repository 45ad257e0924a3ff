//! Textures written to glTF with every packing read back; lossy ones differ within limits.

use crate::bumpy;
use basisu::{DecodeFlags, TargetFormat, Transcoder};
use taotie_engine::compare::angle_deg;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::Vec3;
use taotie_io::{
    GltfAsset, GltfFormat, GltfMaterial, ImageCodec, TextureCodecs, encode_glb, load_model, write_gltf,
};

/// The textures of a GLB with these maps, in the order colour, normals.
fn read_back(color: &Bitmap, normal: &Bitmap, images: impl Into<TextureCodecs>) -> Vec<Bitmap> {
    let mesh = bumpy::sphere(8, 4);
    let material = GltfMaterial {
        base_color_map: Some(color.into()),
        normal_map: Some(normal.into()),
        ..GltfMaterial::default()
    };
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    let bytes = encode_glb(&asset, &GltfFormat { images: images.into(), ..GltfFormat::default() }).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.glb");
    std::fs::write(&path, bytes).unwrap();
    let loaded = load_model(&path).unwrap_or_else(|e| panic!("{e}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene.textures().iter().map(|texture| texture.bitmap().clone()).collect()
}

fn texels(bitmap: &Bitmap) -> Vec<[f32; 4]> {
    let count = bitmap.width() * bitmap.height();
    (0..count as usize).map(|i| bitmap.stored(i)).collect()
}

/// The mean and largest angle between the normals of two maps, in degrees.
fn angles(a: &Bitmap, b: &Bitmap) -> [f64; 2] {
    let normal = |[x, y, z, _]: [f32; 4]| (Vec3::new(x, y, z).to_f64() * 2.0 - Vec3::splat(1.0)).normalize();
    let angles: Vec<f64> =
        texels(a).into_iter().zip(texels(b)).map(|(a, b)| angle_deg(normal(a), normal(b))).collect();
    [angles.iter().sum::<f64>() / angles.len() as f64, angles.iter().copied().fold(0.0, f64::max)]
}

/// Root mean square difference of channels, of 255.
fn rmse(a: &Bitmap, b: &Bitmap) -> f64 {
    let squares = texels(a).into_iter().zip(texels(b)).flat_map(|(a, b)| {
        [0, 1, 2].map(|c| f64::from((a[c] - b[c]) * 255.0) * f64::from((a[c] - b[c]) * 255.0))
    });
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn lossless_packings_lose_nothing() {
    let (color, normal) = (bumpy::colors(32), bumpy::normals(32, 4));
    for images in [ImageCodec::Png, ImageCodec::WebP] {
        assert_eq!(read_back(&color, &normal, images), [color.clone(), normal.clone()], "{images:?}");
    }
    let deep = bumpy::deep_normals(32, 4);
    assert_eq!(read_back(&color, &deep, ImageCodec::Png)[1], deep);
    // WebP rounds it to 8 bits.
    assert_eq!(read_back(&color, &deep, ImageCodec::WebP)[1], normal);
}

#[test]
fn alpha_is_left_out() {
    let Texels::U8(texels) = bumpy::colors(8).texels().clone() else { panic!("8 bits") };
    let clear = texels.iter().map(|[r, g, b, _]| [*r, *g, *b, 7]).collect();
    let color = Bitmap::new(8, 8, 4, Texels::U8(clear)).unwrap();
    for images in [ImageCodec::Png, ImageCodec::WebP, ImageCodec::Ktx2(0)] {
        assert_eq!(read_back(&color, &bumpy::normals(8, 2), images)[0].channels(), 3, "{images:?}");
    }
}

#[test]
fn blocks_come_near() {
    // Bumps of 64, 16 and 8 texels; the last vary strongly within a block.
    for (across, mean_limit, max_limit) in [(4, 0.4, 2.5), (16, 1.1, 4.0), (32, 2.0, 10.0)] {
        let normal = bumpy::normals(256, across);
        let back = read_back(&bumpy::colors(16), &normal, ImageCodec::Ktx2(0));
        let [mean, max] = angles(&normal, &back[1]);
        println!("{across} bumps across 256 texels: {mean:.3}° mean, {max:.3}° max");
        assert!(mean < mean_limit && max < max_limit);
    }
    let waves = waves();
    let [mean, max] = angles(&waves, &read_back(&bumpy::colors(16), &waves, ImageCodec::Ktx2(0))[1]);
    println!("waves: {mean:.3}° mean, {max:.3}° max");
    // Basis Universal 1.16 gives 0.515° and 2.6° at its quality levels 0 and 2.
    assert!(mean < 0.6 && max < 3.5);
    let noisy = bumpy::bitmap(64, |x, y| {
        let hash =
            (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)).wrapping_mul(3_266_489_917);
        [(hash >> 24) as u8 / 4 + 90, (hash >> 16) as u8 / 4 + 60, (x * 3) as u8]
    });
    let back = read_back(&noisy, &bumpy::normals(16, 2), ImageCodec::Ktx2(0));
    let error = rmse(&noisy, &back[0]);
    println!("noise of ±32 in two channels: {error:.2} of 255");
    assert!(error < 8.0, "{error}");
    let plain = bumpy::bitmap(16, |x, _| if x < 8 { [200, 13, 77] } else { [201, 12, 0] });
    let back = read_back(&plain, &bumpy::normals(16, 2), ImageCodec::Ktx2(0));
    assert_eq!(back[0], plain, "single colours are exact");
}

/// Normals of several superimposed waves.
fn waves() -> Bitmap {
    use libm::{cos, sin};
    bumpy::bitmap(512, |x, y| {
        let (u, v) = (f64::from(x) / 47.0, f64::from(y) / 31.0);
        let nx = 0.5 * sin(u) * cos(v * 1.7) + 0.2 * sin(u * 5.3 + v * 3.1);
        let ny = 0.5 * sin(v) * cos(u * 1.3) + 0.2 * cos(u * 2.3 - v * 4.1);
        let nz = (1.0 - nx * nx - ny * ny).max(0.05).sqrt();
        [nx, ny, nz].map(|n| ((n * 0.5 + 0.5) * 255.0).round() as u8)
    })
}

/// The bytes of the first image in a GLB.
fn first_image(color: &Bitmap) -> Vec<u8> {
    let mesh = bumpy::sphere(8, 4);
    let material = GltfMaterial { base_color_map: Some(color.into()), ..GltfMaterial::default() };
    let asset = GltfAsset { levels: &[&mesh], material, ..GltfAsset::default() };
    let format = GltfFormat { images: ImageCodec::Ktx2(0).into(), ..GltfFormat::default() };
    let bytes = encode_glb(&asset, &format).unwrap();
    let at = bytes.windows(8).position(|w| w == b"\xabKTX 20\xbb").expect("a KTX2 file");
    bytes[at..].to_vec()
}

#[test]
fn all_levels_and_targets_are_there() {
    let color = bumpy::bitmap(32, |x, y| [(x * 7) as u8, (y * 7) as u8, 128]);
    let bytes = first_image(&color);
    let transcoder = Transcoder::new(&bytes).unwrap();
    assert_eq!((transcoder.level_count(), transcoder.base_dimensions()), (6, (32, 32)));
    let decode = |level, target| transcoder.transcode(level, target, DecodeFlags::NONE).unwrap();
    // The mean of a ramp in linear light, encoded, is above the mean of its codes.
    let [r, g, b, a] = *decode(5, TargetFormat::Rgba32).first_chunk::<4>().unwrap();
    assert!((120..140).contains(&r) && r == g && b == 128 && a == 255, "{r} {g} {b} {a}");
    assert!(!transcoder.has_alpha());
    // As used by phones without ASTC: the hints for ETC1 work.
    assert_eq!(decode(0, TargetFormat::Etc1Rgb).len(), 64 * 8);
}

#[test]
fn sides_that_the_extension_forbids_are_named() {
    let mesh = bumpy::sphere(8, 4);
    let color = bumpy::colors(18);
    let material = GltfMaterial { base_color_map: Some((&color).into()), ..GltfMaterial::default() };
    let asset = GltfAsset { levels: &[&mesh], material, ..GltfAsset::default() };
    let format = GltfFormat { images: ImageCodec::Ktx2(0).into(), ..GltfFormat::default() };
    let error = encode_glb(&asset, &format).unwrap_err().to_string();
    assert!(error.contains("18×18") && error.contains("multiples of 4"), "{error}");
}

#[test]
fn jpeg_is_for_colours_alone() {
    let (color, normal) = (bumpy::colors(64), bumpy::normals(64, 4));
    let (mesh, folder) = (bumpy::sphere(8, 4), tempfile::tempdir().unwrap());
    let material = GltfMaterial {
        base_color_map: Some((&color).into()),
        normal_map: Some((&normal).into()),
        ..GltfMaterial::default()
    };
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    let path = folder.path().join("m.gltf");
    let written = |quality: u8| {
        let format = GltfFormat {
            images: format!("jpeg:{quality}/webp/webp").parse().unwrap(),
            ..GltfFormat::default()
        };
        write_gltf(&path, &asset, &format).unwrap();
        let bytes = std::fs::metadata(folder.path().join("m_color.jpg")).unwrap().len();
        let scene = load_model(&path).unwrap().scene;
        let [read, numbers] = [0, 1].map(|i| scene.textures()[i].bitmap());
        assert_eq!(*numbers, normal, "numbers are not compressed like colours");
        (bytes, rmse(read, &color))
    };
    let (coarse, fine) = (written(30), written(95));
    assert!(coarse.0 < fine.0 && coarse.1 > fine.1, "{coarse:?} {fine:?}");
    assert!(fine.1 > 0.0 && fine.1 < 3.0, "of 255: {}", fine.1);
    let json = std::fs::read_to_string(&path).unwrap();
    assert!(json.contains("m_color.jpg") && json.contains("m_normal.webp"), "{json}");
    for quality in [0, 101] {
        let format = GltfFormat { images: ImageCodec::Jpeg(quality).into(), ..GltfFormat::default() };
        let error = encode_glb(&asset, &format).unwrap_err().to_string();
        assert_eq!(error, format!("image format jpeg:{quality}: use 1 to 100"));
    }
}

#[test]
fn avif_keeps_the_channels_apart() {
    let (color, normal) = (bumpy::colors(64), waves());
    let read = |quality: u8| {
        let images: TextureCodecs = format!("avif:{quality}/avif:{quality}/webp").parse().unwrap();
        let back = read_back(&color, &normal, images);
        (rmse(&back[0], &color), angles(&back[1], &normal)[0])
    };
    let (coarse, fine) = (read(50), read(95));
    assert!(fine.0 < 1.5 && fine.1 < 0.35 && coarse.0 > fine.0 && coarse.1 > fine.1, "{coarse:?} {fine:?}");
    for side in [1, 3, 18] {
        let flat = bumpy::bitmap(side, |_, _| [128, 128, 255]);
        let back =
            read_back(&bumpy::bitmap(side, |x, y| [x as u8, y as u8, 90]), &flat, ImageCodec::Avif(80));
        assert_eq!([back[0].width(), back[0].height()], [side; 2]);
    }
    // A flat colour that 8 bits of luma and chroma cannot represent.
    let dark = bumpy::bitmap(16, |_, _| [50, 61, 69]);
    let back = read_back(&dark, &bumpy::normals(16, 2), ImageCodec::Avif(95));
    assert!(rmse(&back[0], &dark) < 0.3, "{}", rmse(&back[0], &dark));
}

#[test]
fn threads_change_no_byte() {
    let (mesh, color, normal) = (bumpy::sphere(24, 12), bumpy::colors(64), bumpy::deep_normals(64, 4));
    let material = GltfMaterial {
        base_color_map: Some((&color).into()),
        normal_map: Some((&normal).into()),
        ..GltfMaterial::default()
    };
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
    let plain = GltfFormat { meshopt: true, ..GltfFormat::default() };
    let formats = [
        GltfFormat { images: ImageCodec::Jpeg(80).into(), ..plain },
        GltfFormat { images: ImageCodec::WebP.into(), ..plain },
        GltfFormat { images: ImageCodec::LossyWebP(80).into(), ..plain },
        GltfFormat { images: "avif:80/avif:80/avif:80".parse().unwrap(), ..plain },
        GltfFormat { images: ImageCodec::Ktx2(0).into(), ..plain },
        GltfFormat { images: ImageCodec::Ktx2(2).into(), ..plain },
    ];
    for format in formats {
        let [one, four] = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| encode_glb(&asset, &format).unwrap())
        });
        assert!(one == four, "{format:?}");
    }
}
