//! The last step: simplifies all triangles as a whole, by the mildest method that reaches the number.

use super::apart;
use super::cluster::clustered;
use super::collapse::{Reduced, collapsed_exactly, is_too_many, pruned};
use super::components::{Components, Fate};
use super::options::{SimplifyMethod, SimplifyOptions};
use super::part::Part;

/// Returns the part with the requested number of triangles, or as close to it as possible.
///
/// Edges are collapsed as a whole, which spends triangles where the surface needs them. If that does not reach the
/// number, or loses or tears a large component, each component is simplified separately, so that nothing joins parts
/// that are merely close. Vertices are merged by proximity in triangle soup only.
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
            // If clusters are as small as the whole, nothing is left.
            if last.triangles.is_empty() { together } else { last }
        }
        () if components.len() > 1 => apart::reduce(part, components, &together, options),
        () => together,
    }
}
