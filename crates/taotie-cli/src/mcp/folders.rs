//! The folders that tools may use, and the check that a path is in one of them.

use anyhow::{Context, Result, bail};
use percent_encoding::percent_decode_str;
use std::ffi::OsStr;
use std::fs;
use std::path::{Component, Path, PathBuf};
use taotie_io::names_network;

/// The folders that tools may read and write.
#[derive(Debug, Clone)]
pub struct Folders {
    /// All folders, without links; the first is the base of relative paths.
    allowed: Vec<PathBuf>,
    /// Bounds on roots: they must be in one of these folders. Empty if there are none.
    bounds: Vec<PathBuf>,
}

impl Folders {
    /// Returns the folders given on the command line, otherwise the folder `here`; none if that is the root of a file
    /// system, where some clients start their servers.
    ///
    /// # Errors
    /// If one is not a folder.
    pub fn of_command(given: &[PathBuf], here: &Path) -> Result<Self> {
        let bounds = given.iter().map(|path| folder(path)).collect::<Result<Vec<_>>>()?;
        if bounds.is_empty() {
            let here = folder(here)?;
            let allowed = if here.parent().is_some() { vec![here] } else { Vec::new() };
            return Ok(Self { allowed, bounds });
        }
        Ok(Self { allowed: bounds.clone(), bounds })
    }

    /// Returns the folders that a client declares as roots, within those of the command line. Roots that are not
    /// existing folders of this machine are left out. An empty list declares nothing: clients without a project send
    /// it.
    pub fn of_roots(&self, uris: &[&str]) -> Self {
        if uris.is_empty() {
            return self.clone();
        }
        let roots = uris.iter().filter_map(|uri| folder(&path_of(uri)?).ok());
        let allowed = roots.flat_map(|root| self.within_bounds(root)).collect();
        Self { allowed, bounds: self.bounds.clone() }
    }

    /// Returns the parts of a root that are within the bounds.
    fn within_bounds(&self, root: PathBuf) -> Vec<PathBuf> {
        if self.bounds.is_empty() || self.bounds.iter().any(|bound| root.starts_with(bound)) {
            return vec![root];
        }
        self.bounds.iter().filter(|bound| bound.starts_with(&root)).cloned().collect()
    }

    /// Returns the absolute path of a file, without links, if it is in one of the folders; it need not exist.
    ///
    /// # Errors
    /// If it is elsewhere, or contains `..`.
    pub fn resolve(&self, given: &OsStr) -> Result<PathBuf> {
        let path = Path::new(given);
        let shown = path.display();
        if given.is_empty() {
            bail!("a path is empty; name a file");
        }
        if path.components().any(|component| component == Component::ParentDir) {
            bail!("{shown}: paths with `..` are not allowed; {}", self.advice());
        }
        let Some(base) = self.allowed.first() else {
            bail!("{shown}: {}", self.advice());
        };
        let path = base.join(path);
        if names_network(&path) && !self.holds(&path) {
            bail!("{shown}: outside the allowed folders; {}", self.advice());
        }
        let real = without_links(&path).with_context(|| format!("{shown}: a link leads nowhere"))?;
        if !self.holds(&real) {
            bail!("{shown}: outside the allowed folders; {}", self.advice());
        }
        Ok(real)
    }

    /// Rejects a file outside the folders, whose path may contain `..`.
    ///
    /// # Errors
    /// If it is elsewhere.
    pub fn check(&self, file: &Path) -> Result<()> {
        let real = file.canonicalize().or_else(|_| without_links(file)).unwrap_or_default();
        let climbs = real.components().any(|component| component == Component::ParentDir);
        match self.holds(&real) && !climbs {
            true => Ok(()),
            false => bail!("{}: outside the allowed folders; {}", file.display(), self.advice()),
        }
    }

    fn holds(&self, path: &Path) -> bool {
        self.allowed.iter().any(|folder| path.starts_with(folder))
    }

    /// Returns the folders as advice in an error.
    fn advice(&self) -> String {
        let names: Vec<String> = self.allowed.iter().map(|folder| folder.display().to_string()).collect();
        match names.is_empty() {
            true => "no folder is allowed; specify folders on the command line of the server".into(),
            false => format!("use files in {}", names.join(", ")),
        }
    }
}

/// Returns an existing folder without links.
fn folder(path: &Path) -> Result<PathBuf> {
    let real = path.canonicalize().with_context(|| path.display().to_string())?;
    match real.is_dir() {
        true => Ok(real),
        false => bail!("{}: not a folder", path.display()),
    }
}

/// Returns the path of a `file:` URI of this machine.
fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let rest = rest.strip_prefix("localhost").unwrap_or(rest);
    let path = percent_decode_str(rest).decode_utf8().ok()?;
    // On Windows, /C:/scans is C:/scans.
    let has_drive = |rest: &&str| cfg!(windows) && rest.as_bytes().get(1) == Some(&b':');
    let path = path.strip_prefix('/').filter(has_drive).unwrap_or(&path);
    Path::new(path).is_absolute().then(|| path.into())
}

/// Resolves all links of the part of a path that exists. The rest contains no `..`.
fn without_links(path: &Path) -> std::io::Result<PathBuf> {
    let exists = |part: &&Path| fs::symlink_metadata(part).is_ok();
    let Some(existing) = path.ancestors().find(exists) else { return Ok(path.to_path_buf()) };
    let rest = path.strip_prefix(existing).unwrap_or(Path::new(""));
    let real = existing.canonicalize()?;
    Ok(if rest.as_os_str().is_empty() { real } else { real.join(rest) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a place with the folders `in` and `out`, each with a file, and the folder `in` as the allowed one.
    fn place() -> (tempfile::TempDir, Folders) {
        let place = tempfile::tempdir().unwrap();
        for name in ["in", "out"] {
            fs::create_dir(place.path().join(name)).unwrap();
            fs::write(place.path().join(name).join("a.obj"), "").unwrap();
        }
        let folders = Folders::of_command(&[place.path().join("in")], Path::new(".")).unwrap();
        (place, folders)
    }

    fn uri(path: &Path) -> String {
        format!("file://{}", path.display().to_string().replace(' ', "%20"))
    }

    #[test]
    fn only_paths_inside_are_resolved() {
        let (place, folders) = place();
        let resolved = |path: &str| folders.resolve(path.as_ref()).map_err(|error| error.to_string());
        let inside = place.path().canonicalize().unwrap().join("in");
        assert_eq!(resolved("a.obj"), Ok(inside.join("a.obj")));
        assert_eq!(resolved("./new/b.glb"), Ok(inside.join("new/b.glb")));
        let absolute = |path: &str| place.path().join(path).display().to_string();
        assert_eq!(resolved(&absolute("in/a.obj")), Ok(inside.join("a.obj")));
        let refused = ["out/a.obj", "out/none.obj", "in2", "in/../in/a.obj", ""].map(absolute);
        for path in
            refused.iter().map(String::as_str).chain(["../out/a.obj", "x/../a.obj", "", "/", "/etc/passwd"])
        {
            assert!(resolved(path).is_err(), "{path}");
        }
        assert!(resolved("/etc/passwd").unwrap_err().contains(&inside.display().to_string()));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_before_the_check() {
        use std::os::unix::fs::symlink;
        let (place, folders) = place();
        let inside = |name: &str| place.path().join("in").join(name);
        symlink("../out", inside("way")).unwrap();
        symlink("../out/a.obj", inside("b.obj")).unwrap();
        symlink("../out/later.glb", inside("later.glb")).unwrap();
        symlink("a.obj", inside("near.obj")).unwrap();
        for path in
            ["way", "way/a.obj", "way/new.glb", "way/new/new.glb", "b.obj", "later.glb", "later.glb/x"]
        {
            assert!(folders.resolve(path.as_ref()).is_err(), "{path}");
        }
        let near = folders.resolve("near.obj".as_ref()).unwrap();
        assert!(near.ends_with("in/a.obj"), "{near:?}");
    }

    #[test]
    fn roots_only_narrow_the_folders_of_the_command() {
        let (place, folders) = place();
        let declared = |names: &[&str]| {
            let uris: Vec<String> = names.iter().map(|name| uri(&place.path().join(name))).collect();
            folders.of_roots(&uris.iter().map(String::as_str).collect::<Vec<_>>())
        };
        fs::create_dir(place.path().join("in/a b")).unwrap();
        let allows =
            |folders: &Folders, path: &str| folders.resolve(place.path().join(path).as_ref()).is_ok();
        let below = declared(&["in/a b"]);
        assert!(allows(&below, "in/a b/x") && !allows(&below, "in/a.obj") && !allows(&below, "out/a.obj"));
        let above = declared(&[""]);
        assert!(allows(&above, "in/a.obj") && !allows(&above, "out/a.obj"));
        assert!(allows(&declared(&[]), "in/a.obj"), "an empty list changes nothing");
        for none in [declared(&["out"]), declared(&["missing"]), declared(&["in/a.obj"])] {
            assert!(!allows(&none, "in/a.obj") && none.resolve("a.obj".as_ref()).is_err());
        }
        let free = Folders { bounds: Vec::new(), ..folders.clone() };
        let out = uri(&place.path().join("out"));
        let free = free.of_roots(&[out.as_str(), "https://example.org", "file://host/x"]);
        assert!(allows(&free, "out/a.obj") && !allows(&free, "in/a.obj"));
    }

    #[test]
    fn a_whole_file_system_is_not_the_default() {
        let place = tempfile::tempdir().unwrap();
        let root = place.path().ancestors().last().unwrap();
        let error =
            Folders::of_command(&[], root).unwrap().resolve("a.obj".as_ref()).unwrap_err().to_string();
        assert_eq!(error, "a.obj: no folder is allowed; specify folders on the command line of the server");
        assert!(Folders::of_command(&[root.into()], root).unwrap().resolve("a.obj".as_ref()).is_ok());
        assert!(Folders::of_command(&[], place.path()).unwrap().resolve("a.obj".as_ref()).is_ok());
    }
}
