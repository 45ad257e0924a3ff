//! Options without effect on this input: each is a warning.

use super::args::NormalsArgs;
use taotie_engine::Warnings;
use taotie_engine::normal_map::{MapContent, MapSource};
use taotie_engine::scene::NormalSpace;

/// Adds a warning for each option that has no effect on this conversion.
pub fn note(args: &NormalsArgs, source: &MapSource, warnings: &mut Warnings) {
    let own = match source.content {
        MapContent::Heights => None,
        MapContent::Normals(space) => Some(space),
    };
    let to = args.to.map(NormalSpace::from).or(own).unwrap_or(NormalSpace::Tangent);
    let is_tangent = own == Some(NormalSpace::Tangent);
    let unread = [
        ("--green-in has no effect: the input is not a tangent-space normal map", {
            args.green_in.is_some() && !is_tangent
        }),
        ("--green has no effect: object-space normals have no green direction", {
            args.green.is_some() && to == NormalSpace::Object
        }),
        ("--height-scale has no effect: the input holds no heights", {
            args.height_scale.is_some() && own.is_some()
        }),
        ("--border has no effect: the input holds no heights", args.border.is_some() && own.is_some()),
        ("--mesh has no effect: the normals stay in their space", args.mesh.is_some() && own == Some(to)),
    ];
    unread.iter().for_each(|(what, is)| warnings.note(*what, usize::from(*is)));
}
