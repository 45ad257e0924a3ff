//! What to try where the report shows that something will not look as meant.

use super::material::MaterialReport;
use super::mesh::MeshReport;
use super::report::Report;

/// Mean angle from MikkTSpace's tangents that is worth a word.
const FAR_FROM_MIKKTSPACE: f64 = 5.0;

/// Hints about normal maps and tangents.
pub fn of(report: &Report) -> Vec<String> {
    let maps = report.materials.iter().filter_map(about_map);
    maps.chain(report.meshes.iter().filter_map(about_tangents)).collect()
}

fn about_map(material: &MaterialReport) -> Option<String> {
    let map = material.normal_map.as_ref()?;
    let name = &material.name;
    let kind = map.pixels.kind_by_pixels;
    if kind == "none" {
        return Some(format!("the normal map of '{name}' is no normal map by its pixels"));
    }
    if kind != map.space {
        let space = map.space;
        return Some(format!(
            "the normal map of '{name}' is {kind}-space by its pixels but drawn as {space}-space; \
             give it as --normal-map FILE --normal-space {kind}"
        ));
    }
    let green = map.pixels.green_by_pixels.filter(|green| *green != "unclear" && *green != map.green)?;
    Some(format!(
        "the normal map of '{name}' is green-{green} by its pixels but drawn green-{}; try --green {green}",
        map.green
    ))
}

fn about_tangents(mesh: &MeshReport) -> Option<String> {
    let agreement = mesh.tangents.as_ref()?.mikktspace.as_ref()?;
    let (name, degrees) = (&mesh.name, agreement.mean_degrees);
    (degrees > FAR_FROM_MIKKTSPACE).then(|| {
        format!(
            "the tangents of '{name}' are {degrees:.1} degrees from MikkTSpace's on average; \
             if the map was baked for MikkTSpace, try --tangents mikktspace"
        )
    })
}
