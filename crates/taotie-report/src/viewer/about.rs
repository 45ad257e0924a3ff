//! The metadata in a model file.

use crate::Fact;
use taotie_io::{Loaded, xmp_rights, xmp_sources};

/// Returns the source, rights and size of a model, as far as its file states them.
pub fn facts(loaded: &Loaded, file: &str) -> Vec<Fact> {
    let packet = loaded.xmp.first();
    let sources = packet.map(xmp_sources).unwrap_or_default().join("; ");
    let stated = [
        ("File", Some(file.to_owned())),
        ("Triangles", Some(loaded.scene.triangle_count().to_string())),
        ("Copyright", loaded.copyright.clone()),
        ("Rights", packet.and_then(xmp_rights)),
        ("Source", Some(sources).filter(|text| !text.is_empty())),
        ("Made by", loaded.generator.clone()),
    ];
    stated.into_iter().filter_map(|(name, value)| Some(Fact::new(name, value?))).collect()
}
