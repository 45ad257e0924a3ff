//! The types that the crates declare, and which of them a name means.

use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use syn::{Expr, ExprLit, Item, ItemEnum, ItemStruct, Lit, Type, UseTree};

/// The declaration of a type.
pub enum Declared {
    /// A struct.
    Struct(ItemStruct),
    /// An enum.
    Enum(ItemEnum),
    /// Another name for a type.
    Alias(Type),
}

/// A type and where it is declared.
pub struct Declaration {
    /// Its name.
    pub name: String,
    /// Its crate and modules.
    pub module: Vec<String>,
    /// The number of its file.
    pub file: usize,
    /// Its declaration.
    pub declared: Declared,
}

/// The imports and integer constants of a file.
#[derive(Default)]
pub struct SourceFile {
    module: Vec<String>,
    imports: BTreeMap<String, Vec<String>>,
    constants: BTreeMap<String, u64>,
}

/// All sources of the crates.
#[derive(Default)]
pub struct Sources {
    files: Vec<SourceFile>,
    types: Vec<Declaration>,
    by_name: BTreeMap<String, Vec<usize>>,
}

impl Sources {
    /// Reads the sources of all crates in a folder.
    ///
    /// # Errors
    /// If a file cannot be read or is not valid Rust.
    pub fn read(crates: &Path) -> Result<Self> {
        let mut sources = Self::default();
        for folder in sorted(crates)? {
            let name = folder.file_name().unwrap_or_default().to_string_lossy().replace('-', "_");
            let source = folder.join("src");
            if source.is_dir() {
                sources.add_folder(&source, &[name])?;
            }
        }
        for (number, declaration) in sources.types.iter().enumerate() {
            sources.by_name.entry(declaration.name.clone()).or_default().push(number);
        }
        Ok(sources)
    }

    fn add_folder(&mut self, folder: &Path, module: &[String]) -> Result<()> {
        for path in sorted(folder)? {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let inner = || [module, std::slice::from_ref(&stem)].concat();
            match path.extension().is_some_and(|end| end == "rs") {
                false if path.is_dir() => self.add_folder(&path, &inner())?,
                false => {}
                true => {
                    let is_root = ["lib", "main", "mod"].contains(&stem.as_str());
                    let module = if is_root { module.to_vec() } else { inner() };
                    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
                    let file = syn::parse_file(&text).with_context(|| path.display().to_string())?;
                    self.files.push(SourceFile { module: module.clone(), ..SourceFile::default() });
                    self.add_items(file.items, &module);
                }
            }
        }
        Ok(())
    }

    fn add_items(&mut self, items: Vec<Item>, module: &[String]) {
        let file = self.files.len() - 1;
        let mut add = |name: &syn::Ident, declared| {
            self.types.push(Declaration { name: name.to_string(), module: module.to_vec(), file, declared });
        };
        let mut modules = Vec::new();
        for item in items {
            match item {
                Item::Struct(item) => add(&item.ident.clone(), Declared::Struct(item)),
                Item::Enum(item) => add(&item.ident.clone(), Declared::Enum(item)),
                Item::Type(item) => add(&item.ident, Declared::Alias(*item.ty)),
                Item::Use(item) => import(&item.tree, &[], &mut self.files[file].imports),
                Item::Const(item) => {
                    if let Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) = &*item.expr
                        && let Ok(number) = number.base10_parse()
                    {
                        self.files[file].constants.insert(item.ident.to_string(), number);
                    }
                }
                Item::Mod(item) if item.ident != "tests" => modules.push(item),
                _ => {}
            }
        }
        for inner in modules {
            if let Some((_, items)) = inner.content {
                self.add_items(items, &[module, &[inner.ident.to_string()]].concat());
            }
        }
    }

    /// Returns the type with this number.
    pub fn declaration(&self, number: usize) -> &Declaration {
        &self.types[number]
    }

    /// Returns an integer constant of a file.
    pub fn constant(&self, file: usize, name: &str) -> Option<u64> {
        self.files[file].constants.get(name).copied()
    }

    /// Returns the number of the type with this full path, such as `taotie_cli::render::Printed`.
    ///
    /// # Errors
    /// If there is none.
    pub fn named(&self, path: &str) -> Result<usize> {
        let found = self.types.iter().position(|declaration| {
            let module = declaration.module.iter().map(String::as_str);
            module.chain([declaration.name.as_str()]).eq(path.split("::"))
        });
        found.with_context(|| format!("{path} is not declared; correct it in xtask/src/schemas/mod.rs"))
    }

    /// Returns the number of the type that a path means in a file.
    ///
    /// # Errors
    /// If no type has the name, or if several might be meant.
    pub fn find(&self, file: usize, path: &[String]) -> Result<usize> {
        let place = &self.files[file];
        let shown = || format!("{}: the type `{}`", place.module.join("::"), path.join("::"));
        let Some((name, folders)) = path.split_last() else { bail!("{} has no name", shown()) };
        let imported = place.imports.get(&path[0]).map(|found| [found, &path[1..]].concat());
        let full = imported.as_deref().unwrap_or(path);
        let name = full.last().unwrap_or(name);
        let Some(all) = self.by_name.get(name) else { bail!("{} is not declared in the crates", shown()) };
        if imported.is_none() && folders.is_empty() {
            let here: Vec<usize> = all.iter().copied().filter(|id| self.types[*id].file == file).collect();
            if let [only] = here[..] {
                return Ok(only);
            }
        }
        let is_own = !full[0].starts_with("taotie");
        let root = if is_own { &place.module[0] } else { &full[0] };
        let inside: Vec<usize> =
            all.iter().copied().filter(|id| &self.types[*id].module[0] == root).collect();
        let candidates = if inside.is_empty() { all.clone() } else { inside };
        let score = |id: &usize| {
            let module = &self.types[*id].module;
            let named = full.iter().filter(|part| module[1..].contains(part)).count();
            let shared = module.iter().zip(&place.module).take_while(|(a, b)| a == b).count();
            (named, if is_own { shared } else { 0 })
        };
        let best = candidates.iter().map(score).max();
        let best: Vec<usize> = candidates.into_iter().filter(|id| Some(score(id)) == best).collect();
        match best[..] {
            [only] => Ok(only),
            _ => bail!("{} might be one of {}; rename one of them", shown(), best.len()),
        }
    }
}

/// Adds the names that a `use` brings in, each with its full path.
fn import(tree: &UseTree, before: &[String], all: &mut BTreeMap<String, Vec<String>>) {
    let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
    match tree {
        UseTree::Path(path) => import(&path.tree, &with(&path.ident), all),
        UseTree::Name(name) if name.ident == "self" => {
            all.insert(before.last().cloned().unwrap_or_default(), before.to_vec());
        }
        UseTree::Name(name) => {
            all.insert(name.ident.to_string(), with(&name.ident));
        }
        UseTree::Rename(name) => {
            all.insert(name.rename.to_string(), with(&name.ident));
        }
        UseTree::Group(group) => group.items.iter().for_each(|tree| import(tree, before, all)),
        _ => {}
    }
}

fn sorted(folder: &Path) -> Result<Vec<std::path::PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}
