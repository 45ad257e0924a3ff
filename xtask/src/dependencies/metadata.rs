//! The dependencies as cargo tells them.

use anyhow::{Context, Result};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The system whose crates are looked into; those of others need not be on this machine.
const PLATFORM: &str = "x86_64-unknown-linux-gnu";

/// The packages that are built on one system.
#[derive(Debug, Deserialize)]
pub struct Metadata {
    /// All packages.
    pub packages: Vec<Package>,
    resolve: Resolve,
}

/// A package.
#[derive(Debug, Clone, Deserialize)]
pub struct Package {
    /// Its identity in the graph.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Its licence, an SPDX expression.
    pub license: Option<String>,
    /// Where it comes from; `None` for a crate of this workspace.
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
    /// `None` for a plain dependency, else `dev` or `build`.
    kind: Option<String>,
}

/// The packages of Cargo.lock, those of all systems.
#[derive(Debug, Deserialize)]
pub struct Lock {
    /// All packages.
    pub package: Vec<Locked>,
}

/// A package of Cargo.lock.
#[derive(Debug, Clone, Deserialize)]
pub struct Locked {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Where it comes from; `None` for a crate of this workspace.
    pub source: Option<String>,
}

impl Metadata {
    /// Asks cargo.
    ///
    /// # Errors
    /// Where cargo does not answer.
    pub fn read(root: &Path) -> Result<Self> {
        let line = ["metadata", "--format-version", "1", "--locked", "--filter-platform", PLATFORM];
        serde_json::from_str(&super::output(root, &line)?).context("cargo metadata is of another form")
    }

    /// Returns the packages that go into the program `name`, by name, each with the dependencies of this workspace
    /// through which it came.
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

    /// Returns `true` where the build script of a package compiles another language.
    pub fn compiles_others(&self, id: &str) -> bool {
        let compilers = |kind: &str, name: &str| kind == "build" && (name == "cc" || name == "cmake");
        self.dependencies(id).any(|dependency| {
            let name = self.name(&dependency.pkg);
            dependency.dep_kinds.iter().any(|kind| compilers(kind.kind.as_deref().unwrap_or(""), name))
        })
    }

    /// The crates of this workspace that go into `name`, itself among them.
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

    /// Visits a package and all plain dependencies below it once.
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
    /// Where it cannot be read.
    pub fn read(root: &Path) -> Result<Self> {
        let text = fs::read_to_string(root.join("Cargo.lock")).context("Cargo.lock")?;
        toml::from_str(&text).context("Cargo.lock")
    }
}
