//! DDS images with the block formats of GPUs, BC1 to BC5 and BC7, through the crates `ddsfile` and `block_compression`.

use super::super::reading::{Reading, caught};
use super::limits::{Failure, MAX_TEXELS_OF_PLAIN, TexelRoom, check_room, check_size, credible};
use block_compression::decode::decompress_blocks_as_rgba8;
use block_compression::encode::compress_rgba8;
use block_compression::{BC7Settings, CompressionVariant};
use ddsfile::{AlphaMode, D3D10ResourceDimension, D3DFormat, Dds, DxgiFormat, NewDxgiParams};
use rayon::prelude::*;
use std::io::Cursor;
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::surface::rebuild_z;

/// The bytes of a header with its extension.
const LONGEST_HEADER: usize = 148;

/// Returns true if a file starts as DDS does.
pub(super) fn is_dds(bytes: &[u8]) -> bool {
    bytes.starts_with(b"DDS ")
}

/// Decodes the largest level of an image. Smaller ones are regenerated, as for every other format. The blue of BC5, which
/// has two channels, is that of a unit normal.
///
/// The decoders index into arrays by sizes of the file; if damage makes one panic, the panic is caught here and becomes
/// an error.
pub(super) fn decode(bytes: &[u8], reading: &Reading) -> std::result::Result<Bitmap, Failure> {
    // Without the texels, which would be copied.
    let header = &bytes[..bytes.len().min(LONGEST_HEADER)];
    let read = caught(|| Dds::read(Cursor::new(header)).map(|dds| (dds.get_num_array_layers(), dds)));
    let Some(Ok((layers, dds))) = read else { return Err(Failure::damaged("invalid header")) };
    let (width, height) = (dds.get_width(), dds.get_height());
    if width == 0 || height == 0 {
        return Err(Failure::damaged("a side of 0 texels"));
    }
    let plain = credible(bytes).max(MAX_TEXELS_OF_PLAIN);
    check_size(u64::from(width), u64::from(height), plain)?;
    let (variant, channels) = blocks_of(&dds)
        .ok_or_else(|| Failure::Unsupported("DDS in a format other than BC1 to BC5 and BC7".into()))?;
    if dds.get_depth() > 1 || layers != 1 {
        return Err(Failure::Unsupported("DDS with several layers, faces or slices".into()));
    }
    // The file's blocks, and whole blocks of texels.
    let whole = [width, height].map(|side| side.next_multiple_of(4));
    let scratch = 5 * u64::from(whole[0]) * u64::from(whole[1]);
    check_room(reading, [width, height], TexelRoom { depth: 1, scratch })?;
    let start = header.len() - dds.data.len();
    let blocks = bytes.get(start..start + variant.blocks_byte_size(width, height));
    let blocks = blocks
        .ok_or_else(|| Failure::Damaged("the file ends within its texels; download it again".into()))?;
    let decoded = caught(|| {
        let mut texels = vec![0; 4 * whole[0] as usize * whole[1] as usize];
        decompress_blocks_as_rgba8(variant, whole[0], whole[1], blocks, &mut texels);
        texels
    });
    let decoded = decoded.ok_or_else(|| Failure::damaged("damaged blocks"))?;
    let rows = decoded.as_chunks::<4>().0.chunks_exact(whole[0] as usize).take(height as usize);
    let mut texels: Vec<[u8; 4]> = rows.flat_map(|row| &row[..width as usize]).copied().collect();
    for texel in &mut texels {
        *texel = match (variant, *texel) {
            (CompressionVariant::BC4, [v, ..]) => [v, v, v, 255],
            (CompressionVariant::BC5, [x, y, ..]) => [x, y, blue([x, y]), 255],
            (_, texel) => texel,
        };
    }
    Bitmap::new(width, height, channels, Texels::U8(texels)).map_err(|e| Failure::Damaged(e.to_string()))
}

/// Returns the block format of a file and its channels; `None` for others.
fn blocks_of(dds: &Dds) -> Option<(CompressionVariant, u8)> {
    use CompressionVariant::{BC1, BC2, BC3, BC4, BC5, BC7};
    let bc7 = || BC7(BC7Settings::alpha_basic());
    match (dds.get_dxgi_format(), dds.get_d3d_format()) {
        (Some(format), _) => match format {
            DxgiFormat::BC1_UNorm | DxgiFormat::BC1_UNorm_sRGB => Some((BC1, 4)),
            DxgiFormat::BC2_UNorm | DxgiFormat::BC2_UNorm_sRGB => Some((BC2, 4)),
            DxgiFormat::BC3_UNorm | DxgiFormat::BC3_UNorm_sRGB => Some((BC3, 4)),
            DxgiFormat::BC4_UNorm => Some((BC4, 1)),
            DxgiFormat::BC5_UNorm => Some((BC5, 3)),
            DxgiFormat::BC7_UNorm | DxgiFormat::BC7_UNorm_sRGB => Some((bc7(), 4)),
            _ => None,
        },
        (None, Some(D3DFormat::DXT1)) => Some((BC1, 4)),
        (None, Some(D3DFormat::DXT2 | D3DFormat::DXT3)) => Some((BC2, 4)),
        (None, Some(D3DFormat::DXT4 | D3DFormat::DXT5)) => Some((BC3, 4)),
        (None, _) => match dds.header.spf.fourcc.as_ref().map(|code| code.0.to_le_bytes()) {
            Some([b'A', b'T', b'I', b'1'] | [b'B', b'C', b'4', b'U']) => Some((BC4, 1)),
            Some([b'A', b'T', b'I', b'2'] | [b'B', b'C', b'5', b'U']) => Some((BC5, 3)),
            _ => None,
        },
    }
}

/// Returns the third component of a unit normal from the codes of the others.
fn blue(codes: [u8; 2]) -> u8 {
    let [x, y] = codes.map(|code| f32::from(code) / 127.5 - 1.0);
    ((rebuild_z(x, y) + 1.0) * 127.5 + 0.5) as u8
}

/// Encodes an 8-bit bitmap with mip levels: one channel as BC4, tangent-space normals ([`Encoding::Normal`]) as BC5, which
/// has no blue, anything else as BC7.
///
/// # Errors
/// [`Error::Unsupported`] for other bits.
pub(crate) fn encode_dds(bitmap: &Bitmap, encoding: Encoding) -> Result<Vec<u8>> {
    let Texels::U8(_) = bitmap.texels() else {
        let what = format!("a DDS with {} bits per channel", bitmap.bits());
        return Err(Error::unsupported(what, "write a .png or .exr"));
    };
    let settings = match bitmap.channels() {
        2 | 4 => BC7Settings::alpha_basic(),
        _ => BC7Settings::opaque_basic(),
    };
    let (variant, format) = match bitmap.channels() {
        1 => (CompressionVariant::BC4, DxgiFormat::BC4_UNorm),
        3 if encoding == Encoding::Normal => (CompressionVariant::BC5, DxgiFormat::BC5_UNorm),
        _ if encoding == Encoding::Srgb => (CompressionVariant::BC7(settings), DxgiFormat::BC7_UNorm_sRGB),
        _ => (CompressionVariant::BC7(settings), DxgiFormat::BC7_UNorm),
    };
    let texture = Texture::new(bitmap.clone(), encoding);
    let levels: Vec<Vec<u8>> =
        (0..texture.levels()).map(|level| blocks(texture.level(level), variant)).collect();
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: bitmap.height(),
        width: bitmap.width(),
        depth: None,
        format,
        mipmap_levels: Some(levels.len() as u32),
        array_layers: None,
        caps2: None,
        is_cubemap: false,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: if bitmap.channels().is_multiple_of(2) { AlphaMode::Straight } else { AlphaMode::Opaque },
    })
    .map_err(|error| Error::invalid("a DDS", error.to_string()))?;
    dds.data = levels.concat();
    let mut bytes = Vec::new();
    dds.write(&mut bytes).map_err(|error| Error::invalid("a DDS", error.to_string()))?;
    Ok(bytes)
}

/// Returns the blocks of a level; texels at its right and lower borders are repeated up to whole blocks.
fn blocks(level: &Bitmap, variant: CompressionVariant) -> Vec<u8> {
    let [width, height] = [level.width(), level.height()].map(|side| side as usize);
    let across = width.next_multiple_of(4);
    let code = |v: f32| (v * 255.0 + 0.5) as u8;
    let row_of_blocks = |row: usize| {
        let texels = (0..4 * across).flat_map(|i| {
            let (x, y) = ((i % across).min(width - 1), (4 * row + i / across).min(height - 1));
            let [r, g, b, a] = level.stored(y * width + x).map(code);
            // Mip levels of normals have their variance in alpha.
            [r, g, b, if level.channels().is_multiple_of(2) { a } else { 255 }]
        });
        let texels: Vec<u8> = texels.collect();
        let mut blocks = vec![0; variant.blocks_byte_size(across as u32, 4)];
        compress_rgba8(variant, &texels, &mut blocks, across as u32, 4, 4 * across as u32);
        blocks
    };
    (0..height.div_ceil(4)).into_par_iter().map(row_of_blocks).collect::<Vec<_>>().concat()
}
