//! Converts rows of vertices to columns.

use super::names::{Attributes, ColorCode, Role, full_intensity, slot};
use super::payload::{Element, Rows};
use crate::error::Result;
use crate::math::srgb::linear_from_srgb;
use crate::math::{Vec2, Vec3};
use crate::mesh::first;

/// One array for each attribute that the file declares for vertices; the others are empty.
#[derive(Default)]
pub(super) struct Vertices {
    /// The positions, model units; not checked.
    pub positions: Vec<Vec3>,
    /// The normals as in the file, of any length.
    pub normals: Vec<Vec3>,
    /// The uvs; the origin is top left.
    pub uvs: Vec<Vec2>,
    /// The colours, linear RGBA.
    pub colors: Vec<[f32; 4]>,
}

impl Vertices {
    /// Reads all rows.
    pub fn read(element: &Element, attributes: &Attributes) -> Result<Self> {
        if let Some(all) = Self::of_columns(element, attributes) {
            return Ok(all);
        }
        let reserved = |wanted: bool| if wanted { element.count } else { 0 };
        let mut all = Self {
            positions: Vec::with_capacity(element.count),
            normals: Vec::with_capacity(reserved(attributes.normals)),
            uvs: Vec::with_capacity(reserved(attributes.uvs)),
            colors: Vec::with_capacity(reserved(attributes.colors.is_some())),
        };
        let decoder = attributes.colors.map(Decoder::new);
        element.blocks(
            |rows| Self::of_rows(rows, attributes, decoder.as_ref()),
            |mut block| {
                all.positions.append(&mut block.positions);
                all.normals.append(&mut block.normals);
                all.uvs.append(&mut block.uvs);
                all.colors.append(&mut block.colors);
                Ok(())
            },
        )?;
        Ok(all)
    }

    /// Reads rows of the usual layout: `float` and, for colours, `uchar`, with the numbers of each attribute
    /// adjacent.
    fn of_columns(element: &Element, attributes: &Attributes) -> Option<Self> {
        let points = |slot: usize| Some(element.floats(slot)?.into_iter().map(Vec3::from_array).collect());
        let uvs = || Some(element.floats(slot::UV)?.into_iter().map(|[u, v]| upright(u, v)).collect());
        Some(Self {
            positions: points(slot::POSITION)?,
            normals: where_wanted(attributes.normals, || points(slot::NORMAL))?,
            uvs: where_wanted(attributes.uvs, uvs)?,
            colors: attributes.colors.map_or(Some(Vec::new()), |code| byte_colors(element, code))?,
        })
    }

    fn of_rows(mut rows: Rows, attributes: &Attributes, decoder: Option<&Decoder>) -> Self {
        let mut block = Self { positions: Vec::with_capacity(rows.left), ..Self::default() };
        let mut values = [0.0; slot::COUNT];
        values[slot::COLOR + 3] = 1.0;
        while rows.next(|role, field| {
            if let Role::Slot(slot) = role {
                values[slot] = attribute(slot, field);
            }
        }) {
            let [x, y, z, nx, ny, nz, u, v, color @ ..] = values;
            block.positions.push(Vec3::new(x, y, z));
            if attributes.normals {
                block.normals.push(Vec3::new(nx, ny, nz));
            }
            if attributes.uvs {
                block.uvs.push(upright(u, v));
            }
            if let Some(decoder) = decoder {
                block.colors.push(decoder.linear(color));
            }
        }
        block
    }

    /// Returns for each vertex whether it lacks a valid normal; empty if all normals are valid.
    pub fn lack_normals(&self) -> Vec<bool> {
        let is_bad = |n: &Vec3| {
            let length = n.to_f64().length();
            !(length > 1e-18 && length.is_finite())
        };
        if first(&self.normals, is_bad).is_some() {
            self.normals.iter().map(is_bad).collect()
        } else {
            Vec::new()
        }
    }
}

fn where_wanted<T>(wanted: bool, read: impl FnOnce() -> Option<Vec<T>>) -> Option<Vec<T>> {
    if wanted { read() } else { Some(Vec::new()) }
}

/// Returns the colours if stored as red, green and blue bytes, optionally followed by alpha.
fn byte_colors(element: &Element, code: ColorCode) -> Option<Vec<[f32; 4]>> {
    let decoder = Decoder::new(code);
    match element.has_slot(slot::COLOR + 3) {
        true => element.bytes(slot::COLOR, |color| decoder.linear_of_bytes(color)),
        false => element.bytes(slot::COLOR, |[r, g, b]| decoder.linear_of_bytes([r, g, b, u8::MAX])),
    }
}

/// Returns a number of a vertex or face; colours stored as integers are divided by their maximum.
#[inline(always)]
pub(super) fn attribute(slot: usize, field: super::payload::Values) -> f32 {
    let value = field.number();
    (if slot >= slot::COLOR { value / full_intensity(field.scalar) } else { value }) as f32
}

/// Converts a uv of the file, with a bottom-left origin, to a top-left origin; non-finite values become 0.
pub(super) fn upright(u: f32, v: f32) -> Vec2 {
    let usable = |v: f32| if v.is_finite() { v } else { 0.0 };
    Vec2::new(usable(u), 1.0 - usable(v))
}

/// Converts stored colours to linear.
pub(super) struct Decoder {
    code: ColorCode,
    /// The linear-light values of 0/255 to 255/255, since most files store these.
    steps: Vec<f32>,
}

impl Decoder {
    pub fn new(code: ColorCode) -> Self {
        let steps = (0..=255u8).map(|i| linear_from_srgb(f64::from(step(i))) as f32).collect();
        Self { code, steps }
    }

    /// Returns linear RGBA; alpha is clamped to 1.
    pub fn linear(&self, color: [f32; 4]) -> [f32; 4] {
        let usable = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
        let [r, g, b, a] = color.map(usable);
        let decode = |v: f32| match self.code {
            ColorCode::Encoded => self.decoded(v),
            ColorCode::Linear => v,
        };
        [decode(r), decode(g), decode(b), a.min(1.0)]
    }

    /// Returns [`Self::linear`] for colours stored as bytes.
    fn linear_of_bytes(&self, color: [u8; 4]) -> [f32; 4] {
        let [r, g, b, a] = color;
        let [r, g, b] = [r, g, b].map(|v| match self.code {
            ColorCode::Encoded => self.steps[usize::from(v)],
            ColorCode::Linear => step(v),
        });
        [r, g, b, step(a)]
    }

    fn decoded(&self, v: f32) -> f32 {
        let nearest = (v * 255.0 + 0.5) as u8;
        if step(nearest) == v {
            self.steps[usize::from(nearest)]
        } else {
            linear_from_srgb(f64::from(v)) as f32
        }
    }
}

/// Returns the value `i` / 255.
fn step(i: u8) -> f32 {
    (f64::from(i) / 255.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_decoded_as_any_other_colour() {
        for code in [ColorCode::Encoded, ColorCode::Linear] {
            let decoder = Decoder::new(code);
            for i in 0..=255 {
                let bytes = [i, 255 - i, 7, i];
                assert_eq!(decoder.linear_of_bytes(bytes), decoder.linear(bytes.map(step)), "{bytes:?}");
            }
        }
    }
}
