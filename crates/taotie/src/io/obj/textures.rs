//! The images that MTL files refer to, each read once.

use super::super::bitmap::read_map;
use super::super::locate::find;
use super::super::reading::Reading;
use super::super::text::quote;
use super::super::texture_room::{combined, texture};
use super::mtl::{Channel, Map};
use crate::error::Warnings;
use crate::image::{Bitmap, Encoding, Texels, Texture};
use crate::surface::{NormalMapKind, is_normal_map};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Maximum number of missing files that are named individually.
const NAMED: usize = 64;

/// The textures of a scene under construction.
pub(super) struct Textures<'a> {
    /// The reading of the OBJ file.
    reading: &'a Reading,
    /// The textures, which materials refer to by index.
    pub list: Vec<Texture>,
    /// The source files of each texture.
    pub names: Vec<String>,
    /// The files that were opened, including those that could not be decoded.
    pub files: Vec<PathBuf>,
    /// The files that do not exist.
    pub missing_files: Vec<String>,
    known: HashMap<String, Option<usize>>,
    missing: HashSet<String>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(reading: &'a Reading) -> Self {
        Self {
            reading,
            list: Vec::new(),
            names: Vec::new(),
            files: Vec::new(),
            missing_files: Vec::new(),
            known: HashMap::new(),
            missing: HashSet::new(),
        }
    }

    /// Returns the texture under `key`, made from the files `name`; `make` makes it on the first call. `None` if that
    /// failed.
    pub(super) fn keyed(
        &mut self,
        key: String,
        name: &str,
        make: impl FnOnce(&mut Self) -> Option<Texture>,
    ) -> Option<usize> {
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let index = make(self).map(|texture| {
            self.list.push(texture);
            self.names.push(name.to_owned());
            self.list.len() - 1
        });
        self.known.insert(key, index);
        index
    }

    /// Returns the image of `map` as a separate texture.
    pub(super) fn plain(
        &mut self,
        map: &Map,
        folder: &Path,
        encoding: Encoding,
        warnings: &mut Warnings,
    ) -> Option<usize> {
        let key = format!("{encoding:?} {}", full_name(map, folder));
        self.keyed(key, &map.file, |s| texture(s.reading, s.bitmap(map, folder, warnings)?, encoding))
    }

    /// Returns the image of `map` as a normal map if its pixels are one, else as heights.
    pub(super) fn relief(&mut self, map: &Map, folder: &Path, warnings: &mut Warnings) -> Option<usize> {
        let key = format!("relief {}", full_name(map, folder));
        self.keyed(key, &map.file, |s| {
            let bitmap = s.bitmap(map, folder, warnings)?;
            let is_heights = is_normal_map(&bitmap) == NormalMapKind::No;
            texture(s.reading, bitmap, if is_heights { Encoding::Linear } else { Encoding::Normal })
        })
    }

    /// Makes a texture from channels of several images; `None` if there are none, or it does not fit in memory.
    pub(super) fn combined(&self, bitmap: Option<Bitmap>, encoding: Encoding) -> Option<Texture> {
        combined(self.reading, bitmap?, encoding)
    }

    /// Returns the image of `map`; `None` with a note if it cannot be read.
    pub(super) fn bitmap(&mut self, map: &Map, folder: &Path, warnings: &mut Warnings) -> Option<Bitmap> {
        let name = full_name(map, folder);
        if self.missing.contains(&name) {
            return None;
        }
        let why = match find(&map.file, &[folder, self.reading.folder()], self.reading) {
            Ok(None) => {
                self.missing_files.push(map.file.clone());
                "file not found".to_owned()
            }
            Err(why) => {
                self.missing_files.push(map.file.clone());
                why
            }
            Ok(Some(path)) => {
                self.files.push(path.clone());
                match read_map(&path, self.reading) {
                    Ok(bitmap) => return Some(bitmap),
                    Err(error) => error.to_string(),
                }
            }
        };
        self.missing.insert(name);
        let what = if self.missing.len() > NAMED {
            "skipped further unreadable textures".to_owned()
        } else {
            format!("skipped texture {}: {why}", quote(&map.file))
        };
        warnings.note(what, 1);
        None
    }

    /// Returns `true` if the image of `map` could be read, after it was requested.
    pub(super) fn has(&self, map: &Map, folder: &Path) -> bool {
        !self.missing.contains(&full_name(map, folder))
    }
}

fn full_name(map: &Map, folder: &Path) -> String {
    format!("{} in {}", map.file, folder.display())
}

/// The channel that a map reads from an image, in [0, 1], at a position in [0, 1), using the nearest texel.
pub(super) struct ChannelReader<'a> {
    bitmap: &'a Bitmap,
    channel: Channel,
}

impl<'a> ChannelReader<'a> {
    pub(super) fn new(bitmap: &'a Bitmap, channel: Channel) -> Self {
        Self { bitmap, channel }
    }

    fn at(&self, x: u32, y: u32, size: (u32, u32)) -> f32 {
        let scaled = |i: u32, n: u32, to: u32| (u64::from(i) * u64::from(to) / u64::from(n)) as usize;
        let column = scaled(x, size.0, self.bitmap.width());
        let row = scaled(y, size.1, self.bitmap.height());
        let texel = self.bitmap.stored(row * self.bitmap.width() as usize + column);
        let value = match self.channel {
            Channel::Stored(c) => texel[c],
            Channel::Mean => (texel[0] + texel[1] + texel[2]) / 3.0,
        };
        if value > 0.0 { value.min(1.0) } else { 0.0 }
    }
}

/// Makes a linear image from channels of other images; `None` is 1 everywhere. It has the size of the largest of
/// them, and 16 bits if any has more than 8.
pub(super) fn combine(channels: [Option<ChannelReader>; 4]) -> Option<Bitmap> {
    let sources = || channels.iter().flatten().map(|r| r.bitmap);
    let size = (sources().map(Bitmap::width).max()?, sources().map(Bitmap::height).max()?);
    let deep = sources().any(|b| b.bits() > 8);
    let texel = |i: u64| {
        let (x, y) = ((i % u64::from(size.0)) as u32, (i / u64::from(size.0)) as u32);
        std::array::from_fn(|c| channels[c].as_ref().map_or(1.0, |reader| reader.at(x, y, size)))
    };
    let count = u64::from(size.0) * u64::from(size.1);
    let texels = if deep {
        Texels::U16((0..count).map(|i| texel(i).map(|v: f32| (v * 65535.0 + 0.5) as u16)).collect())
    } else {
        Texels::U8((0..count).map(|i| texel(i).map(|v: f32| (v * 255.0 + 0.5) as u8)).collect())
    };
    Bitmap::new(size.0, size.1, 4, texels).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combines_pictures_of_different_size() {
        let small = Bitmap::new(1, 1, 1, Texels::U8(vec![[51; 4]])).unwrap();
        let wide = Bitmap::new(2, 1, 3, Texels::U8(vec![[0, 7, 30, 255], [0, 9, 60, 255]])).unwrap();
        let green = ChannelReader::new(&small, Channel::Stored(0));
        let blue = ChannelReader::new(&wide, Channel::Mean);
        let both = combine([None, Some(green), Some(blue), None]).unwrap();
        assert_eq!(both.texels(), &Texels::U8(vec![[255, 51, 12, 255], [255, 51, 23, 255]]));
        assert!(combine([None, None, None, None]).is_none());
    }
}
