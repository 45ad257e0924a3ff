//! OpenEXR images: linear float channels in named layers.

use super::file_set::FileSet;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, WritableImage,
};
use std::io::Cursor;
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// Channels of an image under a common name.
#[derive(Debug, Clone, Copy)]
pub struct ExrLayer<'a> {
    /// The prefix of each channel name, such as `normal` in `normal.X`; empty for the image itself.
    pub name: &'a str,
    /// The channels in the order of the samples, such as `["R", "G", "B", "A"]` or `["Z"]`.
    pub channels: &'a [&'a str],
    /// Linear values, interleaved, row by row from the top. Colour is premultiplied by alpha.
    pub samples: &'a [f32],
}

/// Writes layers of equal size into one part, losslessly, completely or not at all.
///
/// # Errors
/// [`Error::Invalid`] if there are no layers, a channel name is duplicated or the sample count does not match the
/// size; [`Error::Io`] if the file cannot be written.
pub fn write_exr(path: &Path, size: (u32, u32), layers: &[ExrLayer]) -> Result<()> {
    FileSet::one(|files| files.write_exr(path, size, layers))
}

/// Returns the bytes that [`write_exr`] would write.
///
/// # Errors
/// As [`write_exr`], except for those of the file.
pub fn encode_exr(size: (u32, u32), layers: &[ExrLayer]) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    let written = image_of(size, layers)?.write().to_buffered(&mut bytes);
    written.map_err(|e| Error::invalid("EXR image", e.to_string()))?;
    Ok(bytes.into_inner())
}

impl FileSet {
    /// Writes layers like [`write_exr`].
    ///
    /// # Errors
    /// As [`write_exr`].
    pub fn write_exr(&self, path: &Path, size: (u32, u32), layers: &[ExrLayer]) -> Result<()> {
        let image = image_of(size, layers)?;
        self.write_with(path, |out| image.write().to_buffered(out).map_err(|e| encoding_error(path, e)))
    }
}

/// Returns all channels of the layers as one part.
fn image_of(
    (width, height): (u32, u32),
    layers: &[ExrLayer],
) -> Result<Image<Layer<AnyChannels<FlatSamples>>>> {
    let size = (width as usize, height as usize);
    let mut channels = Vec::new();
    for layer in layers {
        split_channels(layer, size.0 * size.1, &mut channels)?;
    }
    if channels.is_empty() || size.0 * size.1 == 0 {
        return Err(Error::invalid("EXR image", "no pixels"));
    }
    channels.sort_by(|a, b| a.name.cmp(&b.name));
    if let Some(pair) = channels.windows(2).find(|pair| pair[0].name == pair[1].name) {
        return Err(Error::invalid("EXR image", format!("duplicate channel name {}", pair[0].name)));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(size, LayerAttributes::default(), encoding, AnyChannels::sort(channels.into()));
    Ok(Image::from_layer(layer))
}

fn split_channels(layer: &ExrLayer, pixels: usize, into: &mut Vec<AnyChannel<FlatSamples>>) -> Result<()> {
    let count = layer.channels.len();
    if layer.samples.len() != pixels * count {
        let why = format!("{} samples for {pixels} pixels with {count} channels", layer.samples.len());
        return Err(Error::invalid(format!("EXR layer '{}'", layer.name), why));
    }
    for (c, channel) in layer.channels.iter().enumerate() {
        let name =
            if layer.name.is_empty() { (*channel).to_owned() } else { format!("{}.{channel}", layer.name) };
        let values = layer.samples.iter().skip(c).step_by(count).copied().collect();
        let name = exr::prelude::Text::new_or_none(&name)
            .ok_or_else(|| Error::invalid(format!("EXR channel '{name}'"), "use Latin letters"))?;
        into.push(AnyChannel::new(name, FlatSamples::F32(values)));
    }
    Ok(())
}

fn encoding_error(path: &Path, error: exr::error::Error) -> Error {
    match error {
        exr::error::Error::Io(e) => Error::io(path, e),
        other => Error::invalid("EXR image", other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_bitmap;
    use taotie_engine::image::Texels;

    #[test]
    fn layers_read_back_under_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.exr");
        let color: Vec<f32> = (0..3 * 2 * 4).map(|i| i as f32 * 0.37 - 1.0).collect();
        let depth = [1.0, 2.0, 3.0, 4.0, f32::INFINITY, 6.0];
        let layers = [
            ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples: &color },
            ExrLayer { name: "depth", channels: &["Z"], samples: &depth },
        ];
        write_exr(&path, (3, 2), &layers).unwrap();
        assert!(encode_exr((3, 2), &layers).unwrap() == std::fs::read(&path).unwrap());
        let bitmap = read_bitmap(&path).unwrap();
        assert_eq!((bitmap.width(), bitmap.height(), bitmap.channels(), bitmap.bits()), (3, 2, 4, 32));
        let Texels::F32(texels) = bitmap.texels() else { panic!("float") };
        assert_eq!(texels.as_flattened(), color);
        let all = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        let named = all.layer_data.channel_data.list.iter().find(|c| c.name.eq("depth.Z")).unwrap();
        assert!(matches!(&named.sample_data, FlatSamples::F32(v) if v[..] == depth));
    }

    #[test]
    fn wrong_counts_and_double_names_are_refused() {
        let one = ExrLayer { name: "a", channels: &["X"], samples: &[0.0; 4] };
        let path = Path::new("never-written.exr");
        assert!(write_exr(path, (2, 3), &[one]).is_err());
        assert!(write_exr(path, (2, 2), &[one, one]).unwrap_err().to_string().contains("a.X"));
        assert!(write_exr(path, (2, 2), &[]).is_err());
    }
}
