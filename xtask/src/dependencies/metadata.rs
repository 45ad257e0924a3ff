//! The dependencies according to cargo.

use super::cargo;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The platform whose crates are examined; those of others may be missing on this machine.
const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// The packages built on one platform.
#[derive(Debug, Deserialize)]
pub struct Metadata {
    /// All packages.
    pub packages: Vec<Package>,
    resolve: Resolve,
}

/// A package.
#[derive(Debug, Clone, Deserialize)]
pub struct Package {
    /// Its id in the dependency graph.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Its licence as an SPDX expression.
    pub license: Option<String>,
    /// Its source; `None` for a crate of this workspace.
    pub source: Option<String>,
    /// Its Cargo.toml.
    pub manifest_path: PathBuf,
}

#[derive(Debug, Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Debug, Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Debug, Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<DependencyKind>,
}

#[derive(Debug, Deserialize)]
struct DependencyKind {
    /// `None` for a normal dependency, otherwise `dev` or `build`.
    kind: Option<String>,
}

/// The packages in Cargo.lock, for all platforms.
#[derive(Debug, Deserialize)]
pub struct Lock {
    /// All packages.
    pub package: Vec<Locked>,
}

/// A package in Cargo.lock.
#[derive(Debug, Clone, Deserialize)]
pub struct Locked {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its source; `None` for a crate of this workspace.
    pub source: Option<String>,
}

impl Metadata {
    /// Runs `cargo metadata`.
    ///
    /// # Errors
    /// If cargo fails.
    pub fn read(root: &Path) -> Result<Self> {
        let line = ["metadata", "--format-version", "1", "--locked", "--filter-platform", PLATFORM];
        serde_json::from_str(&cargo::output(root, &line)?).context("unexpected format of cargo metadata")
    }

    /// Returns the packages built into the program `name`, by name, each with the direct dependencies of this
    /// workspace that require it.
    pub fn built_into(&self, name: &str) -> BTreeMap<&str, BTreeSet<&str>> {
        let mut reached = BTreeMap::new();
        let ours: Vec<&Package> = self.of_workspace(name);
        for package in &ours {
            for direct in self.plain(&package.id).filter(|id| !ours.iter().any(|ours| ours.id == *id)) {
                let door = self.name(direct);
                self.walk(direct, &mut BTreeSet::new(), &mut |id| {
                    reached.entry(self.name(id)).or_insert_with(BTreeSet::new).insert(door);
                });
            }
        }
        reached
    }

    /// Returns `true` if the build script of a package compiles another language.
    pub fn compiles_others(&self, id: &str) -> bool {
        let compilers = |kind: &str, name: &str| kind == "build" && (name == "cc" || name == "cmake");
        self.dependencies(id).any(|dependency| {
            let name = self.name(&dependency.pkg);
            dependency.dep_kinds.iter().any(|kind| compilers(kind.kind.as_deref().unwrap_or(""), name))
        })
    }

    /// Returns the crates of this workspace built into `name`, including itself.
    fn of_workspace(&self, name: &str) -> Vec<&Package> {
        let root = self.packages.iter().find(|package| package.name == name && package.source.is_none());
        let mut ids = BTreeSet::new();
        if let Some(root) = root {
            self.walk(&root.id, &mut ids, &mut |_| {});
        }
        self.packages
            .iter()
            .filter(|package| package.source.is_none() && ids.contains(package.id.as_str()))
            .collect()
    }

    /// Visits a package and all normal dependencies below it once.
    fn walk<'a>(&'a self, id: &'a str, seen: &mut BTreeSet<&'a str>, visit: &mut impl FnMut(&'a str)) {
        if seen.insert(id) {
            visit(id);
            self.plain(id).for_each(|below| self.walk(below, seen, visit));
        }
    }

    fn plain<'a>(&'a self, id: &str) -> impl Iterator<Item = &'a str> {
        let is_plain = |dependency: &&Dependency| dependency.dep_kinds.iter().any(|kind| kind.kind.is_none());
        self.dependencies(id).filter(is_plain).map(|dependency| dependency.pkg.as_str())
    }

    fn dependencies<'a>(&'a self, id: &str) -> impl Iterator<Item = &'a Dependency> {
        self.resolve.nodes.iter().find(|node| node.id == id).into_iter().flat_map(|node| &node.deps)
    }

    fn name(&self, id: &str) -> &str {
        self.packages.iter().find(|package| package.id == id).map_or("", |package| package.name.as_str())
    }
}

impl Lock {
    /// Reads Cargo.lock.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(root: &Path) -> Result<Self> {
        let text = fs::read_to_string(root.join("Cargo.lock")).context("Cargo.lock")?;
        toml::from_str(&text).context("Cargo.lock")
    }
}
