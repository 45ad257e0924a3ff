//! The names of the elements and properties of a PLY file, and their meaning.

use ply_rs_bw::ply::{ElementDef, Header, PropertyType, ScalarType};

/// The slots for the numbers of a vertex.
pub(super) mod slot {
    pub const POSITION: usize = 0;
    pub const NORMAL: usize = 3;
    pub const UV: usize = 6;
    pub const COLOR: usize = 8;
    pub const COUNT: usize = 12;
}

/// The use of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Skipped.
    Ignored,
    /// One of the numbers of [`slot`].
    Slot(usize),
    /// The vertices of a face, or of strips.
    Corners,
    /// A uv for each corner of a face.
    Uvs,
}

/// Returns the slot of a vertex property, by the common names.
fn vertex_slot(name: &str) -> Option<usize> {
    Some(match name {
        "x" => slot::POSITION,
        "y" => slot::POSITION + 1,
        "z" => slot::POSITION + 2,
        "nx" | "normal_x" => slot::NORMAL,
        "ny" | "normal_y" => slot::NORMAL + 1,
        "nz" | "normal_z" => slot::NORMAL + 2,
        "s" | "u" | "texture_u" | "texture_s" => slot::UV,
        "t" | "v" | "texture_v" | "texture_t" => slot::UV + 1,
        name => slot::COLOR + color_slot(name)?,
    })
}

/// Returns 0 to 3 for the names of red, green, blue and alpha.
fn color_slot(name: &str) -> Option<usize> {
    Some(match name {
        "red" | "r" | "diffuse_red" => 0,
        "green" | "g" | "diffuse_green" => 1,
        "blue" | "b" | "diffuse_blue" => 2,
        "alpha" | "a" | "diffuse_alpha" => 3,
        _ => return None,
    })
}

/// Returns the use of the property `name` of an element.
pub(super) fn role(element: &str, name: &str, data_type: &PropertyType) -> Result<Role, String> {
    let is_list = matches!(data_type, PropertyType::List(..));
    let slot = match (element, name) {
        ("face" | "tristrips", "vertex_indices" | "vertex_index") if is_list => return Ok(Role::Corners),
        ("face" | "tristrips", "texcoord") if is_list => return Ok(Role::Uvs),
        ("face" | "tristrips", "vertex_indices" | "vertex_index" | "texcoord") => {
            return Err(format!("property {name} must be a list; re-export the mesh"));
        }
        ("vertex", name) => vertex_slot(name),
        ("face", name) => color_slot(name).map(|slot| slot::COLOR + slot),
        _ => None,
    };
    Ok(slot.filter(|_| !is_list).map_or(Role::Ignored, Role::Slot))
}

/// The encoding of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ColorCode {
    /// Integers: sRGB-encoded.
    Encoded,
    /// Floats: linear.
    Linear,
}

/// The attributes declared by the header.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Attributes {
    /// `true` if x, y and z exist.
    pub positions: bool,
    /// A normal per vertex.
    pub normals: bool,
    /// A uv per vertex.
    pub uvs: bool,
    /// A colour per vertex.
    pub colors: Option<ColorCode>,
    /// A colour per face.
    pub face_colors: Option<ColorCode>,
}

impl Attributes {
    /// Reads the declarations.
    pub fn of(header: &Header) -> Self {
        let slots = |name: &str| header.elements.get(name).map(declared).unwrap_or_default();
        let (vertex, face) = (slots("vertex"), slots("face"));
        let has = |slots: std::ops::Range<usize>| slots.into_iter().all(|s| vertex[s].is_some());
        Self {
            positions: has(slot::POSITION..slot::NORMAL),
            normals: has(slot::NORMAL..slot::UV),
            uvs: has(slot::UV..slot::COLOR),
            colors: color_code(&vertex),
            face_colors: color_code(&face),
        }
    }
}

/// The declaration of each slot: `None` if absent, else its colour encoding.
type Declared = [Option<ColorCode>; slot::COUNT];

fn declared(element: &ElementDef) -> Declared {
    let mut declared = Declared::default();
    for (name, property) in &element.properties {
        if let Ok(Role::Slot(slot)) = role(&element.name, name, &property.data_type) {
            let float = matches!(&property.data_type, PropertyType::Scalar(s) if is_float(s));
            declared[slot] = Some(if float { ColorCode::Linear } else { ColorCode::Encoded });
        }
    }
    declared
}

fn color_code(declared: &Declared) -> Option<ColorCode> {
    let rgb = &declared[slot::COLOR..slot::COLOR + 3];
    let linear = rgb.contains(&Some(ColorCode::Linear));
    rgb.iter().all(Option::is_some).then_some(if linear { ColorCode::Linear } else { ColorCode::Encoded })
}

/// Returns `true` for floating-point types.
pub(super) fn is_float(scalar: &ScalarType) -> bool {
    matches!(scalar, ScalarType::Float | ScalarType::Double)
}

/// Returns the number that represents full intensity in a colour.
pub(super) fn full_intensity(scalar: &ScalarType) -> f64 {
    match scalar {
        ScalarType::Char => 127.0,
        ScalarType::Short => 32767.0,
        ScalarType::UShort => 65535.0,
        ScalarType::UChar | ScalarType::Int | ScalarType::UInt => 255.0,
        ScalarType::Float | ScalarType::Double => 1.0,
    }
}
