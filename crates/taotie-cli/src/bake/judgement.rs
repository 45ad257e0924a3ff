//! What is wrong with a pair of meshes, in plain words and with numbers. A bad map is never baked in silence.

use super::work::{Light, Made, Source};
use taotie::Warnings;
use taotie::bake::{Faults, Verifier};
use taotie::mesh::Mesh;
use taotie::surface::facet_normal;

/// Points at which the pair is looked at.
const POINTS: usize = 4_000;
/// More of the texels missing than this is worth a warning.
const MISSED: f64 = 0.001;
/// More of the light mesh far away, or turned, than this is worth a warning.
const PART: f64 = 0.02;

/// Notes what is wrong.
pub fn judge(source: &Source, light: &Light, made: &Made, warnings: &mut Warnings) {
    let percent = |part: f64| format!("{:.1} %", part * 100.0);
    let diagonal = source.scan.mesh().diagonal();
    let pair = Verifier { mesh: &light.mesh, normal: None, cage: &made.cage, scan: &source.scan };
    let mut note = |text: String| warnings.note(text, 1);
    if let Some(fit) = pair.fit(POINTS, diagonal) {
        if fit.away > PART {
            let apart = if fit.away > 0.9 { "the meshes do not overlap" } else { "the meshes part" };
            note(format!(
                "{apart}: {} of the light mesh lies farther than 2 % of the diagonal from the scan ({} on average); is one of \
                 them moved, scaled or posed differently?",
                percent(fit.away),
                percent(fit.distance)
            ));
        }
        // Far from the scan it is chance which of its sides is the closest.
        if fit.turned > PART && fit.away < 0.5 {
            let who = if fit.turned > 0.5 {
                "one of the meshes is inside out"
            } else {
                "some triangles are turned"
            };
            note(format!(
                "{who}: {} of the light mesh faces the other way than the scan beside it; turn its triangles and normals",
                percent(fit.turned)
            ));
        }
    }
    let counts = &made.counts;
    let part = |of: usize, all: usize| of as f64 / all.max(1) as f64;
    let missed = part(counts.missed_texels, counts.texels);
    if missed > MISSED {
        note(format!(
            "{} of the texels have rays that missed the scan: {} of all rays took its closest point, {} found nothing and left \
             the light mesh's own normal; the report shows where, --ray-distance or a --cage may reach farther",
            percent(missed),
            percent(part(counts.missed - counts.lost, counts.samples)),
            percent(part(counts.lost, counts.samples))
        ));
    }
    if counts.shared > counts.samples / 1000 {
        note(format!(
            "{} of the map lies under more than one triangle: charts overlap, and each place has the relief of one of them; \
             unwrap the light mesh without overlaps",
            percent(part(counts.shared, counts.samples))
        ));
    }
    warnings.note("triangles of the light mesh without uv area, which have no relief", counts.flat);
    warnings.note("triangles of the light mesh that face away from their own normals", turned(&light.mesh));
}

/// How many triangles face away from the mean of their corners' normals.
fn turned(mesh: &Mesh) -> usize {
    let is_turned = |t: &usize| {
        let [a, b, c] = mesh.triangles()[*t].map(|v| mesh.normals()[v as usize]);
        facet_normal(mesh.corners(*t)).is_some_and(|facet| facet.dot(a + b + c) < 0.0)
    };
    (0..mesh.triangles().len()).filter(is_turned).count()
}

/// Notes what is wrong with the scan itself.
pub fn inspect(scan: &Mesh, warnings: &mut Warnings) {
    let Faults { open_edges, crowded_edges, duplicates, flat } = Faults::of(scan);
    warnings.note("edges of the scan with one triangle: it is open there", open_edges);
    warnings.note("edges of the scan where more than two triangles meet", crowded_edges);
    warnings.note("triangles of the scan that are there more than once", duplicates);
    warnings.note("triangles of the scan without area", flat);
}
