//! Joins GLBs that show one object at different levels of detail into one (MSFT_lod).

use super::LEVELS;
use super::codec::CodecKind;
use super::draft::{Container, encoded_glb, uri};
use super::edit::{
    self, Visit, drop_unnamed, each_accessor, each_image, each_place, each_texture, each_view,
    joined_buffers, names_no_geometry, short,
};
use super::graft::gltf;
use super::textures::{LEVEL, ROLES, level_role};
use crate::gltf::{GltfSource, RawGltf};
use crate::limits::Limits;
use crate::write::FileBytes;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use taotie_engine::error::{Error, Result};

/// Joins GLBs that show one object at different levels of detail into one file with MSFT_lod, and returns it,
/// followed by its external files if it is a `.gltf`. The finest stays unchanged, except for a node above its others
/// if it shows several; the coarser ones contribute what their default scene shows: nodes, meshes, materials and
/// textures, without lights, cameras, skins and animations. Items that are equal in several of them are stored once.
/// `coverages` has the minimum screen coverage of the object at which each level is shown, for the finest and each
/// coarser one.
///
/// # Errors
/// [`Error::Parse`] for a GLB that cannot be read; [`Error::Invalid`] unless there is one coverage per level;
/// [`Error::Unsupported`] for an extension that may refer to items by index in an unknown way, for a finest file that
/// already has levels, and for coarser ones with different variants; [`Error::Limit`] for a GLB of 4 GiB or more.
pub fn join_levels(
    path: &Path,
    (finest, coarser): (&[u8], &[&[u8]]),
    coverages: &[f32],
) -> Result<Vec<FileBytes>> {
    let container = Container::of(path)?;
    if coverages.len() != coarser.len() + 1 || coverages.iter().any(|c| !(0.0..=1.0).contains(c)) {
        return Err(Error::invalid("screen coverages", "specify one in [0, 1] per level of detail"));
    }
    let mut all = read(finest)?;
    if edit::items(&all.json, "extensionsUsed").iter().any(|name| name == LEVELS) {
        return Err(Error::unsupported(
            "adding levels of detail to a file that has them",
            "remove those first",
        ));
    }
    let root = root(&mut all.json)?;
    let mut ids = Vec::with_capacity(coarser.len());
    for (number, level) in coarser.iter().enumerate() {
        let mut level = read(level)?;
        name_images(&mut level.json, number + 1);
        ids.push(append(&mut all, level)?);
    }
    let node = &mut all.json["nodes"][root];
    *edit::member(edit::member(node, "extensions"), LEVELS) = json!({ "ids": ids });
    let coverages: Vec<f64> = coverages.iter().copied().map(short).collect();
    *edit::member(edit::member(node, "extras"), "MSFT_screencoverage") = json!(coverages);
    edit::name(&mut all.json, "extensionsUsed", LEVELS);
    let mut images = match container {
        Container::Glb => Vec::new(),
        Container::Gltf => apart(&mut all, path),
    };
    // Drops views of images that another level also had.
    drop_unnamed(&mut all.json, "bufferViews", each_view);
    let bytes = joined_buffers(&mut all)?;
    let mut files = match container {
        Container::Glb => {
            let bytes = encoded_glb(edit::text(&all.json)?, &bytes)?;
            vec![FileBytes { path: path.to_path_buf(), bytes }]
        }
        Container::Gltf => gltf(path, all.json, bytes)?,
    };
    files.append(&mut images);
    Ok(files)
}

/// Renames images written by a bake to those of a coarser level.
fn name_images(json: &mut Value, number: usize) {
    for image in edit::items_mut(json, "images") {
        if let Some(role) = role(image) {
            image["name"] = level_role(number, &role).into();
        }
    }
}

/// Returns the role of an image written by a bake, such as `normal`.
fn role(image: &Value) -> Option<String> {
    let name = image.get("name")?.as_str()?;
    let role = name.split_once("_").map_or(name, |(level, role)| if is_level(level) { role } else { name });
    ROLES.contains(&role).then(|| name.to_owned())
}

fn is_level(word: &str) -> bool {
    word.strip_prefix(LEVEL).is_some_and(|number| number.parse::<usize>().is_ok())
}

/// Moves images written by bakes out of a document to external files.
fn apart(all: &mut RawGltf, path: &Path) -> Vec<FileBytes> {
    let mut files = Vec::new();
    let mut taken = BTreeSet::new();
    for i in 0..edit::items(&all.json, "images").len() {
        let image = &all.json["images"][i];
        let Some((role, bytes)) = role(image).zip(image_bytes(all, image).map(<[u8]>::to_vec)) else {
            continue;
        };
        let Some(kind) = CodecKind::detect(&bytes) else { continue };
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}_{role}.{}", kind.file_extension());
        // Files from other programs may have several images with the same name.
        if !taken.insert(name.clone()) {
            continue;
        }
        all.json["images"][i] = json!({ "uri": uri(&name) });
        files.push(FileBytes { path: path.with_file_name(name), bytes });
    }
    files
}

fn read(glb: &[u8]) -> Result<RawGltf> {
    let raw = RawGltf::read(GltfSource::Glb(glb), &Limits::of_own_files())?;
    match edit::items(&raw.json, "extensionsUsed")
        .iter()
        .find(|name| !name.as_str().is_some_and(names_no_geometry))
    {
        Some(name) => Err(Error::unsupported(
            format!("adding levels of detail to a file with {name}"),
            "it may refer to items by index, and indices change; omit the levels or the extension",
        )),
        None => Ok(raw),
    }
}

/// Returns the node that shows the whole default scene: its only one, or a new one above all.
fn root(json: &mut Value) -> Result<usize> {
    let scene = edit::number(json, "scene").unwrap_or(0);
    let nodes = edit::items(json, "scenes").get(scene).map(|scene| edit::items(scene, "nodes").to_vec());
    let nodes = nodes.filter(|nodes| !nodes.is_empty());
    let nodes = nodes.ok_or_else(|| Error::invalid("level of detail", "no scene with nodes"))?;
    if let [only] = &nodes[..]
        && let Some(only) = only.as_u64()
    {
        return Ok(only as usize);
    }
    let root = edit::push(json, "nodes", json!({ "children": nodes }));
    json["scenes"][scene]["nodes"] = json!([root]);
    Ok(root)
}

/// Appends what the default scene of a document shows; returns its root node.
fn append(all: &mut RawGltf, mut level: RawGltf) -> Result<usize> {
    let root = root(&mut level.json)?;
    let variants = |json: &Value| json.pointer("/extensions/KHR_materials_variants").cloned();
    if let Some(own) = variants(&level.json)
        && variants(&all.json).as_ref() != Some(&own)
    {
        return Err(Error::unsupported(
            "joining levels of detail with different variants",
            "use the same for all",
        ));
    }
    strip_unshown(&mut level.json);
    for list in ["extensionsUsed", "extensionsRequired"] {
        for name in edit::taken(&mut level.json, list).iter().filter_map(Value::as_str) {
            edit::name(&mut all.json, list, name);
        }
    }
    let buffers = all.buffers.len();
    all.buffers.append(&mut level.buffers);
    move_all(&mut all.json, &mut level.json, "buffers");
    let places = |json: &mut Value, visit: &mut dyn FnMut(&mut Value)| {
        let mut of = |place: &mut Value| place.get_mut("buffer").into_iter().for_each(&mut *visit);
        edit::items_mut(json, "bufferViews").for_each(|view| each_place(view, &mut of));
    };
    places(&mut level.json, &mut |number| shift(number, buffers));
    let views = edit::items(&all.json, "bufferViews").len();
    each_view(&mut level.json, &mut |number| shift(number, views));
    move_all(&mut all.json, &mut level.json, "bufferViews");
    let accessors = edit::items(&all.json, "accessors").len();
    each_accessor(&mut level.json, &mut |number| shift(number, accessors));
    move_all(&mut all.json, &mut level.json, "accessors");
    share_images(all, &mut level.json);
    share(all, &mut level.json, ("samplers", each_sampler));
    share(all, &mut level.json, ("textures", each_texture));
    share(all, &mut level.json, ("materials", each_material));
    let meshes = edit::items(&all.json, "meshes").len();
    for mesh in edit::items_mut(&mut level.json, "nodes").filter_map(|node| node.get_mut("mesh")) {
        shift(mesh, meshes);
    }
    move_all(&mut all.json, &mut level.json, "meshes");
    let nodes = edit::items(&all.json, "nodes").len();
    for node in edit::items_mut(&mut level.json, "nodes") {
        edit::items_mut(node, "children").for_each(|child| shift(child, nodes));
    }
    move_all(&mut all.json, &mut level.json, "nodes");
    Ok(nodes + root)
}

/// Removes the parts not used from a coarser level: whatever moves it, its lights and cameras, and all scenes.
fn strip_unshown(json: &mut Value) {
    ["animations", "skins", "cameras", "scenes"].iter().for_each(|list| edit::remove(json, list));
    for node in edit::items_mut(json, "nodes") {
        ["skin", "camera"].iter().for_each(|member| edit::remove(node, member));
        ["KHR_lights_punctual", LEVELS].iter().for_each(|name| edit::drop_extension(node, name));
    }
}

/// Appends all items of a list to that of another document.
fn move_all(all: &mut Value, level: &mut Value, list: &str) {
    for item in edit::taken(level, list) {
        edit::push(all, list, item);
    }
}

fn shift(number: &mut Value, by: usize) {
    if let Some(old) = number.as_u64() {
        *number = (old + by as u64).into();
    }
}

/// Moves the items of a list that the other document lacks, and redirects references to the others. The references
/// within items have already been renumbered.
fn share(all: &mut RawGltf, level: &mut Value, (list, each): (&str, Visit)) {
    let own = edit::taken(level, list);
    let numbers: Vec<usize> = own.into_iter().map(|item| placed(&mut all.json, list, item)).collect();
    rename(level, each, &numbers);
}

fn placed(all: &mut Value, list: &str, item: Value) -> usize {
    let known = edit::items(all, list).iter().position(|known| *known == item);
    known.unwrap_or_else(|| edit::push(all, list, item))
}

fn rename(level: &mut Value, each: Visit, numbers: &[usize]) {
    each(level, &mut |number| {
        let old = number.as_u64().and_then(|old| numbers.get(old as usize));
        if let Some(new) = old {
            *number = (*new).into();
        }
    });
}

/// Like [`share`], for images, which are equal if their bytes are.
fn share_images(all: &mut RawGltf, level: &mut Value) {
    let mut numbers = Vec::new();
    for image in edit::taken(level, "images") {
        let bytes = image_bytes(all, &image);
        let is_same = |known: &Value| bytes.is_some() && image_bytes(all, known) == bytes;
        let known = edit::items(&all.json, "images").iter().position(is_same);
        numbers.push(known.unwrap_or_else(|| edit::push(&mut all.json, "images", image)));
    }
    rename(level, each_image, &numbers);
}

/// Returns the bytes of an image stored in a view.
fn image_bytes<'a>(all: &'a RawGltf, image: &Value) -> Option<&'a [u8]> {
    let view = edit::items(&all.json, "bufferViews").get(edit::number(image, "bufferView")?)?;
    let start = edit::number(view, "byteOffset").unwrap_or(0);
    let end = start.checked_add(edit::number(view, "byteLength")?)?;
    all.buffers.get(edit::number(view, "buffer")?)?.as_deref()?.get(start..end)
}

/// Visits the samplers of textures.
fn each_sampler(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    edit::items_mut(json, "textures").filter_map(|texture| texture.get_mut("sampler")).for_each(visit);
}

/// Visits the materials of primitives, in all variants.
fn each_material(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        members.get_mut("material").into_iter().for_each(&mut *visit);
    };
    edit::items_mut(json, "meshes").for_each(|mesh| edit::each_object(mesh, &mut of));
}
