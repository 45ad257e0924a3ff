//! The rules of `deny.toml`, as far as they can be checked without cargo-deny.

use super::metadata::{Locked, Package};
use anyhow::{Context, Result};
use serde::Deserialize;
use spdx::{Expression, ParseMode};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The rules.
#[derive(Debug, Deserialize)]
pub struct Policy {
    /// For licences.
    pub licenses: Licenses,
    /// For versions.
    pub bans: Bans,
    /// For sources.
    pub sources: Sources,
}

/// The licences that packages may have.
#[derive(Debug, Deserialize)]
pub struct Licenses {
    allow: Vec<String>,
    #[serde(default)]
    exceptions: Vec<Exception>,
}

#[derive(Debug, Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    name: String,
    allow: Vec<String>,
}

/// The duplicate versions that packages may have.
#[derive(Debug, Deserialize)]
pub struct Bans {
    #[serde(default)]
    skip: Vec<Skip>,
}

#[derive(Debug, Deserialize)]
struct Skip {
    /// Name and version, such as `syn@2`.
    #[serde(rename = "crate")]
    spec: String,
}

/// The allowed sources of packages.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Sources {
    allow_registry: Vec<String>,
}

impl Policy {
    /// Reads `deny.toml`.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(root: &Path) -> Result<Self> {
        let text = fs::read_to_string(root.join("deny.toml")).context("deny.toml")?;
        toml::from_str(&text).context("deny.toml")
    }
}

impl Licenses {
    /// Returns the packages with licences that are not allowed.
    pub fn faults(&self, packages: &[Package]) -> Vec<String> {
        let refused = packages.iter().filter(|package| !self.allows(package));
        let message = |package: &Package| {
            let license = package.license.as_deref().unwrap_or("none");
            format!("{}: licence not allowed by deny.toml: {license}", package.name)
        };
        refused.map(message).collect()
    }

    fn allows(&self, package: &Package) -> bool {
        let excepted = self.exceptions.iter().filter(|exception| exception.name == package.name);
        let allowed: Vec<&String> =
            excepted.flat_map(|exception| &exception.allow).chain(&self.allow).collect();
        let license = package.license.as_deref().unwrap_or_default();
        let expression = Expression::parse_mode(license, ParseMode::LAX);
        expression.is_ok_and(|it| it.evaluate(|license| allowed.contains(&&license.to_string())))
    }
}

impl Bans {
    /// Returns the packages with several versions that are not skipped, and unnecessary entries of `skip`.
    pub fn faults(&self, packages: &[Locked]) -> Vec<String> {
        let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        packages.iter().for_each(|it| versions.entry(&it.name).or_default().push(&it.version));
        let several = |left: &[&str]| left.len() > 1;
        let faults = versions.iter().filter_map(|(name, all)| {
            let left: Vec<&str> = all.iter().copied().filter(|version| !self.skips(name, version)).collect();
            several(&left).then(|| format!("{name}: several versions: {}", left.join(", ")))
        });
        let idle = self.skip.iter().filter(|skip| {
            !versions
                .iter()
                .any(|(name, all)| several(all) && all.iter().any(|version| skip.is_of(name, version)))
        });
        faults.chain(idle.map(|skip| format!("{}: remove it from `skip` in deny.toml", skip.spec))).collect()
    }

    fn skips(&self, name: &str, version: &str) -> bool {
        self.skip.iter().any(|skip| skip.is_of(name, version))
    }
}

impl Skip {
    fn is_of(&self, name: &str, version: &str) -> bool {
        let spec = self.spec.strip_prefix(name).and_then(|rest| rest.strip_prefix('@'));
        spec.and_then(|spec| version.strip_prefix(spec))
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }
}

impl Sources {
    /// Returns the packages from other sources.
    pub fn faults(&self, packages: &[Locked]) -> Vec<String> {
        let allowed = |source: &str| {
            source
                .strip_prefix("registry+")
                .is_some_and(|from| self.allow_registry.iter().any(|known| known == from))
        };
        let other = packages.iter().filter_map(|package| Some((package, package.source.as_deref()?)));
        let other = other.filter(|(_, source)| !allowed(source));
        other.map(|(package, source)| format!("{}: source not allowed: {source}", package.name)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn policy() -> Policy {
        toml::from_str(
            "[licenses]\nallow = ['MIT']\nexceptions = [{ crate = 'odd', allow = ['MPL-2.0'] }]\n\
             [bans]\nskip = [{ crate = 'twice@1' }]\n[sources]\nallow-registry = ['https://index']\n",
        )
        .unwrap()
    }

    #[test]
    fn licences_are_checked() {
        let faults = |name: &str, license: Option<&str>| {
            let (name, license) = (name.to_owned(), license.map(str::to_owned));
            let package =
                Package { id: String::new(), name, license, source: None, manifest_path: "".into() };
            policy().licenses.faults(&[package]).len()
        };
        assert_eq!(["MIT", "Apache-2.0 OR MIT", "Apache-2.0/MIT"].map(|it| faults("a", Some(it))), [0; 3]);
        assert_eq!(["MPL-2.0", "MIT AND GPL-3.0-only", "Own"].map(|it| faults("a", Some(it))), [1; 3]);
        assert_eq!([faults("odd", Some("MPL-2.0")), faults("a", None)], [0, 1]);
    }

    #[test]
    fn versions_and_sources_are_checked() {
        let locked = |name: &str, version: &str, source: &str| {
            let [name, version, source] = [name, version, source].map(str::to_owned);
            Locked { name, version, source: (!source.is_empty()).then_some(source) }
        };
        let known = "registry+https://index";
        let twice = [locked("twice", "1.2.0", known), locked("twice", "2.0.0", known)];
        assert_eq!(policy().bans.faults(&twice), [""; 0]);
        let other = [locked("twice", "3.0.0", known), locked("twice", "2.0.0", known)];
        assert_eq!(policy().bans.faults(&other).len(), 2, "two versions, and an unnecessary entry");
        let once = policy().bans.faults(&twice[..1]);
        assert_eq!(once, ["twice@1: remove it from `skip` in deny.toml"]);
        let sources =
            [locked("a", "1.0.0", known), locked("ours", "1.0.0", ""), locked("b", "1.0.0", "git+https://b")];
        assert_eq!(policy().sources.faults(&sources), ["b: source not allowed: git+https://b"]);
    }
}
