//! Lists the names that a crate exports: the items of its public modules, under every path that leads to them.

use super::cycles::{Path, from_root, leaves};
use std::collections::{BTreeMap, BTreeSet};
use syn::{Item, ItemMod, Visibility};

/// The items of a crate by module.
#[derive(Default)]
pub struct Exports(BTreeMap<Path, Module>);

#[derive(Default)]
struct Module {
    /// Public items that are declared here.
    items: BTreeSet<String>,
    /// Public child modules.
    modules: BTreeSet<String>,
    /// Public re-exports: the name given, and the path of the origin.
    doors: Vec<(String, Path)>,
}

impl Exports {
    /// Adds the source text of a module.
    pub fn add(&mut self, module: &[String], text: &str) -> syn::Result<()> {
        self.read(module, &syn::parse_file(text)?.items);
        Ok(())
    }

    fn read(&mut self, module: &[String], items: &[Item]) {
        let (mut found, mut doors) = (Module::default(), Vec::new());
        for item in items {
            if let Item::Use(item) = item
                && is_public(&item.vis)
            {
                leaves(&item.tree, &mut Vec::new(), &mut doors);
            }
            let Some((name, visibility)) = declared(item) else { continue };
            if let Item::Mod(ItemMod { content: Some((_, items)), .. }) = item {
                self.read(&child(module, &name), items);
            }
            if !is_public(visibility) {
                continue;
            }
            match item {
                Item::Mod(_) => found.modules.insert(name),
                _ => found.items.insert(name),
            };
        }
        let absolute = |path: Path| from_root(module, &path).unwrap_or_else(|| [module, &path].concat());
        found.doors = doors.into_iter().map(|(path, name)| (name, absolute(path))).collect();
        self.0.insert(module.to_vec(), found);
    }

    /// Returns every exported name with the public paths that lead to it, by the path of its declaration.
    pub fn names(&self) -> BTreeMap<Path, BTreeSet<String>> {
        let mut found = BTreeMap::new();
        self.collect(&Vec::new(), &mut found);
        found
    }

    fn collect(&self, module: &Path, found: &mut BTreeMap<Path, BTreeSet<String>>) {
        let Some(content) = self.0.get(module) else { return };
        let own = content.items.iter().map(|name| (name.clone(), child(module, name)));
        let doors = content.doors.iter().flat_map(|(name, path)| self.behind(name, path));
        for (name, origin) in own.chain(doors) {
            found.entry(origin).or_default().insert(child(module, &name).join("::"));
        }
        content.modules.iter().for_each(|name| self.collect(&child(module, name), found));
    }

    /// The items that a re-export hands on: one, or all of a module.
    fn behind(&self, name: &str, path: &Path) -> Vec<(String, Path)> {
        let origin = self.origin(path);
        match self.0.get(&origin) {
            Some(module) if name == "*" => {
                module.items.iter().map(|name| (name.clone(), child(&origin, name))).collect()
            }
            _ => vec![(name.to_owned(), origin)],
        }
    }

    /// The path of the declaration, through re-exports.
    fn origin(&self, path: &Path) -> Path {
        let Some((name, module)) = path.split_last() else { return path.clone() };
        let door = self.0.get(module).and_then(|module| module.doors.iter().find(|(given, _)| given == name));
        match door {
            Some((_, next)) if next != path => self.origin(next),
            _ => path.clone(),
        }
    }
}

fn child(module: &[String], name: &str) -> Path {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn declared(item: &Item) -> Option<(String, &Visibility)> {
    let (name, visibility) = match item {
        Item::Const(item) => (&item.ident, &item.vis),
        Item::Enum(item) => (&item.ident, &item.vis),
        Item::Fn(item) => (&item.sig.ident, &item.vis),
        Item::Mod(item) => (&item.ident, &item.vis),
        Item::Static(item) => (&item.ident, &item.vis),
        Item::Struct(item) => (&item.ident, &item.vis),
        Item::Trait(item) => (&item.ident, &item.vis),
        Item::Type(item) => (&item.ident, &item.vis),
        Item::Union(item) => (&item.ident, &item.vis),
        _ => return None,
    };
    Some((name.to_string(), visibility))
}
