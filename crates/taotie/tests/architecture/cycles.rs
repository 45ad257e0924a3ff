//! Which file of a module imports from which, and which of them go round in a circle.

use super::scanner::{Found, scan};
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::Visit;
use syn::{Item, ItemMod, ItemUse, Macro, UseTree, Visibility};

/// A path of names from the crate's root on.
type Path = Vec<String>;

/// The files of a crate: modules by their paths.
#[derive(Default)]
pub struct Files(BTreeMap<Path, File>);

#[derive(Default)]
struct File {
    /// What its `use` items and its other paths name, from the crate's root on.
    imports: BTreeSet<Path>,
    /// What it hands on under a name of its own.
    doors: BTreeMap<String, Path>,
}

impl Files {
    /// Adds the source text of a module. Its tests are left out.
    pub fn add(&mut self, module: &[String], text: &str) -> syn::Result<()> {
        let source = syn::parse_file(text)?;
        let children = source.items.iter().filter_map(|item| match item {
            Item::Mod(ItemMod { ident, content: None, .. }) => Some(ident.to_string()),
            _ => None,
        });
        let mut reader =
            ImportReader { module: module.to_vec(), children: children.collect(), file: File::default() };
        reader.visit_file(&source);
        self.0.insert(module.to_vec(), reader.file);
        Ok(())
    }

    /// Returns the circles: groups of more than one file, each of which leads to every other.
    pub fn cycles(&self) -> Vec<BTreeSet<String>> {
        let arrows: BTreeMap<&Path, BTreeSet<&Path>> =
            self.0.iter().map(|(module, file)| (module, self.targets(module, file))).collect();
        let reached: BTreeMap<&Path, BTreeSet<&Path>> =
            arrows.keys().map(|module| (*module, reach(module, &arrows))).collect();
        let mutual = |module: &Path| {
            let with = |other: &&Path| reached[*other].contains(module);
            reached[module].iter().copied().filter(with).map(|other| other.join("/")).collect()
        };
        let groups: BTreeSet<BTreeSet<String>> = self.0.keys().map(mutual).collect();
        groups.into_iter().filter(|group: &BTreeSet<String>| group.len() > 1).collect()
    }

    /// The other files of the same top module that one takes something from.
    fn targets(&self, module: &Path, file: &File) -> BTreeSet<&Path> {
        // To hand on what lies within is no arrow.
        let handed_on = file.doors.values().filter(|path| !path.starts_with(module));
        let homes = file.imports.iter().chain(handed_on).filter_map(|import| self.home(import, 0));
        homes.filter(|home| *home != module && home.first() == module.first()).collect()
    }

    /// The file that a name is written in, through the doors that hand it on.
    fn home(&self, import: &[String], depth: usize) -> Option<&Path> {
        /// No name is handed on more often.
        const MOST_DOORS: usize = 8;
        let known = (1..=import.len()).rev().find_map(|length| self.0.get_key_value(&import[..length]));
        let (module, file) = known?;
        match import.get(module.len()).and_then(|name| file.doors.get(name)) {
            Some(origin) if depth < MOST_DOORS => self.home(origin, depth + 1),
            _ => Some(module),
        }
    }
}

/// All that can be reached from a file, itself among them where arrows lead back to it.
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
    /// What the tests in a file import is no arrow.
    fn visit_item_mod(&mut self, _: &ItemMod) {}

    /// Who may see an item is no arrow.
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
    /// The path from the crate's root on; `None` for what lies in another crate.
    fn absolute(&self, path: &[String]) -> Option<Path> {
        let (first, rest) = path.split_first()?;
        let ups = path.iter().take_while(|name| *name == "super").count();
        let (home, rest) = match first.as_str() {
            "crate" => (&[][..], rest),
            "self" => (&self.module[..], rest),
            "super" => (&self.module[..self.module.len().checked_sub(ups)?], &path[ups..]),
            child if self.children.contains(child) => (&self.module[..], path),
            _ => return None,
        };
        Some(home.iter().chain(rest).cloned().collect())
    }
}

/// The paths that a tree of imports names, with the names that they get.
fn leaves(tree: &UseTree, before: &mut Path, found: &mut Vec<(Path, String)>) {
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
