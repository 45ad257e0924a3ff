//! Converts the rows of a PLY file's elements: vertices to columns, and faces to triangles, block by block; and
//! splits vertices whose faces differ in uvs or colours.

use super::super::polygon::{Cutter, Outline};
use super::header::{Attributes, ColorCode, Role, full_intensity, slot};
use super::payload::{Element, Rows, Values};
use std::collections::HashMap;
use taotie_engine::error::Result;
use taotie_engine::math::srgb::linear_from_srgb;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::first;

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
fn attribute(slot: usize, field: Values) -> f32 {
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

/// The faces of an element.
pub(super) struct FaceElement<'a> {
    /// Its rows.
    pub rows: Element<'a>,
    /// `true` if a row is a set of triangle strips rather than a polygon.
    pub strips: bool,
}

impl FaceElement<'_> {
    /// Returns all faces as one block if they are triangles with only indices; else `None`.
    pub fn triangles(&self, wanted: &Wanted) -> Option<Block> {
        let plain =
            !self.strips && !wanted.splits() && wanted.textures == 0 && wanted.lack_normals.is_empty();
        let triangles = plain.then(|| self.rows.triangles(wanted.positions.len()))??;
        Some(Block { faces: triangles.len(), triangles, ..Block::default() })
    }
}

/// The data required from faces.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    /// The vertices' positions.
    pub positions: &'a [Vec3],
    /// See [`Vertices::lack_normals`].
    pub lack_normals: &'a [bool],
    /// `true` if corners have their own uvs.
    pub uvs: bool,
    /// `true` if faces have their own colours.
    pub colors: bool,
    /// The number of textures, if faces have the number of theirs; else 0.
    pub textures: usize,
}

impl Wanted<'_> {
    /// Returns `true` if corners with the same vertex may differ.
    pub fn splits(&self) -> bool {
        self.uvs || self.colors
    }
}

/// Some faces, triangulated.
#[derive(Default)]
pub(super) struct Block {
    /// The vertex of each corner, if corners have their own data.
    pub corners: Vec<u32>,
    /// The stored uv of each corner, if wanted.
    pub uvs: Vec<[f32; 2]>,
    /// The stored colour of each corner, if wanted.
    pub colors: Vec<[f32; 4]>,
    /// Triangles as indices of vertices, or of corners if these have their own data.
    pub triangles: Vec<[u32; 3]>,
    /// The number of the texture of each triangle, or [`UNTEXTURED`], if wanted.
    pub textures: Vec<u32>,
    /// The number of faces.
    pub faces: usize,
    /// The number of faces with fewer than three corners.
    pub too_few: usize,
    /// The number of self-intersecting faces.
    pub crossing: usize,
    /// The number of corners with an invalid normal.
    pub without_normal: usize,
    /// The first unusable face, and the reason.
    pub error: Option<(usize, String)>,
}

impl Block {
    /// Reads and triangulates the faces of `rows`.
    pub fn read(mut rows: Rows, strips: bool, wanted: &Wanted) -> Self {
        let mut block = Self::default();
        block.triangles.reserve(rows.left);
        let mut scratch = Scratch::default();
        let mut row = Row::default();
        while row.read(&mut rows, wanted) {
            if strips {
                row.strip_triangles()
                    .for_each(|corners| block.add(&corners, &Row::default(), wanted, &mut scratch));
            } else {
                block.add(&row.corners, &row, wanted, &mut scratch);
            }
            if block.error.is_some() {
                break;
            }
        }
        block
    }

    #[inline(always)]
    fn add(&mut self, corners: &[u32], row: &Row, wanted: &Wanted, scratch: &mut Scratch) {
        self.faces += 1;
        if !wanted.lack_normals.is_empty() {
            let lacks = |c: &&u32| wanted.lack_normals.get(**c as usize) == Some(&true);
            self.without_normal += corners.iter().filter(lacks).count();
        }
        if corners.len() < 3 {
            self.too_few += 1;
            return;
        }
        if corners.len() > Cutter::MAX_CORNERS
            || corners.iter().any(|c| *c as usize >= wanted.positions.len())
        {
            let why = || (self.faces - 1, why_not(corners, wanted.positions.len()));
            self.error.get_or_insert_with(why);
            return;
        }
        let texture = match wanted.textures {
            0 => Ok(UNTEXTURED),
            count => row.texture(count),
        };
        let texture = match texture {
            Ok(texture) => texture,
            Err(why) => {
                self.error.get_or_insert((self.faces - 1, why));
                return;
            }
        };
        if wanted.splits() {
            let first = self.corners.len() as u32;
            self.add_corners(corners, row, wanted);
            self.cut(corners, wanted.positions, |i| first + i, scratch);
        } else {
            self.cut(corners, wanted.positions, |i| corners[i as usize], scratch);
        }
        if wanted.textures > 0 {
            self.textures.resize(self.triangles.len(), texture);
        }
    }

    fn add_corners(&mut self, corners: &[u32], row: &Row, wanted: &Wanted) {
        self.corners.extend_from_slice(corners);
        if wanted.uvs {
            let (uvs, _) = row.uvs.as_chunks::<2>();
            self.uvs.extend((0..corners.len()).map(|i| uvs.get(i).copied().unwrap_or_default()));
        }
        if wanted.colors {
            self.colors.extend(corners.iter().map(|_| row.color));
        }
    }

    /// Adds the triangles of a polygon; `name` maps its corners to indices.
    #[inline(always)]
    fn cut(&mut self, corners: &[u32], positions: &[Vec3], name: impl Fn(u32) -> u32, scratch: &mut Scratch) {
        if corners.len() == 3 {
            self.triangles.push([name(0), name(1), name(2)]);
            return;
        }
        scratch.points.clear();
        scratch.points.extend(corners.iter().map(|c| positions[*c as usize]));
        scratch.triangles.clear();
        let outline = scratch.cutter.cut(&scratch.points, &mut scratch.triangles);
        self.crossing += usize::from(outline == Outline::Crossing);
        self.triangles.extend(scratch.triangles.iter().map(|t| t.map(&name)));
    }
}

fn why_not(corners: &[u32], count: usize) -> String {
    if corners.len() > Cutter::MAX_CORNERS {
        return format!("{} corners; the maximum is {}", corners.len(), Cutter::MAX_CORNERS);
    }
    match corners.iter().find(|c| **c as usize >= count) {
        Some(&u32::MAX) => "negative vertex index; fix the file".to_owned(),
        index => format!(
            "vertex index {} is out of range: the count is {count}; fix the file",
            index.copied().unwrap_or_default()
        ),
    }
}

#[derive(Default)]
struct Scratch {
    cutter: Cutter,
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// The texture number of faces without a texture.
pub(super) const UNTEXTURED: u32 = u32::MAX;

/// The current row.
struct Row {
    /// Vertex indices; a negative one is `u32::MAX`.
    corners: Vec<u32>,
    /// u and v for each corner, or empty.
    uvs: Vec<f32>,
    color: [f32; 4],
    /// The texture's number as stored.
    texture: f64,
}

impl Default for Row {
    fn default() -> Self {
        Self { corners: Vec::new(), uvs: Vec::new(), color: [1.0; 4], texture: 0.0 }
    }
}

impl Row {
    #[inline(always)]
    fn read(&mut self, rows: &mut Rows, wanted: &Wanted) -> bool {
        self.corners.clear();
        self.uvs.clear();
        rows.next(|role, values| match role {
            Role::Corners => {
                self.corners.clear();
                values.push_indices(&mut self.corners);
            }
            Role::Uvs if wanted.uvs => {
                self.uvs.clear();
                self.uvs.extend(values.numbers().map(|v| v as f32));
            }
            Role::Slot(slot) if wanted.colors => self.color[slot - slot::COLOR] = attribute(slot, values),
            Role::Texture => self.texture = values.number(),
            _ => {}
        })
    }

    /// Returns the number of the texture, below `count`; [`UNTEXTURED`] for −1, as MeshLab writes it.
    fn texture(&self, count: usize) -> std::result::Result<u32, String> {
        let number = self.texture;
        if number == -1.0 {
            Ok(UNTEXTURED)
        } else if number >= 0.0 && number < count as f64 && number.fract() == 0.0 {
            Ok(number as u32)
        } else {
            let why = format!("texnumber {number} is out of range: the header names {count} texture files");
            Err(format!("{why}; fix the file"))
        }
    }

    /// Returns the triangles of strips, which are separated by negative indices; every second one of a strip is
    /// flipped.
    fn strip_triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let strips = self.corners.split(|index| *index == u32::MAX);
        strips.flat_map(|strip| {
            strip.windows(3).enumerate().filter_map(|(i, w)| {
                let corners = if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
                let is_joint = w[0] == w[1] || w[1] == w[2] || w[0] == w[2];
                (!is_joint).then_some(corners)
            })
        })
    }
}

/// The vertex of a corner in the file, and the bits of its face's values.
type Corner = [u32; 7];

/// Splits vertices for corners with their own uvs or colours: gives identical corners the same vertex, numbered in
/// order of first appearance.
pub(super) struct Splitter {
    /// `true` if corners have their own uvs.
    pub uvs: bool,
    /// `true` if corners have their own colours.
    pub colors: bool,
    corners: Vec<Corner>,
    /// The first corner of each vertex of the file, which is usually the only one.
    first: Vec<u32>,
    /// All other corners.
    known: HashMap<Corner, u32>,
}

impl Splitter {
    /// Makes a splitter for corners with the wanted values.
    pub fn new(wanted: &Wanted) -> Self {
        let first = vec![u32::MAX; wanted.positions.len()];
        Self { uvs: wanted.uvs, colors: wanted.colors, corners: Vec::new(), first, known: HashMap::new() }
    }

    /// Returns the vertex of corner `i` of `block`.
    pub fn index(&mut self, block: &Block, i: usize) -> u32 {
        let vertex = block.corners[i];
        let [u, v] = block.uvs.get(i).copied().unwrap_or_default();
        let [r, g, b, a] = block.colors.get(i).copied().unwrap_or_default();
        let [u, v, r, g, b, a] = [u, v, r, g, b, a].map(f32::to_bits);
        let corner = [vertex, u, v, r, g, b, a];
        let next = self.corners.len() as u32;
        let first = &mut self.first[vertex as usize];
        let index = match self.corners.get(*first as usize) {
            Some(known) if *known == corner => *first,
            Some(_) => *self.known.entry(corner).or_insert(next),
            None => {
                *first = next;
                next
            }
        };
        if index == next {
            self.corners.push(corner);
        }
        index
    }

    /// Returns the source vertex in the file for each vertex.
    pub fn vertices(&self) -> impl Iterator<Item = usize> {
        self.corners.iter().map(|corner| corner[0] as usize)
    }

    /// Returns the uvs of the vertices as stored.
    pub fn own_uvs(&self) -> impl Iterator<Item = [f32; 2]> {
        self.corners.iter().map(|[_, u, v, ..]| [*u, *v].map(f32::from_bits))
    }

    /// Returns the colours of the vertices as stored.
    pub fn own_colors(&self) -> impl Iterator<Item = [f32; 4]> {
        self.corners.iter().map(|[_, _, _, color @ ..]| color.map(f32::from_bits))
    }
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

    #[test]
    fn strips_alternate_and_restart() {
        let strips = Row { corners: vec![0, 1, 2, 3, 3, u32::MAX, 4, 5, 6], ..Row::default() };
        let triangles: Vec<[u32; 3]> = strips.strip_triangles().collect();
        assert_eq!(triangles, [[0, 1, 2], [2, 1, 3], [4, 5, 6]]);
    }
}
