//! The files of a folder of photographs, and the photograph that a name in a file of lights refers to.

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
        let is_other = |name: &str| ["mask", "normal", "normals", "normal_gt"].contains(&stem(name).as_str());
        let is_image = |extension: String| [&READ[..], &UNREAD[..]].concat().contains(&extension.as_str());
        let is_photograph = |name: &&String| is_image(extension(name)) && !is_other(name);
        let photographs = names.iter().filter(is_photograph).cloned().collect();
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
