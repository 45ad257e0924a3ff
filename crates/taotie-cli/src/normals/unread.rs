//! Options that the content of the input leaves without effect: each is a warning.

use super::args::NormalsArgs;
use taotie::Warnings;
use taotie::normal_map::{MapContent, MapSource};
use taotie::scene::NormalSpace;

/// Notes each option that this conversion does not read.
pub fn note(args: &NormalsArgs, source: &MapSource, warnings: &mut Warnings) {
    let own = match source.content {
        MapContent::Heights => None,
        MapContent::Normals(space) => Some(space),
    };
    let to = args.to.map(NormalSpace::from).or(own).unwrap_or(NormalSpace::Tangent);
    let is_tangent = own == Some(NormalSpace::Tangent);
    let unread = [
        ("--green-in is not read: the input is no tangent-space normal map", {
            args.green_in.is_some() && !is_tangent
        }),
        ("--green is not read: object-space normals have no green that points up or down", {
            args.green.is_some() && to == NormalSpace::Object
        }),
        ("--height-scale is not read: the input holds no heights", {
            args.height_scale.is_some() && own.is_some()
        }),
        ("--border is not read: the input holds no heights", args.border.is_some() && own.is_some()),
        ("--mesh is not read: the normals stay in their space", args.mesh.is_some() && own == Some(to)),
    ];
    unread.iter().for_each(|(what, is)| warnings.note(*what, usize::from(*is)));
}
