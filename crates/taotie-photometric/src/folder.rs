//! The files of a folder of photographs, and the photograph that a name in a file of lights refers to.

use crate::diligent;
use crate::relight::Relightable;
use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_io::quote;

/// Extensions of images that are read.
const READ: [&str; 9] = ["png", "jpg", "jpeg", "tif", "tiff", "exr", "hdr", "tga", "webp"];

/// Extensions of images that are not.
const UNREAD: [&str; 8] = ["dng", "cr2", "cr3", "nef", "arw", "raf", "orf", "rw2"];

/// The files of a folder.
pub struct Folder {
    path: PathBuf,
    /// File names, sorted as people number them: `a2` before `a10`.
    names: Vec<String>,
    /// Those of photographs, in the same order: all images except masks and normal maps.
    photographs: Vec<String>,
}

impl Folder {
    /// Lists a folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        let failed = |cause| Error::io(path, cause);
        let mut names = Vec::new();
        for entry in std::fs::read_dir(path).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            if !entry.path().is_dir() {
                names.push(entry.file_name().to_string_lossy().into_owned());
            }
        }
        names.sort_by(|a, b| natural_order(a, b).then_with(|| a.cmp(b)));
        Ok(Self::of_names(path, names))
    }

    fn of_names(path: &Path, names: Vec<String>) -> Self {
        let photographs = names.iter().filter(|name| is_photograph(name.as_ref())).cloned().collect();
        Self { path: path.to_path_buf(), names, photographs }
    }

    /// The names of files with one of these extensions, in any case.
    pub fn with_extension<'a>(&'a self, extensions: &'a [&str]) -> impl Iterator<Item = &'a str> {
        let has = move |name: &&String| extensions.contains(&extension(name).as_str());
        self.names.iter().filter(has).map(String::as_str)
    }

    /// The number of photographs.
    pub fn count(&self) -> usize {
        self.photographs.len()
    }

    /// The mask: an image named `mask`.
    pub fn mask(&self) -> Option<PathBuf> {
        self.with_extension(&READ).find(|name| stem(name) == "mask").map(|name| self.path.join(name))
    }

    /// The path of the file with this name, in any case.
    pub fn find(&self, name: &str) -> Option<PathBuf> {
        let same = |other: &&String| other.to_lowercase() == name.to_lowercase();
        self.names.iter().find(same).map(|name| self.path.join(name))
    }

    /// Returns the path of the photograph that `name` refers to. The name may have another case, folder or extension.
    ///
    /// # Errors
    /// The reason, if there is no such photograph, or several.
    pub fn photograph(&self, name: &str) -> std::result::Result<PathBuf, String> {
        let base = name.rsplit(['/', '\\']).next().unwrap_or(name).trim();
        let lower = base.to_lowercase();
        let number = base.parse::<u64>().ok();
        let rules: [&dyn Fn(&str) -> bool; 4] = [
            &|other| other == base,
            &|other| other.to_lowercase() == lower,
            &|other| !lower.is_empty() && stem(other) == stem(base),
            &|other| number.is_some() && stem(other).parse().ok() == number,
        ];
        for rule in rules {
            let found: Vec<&str> =
                self.photographs.iter().map(String::as_str).filter(|other| rule(other)).collect();
            match found.as_slice() {
                [] => {}
                [one] => return Ok(self.path.join(one)),
                [one, other, ..] => {
                    return Err(format!(
                        "{} matches both '{one}' and '{other}'; name one exactly",
                        quote(base)
                    ));
                }
            }
        }
        Err(format!(
            "{} is not among the {} photographs of {}; correct the name or add the file",
            quote(base),
            self.count(),
            self.path.display()
        ))
    }

    /// Returns the path of photograph `index`, counted from 0.
    pub fn nth(&self, index: usize) -> Option<PathBuf> {
        self.photographs.get(index).map(|name| self.path.join(name))
    }
}

/// Returns true for the name of a photograph, also in a format that is not read: an image except for masks and normal
/// maps.
pub fn is_photograph(file: &Path) -> bool {
    let name = file.to_string_lossy();
    let is_other = ["mask", "normal", "normals", "normal_gt"].contains(&stem(&name).as_str());
    let extension = extension(&name);
    [&READ[..], &UNREAD[..]].concat().contains(&extension.as_str()) && !is_other
}

/// Returns all files that an estimate from a folder, an `.lp` file or a relightable image can depend on: the file itself
/// first, then the photographs, the mask and the files of lights in its folder, sorted as people number them.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be read.
pub fn input_files(path: &Path) -> Result<Vec<PathBuf>> {
    let is_folder = path.is_dir();
    if !is_folder && Relightable::is_named(path) && !is_description(&path.to_string_lossy()) {
        return Ok(vec![path.to_path_buf()]);
    }
    let folder = if is_folder { path } else { path.parent().unwrap_or(Path::new("")) };
    let Folder { names, photographs, .. } = Folder::read(folder)?;
    let is_text = |name: &str| {
        let is_lights = diligent::FILES.iter().any(|file| name.eq_ignore_ascii_case(file));
        is_folder && (is_lights || extension(name) == "lp" || is_description(name))
    };
    let is_mask = |name: &str| stem(name) == "mask" && READ.contains(&extension(name).as_str());
    let is_input = |name: &&String| is_text(name) || is_mask(name) || photographs.contains(name);
    let others = names.iter().filter(is_input).map(|name| folder.join(name));
    let own = (!is_folder).then(|| path.to_path_buf());
    Ok(own.into_iter().chain(others.filter(|other| other != path)).collect())
}

/// Returns true for the description of a relightable image whose planes are images next to it.
fn is_description(name: &str) -> bool {
    extension(name) == "json" && Relightable::is_named(Path::new(name))
}

/// Rejects an image format that is not read.
///
/// # Errors
/// [`Error::Unsupported`], with the format to convert to.
pub fn check_format(path: &Path) -> Result<()> {
    let extension = extension(&path.to_string_lossy());
    if !UNREAD.contains(&extension.as_str()) {
        return Ok(());
    }
    let what = format!("{}: the image format '{extension}'", path.display());
    Err(Error::unsupported(
        what,
        "convert the photographs to 16-bit TIFF or PNG in linear light, without a tone curve",
    ))
}

fn extension(name: &str) -> String {
    Path::new(name).extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

fn stem(name: &str) -> String {
    Path::new(name).file_stem().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Compares names with their numbers as numbers, and letters in any case.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a.chars().peekable(), b.chars().peekable());
    loop {
        match (a.peek().copied(), b.peek().copied()) {
            (Some(x), Some(y)) if x.is_ascii_digit() && y.is_ascii_digit() => {
                let [x, y] = [digits(&mut a), digits(&mut b)];
                match x.len().cmp(&y.len()).then_with(|| x.cmp(&y)) {
                    Ordering::Equal => {}
                    order => return order,
                }
            }
            (Some(x), Some(y)) => match x.to_lowercase().cmp(y.to_lowercase()) {
                Ordering::Equal => {
                    a.next();
                    b.next();
                }
                order => return order,
            },
            (x, y) => return x.is_some().cmp(&y.is_some()),
        }
    }
}

/// Takes the leading digits, without leading zeros.
fn digits(chars: &mut std::iter::Peekable<std::str::Chars<'_>>) -> String {
    let mut found = String::new();
    while let Some(digit) = chars.next_if(char::is_ascii_digit) {
        found.push(digit);
    }
    found.trim_start_matches('0').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_are_numbers() {
        let mut names = ["IMG_10.jpg", "img_9.jpg", "IMG_2.jpg", "a.jpg", "img_010b.jpg"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["a.jpg", "IMG_2.jpg", "img_9.jpg", "IMG_10.jpg", "img_010b.jpg"]);
    }

    #[test]
    fn inputs_are_photographs_masks_and_lights() {
        let place = tempfile::tempdir().expect("temporary folders can be made");
        for name in [
            "p10.png",
            "p9.png",
            "mask.png",
            "normal_gt.png",
            "a.lp",
            "b.lp",
            "notes.txt",
            "x.ptm",
            "filenames.txt",
        ] {
            std::fs::write(place.path().join(name), "").expect("it can be written");
        }
        std::fs::create_dir(place.path().join("out.png")).expect("it is new");
        let inputs = |path: PathBuf| {
            let found = input_files(&path).expect("it can be read");
            let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            found.iter().map(name).collect::<Vec<_>>()
        };
        let of_folder = ["a.lp", "b.lp", "filenames.txt", "mask.png", "p9.png", "p10.png"];
        assert_eq!(inputs(place.path().to_path_buf()), of_folder);
        assert_eq!(inputs(place.path().join("b.lp")), ["b.lp", "mask.png", "p9.png", "p10.png"]);
        assert_eq!(inputs(place.path().join("x.ptm")), ["x.ptm"]);
        assert!(input_files(&place.path().join("none/a.lp")).is_err());
    }

    #[test]
    fn names_of_other_folders_cases_and_extensions_are_found() {
        let names = ["Coin 01.PNG", "coin 02.png", "0003.png", "mask.png", "x.jpg", "x.png", "notes.txt"];
        let folder = Folder::of_names(Path::new("p"), names.map(str::to_owned).to_vec());
        let found = |name: &str| folder.photograph(name).map(|path| path.to_string_lossy().into_owned());
        let first = Ok("p/Coin 01.PNG".to_owned());
        for name in ["Coin 01.PNG", "coin 01.png", "D:\\dome\\COIN 01.JPG", "/home/a/coin 01.tif", "coin 01"]
        {
            assert_eq!(found(name).map(|path| path.replace('\\', "/")), first, "{name}");
        }
        assert!(found("3").is_ok_and(|path| path.ends_with("0003.png")));
        assert!(found("x").unwrap_err().contains("both 'x.jpg' and 'x.png'"));
        assert!(found("y.png").unwrap_err().contains("not among the 5 photographs"));
        assert!(found("mask.png").is_err() && found("").is_err());
        assert_eq!(folder.mask(), Some(PathBuf::from("p").join("mask.png")));
    }
}
