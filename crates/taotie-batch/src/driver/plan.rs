//! The outstanding work on a collection.

use super::DriveOptions;
use super::books::{Books, now};
use super::todo::Todo;
use crate::address::{self, VERSION};
use crate::collection::{Collection, Scan};
use crate::input::InputFile;
use crate::objects::AssetObject;
use crate::record::{Record, SCHEMA, State};
use crate::settings::Settings;
use std::path::Path;
use taotie_engine::Result;

/// The outstanding work, and the assets that need none.
pub struct Plan {
    /// Assets to be made, the largest first.
    pub todo: Vec<Todo>,
    /// Existing assets to be judged again, since their requirements or the record version have changed.
    pub judged: Vec<Record>,
    /// The number of assets that stay as they are.
    pub known: usize,
    /// All assets of the shard.
    pub ids: Vec<String>,
}

/// The action due for one asset.
enum Due {
    Making(Box<Todo>),
    Judging(Box<Record>),
    Nothing,
}

impl Plan {
    /// Compares a collection with its known state.
    ///
    /// # Errors
    /// Settings that contradict one another.
    pub fn of(
        collection: &Collection,
        scans: &[Scan],
        books: &Books,
        options: &DriveOptions,
    ) -> Result<Self> {
        let mut plan = Self { todo: Vec::new(), judged: Vec::new(), known: 0, ids: Vec::new() };
        let is_ours = |scan: &&Scan| options.shard.is_none_or(|shard| shard.covers(&scan.id));
        for scan in scans.iter().filter(is_ours) {
            plan.ids.push(scan.id.clone());
            let todo = todo(collection, scan)?;
            match due(todo, (collection.folder(), books), options.retry_failed) {
                Due::Making(todo) => plan.todo.push(*todo),
                Due::Judging(record) => plan.judged.push(*record),
                Due::Nothing => plan.known += 1,
            }
        }
        plan.todo.sort_by_key(|todo| std::cmp::Reverse(todo.bytes));
        Ok(plan)
    }
}

fn todo(collection: &Collection, scan: &Scan) -> Result<Todo> {
    let settings = collection.settings(&scan.id)?;
    let Settings { asset, thumbnail, turntable, viewer, .. } = &settings;
    let settings_hash = address::of(&(asset.with_names(), thumbnail, turntable, viewer));
    let known = InputFile::stat(&collection.folder().join(&scan.path)).ok();
    let input: Vec<_> = known.map(|file| InputFile { path: scan.path.clone(), ..file }).into_iter().collect();
    let bytes = input.iter().map(|file| file.bytes).sum();
    Ok(Todo { scan: scan.clone(), settings, settings_hash, input, bytes })
}

fn due(todo: Todo, (folder, books): (&Path, &Books), retry: bool) -> Due {
    let is_same = |last: &&Record| {
        (&last.settings, last.version.as_str()) == (&todo.settings_hash, VERSION)
            && last.input.first().map(|file| &file.path) == Some(&todo.scan.path)
            && last.has_same_input(folder)
    };
    let last = books.history.last.get(&todo.scan.id).filter(is_same);
    let Some(last) = last else { return Due::Making(Box::new(todo)) };
    if !last.state.is_made() {
        return if retry { Due::Making(Box::new(todo)) } else { Due::Nothing };
    }
    if !last.parts.iter().all(|part| books.store.holds(part)) {
        return Due::Making(Box::new(todo));
    }
    if last.is_current() && last.require == todo.settings.require && last.title == todo.scan.title {
        return Due::Nothing;
    }
    let object = last.part("asset").and_then(|part| books.store.object::<AssetObject>(&part.address));
    match object {
        Some(object) => Due::Judging(Box::new(judged(last, &todo, &object))),
        None => Due::Making(Box::new(todo)),
    }
}

/// Returns the record of an asset that is judged again: its requirements, its title or the record version have
/// changed.
fn judged(last: &Record, todo: &Todo, object: &AssetObject) -> Record {
    let required = object.figures.require(&todo.settings.require);
    Record {
        schema: SCHEMA,
        attempt: last.attempt + 1,
        ended: now(),
        title: todo.scan.title.clone(),
        state: State::of(&required),
        require: todo.settings.require.clone(),
        required,
        figures: Some(object.short()),
        seconds: 0.0,
        stages: Vec::new(),
        ..last.clone()
    }
}
