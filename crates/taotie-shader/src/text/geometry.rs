//! The geometry of a point, from the interpolated values and their changes to the next pixels.

use crate::pixel::PixelProgram;

/// Written before the structure's fields are put together.
const VIEWER: &str = "// The unit direction to the viewer.
vec3 direction_to_viewer(vec3 position, vec3 fallback) {
    if (frame.eye.w == 0.0) {
        return frame.eye.xyz;
    }
    return normalize_or(frame.eye.xyz - position, fallback);
}

// The geometry of the point. The triangle's normal is that of the plane in which the position changes.
Geometry geometry(Interpolated i, bool front) {
    vec3 position_dx = dFdx(i.position);
    vec3 position_dy = dFdy(i.position);
    vec3 facet = normalize_or(cross(position_dx, position_dy), vec3(0.0, 0.0, 1.0));
    vec3 v = direction_to_viewer(i.position, facet);
    mut vec3 n_geom = facet;
    if (dot(facet, v) < 0.0) {
        n_geom = -facet;
    }
";

const FACING: &str = "    mut float facing = 1.0;
    if (!front) {
        facing = -1.0;
    }
";

/// The function `geometry`; empty if no stage reads it.
pub(crate) fn geometry(pixel: &PixelProgram) -> String {
    let fields = pixel.fields("Geometry");
    if fields.is_empty() {
        return String::new();
    }
    let values: Vec<&str> = fields.iter().map(|field| value(field)).collect();
    let takes_height = fields.iter().any(|field| field.starts_with("du_") || field.starts_with("dv_"));
    let height = if takes_height { "    Coordinates height = height_coordinates(i);\n" } else { "" };
    let facing = if fields.contains(&"facing") { FACING } else { "" };
    format!("{VIEWER}{facing}{height}    return Geometry({});\n}}\n", values.join(", "))
}

/// The value of a field; changes are to the next sample.
fn value(field: &str) -> &'static str {
    match field {
        "n_geom" => "n_geom",
        "normal" => "i.normal",
        "normal_dx" => "dFdx(i.normal) * frame.spacing",
        "normal_dy" => "dFdy(i.normal) * frame.spacing",
        "tangent" => "i.tangent",
        "handedness" => "i.handedness",
        "facing" => "facing",
        "v" => "v",
        "position_dx" => "position_dx * frame.spacing",
        "position_dy" => "position_dy * frame.spacing",
        "du_dx" => "height.d_x.x",
        "dv_dx" => "height.d_x.y",
        "du_dy" => "height.d_y.x",
        "dv_dy" => "height.d_y.y",
        "height_width" => "vec2(textureSize(height_texture, 0)).x",
        _ => "0.0",
    }
}
