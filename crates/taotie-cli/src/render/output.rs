//! Developing pictures and writing them.

use super::RenderArgs;
use anyhow::Result;
use std::path::{Path, PathBuf};
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::image::Image;
use taotie_engine::render::{Frame, HeldPixels};
use taotie_io::{AnimationFormat, FileSet, ImageFormat};

/// Returns how pixels are held until they are written.
pub fn held(args: &RenderArgs) -> Result<HeldPixels> {
    let is_raster = args.integrator.reference().is_none();
    Ok(match args.formats()?.still {
        ImageFormat::Png8 if is_raster && args.aovs.is_empty() => HeldPixels::Codes,
        ImageFormat::Png8 => HeldPixels::Light8,
        ImageFormat::Png16 => HeldPixels::Light16,
        ImageFormat::Exr => HeldPixels::Floats,
    })
}

/// Returns the memory of GIF pictures that wait until there is one for each thread, bytes.
pub fn waiting_bytes(args: &RenderArgs) -> Result<u64> {
    /// Codes, and memory for choosing their colours.
    const PIXEL: u64 = 5;
    let [width, height] = args.size.map(u64::from);
    let pictures = match args.formats()?.moving {
        Some(AnimationFormat::Gif) => rayon::current_num_threads() as u64,
        _ => 0,
    };
    Ok(pictures * width * height * PIXEL)
}

fn extension(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png8 | ImageFormat::Png16 => "png",
        ImageFormat::Exr => "exr",
    }
}

/// `turn.gif` becomes `turn.007.png`.
pub fn numbered(path: &Path, format: ImageFormat, index: usize, count: usize) -> PathBuf {
    let digits = (count.saturating_sub(1)).to_string().len().max(3);
    path.with_extension(format!("{index:0digits$}.{}", extension(format)))
}

/// Returns the files of a picture at `path`: its own, and those of the requested output variables.
pub fn targets(args: &RenderArgs, path: &Path) -> Vec<PathBuf> {
    let variables = args.aovs.iter().flat_map(|name| variable(path, name));
    std::iter::once(path.to_path_buf()).chain(variables).collect()
}

/// Returns the files of an output variable: the exact values, and a preview.
fn variable(path: &Path, name: &str) -> [PathBuf; 2] {
    ["exr", "png"].map(|extension| path.with_extension(format!("{name}.{extension}")))
}

/// Writes a frame and the requested output variables as files of a set; returns the files.
pub fn write(set: &FileSet, args: &RenderArgs, path: &Path, frame: &Frame) -> Result<Vec<PathBuf>> {
    let development = args.film.development(args.running.simd)?;
    set.write_image(path, &frame.color, &development, args.formats()?.still)?;
    let mut files = vec![path.to_path_buf()];
    let named = frame.aovs.iter().flat_map(|aovs| aovs.named());
    for (name, image) in named.filter(|(name, _)| args.aovs.iter().any(|asked| asked == name)) {
        let [exact, visible] = variable(path, name);
        set.write_image(&exact, image, &Development::default(), ImageFormat::Exr)?;
        let development = Development { tone: ToneCurve::Linear, background: None, ..Development::default() };
        set.write_image(&visible, &to_look_at(name, image), &development, ImageFormat::Png8)?;
        files.extend([exact, visible]);
    }
    Ok(files)
}

/// Maps an output variable to [0, 1] for its PNG preview.
fn to_look_at(name: &str, image: &Image) -> Image {
    let mut picture = image.clone();
    let ranges = [0, 1, 2].map(|channel| range(image, channel));
    let share = |v: f32, (least, most): (f32, f32)| (v - least) / (most - least).max(f32::MIN_POSITIVE);
    for pixel in picture.pixels_mut().iter_mut().filter(|pixel| pixel[3] != 0.0) {
        let [x, y, z, a] = *pixel;
        let encoded = match name {
            "normals" => [x, y, z].map(|v| v * 0.5 + 0.5),
            "depth" => [1.0 - 0.9 * share(x, ranges[0]); 3],
            "position" => [share(x, ranges[0]), share(y, ranges[1]), share(z, ranges[2])],
            "uv" => [x - x.floor(), y - y.floor(), 0.0],
            "triangle" => false_color(x as u32),
            _ => continue,
        };
        // Undo the sRGB curve that is applied when writing, so that these numbers are stored unchanged.
        let [r, g, b] = encoded.map(|v| taotie_engine::math::srgb::linear_from_srgb(f64::from(v)) as f32);
        *pixel = [r, g, b, a];
    }
    picture
}

/// Returns the minimum and maximum of a channel over covered pixels.
fn range(image: &Image, channel: usize) -> (f32, f32) {
    let seen = image.pixels().iter().filter(|pixel| pixel[3] != 0.0).map(|pixel| pixel[channel]);
    seen.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Returns a colour that differs between consecutive numbers.
fn false_color(id: u32) -> [f32; 3] {
    let hash = id.wrapping_add(1).wrapping_mul(0x9e37_79b1);
    let hash = (hash ^ (hash >> 15)).wrapping_mul(0x85eb_ca77);
    [hash, hash >> 8, hash >> 16].map(|h| 0.15 + 0.85 * (h & 0xff) as f32 / 255.0)
}
