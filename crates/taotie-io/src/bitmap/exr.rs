//! OpenEXR through the `exr` crate, which reads any channels, while `image` requires red, green and blue.

use super::super::limits::Bytes;
use super::super::reading::{Reading, caught};
use super::limits::{Failure, check_size, credible};
use exr::block::reader::Reader;
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Compression, FlatSamples, Image, Layer, ReadChannels, ReadLayers, read,
};
use std::io::Cursor;
use taotie_engine::image::{Bitmap, Texels};

/// Maximum number of channels read from one layer.
const MAX_CHANNELS: usize = 64;

/// Decodes the colour of the first layer without depth samples, as float. A lone luminance channel is repeated.
///
/// The decoder (`exr` 1.74) has assertions that rare damage triggers, such as a block of a mip level that was not
/// requested; the panic is caught here and becomes an error. It therefore runs on this thread only: a panic on
/// another thread could not be caught.
pub(super) fn decode(bytes: &[u8], reading: &Reading) -> Result<Bitmap, Failure> {
    let damaged = || Failure::damaged("the blocks contradict the header");
    caught(|| decode_or_panic(bytes, reading)).unwrap_or_else(|| Err(damaged()))
}

fn decode_or_panic(bytes: &[u8], reading: &Reading) -> Result<Bitmap, Failure> {
    check_headers(bytes, reading)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(failure)?;
    bitmap_from(&image)
}

/// Checks every layer's size and compression before anything is allocated for it.
fn check_headers(bytes: &[u8], reading: &Reading) -> Result<(), Failure> {
    let reader = Reader::read_from_buffered(Cursor::new(bytes), false).map_err(failure)?;
    let mut deepest = 0;
    for header in reader.headers() {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        check_size(width, height, credible(bytes))?;
        check_compression(header)?;
        if header.channels.list.len() > MAX_CHANNELS {
            return Err(Failure::TooLarge(format!("the maximum is {MAX_CHANNELS} channels")));
        }
        check_content(header, bytes)?;
        deepest = deepest.max(room(header));
    }
    match reading.take(deepest) {
        true => Ok(()),
        false => Err(Failure::TooLarge(format!("it needs about {} of memory", Bytes(deepest)))),
    }
}

/// Returns the bytes needed to decode a layer: all its channels, and the texels made from them.
fn room(header: &Header) -> u64 {
    /// Float texels with their mip levels.
    const TEXEL: u64 = 22;
    let texels = header.layer_size.area() as u64;
    texels * (TEXEL + header.channels.bytes_per_pixel as u64)
}

/// Rejects a layer with more bytes than compression can pack into a file of this length.
fn check_content(header: &Header, bytes: &[u8]) -> Result<(), Failure> {
    /// Deflate reaches 1032 to 1, and PXR24 stores three bytes of four; other compression methods reach less.
    const MOST: u64 = 1500;
    let content = header.layer_size.area() as u64 * header.channels.bytes_per_pixel as u64;
    match content > MOST * bytes.len() as u64 {
        true => Err(Failure::damaged(&format!("the file cannot hold {}", Bytes(content)))),
        false => Ok(()),
    }
}

/// Rejects DWA: its decoder allocates as much as the file states, and the process aborts if that is too much.
fn check_compression(header: &Header) -> Result<(), Failure> {
    match header.compression {
        Compression::DWAA(_) | Compression::DWAB(_) => {
            Err(Failure::Unsupported("OpenEXR's lossy DWAA or DWAB compression (unlike ZIP and PIZ)".into()))
        }
        _ => Ok(()),
    }
}

fn bitmap_from(image: &Image<Layer<AnyChannels<FlatSamples>>>) -> Result<Bitmap, Failure> {
    let layer = &image.layer_data;
    let (width, height) = (layer.size.width(), layer.size.height());
    let sources = sources(&layer.channel_data.list)
        .ok_or_else(|| Failure::Unsupported("OpenEXR without R, G, B or Y channels".into()))?;
    let mut texels = vec![[0.0, 0.0, 0.0, 1.0]; width * height];
    for (c, source) in sources.iter().enumerate() {
        let Some(channel) = source else { continue };
        if channel.sample_data.len() != texels.len() {
            return Err(Failure::Unsupported("subsampled channels".into()));
        }
        for (texel, value) in texels.iter_mut().zip(channel.sample_data.values_as_f32()) {
            texel[c] = value;
        }
    }
    let grey = sources[0].map(|c| c.name.to_string()) == sources[1].map(|c| c.name.to_string());
    let channels = if grey { 1 } else { 3 } + u8::from(sources[3].is_some());
    Bitmap::new(width as u32, height as u32, channels, Texels::F32(texels))
        .map_err(|e| Failure::Damaged(e.to_string()))
}

type Channel = AnyChannel<FlatSamples>;

/// Returns the channels for red, green, blue and alpha, by name; luminance or a lone channel supplies all three
/// colours.
fn sources(list: &[Channel]) -> Option<[Option<&Channel>; 4]> {
    let named = |name: &str| list.iter().find(|c| c.name.to_string().eq_ignore_ascii_case(name));
    let alpha = named("A");
    let colors = [named("R"), named("G"), named("B")];
    if colors.iter().any(Option::is_some) {
        let [r, g, b] = colors;
        return Some([r, g, b, alpha]);
    }
    let lone = if list.len() == 1 { list.first() } else { None };
    let grey = named("Y").or(lone)?;
    Some([Some(grey), Some(grey), Some(grey), alpha])
}

fn failure(error: exr::error::Error) -> Failure {
    match error {
        exr::error::Error::NotSupported(what) => Failure::Unsupported(what.to_string()),
        other => Failure::Damaged(other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::limits::Limits;
    use super::*;
    use exr::prelude::{
        Blocks, Compression, Encoding, LayerAttributes, LineOrder, SpecificChannels, Vec2, WritableImage,
    };

    use std::path::Path;

    const LOSSLESS: [Compression; 5] = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    const LOSSY: [Compression; 3] = [Compression::PXR24, Compression::B44, Compression::B44A];

    fn color(p: Vec2<usize>) -> (f32, f32, f32, f32) {
        (p.0 as f32 * 0.25, p.1 as f32 - 7.5, if p.0 > 8 { 3.0 } else { 0.5 }, 0.5)
    }

    fn encoded(compression: Compression, blocks: Blocks) -> Vec<u8> {
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let channels = SpecificChannels::rgba(color);
        let layer = Layer::new((19, 17), LayerAttributes::default(), encoding, channels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn decoded(bytes: &[u8]) -> Result<Bitmap, Failure> {
        decode(bytes, &Reading::new(Path::new("a.exr"), &Limits::default()))
    }

    fn texels(bytes: &[u8]) -> Vec<[f32; 4]> {
        match decoded(bytes).ok().map(|b| b.texels().clone()) {
            Some(Texels::F32(texels)) => texels,
            _ => panic!("it decodes to float"),
        }
    }

    #[test]
    fn every_lossless_compression_and_both_layouts_read_back() {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 8))] {
            for compression in LOSSLESS {
                let texels = texels(&encoded(compression, blocks));
                let (r, g, b, a) = color(Vec2(13, 5));
                assert_eq!(texels[5 * 19 + 13], [r, g, b, a], "{compression:?} {blocks:?}");
            }
        }
    }

    #[test]
    fn many_channels_in_few_bytes_are_refused_before_they_are_decoded() {
        let tight = Limits { memory: Some(Bytes(1 << 14)), ..Limits::default() };
        let bytes = encoded(Compression::ZIP16, Blocks::ScanLines);
        let needs = Reading::new(Path::new("a.exr"), &tight);
        assert!(decode(&bytes, &needs).is_ok(), "19 × 17 texels of 38 bytes fit 16 KiB");
        let tight = Limits { memory: Some(Bytes(1 << 13)), ..Limits::default() };
        let needs = Reading::new(Path::new("a.exr"), &tight);
        assert!(matches!(decode(&bytes, &needs), Err(Failure::TooLarge(_))));
        assert!(needs.check().is_err());
    }

    #[test]
    fn dwa_is_refused_before_it_is_decoded() {
        for compression in [Compression::DWAA(None), Compression::DWAB(None)] {
            let mut bytes = encoded(compression, Blocks::ScanLines);
            match decoded(&bytes) {
                Err(Failure::Unsupported(what)) => assert!(what.contains("DWAA"), "{what}"),
                _ => panic!("{compression:?} is rejected"),
            }
            // Regardless of the counts in its blocks.
            let end = bytes.len();
            bytes[end - end / 4..].fill(0x7f);
            assert!(matches!(decoded(&bytes), Err(Failure::Unsupported(_))));
        }
    }

    #[test]
    fn damaged_files_fail_quietly() {
        let mut seed = 1u64;
        let mut below = |bound: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % bound
        };
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 8))] {
            for compression in LOSSLESS.into_iter().chain(LOSSY) {
                let bytes = encoded(compression, blocks);
                for _ in 0..200 {
                    let mut changed = bytes.clone();
                    changed[below(bytes.len())] = below(256) as u8;
                    let at = below(bytes.len());
                    changed[at] ^= 1 << below(8);
                    let _ = decoded(&changed);
                }
                let _ = decoded(&bytes[..below(bytes.len())]);
            }
        }
    }
}
