//! `--for`: what an asset is made for chooses what is not asked for.

use clap::ValueEnum;
use taotie::io::GltfImages;

/// The use that an asset is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Purpose {
    /// Small files for browsers: 20,000 triangles, maps of 1024×1024, WebP with colours of quality 85, meshopt
    Web,
    /// Nothing lost that can be kept, for every viewer: 200,000 triangles, maps of 4096×4096, PNG, normals in 16 bits
    Archive,
    /// Textures that graphics cards read as they are, and levels of detail: 50,000, 15,000 and 5,000 triangles, maps of
    /// 2048×2048, KTX2 with an RDO of 2
    Engine,
}

/// Size and packing of an asset where nothing else is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Defaults {
    /// Triangles of the low-poly mesh.
    pub triangles: u32,
    /// Triangles of further levels of detail.
    pub lods: &'static [u32],
    /// Texels along a side.
    pub size: u32,
    /// Bits a channel of normal maps, where the file format holds them.
    pub bits: u8,
    /// The packing of textures.
    pub images: GltfImages,
    /// The quality of colours as WebP.
    pub webp_quality: Option<u8>,
    /// The rate–distortion optimisation of KTX2.
    pub uastc_rdo: Option<u8>,
    /// Geometry is compressed.
    pub meshopt: bool,
}

impl Defaults {
    /// Returns the defaults for a use, or for none.
    pub fn of(purpose: Option<Purpose>) -> Self {
        let plain = Self {
            triangles: 50_000,
            lods: &[],
            size: 2048,
            bits: 8,
            images: GltfImages::Png,
            webp_quality: None,
            uastc_rdo: None,
            meshopt: false,
        };
        match purpose {
            None => plain,
            Some(Purpose::Web) => {
                let packed =
                    Self { images: GltfImages::WebP, webp_quality: Some(85), meshopt: true, ..plain };
                Self { triangles: 20_000, size: 1024, ..packed }
            }
            Some(Purpose::Archive) => Self { triangles: 200_000, size: 4096, bits: 16, ..plain },
            Some(Purpose::Engine) => {
                Self { lods: &[15_000, 5_000], images: GltfImages::Ktx2, uastc_rdo: Some(2), ..plain }
            }
        }
    }
}
