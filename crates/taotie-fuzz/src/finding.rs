//! Findings: minimised, and kept as descriptions that rebuild them.

use crate::case::Case;
use crate::failure::Failure;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// A case that failed, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The case that reproduces it.
    #[serde(flatten)]
    pub case: Case,
    /// The failure at the time it was found.
    pub failure: Failure,
}

impl Finding {
    /// Removes changes as long as `fails` reports the same fault.
    ///
    /// # Errors
    /// The errors of `fails`.
    pub fn minimised(mut self, fails: impl Fn(&Case) -> Result<Option<Failure>>) -> Result<Self> {
        let mut at = self.case.mutations.len();
        while at > 0 {
            at -= 1;
            let mut smaller = self.case.clone();
            smaller.mutations.remove(at);
            if fails(&smaller)?.is_some_and(|failure| failure.is_like(&self.failure)) {
                self.case = smaller;
            }
        }
        Ok(self)
    }

    /// Writes the finding into a folder and returns its path.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn keep(&self, folder: &Path) -> Result<PathBuf> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        let sum = crc32fast::hash(text.as_bytes());
        let name = format!("{}-{}-{sum:08x}.json", self.case.target.name(), self.failure.kind_name());
        let path = folder.join(name);
        fs::create_dir_all(folder)?;
        fs::write(&path, text).with_context(|| path.display().to_string())?;
        Ok(path)
    }
}

/// Reads the findings in a folder, sorted by name; none if the folder does not exist.
///
/// # Errors
/// If a file cannot be read.
pub fn kept(folder: &Path) -> Result<Vec<(PathBuf, Finding)>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<PathBuf>>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    paths.sort();
    paths.into_iter().map(|path| read(&path).map(|finding| (path, finding))).collect()
}

/// Reads a finding.
///
/// # Errors
/// If the file cannot be read, or is not a finding.
pub fn read(path: &Path) -> Result<Finding> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failure::FailureKind;
    use crate::target::Target;

    fn finding() -> Finding {
        let mutations = serde_json::from_str(
            r#"[{"lines":{"remove":{"line":1}}},"mend",{"bytes":{"truncate":{"at":9}}}]"#,
        );
        let case =
            Case { target: Target::Obj, seed: "ball.obj".into(), variant: 3, mutations: mutations.unwrap() };
        Finding { case, failure: Failure { kind: FailureKind::Panic, message: "index 3".into() } }
    }

    #[test]
    fn findings_are_kept_and_read() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("findings");
        assert!(kept(&folder).unwrap().is_empty());
        let path = finding().keep(&folder).unwrap();
        assert_eq!(kept(&folder).unwrap(), [(path, finding())]);
        fs::write(folder.join("wrong.json"), "{}").unwrap();
        assert!(kept(&folder).is_err());
    }

    #[test]
    fn changes_that_do_not_matter_are_struck() {
        let guilty = finding().case.mutations[2].clone();
        let fails = |case: &Case| {
            let failure = Failure { kind: FailureKind::Panic, message: "index 12".into() };
            Ok(case.mutations.contains(&guilty).then_some(failure))
        };
        assert_eq!(finding().minimised(fails).unwrap().case.mutations, std::slice::from_ref(&guilty));
        let other = |_: &Case| Ok(Some(Failure { kind: FailureKind::Time, message: String::new() }));
        assert_eq!(finding().minimised(other).unwrap(), finding());
    }
}
