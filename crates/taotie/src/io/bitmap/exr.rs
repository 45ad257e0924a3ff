//! OpenEXR through the `exr` crate, which reads any channels: `image` wants red, green and blue.

use super::{Failure, check_size};
use crate::image::{Bitmap, Texels};
use exr::block::reader::Reader;
use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, Layer, ReadChannels, ReadLayers, read};
use std::io::Cursor;

/// The most channels of one layer that are read.
const MAX_CHANNELS: usize = 64;

/// The colour of the first layer without depth samples, as float. Luminance alone is repeated.
pub(super) fn decode(bytes: &[u8]) -> Result<Bitmap, Failure> {
    check_headers(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(failure)?;
    bitmap_from(&image)
}

/// Every layer's size, before anything is allocated for it.
fn check_headers(bytes: &[u8]) -> Result<(), Failure> {
    let reader = Reader::read_from_buffered(Cursor::new(bytes), false).map_err(failure)?;
    for header in reader.headers() {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        check_size(width, height, bytes.len())?;
        if header.channels.list.len() > MAX_CHANNELS {
            return Err(Failure::TooLarge(format!("at most {MAX_CHANNELS} channels")));
        }
    }
    Ok(())
}

fn bitmap_from(image: &Image<Layer<AnyChannels<FlatSamples>>>) -> Result<Bitmap, Failure> {
    let layer = &image.layer_data;
    let (width, height) = (layer.size.width(), layer.size.height());
    let sources = sources(&layer.channel_data.list)
        .ok_or_else(|| Failure::Unsupported("it has neither R, G, B nor Y channels".into()))?;
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

/// The channels for red, green, blue and alpha: by name, with luminance or a lone channel for all three colours.
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
