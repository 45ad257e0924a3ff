//! The report on a model, printed as JSON, or as text in sections of aligned lines.

use super::words::{self, clean, number, numbers, percent, short, thousands, yes_or_no};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::Path;
use taotie::Warning;
use taotie::inspection::{
    AnimationReport, Counts, Extent, Inspection, Listed, MaterialReport, MeshReport, NormalMapReport,
    Normals, TangentHealth, TextureReport,
};
use taotie_engine::names::Named;
use taotie_engine::surface::GreenVerdict;
use taotie_io::{GltfSizes, XmpEvent};
use taotie_report::table::Table;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 5;

/// The printed report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// [`SCHEMA`].
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path as given.
    model: String,
    /// The content of the model and its defects.
    #[serde(flatten)]
    inspection: Inspection,
    /// Suggestions.
    hints: Vec<String>,
}

impl Report {
    /// Makes the report on the model at `path`.
    pub fn new(path: &Path, inspection: Inspection) -> Self {
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            model: path.display().to_string(),
            hints: inspection.hints().iter().filter_map(words::hint).collect(),
            inspection,
        }
    }
}

/// Returns the report as text: sections of aligned lines.
pub fn text(printed: &Report) -> String {
    let report = &printed.inspection;
    let sections = [
        ("", head(&printed.model, report)),
        ("Counts", counts(&report.counts)),
        ("Bytes", report.sizes.as_ref().map(sizes).unwrap_or_default()),
        ("Meshes", meshes(&report.meshes)),
        ("Uv sets", uv_sets(&report.meshes)),
        ("Tangents of the file", tangents(&report.meshes)),
        ("Materials", materials(&report.materials)),
        ("Lights", named(&report.lights)),
        ("Cameras", named(&report.cameras)),
        ("Animations", animations(&report.animations)),
        ("Variants", report.variants.iter().map(|name| format!("  {}\n", short(name))).collect()),
        ("History", history(&report.history)),
        ("Extensions", extensions(report)),
        ("Missing files", report.missing_files.iter().map(|file| format!("  {}\n", clean(file))).collect()),
        ("Warnings", warnings(&report.warnings)),
        ("Hints", printed.hints.iter().map(|hint| format!("  {}\n", clean(hint))).collect()),
    ];
    let filled = sections.into_iter().filter(|(_, lines)| !lines.is_empty());
    let titled =
        filled.map(|(title, lines)| if title.is_empty() { lines } else { format!("{title}\n{lines}") });
    titled.collect::<Vec<_>>().join("\n")
}

fn head(model: &str, report: &Inspection) -> String {
    let mut table = Table::untitled(&["", ""]);
    let mut row = |key: &str, value: String| table.row([key.into(), value]);
    row("model", clean(model));
    row("format", report.format.clone());
    let about =
        [("generator", &report.generator), ("copyright", &report.copyright), ("rights", &report.rights)];
    let given = about.into_iter().filter_map(|(key, value)| Some((key, value.as_ref()?)));
    for (key, value) in given.chain(report.sources.iter().map(|source| ("source", source))) {
        row(key, clean(value));
    }
    match &report.bounds {
        Some(Extent { min, max, size, .. }) => {
            row("bounds", format!("{} to {}", numbers(min), numbers(max)));
            row("size", size.map(number).join(" × "));
        }
        None => row("bounds", "nothing is drawn".into()),
    }
    table.lines(0)
}

fn counts(counts: &Counts) -> String {
    let mut table = Table::untitled(&["", ">"]);
    let rows = [
        ("meshes", counts.meshes),
        ("instances", counts.instances),
        ("triangles", counts.triangles),
        ("triangles drawn", counts.triangles_drawn),
        ("vertices", counts.vertices),
        ("materials", counts.materials),
        ("textures", counts.textures),
        ("lights", counts.lights),
        ("cameras", counts.cameras),
        ("animations", counts.animations),
    ];
    rows.into_iter().for_each(|(key, count)| table.row([key.into(), thousands(count)]));
    table.lines(2)
}

/// Returns the table of bytes in the file and on the graphics card.
fn sizes(sizes: &GltfSizes) -> String {
    let mut table = Table::new(&["", ">bytes", ">GPU bytes"]);
    let mut row = |name: &str, bytes: Option<u64>, gpu_bytes: Option<u64>| {
        let cell = |bytes: Option<u64>| bytes.map_or_else(String::new, thousands);
        table.row([short(name), cell(bytes), cell(gpu_bytes)]);
    };
    row("JSON", Some(sizes.json), None);
    for size in
        sizes.attributes.iter().chain([&sizes.indices]).filter(|size| size.bytes > 0 || size.gpu_bytes > 0)
    {
        row(&size.name, Some(size.bytes), Some(size.gpu_bytes));
    }
    sizes.images.iter().for_each(|image| row(&image.name, Some(image.bytes), Some(image.gpu_bytes)));
    let others = [("animations and skins", sizes.animations), ("other", sizes.other)];
    others.into_iter().filter(|(_, bytes)| *bytes > 0).for_each(|(name, bytes)| row(name, Some(bytes), None));
    row("all", Some(sizes.bytes()), Some(sizes.gpu_bytes));
    table.filled_lines(2)
}

fn meshes(meshes: &[MeshReport]) -> String {
    let titles = [
        ">#",
        "name",
        ">triangles",
        ">zero-area",
        ">vertices",
        ">uv sets",
        "normals",
        "tangents",
        "colours",
        "material",
    ];
    let mut table = Table::new(&titles);
    for (index, mesh) in meshes.iter().enumerate() {
        table.row([
            index.to_string(),
            short(&mesh.name),
            thousands(mesh.triangles),
            thousands(mesh.zero_area_triangles),
            thousands(mesh.vertices),
            mesh.uv_sets.len().to_string(),
            normals(mesh),
            yes_or_no(mesh.tangents.is_some()),
            yes_or_no(mesh.colors),
            numbered(&mesh.materials),
        ]);
    }
    table.filled_lines(2)
}

/// Returns the first numbers of a list, with an ellipsis if there are more.
fn numbered(all: &[usize]) -> String {
    /// The number that fits on a line.
    const MOST: usize = 16;
    let more = (all.len() > MOST).then(|| "…".to_owned());
    all.iter().take(MOST).map(usize::to_string).chain(more).collect::<Vec<_>>().join(" ")
}

fn normals(mesh: &MeshReport) -> String {
    let kind = match mesh.normals {
        Normals::Missing => "missing",
        Normals::Flat => "flat",
        Normals::Smooth => "smooth",
    };
    match mesh.normals_not_unit {
        0 => kind.into(),
        bad => format!("{kind}, {} not unit", thousands(bad)),
    }
}

fn uv_sets(meshes: &[MeshReport]) -> String {
    let mut table = Table::new(&[">#", "mesh", ">set", ">outside [0, 1]", ">no area", ">mirrored"]);
    for (index, mesh) in meshes.iter().enumerate() {
        for (set, uvs) in mesh.uv_sets.iter().enumerate() {
            table.row([
                index.to_string(),
                short(&mesh.name),
                set.to_string(),
                percent(uvs.outside),
                thousands(uvs.degenerate),
                percent(uvs.mirrored),
            ]);
        }
    }
    table.filled_lines(2)
}

fn tangents(meshes: &[MeshReport]) -> String {
    let titles = [">#", "mesh", ">not unit", ">not perpendicular", ">mixed handedness", "against MikkTSpace"];
    let mut table = Table::new(&titles);
    for (index, mesh) in meshes.iter().enumerate() {
        let Some(health) = &mesh.tangents else { continue };
        table.row([
            index.to_string(),
            short(&mesh.name),
            thousands(health.not_unit),
            thousands(health.not_perpendicular),
            thousands(health.mixed_handedness),
            agreement(health),
        ]);
    }
    table.filled_lines(2)
}

fn agreement(health: &TangentHealth) -> String {
    let Some(agreement) = &health.mikktspace else { return "no normal map".into() };
    format!(
        "mean {:.2}°, max {:.2}°, {} corners of opposite handedness",
        agreement.mean_degrees,
        agreement.max_degrees,
        thousands(agreement.other_handedness)
    )
}

fn materials(materials: &[MaterialReport]) -> String {
    materials.par_iter().enumerate().map(|(index, one)| material(index, one)).collect()
}

fn material(index: usize, material: &MaterialReport) -> String {
    let name = if material.name.is_empty() { "(no name)".into() } else { short(&material.name) };
    let textures = textures(&material.textures);
    let map = material.normal_map.iter().map(normal_map);
    let map: String = map.map(|line| format!("      {line}\n")).collect();
    format!("  {index}  {name}: {}\n{textures}{map}", factors(material))
}

fn factors(material: &MaterialReport) -> String {
    let alpha = match material.alpha_cutoff {
        Some(cutoff) => format!("mask at {cutoff}"),
        None => material.alpha_mode.clone(),
    };
    let mut parts = vec![
        format!("base colour {}", numbers(&material.base_color.map(f64::from))),
        format!("metallic {}", material.metallic),
        format!("roughness {}", material.roughness),
        alpha,
        if material.double_sided { "double-sided".into() } else { "single-sided".into() },
    ];
    let classic = &material.classic;
    let colors = [
        ("f0", material.f0),
        ("emissive", Some(material.emissive).filter(|emissive| *emissive != [0.0; 3])),
        ("ambient", classic.ambient),
        ("diffuse", classic.diffuse),
        ("specular", classic.specular),
    ];
    let given = colors.into_iter().filter_map(|(key, color)| Some((key, color?)));
    parts.extend(given.map(|(key, color)| format!("{key} {}", numbers(&color.map(f64::from)))));
    let scalars =
        [("shininess", classic.shininess), ("slope", classic.slope), ("height scale", material.height_scale)];
    let given = scalars.into_iter().filter_map(|(key, value)| Some((key, value?)));
    parts.extend(given.map(|(key, value)| format!("{key} {value}")));
    parts.extend(words::layers(material));
    if material.unlit {
        parts.push("unlit".into());
    }
    parts.join(", ")
}

fn textures(textures: &[TextureReport]) -> String {
    let mut table = Table::untitled(&["", "", ">", "", "", ""]);
    for texture in textures {
        let channels = ["", "grey", "grey + alpha", "RGB", "RGBA"][usize::from(texture.channels.min(4))];
        table.row([
            texture.role.clone(),
            clean(&texture.file),
            format!("{}×{}", texture.width, texture.height),
            format!("{}-bit {channels}", texture.bits),
            if texture.encoding == "srgb" { "sRGB".into() } else { texture.encoding.clone() },
            format!("uv {}", texture.uv_set),
        ]);
    }
    table.lines(6)
}

fn normal_map(map: &NormalMapReport) -> String {
    let pixels = &map.pixels;
    let kind = words::kind(pixels.kind_by_pixels);
    let green = match (pixels.green_by_pixels, pixels.green_confidence) {
        (Some(GreenVerdict::Unclear), _) => ", green unclear".into(),
        (Some(green), Some(sure)) => {
            format!(", green {} ({} sure)", words::verdict(green), percent(f64::from(sure)))
        }
        _ => String::new(),
    };
    let invalid = pixels
        .invalid_texels
        .map(|invalid| format!(", {} of {} texels invalid", thousands(invalid), thousands(pixels.texels)));
    format!(
        "normal map by its pixels: {kind}{green}{}; drawn as {}-space, green {}, scale {}",
        invalid.unwrap_or_default(),
        map.space.name(),
        map.green.name(),
        map.scale
    )
}

fn named(all: &[Listed]) -> String {
    let mut table = Table::untitled(&[">", "", ""]);
    for (index, one) in all.iter().enumerate() {
        table.row([index.to_string(), one.kind.clone(), short(&one.name)]);
    }
    table.lines(2)
}

fn animations(all: &[AnimationReport]) -> String {
    let mut table = Table::new(&[">#", "name", ">seconds", ">channels", ">keyframes"]);
    for (index, animation) in all.iter().enumerate() {
        table.row([
            index.to_string(),
            short(&animation.name),
            number(animation.seconds),
            thousands(animation.channels),
            thousands(animation.keyframes),
        ]);
    }
    table.filled_lines(2)
}

fn extensions(report: &Inspection) -> String {
    let mut table = Table::untitled(&["", ""]);
    let required: BTreeSet<&String> = report.extensions_required.iter().collect();
    for name in &report.extensions_used {
        let required = required.contains(name);
        table.row([clean(name), if required { "required".into() } else { String::new() }]);
    }
    table.lines(2)
}

fn history(all: &[XmpEvent]) -> String {
    let mut table = Table::new(&[">#", "action", "program", "when", "parameters"]);
    for (index, event) in all.iter().enumerate() {
        let said = |text: &Option<String>| clean(text.as_deref().unwrap_or_default());
        table.row([
            index.to_string(),
            clean(&event.action),
            said(&event.agent),
            said(&event.when),
            said(&event.parameters),
        ]);
    }
    table.filled_lines(2)
}

/// Lists each warning with its count.
pub fn warnings(all: &[Warning]) -> String {
    let mut table = Table::untitled(&[">", ""]);
    for warning in all {
        table.row([format!("{}×", thousands(warning.count)), clean(&warning.what)]);
    }
    table.lines(2)
}
