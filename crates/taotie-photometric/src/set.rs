//! A set of photographs with their lights, from an `.lp` file or a folder.

use crate::calibration::{Balls, Setup, brightness_of, lights_of_balls};
use crate::circle::Circle;
use crate::diligent::{self, Text};
use crate::folder::{Folder, check_format};
use crate::light::{self, Light};
use crate::lp::{Entry, parse_lp};
use crate::photograph::{Photograph, Shape};
use crate::relight::{Relightable, lights_of_relit};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, Warnings};
use taotie_io::{decode_text, quote, read_bytes, read_photograph_within};

/// Photographs of one object from one position, each under one light.
#[derive(Debug, Clone)]
pub struct PhotographSet {
    /// The photographs, at least four, whose lights determine a normal.
    pub photographs: Vec<Photograph>,
    /// An image named `mask` next to them.
    pub mask: Option<PathBuf>,
    /// The file that states the lights, or the folder of photographs with chrome balls.
    pub lights: PathBuf,
    /// `lp`, `diligent`, `balls` or `relightable`.
    pub layout: &'static str,
    /// All files that were read, except for the photographs.
    pub files: Vec<PathBuf>,
    /// Chrome and grey balls in the photographs, which are not estimated.
    pub balls: Vec<Circle>,
    /// The chrome balls that the lights follow from.
    pub chrome: Option<Balls>,
    /// The relightable image that the photographs are made from, one for each light; their paths are only names.
    pub relightable: Option<Relightable>,
}

/// Refuses an output folder that contains one of the inputs of a set: masks and other images in it would be input of the
/// next estimate.
///
/// # Errors
/// [`Error::Invalid`] with the folder.
pub fn check_output(inputs: &[PathBuf], folder: &Path) -> Result<()> {
    // An empty path is the current folder.
    let resolved = |path: &Path| Path::new(".").join(path).canonicalize().ok();
    let output = resolved(folder);
    let is_output = |input: &PathBuf| output.is_some() && input.parent().and_then(resolved) == output;
    match inputs.iter().any(is_output) {
        true => Err(Error::invalid(
            folder.display().to_string(),
            "the folder of the photographs; the mask and other images written there would be input of the next run: \
             name another folder",
        )),
        false => Ok(()),
    }
}

/// The longest file of lights, bytes.
const LONGEST: usize = 1 << 24;

impl PhotographSet {
    /// Opens an `.lp` file, a folder with one, or a folder in the layout of DiLiGenT. The photographs are not read yet.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::Parse`] with file and line, [`Error::Invalid`] if it is unclear which lights count, or
    /// if they do not determine a normal.
    pub fn open(path: &Path, warnings: &mut Warnings) -> Result<Self> {
        Self::open_with(path, &Setup::default(), warnings, Progress::SILENT)
    }

    /// Opens the same, or a folder whose photographs show chrome balls, given more that is known about them.
    ///
    /// # Errors
    /// Those of [`PhotographSet::open`], and of reading photographs if balls are looked for or given.
    pub fn open_with(
        path: &Path,
        setup: &Setup,
        warnings: &mut Warnings,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let mut set = Self::find(path, setup, warnings, progress)?;
        if let Some(ball) = &setup.grey_ball {
            let brightness = brightness_of(&set.photographs, ball, setup, progress.begin("grey ball")?)?;
            for (photograph, brightness) in set.photographs.iter_mut().zip(brightness) {
                photograph.light.intensity = [brightness; 3];
            }
            set.balls.push(*ball);
        }
        Ok(set)
    }

    /// Returns all files that it consists of.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let photographs = self.photographs.iter().filter(|_| self.relightable.is_none());
        let photographs = photographs.map(|photograph| &photograph.path);
        photographs.chain(&self.files).chain(&self.mask).cloned().collect()
    }

    fn find(path: &Path, setup: &Setup, warnings: &mut Warnings, progress: Progress<'_>) -> Result<Self> {
        let given = !setup.balls.is_empty();
        if !path.is_dir() {
            if given {
                return Err(several(&path.display().to_string(), "chrome balls"));
            }
            return match Relightable::is_named(path) {
                true => Self::of_relightable(path, setup, warnings),
                false => Self::of_lp(path, setup, warnings),
            };
        }
        let folder = Folder::read(path)?;
        let lps: Vec<&str> = folder.with_extension(&["lp"]).collect();
        let found = diligent::FILES.map(|name| folder.find(name));
        match (lps.as_slice(), found) {
            ([], [Some(_), Some(_), Some(intensities)]) if setup.grey_ball.is_some() => {
                let what = format!("{} and a grey ball: two sources of brightness", intensities.display());
                Err(Error::invalid(what, "give only one of them"))
            }
            ([], [Some(names), Some(directions), intensities]) => {
                Self::of_diligent(&folder, [names, directions], intensities, warnings)
            }
            ([], [None, None, _]) if !given && Relightable::of_folder(path).is_some() => {
                let info = Relightable::of_folder(path).unwrap_or_default();
                Self::of_relightable(&info, setup, warnings)
            }
            ([], [None, None, _]) => {
                Self::of_balls((&folder, path), setup, progress)?.checked(&folder, warnings)
            }
            (lps, [names, ..]) if given => {
                let file =
                    lps.first().map(|lp| (*lp).to_owned()).or(names.map(|path| path.display().to_string()));
                Err(several(&file.unwrap_or_default(), "chrome balls"))
            }
            ([], [names, ..]) => {
                let missing = diligent::FILES[usize::from(names.is_some())];
                Err(Error::invalid(
                    format!("{}: {missing} is missing", path.display()),
                    "add it, or an .lp file",
                ))
            }
            ([lp], [None, None, _]) => Self::of_lp(&path.join(lp), setup, warnings),
            (lps, found) => {
                let names = found
                    .iter()
                    .flatten()
                    .filter_map(|path| path.file_name())
                    .map(|name| name.to_string_lossy());
                let all: Vec<_> = lps.iter().map(|lp| (*lp).into()).chain(names).collect();
                Err(Error::invalid(
                    format!("{}: several files of lights ({})", path.display(), all.join(", ")),
                    "name the .lp file to use, or move the others away",
                ))
            }
        }
    }

    fn of_lp(path: &Path, setup: &Setup, warnings: &mut Warnings) -> Result<Self> {
        let entries = parse_lp(path, &text_of(path)?)?;
        let folder = Folder::read(path.parent().unwrap_or(Path::new(".")))?;
        let files = Names::new(&entries, &folder);
        let mut photographs = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            let at = || format!("line {}", entry.line);
            let file = files.path(i, entry).map_err(|what| Error::parse(path, at(), what))?;
            let zero = || {
                Error::parse(path, at(), "the vector towards the light has no direction; correct its numbers")
            };
            photographs
                .push(Photograph { path: file, light: Light::towards(entry.vector).ok_or_else(zero)? });
        }
        let lines: Vec<usize> = entries.iter().map(|entry| entry.line).collect();
        check_unique(path, &lines, &photographs)?;
        place_lamps(&mut photographs, &entries, setup, warnings)?;
        let set = Self::new(photographs, path, "lp");
        Self { mask: folder.mask(), files: vec![path.into()], ..set }.checked(&folder, warnings)
    }

    fn of_diligent(
        folder: &Folder,
        [names, directions]: [PathBuf; 2],
        intensities: Option<PathBuf>,
        warnings: &mut Warnings,
    ) -> Result<Self> {
        let read = |path: PathBuf| text_of(&path).map(|text| Text { path, text });
        let (names, directions) = (read(names)?, read(directions)?);
        let intensities = intensities.map(read).transpose()?;
        if intensities.is_none() {
            warnings
                .note(format!("{} is missing: all lights are assumed equally bright", diligent::FILES[2]), 1);
        }
        let lines = diligent::parse_diligent(&names, &directions, intensities.as_ref())?;
        let mut photographs = Vec::with_capacity(lines.len());
        for (line, name, light) in &lines {
            let file = folder
                .photograph(name)
                .map_err(|what| Error::parse(&names.path, format!("line {line}"), what))?;
            photographs.push(Photograph { path: file, light: *light });
        }
        let numbers: Vec<usize> = lines.iter().map(|(line, ..)| *line).collect();
        check_unique(&names.path, &numbers, &photographs)?;
        let files = [Some(&names), Some(&directions), intensities.as_ref()];
        let files = files.into_iter().flatten().map(|file| file.path.clone()).collect();
        let set = Self::new(photographs, &directions.path, "diligent");
        Self { mask: folder.mask(), files, ..set }.checked(folder, warnings)
    }

    /// Makes photographs from a relightable image.
    fn of_relightable(path: &Path, setup: &Setup, warnings: &mut Warnings) -> Result<Self> {
        if setup.grey_ball.is_some() {
            let what = format!("{}: a relightable image has no photographs of a grey ball", path.display());
            return Err(Error::invalid(what, "leave the ball out: its lights are equally bright"));
        }
        let mask = Folder::read(path.parent().unwrap_or(Path::new(".")))?.mask();
        let image = Relightable::open(path, &setup.limits)?;
        warnings.note(
            "relit from an image, not photographed: shadows and highlights are smoothed, so that normals are less accurate, and \
             their sigma is a rough estimate",
            1,
        );
        let photograph = |(i, direction)| Photograph {
            path: format!("light {}", i + 1).into(),
            light: Light { direction, intensity: [1.0; 3], position: None },
        };
        let photographs = lights_of_relit().into_iter().enumerate().map(photograph).collect();
        let set = Self::new(photographs, path, "relightable");
        Ok(Self { mask, files: vec![path.into()], relightable: Some(image), ..set })
    }

    fn of_balls((folder, path): (&Folder, &Path), setup: &Setup, progress: Progress<'_>) -> Result<Self> {
        let paths: Vec<PathBuf> = (0..folder.count()).filter_map(|i| folder.nth(i)).collect();
        paths.iter().try_for_each(|path| check_format(path))?;
        if paths.len() < light::FEWEST {
            return Err(Error::invalid(
                format!("{}: {} photographs", path.display(), paths.len()),
                format!("at least {} are needed", light::FEWEST),
            ));
        }
        let (lights, chrome) = lights_of_balls(path, &paths, setup, progress.begin("chrome balls")?)?;
        let photographs = paths.into_iter().zip(lights).map(|(path, light)| Photograph { path, light });
        let balls = chrome.outlines.iter().map(|outline| outline.circle).collect();
        let set = Self::new(photographs.collect(), path, "balls");
        Ok(Self { mask: folder.mask(), balls, chrome: Some(chrome), ..set })
    }

    /// Makes a set from photographs whose near lamps are equally bright. `lights` is the file or folder that the lights
    /// are from.
    fn new(mut photographs: Vec<Photograph>, lights: &Path, layout: &'static str) -> Self {
        light::equalise(photographs.iter_mut().map(|photograph| &mut photograph.light).collect());
        Self {
            photographs,
            mask: None,
            lights: lights.to_path_buf(),
            layout,
            files: Vec::new(),
            balls: Vec::new(),
            chrome: None,
            relightable: None,
        }
    }

    fn checked(self, folder: &Folder, warnings: &mut Warnings) -> Result<Self> {
        let lights: Vec<Light> = self.photographs.iter().map(|photograph| photograph.light).collect();
        light::check(&lights, &self.lights.display().to_string())?;
        self.photographs.iter().try_for_each(|photograph| check_format(&photograph.path))?;
        light::note_behind(&lights, warnings);
        let unlisted = folder.count().saturating_sub(self.photographs.len());
        warnings.note("a photograph in the folder has no light", unlisted);
        Ok(self)
    }

    /// Returns the mask that counts: the one given, otherwise that of the set.
    pub fn mask_or<'a>(&'a self, given: Option<&'a Path>) -> Option<&'a Path> {
        given.or(self.mask.as_deref())
    }

    /// Returns the lights, in the order of the photographs.
    pub fn lights(&self) -> Vec<Light> {
        self.photographs.iter().map(|photograph| photograph.light).collect()
    }
}

fn text_of(path: &Path) -> Result<String> {
    let bytes = read_bytes(path)?;
    if bytes.len() > LONGEST {
        return Err(Error::limit(
            path.display().to_string(),
            "at most 16 MiB of text; is it a file of lights?",
        ));
    }
    if bytes.iter().take(1024).filter(|byte| **byte == 0).count() > 512 {
        return Err(Error::parse(path, "byte 0", "not a text file; expected lines `NAME X Y Z`"));
    }
    Ok(decode_text(bytes))
}

/// The meaning of the names of an `.lp` file.
struct Names<'a> {
    folder: &'a Folder,
    /// The number of the first photograph, if names are numbers in a series.
    first: Option<u64>,
}

impl<'a> Names<'a> {
    fn new(entries: &[Entry], folder: &'a Folder) -> Self {
        let numbers: Option<Vec<u64>> = entries.iter().map(|entry| entry.name.parse().ok()).collect();
        let first = numbers.and_then(|numbers| numbers.into_iter().min());
        Self { folder, first: first.filter(|first| *first <= 1) }
    }

    /// Returns the photograph of entry `i`.
    fn path(&self, i: usize, entry: &Entry) -> std::result::Result<PathBuf, String> {
        let number = match (entry.name.is_empty(), self.first) {
            (true, _) => i as u64,
            (false, Some(first)) => match self.folder.photograph(&entry.name) {
                Ok(path) => return Ok(path),
                Err(_) => entry.name.parse::<u64>().unwrap_or(u64::MAX).saturating_sub(first),
            },
            (false, None) => return self.folder.photograph(&entry.name),
        };
        let count = self.folder.count();
        let missing =
            || format!("photograph {} of {count}: the folder has too few", number.saturating_add(1));
        usize::try_from(number).ok().and_then(|i| self.folder.nth(i)).ok_or_else(missing)
    }
}

/// Rejects a photograph that is listed twice.
fn check_unique(file: &Path, lines: &[usize], photographs: &[Photograph]) -> Result<()> {
    let mut first: HashMap<&Path, usize> = HashMap::new();
    for (line, photograph) in lines.iter().zip(photographs) {
        if let Some(other) = first.insert(&photograph.path, *line) {
            let name = quote(&photograph.path.file_name().unwrap_or_default().to_string_lossy());
            let what = format!("{name} is also the photograph of line {other}; list each once");
            return Err(Error::parse(file, format!("line {line}"), what));
        }
    }
    Ok(())
}

fn several(file: &str, other: &str) -> Error {
    Error::invalid(format!("{file} and {other}: two sources of lights"), "give only one of them")
}

/// Sets the positions of lamps if the pixel size is known and the vectors of the `.lp` file are positions; otherwise
/// notes vectors that may be positions. They are directions if all have length 1, or if all end closer to the centre than
/// the picture's corners, where no lamp can be.
fn place_lamps(
    photographs: &mut [Photograph],
    entries: &[Entry],
    setup: &Setup,
    warnings: &mut Warnings,
) -> Result<()> {
    let lengths = || entries.iter().map(|entry| Vec3::from_array(entry.vector).length());
    let (least, most) = lengths().fold((f64::INFINITY, 0.0), |(least, most), v| (v.min(least), v.max(most)));
    let Some(pixel_size) = setup.pixel_size else {
        let remedy = ", unless --pixel-size states the size of a pixel in their unit";
        light::note_lengths(lengths(), remedy, warnings);
        return Ok(());
    };
    if least > 0.99 && most < 1.01 {
        return Ok(());
    }
    let Some(first) = photographs.first() else { return Ok(()) };
    let Shape { width, height, .. } = Shape::of(&read_photograph_within(&first.path, &setup.limits)?);
    let corner = 0.5 * pixel_size * f64::from(width).hypot(f64::from(height));
    if most < corner {
        let what = format!(
            "the vectors of the lights end closer to the centre than the picture's corners ({corner:.3} away in the \
             unit of --pixel-size): only their directions are used; if they are positions of lamps, state the size of \
             a pixel in their unit"
        );
        warnings.note(what, 1);
        return Ok(());
    }
    for (photograph, entry) in photographs.iter_mut().zip(entries) {
        photograph.light.position = Some(Vec3::from_array(entry.vector) / pixel_size);
    }
    Ok(())
}
