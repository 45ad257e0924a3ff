//! The rows of a PLY file as they are read: only what can be drawn is kept.

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// Where the values of a vertex stand in [`VertexRow::values`].
pub(super) mod slot {
    pub const POSITION: usize = 0;
    pub const NORMAL: usize = 3;
    pub const UV: usize = 6;
    pub const COLOR: usize = 8;
    pub const COUNT: usize = 12;
}

/// One vertex. What the file lacks is 0, but alpha is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VertexRow {
    /// Position, normal, uv and RGBA as [`slot`] says; colours stored as whole numbers are divided by their greatest.
    pub values: [f32; slot::COUNT],
}

/// The slot of a vertex property, by the names in use.
pub(super) fn vertex_slot(name: &str) -> Option<usize> {
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

/// 0 to 3 for the names of red, green, blue and alpha.
pub(super) fn color_slot(name: &str) -> Option<usize> {
    Some(match name {
        "red" | "r" | "diffuse_red" => 0,
        "green" | "g" | "diffuse_green" => 1,
        "blue" | "b" | "diffuse_blue" => 2,
        "alpha" | "a" | "diffuse_alpha" => 3,
        _ => return None,
    })
}

impl PropertyAccess for VertexRow {
    fn new() -> Self {
        let mut values = [0.0; slot::COUNT];
        values[slot::COLOR + 3] = 1.0;
        Self { values }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let (Some(slot), Some((value, full))) = (vertex_slot(name), number(&property)) else {
            return PropertyAccessResult::Ignored;
        };
        self.values[slot] = (if slot >= slot::COLOR { value / full } else { value }) as f32;
        PropertyAccessResult::Set
    }
}

/// One polygon, or one set of triangle strips.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FaceRow {
    /// Vertex indices; a negative one is `u32::MAX`.
    pub corners: Vec<u32>,
    /// u and v for each corner, or empty.
    pub uvs: Vec<f32>,
    /// RGBA, as at vertices.
    pub color: [f32; 4],
}

impl PropertyAccess for FaceRow {
    fn new() -> Self {
        Self { corners: Vec::new(), uvs: Vec::new(), color: [1.0; 4] }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match (name, color_slot(name)) {
            ("vertex_indices" | "vertex_index", _) => match indices(property) {
                Some(corners) => self.corners = corners,
                None => return PropertyAccessResult::UnsupportedType,
            },
            ("texcoord", _) => match property {
                Property::ListFloat(uvs) => self.uvs = uvs,
                Property::ListDouble(uvs) => self.uvs = uvs.into_iter().map(|v| v as f32).collect(),
                _ => return PropertyAccessResult::UnsupportedType,
            },
            (_, Some(slot)) => match number(&property) {
                Some((value, full)) => self.color[slot] = (value / full) as f32,
                None => return PropertyAccessResult::Ignored,
            },
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl FaceRow {
    /// The triangles of strips that are cut by negative indices; every second one of a strip is turned.
    pub(super) fn strip_triangles(&self) -> impl Iterator<Item = FaceRow> {
        let strips = self.corners.split(|index| *index == u32::MAX);
        strips.flat_map(|strip| {
            strip.windows(3).enumerate().filter_map(|(i, w)| {
                let corners = if i % 2 == 0 { vec![w[0], w[1], w[2]] } else { vec![w[1], w[0], w[2]] };
                let is_joint = w[0] == w[1] || w[1] == w[2] || w[0] == w[2];
                (!is_joint).then(|| FaceRow { corners, ..FaceRow::new() })
            })
        })
    }
}

/// A row of which nothing is kept.
#[derive(Debug)]
pub(super) struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}

/// A scalar with the value that is full intensity where it is a colour.
fn number(property: &Property) -> Option<(f64, f64)> {
    Some(match property {
        Property::Char(v) => (f64::from(*v), 127.0),
        Property::UChar(v) => (f64::from(*v), 255.0),
        Property::Short(v) => (f64::from(*v), 32767.0),
        Property::UShort(v) => (f64::from(*v), 65535.0),
        Property::Int(v) => (f64::from(*v), 255.0),
        Property::UInt(v) => (f64::from(*v), 255.0),
        Property::Float(v) => (f64::from(*v), 1.0),
        Property::Double(v) => (*v, 1.0),
        _ => return None,
    })
}

fn indices(property: Property) -> Option<Vec<u32>> {
    fn widened<T: TryInto<u32>>(list: Vec<T>) -> Vec<u32> {
        list.into_iter().map(|i| i.try_into().unwrap_or(u32::MAX)).collect()
    }
    Some(match property {
        Property::ListUInt(list) => list,
        Property::ListInt(list) => widened(list),
        Property::ListUShort(list) => widened(list),
        Property::ListShort(list) => widened(list),
        Property::ListUChar(list) => widened(list),
        Property::ListChar(list) => widened(list),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_alternate_and_restart() {
        let strips = FaceRow { corners: vec![0, 1, 2, 3, 3, u32::MAX, 4, 5, 6], ..FaceRow::new() };
        let triangles: Vec<Vec<u32>> = strips.strip_triangles().map(|f| f.corners).collect();
        assert_eq!(triangles, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
    }

    #[test]
    fn colours_of_every_type_reach_one() {
        let mut row = VertexRow::new();
        row.set_property("red", Property::UChar(255));
        row.set_property("g", Property::UShort(65535));
        row.set_property("diffuse_blue", Property::Float(1.0));
        row.set_property("quality", Property::Float(7.0));
        assert_eq!(row.values[slot::COLOR..], [1.0; 4]);
    }
}
