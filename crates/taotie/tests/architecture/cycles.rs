//! Imports between the files of a module, and the cycles among them.

use super::scanner::{Found, scan};
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::Visit;
use syn::{Item, ItemMod, ItemUse, Macro, UseTree, Visibility};

/// A path of names from the crate's root.
pub type Path = Vec<String>;

/// The files of a crate: modules by path.
#[derive(Default)]
pub struct Files {
    files: BTreeMap<Path, File>,
    /// `true` if imports between top modules count, not only those within one.
    pub across_modules: bool,
}

#[derive(Default)]
struct File {
    /// The paths that it imports or mentions, from the crate's root.
    imports: BTreeSet<Path>,
    /// Its re-exports under separate names.
    doors: BTreeMap<String, Path>,
}

impl Files {
    /// Adds the source text of a module, without its tests.
    pub fn add(&mut self, module: &[String], text: &str) -> syn::Result<()> {
        let source = syn::parse_file(text)?;
        let children = source.items.iter().filter_map(|item| match item {
            Item::Mod(ItemMod { ident, content: None, .. }) => Some(ident.to_string()),
            _ => None,
        });
        let mut reader =
            ImportReader { module: module.to_vec(), children: children.collect(), file: File::default() };
        reader.visit_file(&source);
        self.files.insert(module.to_vec(), reader.file);
        Ok(())
    }

    /// Adds a script, which imports others of its folder by their names.
    pub fn add_script(&mut self, name: &str, imports: impl Iterator<Item = String>) {
        let path = |name: String| vec!["scripts".to_owned(), name];
        let file = File { imports: imports.map(path).collect(), doors: BTreeMap::new() };
        self.files.insert(path(name.to_owned()), file);
    }

    /// Returns the number of files on the longest chain of imports within a top module.
    pub fn levels(&self, top: &str) -> usize {
        let own = self.files.iter().filter(|(module, _)| module.first().is_some_and(|first| first == top));
        let arrows: BTreeMap<&Path, BTreeSet<&Path>> =
            own.map(|(module, file)| (module, self.targets(module, file))).collect();
        let mut depths = BTreeMap::new();
        // Import cycles are another test's concern: the number of rounds is bounded.
        for _ in 0..arrows.len() {
            let deepest = |targets: &BTreeSet<&Path>| {
                targets.iter().map(|target| depths.get(target).copied().unwrap_or(1)).max().unwrap_or(0) + 1
            };
            let next: BTreeMap<&Path, usize> =
                arrows.iter().map(|(module, targets)| (*module, deepest(targets))).collect();
            if next == depths {
                break;
            }
            depths = next;
        }
        depths.into_values().max().unwrap_or(0)
    }

    /// Returns the circles: groups of more than one file, each of which leads to every other.
    pub fn cycles(&self) -> Vec<BTreeSet<String>> {
        let arrows: BTreeMap<&Path, BTreeSet<&Path>> =
            self.files.iter().map(|(module, file)| (module, self.targets(module, file))).collect();
        let reached: BTreeMap<&Path, BTreeSet<&Path>> =
            arrows.keys().map(|module| (*module, reach(module, &arrows))).collect();
        let mutual = |module: &Path| {
            let with = |other: &&Path| reached[*other].contains(module);
            reached[module].iter().copied().filter(with).map(|other| other.join("/")).collect()
        };
        let groups: BTreeSet<BTreeSet<String>> = self.files.keys().map(mutual).collect();
        groups.into_iter().filter(|group: &BTreeSet<String>| group.len() > 1).collect()
    }

    /// Returns the other files of the same top module that this one takes something from.
    fn targets(&self, module: &Path, file: &File) -> BTreeSet<&Path> {
        // Re-exporting from its own submodules is not an arrow.
        let handed_on = file.doors.values().filter(|path| !path.starts_with(module));
        let homes = file.imports.iter().chain(handed_on).filter_map(|import| self.home(import, 0));
        let counts = |home: &&Path| self.across_modules && !home.is_empty() || home.first() == module.first();
        homes.filter(|home| *home != module).filter(counts).collect()
    }

    /// Returns the file that a name is written in, through the doors that re-export it.
    fn home(&self, import: &[String], depth: usize) -> Option<&Path> {
        /// No name is re-exported more often.
        const MOST_DOORS: usize = 8;
        let known = (1..=import.len()).rev().find_map(|length| self.files.get_key_value(&import[..length]));
        let (module, file) = known?;
        match import.get(module.len()).and_then(|name| file.doors.get(name)) {
            Some(origin) if depth < MOST_DOORS => self.home(origin, depth + 1),
            _ => Some(module),
        }
    }
}

/// Returns everything reachable from a file, including itself if arrows lead back to it.
fn reach<'f>(from: &'f Path, arrows: &BTreeMap<&'f Path, BTreeSet<&'f Path>>) -> BTreeSet<&'f Path> {
    let (mut found, mut waiting) = (BTreeSet::new(), vec![from]);
    while let Some(module) = waiting.pop() {
        for next in arrows.get(module).into_iter().flatten().copied() {
            if found.insert(next) {
                waiting.push(next);
            }
        }
    }
    found
}

struct ImportReader {
    module: Path,
    children: BTreeSet<String>,
    file: File,
}

impl Visit<'_> for ImportReader {
    /// Imports of a file's tests are not arrows.
    fn visit_item_mod(&mut self, _: &ItemMod) {}

    /// The visibility of an item is not an arrow.
    fn visit_visibility(&mut self, _: &Visibility) {}

    fn visit_item_use(&mut self, item: &ItemUse) {
        let door = !matches!(item.vis, Visibility::Inherited);
        let mut found = Vec::new();
        leaves(&item.tree, &mut Vec::new(), &mut found);
        for (path, name) in found {
            let Some(path) = self.absolute(&path) else { continue };
            if door {
                self.file.doors.insert(name, path);
            } else {
                self.file.imports.insert(path);
            }
        }
    }

    fn visit_macro(&mut self, used: &Macro) {
        for (_, found) in scan(&self.module, &used.tokens.to_string()) {
            if let Found::Import(path) = found
                && let Some(path) = self.absolute(&path)
            {
                self.file.imports.insert(path);
            }
        }
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let names: Path = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1
            && let Some(path) = self.absolute(&names)
        {
            self.file.imports.insert(path);
        }
        syn::visit::visit_path(self, path);
    }
}

impl ImportReader {
    /// Returns the path from the crate's root; `None` for paths into another crate.
    fn absolute(&self, path: &[String]) -> Option<Path> {
        match path.first() {
            Some(child) if self.children.contains(child) => Some([&self.module[..], path].concat()),
            _ => from_root(&self.module, path),
        }
    }
}

/// Returns the path from the crate's root of one that starts with `crate`, `self` or `super` in `module`.
pub fn from_root(module: &[String], path: &[String]) -> Option<Path> {
    let ups = path.iter().take_while(|name| *name == "super").count();
    let (home, rest) = match path.first()?.as_str() {
        "crate" => (&[][..], &path[1..]),
        "self" => (module, &path[1..]),
        "super" => (&module[..module.len().checked_sub(ups)?], &path[ups..]),
        _ => return None,
    };
    Some([home, rest].concat())
}

/// Collects the paths named by a tree of imports, with the names that they get.
pub fn leaves(tree: &UseTree, before: &mut Path, found: &mut Vec<(Path, String)>) {
    let mut leaf = |name: String, given: String| {
        let mut path = before.clone();
        path.extend((name != "self").then_some(name));
        found.push((path, given));
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.to_string());
            leaves(&path.tree, before, found);
            before.pop();
        }
        UseTree::Name(name) => leaf(name.ident.to_string(), name.ident.to_string()),
        UseTree::Rename(rename) => leaf(rename.ident.to_string(), rename.rename.to_string()),
        UseTree::Glob(_) => found.push((before.clone(), "*".into())),
        UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, before, found)),
    }
}
