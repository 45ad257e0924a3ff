//! The last step: all triangles at once, by the mildest method that reaches the number.

use super::apart;
use super::cluster::clustered;
use super::collapse::{Reduced, collapsed_exactly, is_too_many, pruned};
use super::components::{Components, Fate};
use super::options::{SimplifyMethod, SimplifyOptions};
use super::part::Part;

/// Returns the part with the wanted number of triangles, or as near to it as can be.
///
/// Edges are collapsed all at once, which spends triangles where the surface needs them. Where that does not reach the
/// number, or loses or tears a large component, each component is simplified alone, so that nothing joins what only
/// lies near. Vertices are joined by nearness in triangle soup only.
pub(super) fn reduce(part: &Part, components: &Components, options: &SimplifyOptions) -> Reduced {
    let wanted = options.triangles;
    if part.triangles.len() <= wanted {
        return Reduced::kept(part, SimplifyMethod::Kept);
    }
    let is_soup = components.is_soup;
    let is_whole = |reduced: &Reduced| {
        let fate = |reduced: &Reduced| components.fate(part, &reduced.triangles);
        is_soup || matches!(fate(reduced), Fate { lost_large: 0, torn: 0, .. })
    };
    let first = collapsed_exactly(part, options);
    if !is_too_many(&first, wanted) && is_whole(&first) {
        return first;
    }
    let together = if is_too_many(&first, wanted) { pruned(first, options) } else { first };
    let is_reached = !is_too_many(&together, wanted);
    match () {
        () if is_reached && is_whole(&together) => together,
        () if is_soup => {
            let last = clustered(part, options);
            // Clusters as small as the whole leave nothing.
            if last.triangles.is_empty() { together } else { last }
        }
        () if components.len() > 1 => apart::reduce(part, components, &together, options),
        () => together,
    }
}
