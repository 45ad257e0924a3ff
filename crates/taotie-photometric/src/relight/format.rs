//! Files of relightable images.

use super::basis::Basis;
use super::image::{ColorModel, Relightable};
use super::{ptm, rti, web};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::names::Named;
use taotie_io::{Bytes, FileBytes, Limits, file_size, read_bytes};

/// A kind of file for relightable images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum RelightFormat {
    /// A polynomial texture map of a colour and a brightness.
    Ptm,
    /// A polynomial texture map of three channels: twice the size, for objects with coloured highlights.
    PtmRgb,
    /// Hemispherical harmonics of three channels.
    Rti,
    /// A folder of JPEG images with `info.json`, for web viewers.
    Web,
}

impl Named for RelightFormat {
    const WHAT: &'static str = "relightable format";
    const NAMES: &'static [(&'static str, Self)] =
        &[("ptm", Self::Ptm), ("ptm-rgb", Self::PtmRgb), ("rti", Self::Rti), ("openlime", Self::Web)];
}

impl TryFrom<String> for RelightFormat {
    type Error = Error;

    fn try_from(name: String) -> Result<Self> {
        Self::from_name(&name)
    }
}

impl From<RelightFormat> for &'static str {
    fn from(format: RelightFormat) -> Self {
        format.name()
    }
}

impl RelightFormat {
    /// The functions of the light for a number of photographs. Numbers of terms are those with which each photograph is
    /// predicted best from the others (docs/photometric.md); web viewers know at most 9.
    pub fn basis(self, photographs: usize) -> Basis {
        match (self, photographs) {
            (Self::Ptm | Self::PtmRgb, _) => Basis::Ptm,
            (_, ..26) => Basis::Hsh(1),
            (Self::Rti, 60..) => Basis::Hsh(3),
            _ => Basis::Hsh(2),
        }
    }

    /// How colours are stored.
    pub fn colors(self) -> ColorModel {
        match self {
            Self::Ptm => ColorModel::Lrgb,
            Self::PtmRgb | Self::Rti | Self::Web => ColorModel::Rgb,
        }
    }

    /// Returns the files of a relightable image, with `path` as the name of the file or folder.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if a JPEG cannot be as wide or high.
    pub fn files(self, image: &Relightable, path: &Path) -> Result<Vec<FileBytes>> {
        let one = |bytes| vec![FileBytes { path: path.to_path_buf(), bytes }];
        match self {
            Self::Ptm | Self::PtmRgb => Ok(one(ptm::encode(image))),
            Self::Rti => Ok(one(rti::encode(image))),
            Self::Web => web::encode(image, path),
        }
    }

    /// Returns an image as its files hold it: JPEG changes it a little.
    ///
    /// # Errors
    /// None that can occur for files of [`RelightFormat::files`].
    pub fn held(self, image: Relightable, files: &[FileBytes]) -> Result<Relightable> {
        if self == Self::Web { web::written(files) } else { Ok(image) }
    }
}

impl Relightable {
    /// Returns true for the name of a file of a relightable image: `.ptm`, `.rti` or `info.json`.
    pub fn is_named(path: &Path) -> bool {
        let has = |extension: &str| path.extension().is_some_and(|own| own.eq_ignore_ascii_case(extension));
        has("ptm") || has("rti") || path.file_name().is_some_and(|name| name == web::INFO)
    }

    /// Returns the description of a web viewer's images in a folder, if it has one.
    pub fn of_folder(folder: &Path) -> Option<PathBuf> {
        Some(folder.join(web::INFO)).filter(|path| path.is_file())
    }

    /// Reads a `.ptm` or `.rti` file, or the images described by an `info.json`.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Io`]; [`taotie_engine::Error::Parse`] if a file is damaged;
    /// [`taotie_engine::Error::Unsupported`] for other kinds of coefficients;
    /// [`taotie_engine::Error::Limit`].
    pub fn open(path: &Path, limits: &Limits) -> Result<Self> {
        /// The file and its planes.
        const COPIES: u64 = 3;
        let what = || path.display().to_string();
        limits.check(what(), Bytes(file_size(path)?.saturating_mul(COPIES)))?;
        let bytes = read_bytes(path)?;
        match bytes.as_slice() {
            [b'P', b'T', b'M', ..] => ptm::decode(&bytes, path),
            [b'{', ..] => web::decode(&bytes, path, limits),
            _ if path.file_name().is_some_and(|name| name == web::INFO) => web::decode(&bytes, path, limits),
            _ => rti::decode(&bytes, path),
        }
    }
}
