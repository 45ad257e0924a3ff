//! The files of the output folder: their names, and those that shaders share: the albedo tables and the maps of an
//! environment.

use serde::Serialize;
use taotie_engine::render::EnvironmentLight;
use taotie_engine::shade::dfg::{COLUMNS, ROWS, tables};
use taotie_engine::shade::environment::HalfPicture;
use taotie_shader::{EnvironmentAtlas, opaque};

/// A file by its name in the folder.
pub struct NamedFile {
    /// Its name.
    pub name: String,
    /// Its whole content.
    pub bytes: Vec<u8>,
}

impl NamedFile {
    /// Makes a file.
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into() }
    }
}

/// Maximum length of a name, characters.
const LONGEST: usize = 60;

/// Unique shader names, even on file systems that ignore case.
#[derive(Default)]
pub struct Names(Vec<String>);

impl Names {
    /// Returns a name of letters, digits, `-` and `_` like the one wanted, with a number if it is taken.
    pub fn take(&mut self, wanted: &str) -> String {
        let plain = plain_name(wanted);
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        let mut candidates = std::iter::once(plain.clone()).chain(numbered);
        let free = candidates.find(|name| !self.0.contains(&name.to_lowercase())).unwrap_or(plain);
        self.0.push(free.to_lowercase());
        free
    }
}

/// Returns the name with only ASCII letters, digits, `-` and `_`.
fn plain_name(wanted: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = wanted.split(|c| !is_plain(c)).filter(|word| !word.is_empty());
    let name: String = words.collect::<Vec<_>>().join("-").chars().take(LONGEST).collect();
    if name.is_empty() { "material".into() } else { name }
}

/// The file name of the tables.
pub const TABLES: &str = "albedo-tables.bin";

/// The file names of an environment.
const MAPS: &str = "environment-maps.bin";
const PICTURE: &str = "environment-picture.bin";

/// A texture in a file of raw numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BinaryTexture {
    /// The name of the file.
    pub file: &'static str,
    /// Texels across.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// `rgba32float` or `rgba16float`: four numbers a texel, little-endian, row by row from the top.
    pub format: &'static str,
    /// The meaning of its rows and channels.
    pub meaning: &'static str,
}

/// Returns the description of the albedo tables.
pub fn tables_description() -> BinaryTexture {
    BinaryTexture {
        file: TABLES,
        width: COLUMNS,
        height: 3 * ROWS,
        format: "rgba32float",
        meaning: "Directional albedos: columns go along the square root of n·v from 0 to 1, rows along the roughness from 0 \
            to 1. 48 rows of GGX and 48 of Cook-Torrance hold the factors of F0, of F90 and of the drop of F82, and \
            Schlick's rise over a diffuse reflection; 48 rows of sheen hold its albedo in red.",
    }
}

/// Returns the file of the albedo tables.
pub fn tables_file() -> NamedFile {
    let numbers = tables();
    let bytes: Vec<u8> = numbers.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    NamedFile::new(TABLES, bytes)
}

/// The maps of an environment, as its shaders read them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnvironmentDescription {
    /// `environment_maps`.
    pub maps: BinaryTexture,
    /// `environment_picture`.
    pub picture: BinaryTexture,
    /// `environment_levels`: 32 times four numbers.
    pub levels: Vec<[f32; 4]>,
    /// The number of levels: `frame.environment_levels`.
    pub count: usize,
    /// `frame.smoothest_alpha`.
    pub smoothest_alpha: f32,
}

/// Returns the description of an environment, and its files.
pub fn environment(light: &EnvironmentLight) -> (EnvironmentDescription, [NamedFile; 2]) {
    let maps = light.environment.maps();
    let atlas = EnvironmentAtlas::new(&maps);
    let half = |file, [width, height]: [usize; 2], meaning| BinaryTexture {
        file,
        width,
        height,
        format: "rgba16float",
        meaning,
    };
    let description = EnvironmentDescription {
        maps: half(
            MAPS,
            atlas.size,
            "The levels of the environment, each an unfolded octahedron with a border.",
        ),
        picture: half(
            PICTURE,
            [maps.picture.width, maps.picture.height],
            "The equirectangular picture, divided by its factor.",
        ),
        levels: atlas.table.to_vec(),
        count: maps.levels.len(),
        smoothest_alpha: maps.smoothest_alpha,
    };
    let picture = NamedFile::new(PICTURE, picture_bytes(&maps.picture));
    (description, [NamedFile::new(MAPS, half_bytes(&atlas.texels)), picture])
}

fn picture_bytes(picture: &HalfPicture<'_>) -> Vec<u8> {
    half_bytes(&picture.texels.iter().map(opaque).collect::<Vec<_>>())
}

fn half_bytes(texels: &[[u16; 4]]) -> Vec<u8> {
    texels.as_flattened().iter().flat_map(|half| half.to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_apart() {
        let mut names = Names::default();
        let taken =
            ["Old Gold", "old gold", "../../etc/passwd", "", "黄金", "a.b"].map(|name| names.take(name));
        assert_eq!(taken, ["Old-Gold", "old-gold-2", "etc-passwd", "material", "material-2", "a-b"]);
        assert_eq!(names.take(&"x".repeat(1000)).len(), LONGEST);
    }

    #[test]
    fn the_file_of_tables_is_as_it_is_described() {
        let described = tables_description();
        let bytes = tables_file().bytes;
        assert_eq!(bytes.len(), described.width * described.height * 16);
        let first = f32::from_le_bytes([0, 1, 2, 3].map(|i| bytes[i]));
        assert_eq!(first, tables()[0][0]);
    }
}
