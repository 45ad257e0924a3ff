//! Drops textures, images and views that are no longer used.

use super::super::edit;
use super::factors::GLOSSINESS;
use crate::io::gltf::{OF_TEXTURES, is_known};
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// Drops them, and returns how many of the first `count` images are left. If the document uses an unknown extension,
/// which may refer to anything, everything is kept.
pub(in super::super) fn prune(json: &mut Value, count: usize) -> usize {
    drop_unused(json, &["materials"], GLOSSINESS);
    let knows = |name: &Value| name.as_str().is_some_and(is_known);
    if !edit::items(json, "extensionsUsed").iter().all(knows) {
        return count;
    }
    drop_unnamed(json, "textures", each_texture);
    let kept = drop_unnamed(json, "images", each_image);
    drop_unnamed(json, "bufferViews", each_view);
    for name in OF_TEXTURES {
        drop_unused(json, &["textures"], name);
    }
    kept.into_iter().filter(|image| *image < count as u64).count()
}

/// Drops the name of an extension that is no longer used by any item of the lists `holders`, such as `textures`.
pub(in super::super) fn drop_unused(json: &mut Value, holders: &[&str], name: &str) {
    let has_it = |holder: &Value| holder.pointer(&format!("/extensions/{name}")).is_some();
    if holders.iter().flat_map(|list| edit::items(json, list)).any(has_it) {
        return;
    }
    for list in ["extensionsUsed", "extensionsRequired"] {
        let names: Vec<Value> = edit::taken(json, list).into_iter().filter(|known| known != name).collect();
        if !names.is_empty() {
            json[list] = Value::Array(names);
        }
    }
}

/// Visits all references to items of one kind in a document.
pub(in super::super) type Visit = fn(&mut Value, &mut dyn FnMut(&mut Value));

/// Drops the unreferenced items of a list, and renumbers the others; returns the old indices of those kept.
pub(in super::super) fn drop_unnamed(json: &mut Value, list: &str, each: Visit) -> Vec<u64> {
    let mut named = BTreeSet::new();
    each(json, &mut |number| named.extend(number.as_u64()));
    let items = edit::taken(json, list);
    let kept: Vec<u64> = (0..items.len() as u64).filter(|i| named.contains(i)).collect();
    each(json, &mut |number| {
        if let Some(old) = number.as_u64() {
            // An invalid index stays invalid.
            *number = kept.binary_search(&old).unwrap_or(kept.len()).into();
        }
    });
    let is_kept = |(i, _): &(usize, Value)| kept.binary_search(&(*i as u64)).is_ok();
    let items: Vec<Value> = items.into_iter().enumerate().filter(is_kept).map(|(_, item)| item).collect();
    if !items.is_empty() {
        json[list] = Value::Array(items);
    }
    kept
}

/// Visits the textures of materials: `index` of members such as `normalTexture`.
pub(in super::super) fn each_texture(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        let slots = members.iter_mut().filter(|(name, _)| name.ends_with("Texture"));
        slots.filter_map(|(_, slot)| slot.get_mut("index")).for_each(&mut *visit);
    };
    edit::items_mut(json, "materials").for_each(|material| edit::each_object(material, &mut of));
}

/// Visits the images of textures.
pub(in super::super) fn each_image(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        members.get_mut("source").into_iter().for_each(&mut *visit);
    };
    edit::items_mut(json, "textures").for_each(|texture| edit::each_object(texture, &mut of));
}

/// Visits the views of accessors, images and everything else.
pub(in super::super) fn each_view(json: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    let mut of = |members: &mut Map<String, Value>| {
        members.get_mut("bufferView").into_iter().for_each(&mut *visit);
    };
    edit::each_object(json, &mut of);
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn extensions_of_textures_go_with_the_last_of_them() {
        let file = |extensions: Value| {
            json!({
                "extensionsUsed": ["EXT_texture_webp"], "extensionsRequired": ["EXT_texture_webp"],
                "materials": [{ "normalTexture": { "index": 0 } }],
                "textures": [{ "source": 0, "extensions": extensions }], "images": [{}],
            })
        };
        let mut png = file(json!({}));
        prune(&mut png, 1);
        assert!(png.get("extensionsUsed").is_none() && png.get("extensionsRequired").is_none());
        let mut webp = file(json!({ "EXT_texture_webp": { "source": 0 } }));
        prune(&mut webp, 1);
        assert_eq!(webp["extensionsRequired"], json!(["EXT_texture_webp"]));
    }

    #[test]
    fn what_only_colours_and_gloss_named_goes_with_them() {
        let file = |material: Value| {
            json!({
                "extensionsUsed": [GLOSSINESS], "materials": [material],
                "textures": [{ "source": 0 }], "images": [{}],
            })
        };
        let mut glossy = file(json!({ "extensions": { GLOSSINESS: { "diffuseTexture": { "index": 0 } } } }));
        assert_eq!((prune(&mut glossy, 1), &glossy["extensionsUsed"]), (1, &json!([GLOSSINESS])));
        let mut plain = file(json!({}));
        assert_eq!(prune(&mut plain, 1), 0);
        assert!(plain.get("extensionsUsed").is_none() && plain.get("textures").is_none(), "{plain}");
    }

    #[test]
    fn what_nothing_names_goes() {
        let mut json = json!({
            "extensionsUsed": ["KHR_materials_sheen"],
            "materials": [
                { "normalTexture": { "index": 2 } },
                { "extensions": { "KHR_materials_sheen": { "sheenColorTexture": { "index": 3 } } } },
            ],
            "textures": [{ "source": 0 }, { "source": 1 }, { "source": 1 }, { "source": 2 }],
            "images": [{ "bufferView": 0 }, { "bufferView": 2 }, { "uri": "a.png" }],
            "accessors": [{ "bufferView": 3, "sparse": { "values": { "bufferView": 4 } } }],
            "bufferViews": ["dead", "dead", "image", "numbers", "sparse"],
        });
        assert_eq!(prune(&mut json, 2), 1, "of the first two, one is left");
        assert_eq!(json["textures"], json!([{ "source": 0 }, { "source": 1 }]));
        assert_eq!(json["images"], json!([{ "bufferView": 0 }, { "uri": "a.png" }]));
        assert_eq!(json["bufferViews"], json!(["image", "numbers", "sparse"]));
        assert_eq!(json["accessors"][0]["sparse"]["values"]["bufferView"], 2);
        assert_eq!(json["materials"][0]["normalTexture"]["index"], 0);
        let sheen = "/materials/1/extensions/KHR_materials_sheen/sheenColorTexture/index";
        assert_eq!(json.pointer(sheen), Some(&json!(1)));
    }

    #[test]
    fn an_unknown_extension_keeps_all() {
        let before = json!({ "extensionsUsed": ["EXT_nobody"], "images": [{}], "bufferViews": [{}] });
        let mut json = before.clone();
        assert_eq!(prune(&mut json, 1), 1);
        assert_eq!(json, before);
    }
}
