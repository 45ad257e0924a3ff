//! The options of `taotie inspect`.

use crate::limits::LimitArgs;
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  taotie inspect statue.glb
  taotie inspect statue.obj --json
  taotie inspect statue.glb --audit schema.json

Counted as defects:
  UVs       triangles with a corner outside [0, 1], without UV area, or mirrored (UVs run clockwise)
  tangents  more than 1 % from unit length, more than 1 degree from perpendicular to the normal,
            triangles whose corners differ in handedness; if the material has a normal map, the
            angle to MikkTSpace's tangents
  texels    of a tangent-space normal map whose blue is not above one half";

/// Lists the content of a model file and its defects.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct InspectArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl
    pub model: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    pub json: bool,
    /// Check the model against a schema of the Khronos glTF Asset Auditor instead; exit with 1 if a check fails
    #[arg(long, value_name = "SCHEMA")]
    pub audit: Option<PathBuf>,
    /// Dimensions of the product that the model shows, as JSON in the auditor's format
    #[arg(long, value_name = "FILE", requires = "audit")]
    pub product_info: Option<PathBuf>,
    #[command(flatten)]
    pub limits: LimitArgs,
}
