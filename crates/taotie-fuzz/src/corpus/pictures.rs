//! Pictures in every supported format, including environments.

use super::seed::Seed;
use crate::mutation::{self, Mutation};
use anyhow::Result;
use image::{DynamicImage, ImageFormat};
use std::io::Cursor;
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::math::scalar::pow;
use taotie_engine::shade::environment::ENVIRONMENT_VERSION;
use taotie_io::{ExrLayer, MapFormat, encode_map, encode_png_bitmap, write_exr};

/// A PNG of 8 bits.
pub const WAVES: &[u8] = include_bytes!("../../../../tests/data/pictures/waves.png");

/// Returns all pictures.
///
/// # Errors
/// If no temporary file can be written.
pub fn seeds() -> Result<Vec<Seed>> {
    let mut seeds = vec![
        Seed::single("waves.png", WAVES),
        Seed::single("deep.png", deep_png()?),
        Seed::single("open.exr", exr(9, 7, &["R", "G", "B"])?),
        Seed::single("sky.exr", exr(8, 4, &["R", "G", "B", "A"])?),
        Seed::single("etc1s.ktx2", &include_bytes!("../../../../tests/data/pictures/etc1s.ktx2")[..]),
        Seed::single("alpha.ktx2", &include_bytes!("../../../../tests/data/pictures/etc1s-alpha.ktx2")[..]),
        Seed::single("uastc.ktx2", &include_bytes!("../../../../tests/data/pictures/uastc-zstd.ktx2")[..]),
        Seed::single("lossy.webp", &include_bytes!("../../../../tests/data/pictures/lossy.webp")[..]),
        Seed::single("lossless.webp", &include_bytes!("../../../../tests/data/pictures/lossless.webp")[..]),
        Seed::single("chroma.avif", &include_bytes!("../../../../tests/data/pictures/avif-420.avif")[..]),
        Seed::single("alpha.avif", &include_bytes!("../../../../tests/data/pictures/avif-alpha.avif")[..]),
        Seed::single("light.environment", cached()),
    ];
    let grey = image::GrayImage::from_fn(16, 8, |x, y| image::Luma([(x * y) as u8]));
    let grey = DynamicImage::ImageLuma8(grey);
    let float = DynamicImage::ImageRgb32F(grey.to_rgb32f());
    let formats = [
        ("grey.jpg", &grey, ImageFormat::Jpeg),
        ("grey.tga", &grey, ImageFormat::Tga),
        ("sky.hdr", &float, ImageFormat::Hdr),
    ];
    for (name, picture, format) in formats {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format)?;
        seeds.push(Seed::single(name, bytes.into_inner()));
    }
    for (name, channels) in [("blocks.dds", 4), ("normals.dds", 3), ("grey.dds", 1)] {
        let texels = (0..60u8).map(|i| [i * 4, 255 - i * 3, 255, i]).collect();
        let bitmap = Bitmap::new(10, 6, channels, Texels::U8(texels))?;
        seeds.push(Seed::single(name, encode_map(&bitmap, Encoding::Normal, MapFormat::Dds)?));
    }
    Ok(seeds)
}

/// Returns a 16-bit PNG with alpha.
fn deep_png() -> Result<Vec<u8>> {
    let texels = (0..60u16).map(|i| [i * 1000, 65535 - i * 500, i * 7, 60000]).collect();
    Ok(encode_png_bitmap(&Bitmap::new(10, 6, 4, Texels::U16(texels))?, Encoding::Linear)?)
}

/// Returns an OpenEXR picture of floats.
fn exr(width: u32, height: u32, channels: &[&str]) -> Result<Vec<u8>> {
    let count = (width * height) as usize * channels.len();
    let samples: Vec<f32> = (0..count).map(|i| i as f32 / 100.0).collect();
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("a.exr");
    write_exr(&path, (width, height), &[ExrLayer { name: "", channels, samples: &samples }])?;
    Ok(std::fs::read(path)?)
}

/// Returns an environment as stored in the cache, of a few texels: the levels that [`Environment::new`] makes are
/// megabytes.
fn cached() -> Vec<u8> {
    let mut bytes = b"taotie\0E".to_vec();
    bytes.extend(ENVIRONMENT_VERSION.to_le_bytes());
    bytes.extend([0; 4]);
    [0u64, 4, 2].iter().for_each(|count| bytes.extend(count.to_le_bytes()));
    put_texels(&mut bytes, 8);
    let alphas: Vec<f64> = alphas().collect();
    bytes.extend((alphas.len() as u64).to_le_bytes());
    for alpha in alphas {
        bytes.extend((alpha as f32).to_le_bytes());
        bytes.extend(1u64.to_le_bytes());
        put_texels(&mut bytes, 9);
    }
    mutation::changed(&bytes, &[Mutation::Mend])
}

/// Writes `count` texels of value one, as half floats after the exponent of their scale.
fn put_texels(bytes: &mut Vec<u8>, count: usize) {
    bytes.extend(0i32.to_le_bytes());
    (0..3 * count).for_each(|_| bytes.extend(0x3c00u16.to_le_bytes()));
}

/// Returns the squared roughnesses that a cached environment stores light for.
fn alphas() -> impl Iterator<Item = f64> {
    let sparse = (1..=6).rev().map(|n| 0.04 * pow(1.5, -f64::from(n)));
    sparse.chain((0..=24).map(|n| pow(0.04, 1.0 - f64::from(n) / 24.0)))
}
