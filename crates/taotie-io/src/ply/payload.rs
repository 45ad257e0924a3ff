//! Rows of binary elements: their positions, and the uses of their properties.
//!
//! A scan is one long table of vertices and one of faces, so rows are never separate objects: one pass over the file
//! records where each block of them starts, and the blocks are decoded in parallel.

use super::ascii::Tokens;
use super::header::{Role, role};
use ply_rs_bw::ply::{ElementDef, PropertyType, ScalarType};
use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use taotie_engine::error::{Error, Result};
use taotie_engine::parallel;

/// The number of rows decoded at a time.
const BLOCK: usize = 1 << 15;

/// One property of an element.
pub(super) struct Property {
    role: Role,
    /// The type of a list's length; `None` for a scalar.
    length: Option<ScalarType>,
    scalar: ScalarType,
}

impl Property {
    /// Returns its bytes per row if lists have three values.
    fn length_of_three(&self) -> usize {
        self.length.as_ref().map_or(size(&self.scalar), |length| size(length) + 3 * size(&self.scalar))
    }
}

/// All rows of an element.
pub(super) struct Element<'a> {
    /// The number of rows.
    pub count: usize,
    /// The number of corners of all rows together.
    pub corners: usize,
    /// The number of rows with a uv for each corner.
    pub with_uvs: usize,
    bytes: Cow<'a, [u8]>,
    big_endian: bool,
    properties: Vec<Property>,
    /// The start of each block in `bytes`.
    starts: Vec<usize>,
    /// Bytes per row, if all rows have equal length: there is no list, or one with three values in each row.
    row: Option<usize>,
}

/// Some consecutive rows.
pub(super) struct Rows<'a> {
    properties: &'a [Property],
    big_endian: bool,
    rest: &'a [u8],
    /// The number of rows left.
    pub left: usize,
}

/// The numbers of one property in one row.
#[derive(Clone, Copy)]
pub(super) struct Values<'a> {
    /// The number of values.
    pub count: usize,
    /// Their type in the file.
    pub scalar: &'a ScalarType,
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Element<'a> {
    /// Locates the rows of the element at the start of `bytes`, and returns their total length in bytes.
    pub fn binary(
        path: &Path,
        definition: &ElementDef,
        bytes: &'a [u8],
        big_endian: bool,
    ) -> Result<(Self, usize)> {
        check_length(path, definition, bytes.len())?;
        let mut element = Self::new(path, definition, Cow::Borrowed(bytes), big_endian)?;
        let length = element.walk().map_err(|what| error(path, definition, what))?;
        Ok((element, length))
    }

    /// Reads the rows of an element from text.
    pub fn ascii(path: &Path, definition: &ElementDef, tokens: &mut Tokens) -> Result<Self> {
        let (bytes, widened) = tokens.rows(definition)?;
        let mut element = Self::new(path, &widened, Cow::Owned(bytes), false)?;
        element.walk().map_err(|what| error(path, definition, what))?;
        Ok(element)
    }

    fn new(path: &Path, definition: &ElementDef, bytes: Cow<'a, [u8]>, big_endian: bool) -> Result<Self> {
        let properties = definition.properties.iter().map(|(name, property)| {
            let role = role(&definition.name, name, &property.data_type)
                .map_err(|what| error(path, definition, what))?;
            let (length, scalar) = match &property.data_type {
                PropertyType::Scalar(scalar) => (None, scalar),
                PropertyType::List(length, scalar) => (Some(length.clone()), scalar),
            };
            Ok(Property { role, length, scalar: scalar.clone() })
        });
        let properties = properties.collect::<Result<Vec<Property>>>()?;
        let (count, starts) = (definition.count, Vec::new());
        Ok(Self { count, corners: 0, with_uvs: 0, bytes, big_endian, properties, starts, row: None })
    }

    /// Finds where blocks start and where the last one ends.
    fn walk(&mut self) -> std::result::Result<usize, String> {
        self.row = self.length_of_all_rows();
        if let Some(row) = self.row {
            self.starts = (0..self.count).step_by(BLOCK).map(|i| i * row).collect();
            let is_face = self.properties.iter().any(|p| p.role == Role::Corners && p.length.is_some());
            self.corners = if is_face { 3 * self.count } else { 0 };
            return Ok(self.count * row);
        }
        let mut rows = Rows {
            properties: &self.properties,
            big_endian: self.big_endian,
            rest: &self.bytes,
            left: self.count,
        };
        while rows.left > 0 {
            let i = self.count - rows.left;
            if i.is_multiple_of(BLOCK) {
                self.starts.push(self.bytes.len() - rows.rest.len());
            }
            let (mut corners, mut uvs) = (0, 0);
            let count = |role, values: Values| match role {
                Role::Corners => corners = values.count,
                Role::Uvs => uvs = values.count,
                _ => {}
            };
            rows.try_next(count).map_err(|what| format!("row {i} of {}: {what}", self.count))?;
            self.corners += corners;
            self.with_uvs += usize::from(corners > 0 && uvs == 2 * corners);
        }
        Ok(self.bytes.len() - rows.rest.len())
    }

    /// Returns the bytes per row if all rows have equal length, see [`Element::row`].
    fn length_of_all_rows(&self) -> Option<usize> {
        let mut lists = self.properties.iter().enumerate().filter(|(_, p)| p.length.is_some());
        let list = lists.next();
        let row: usize = self.properties.iter().map(Property::length_of_three).sum();
        if lists.next().is_some() || self.bytes.len() < self.count.checked_mul(row)? {
            return None;
        }
        let Some((place, Property { length: Some(length), .. })) = list else { return Some(row) };
        let start: usize = self.properties[..place].iter().map(Property::length_of_three).sum();
        let has_more = |i: usize| number(length, self.big_endian, &self.bytes[i * row + start..]) != 3.0;
        parallel::first(self.count, has_more).is_none().then_some(row)
    }

    /// Returns the corners of all rows, if each has three plain indices below `vertices`; else `None`.
    pub fn triangles(&self, vertices: usize) -> Option<Vec<[u32; 3]>> {
        let place = self.properties.iter().position(|p| p.role == Role::Corners)?;
        let Property { length: Some(length), scalar, .. } = &self.properties[place] else { return None };
        // A negative index is neither plain nor below these.
        let below = match scalar {
            ScalarType::Int => vertices.min(1 << 31),
            ScalarType::UInt => vertices,
            _ => return None,
        };
        let row = self.row.filter(|_| !self.big_endian)?;
        let start =
            self.properties[..place].iter().map(Property::length_of_three).sum::<usize>() + size(length);
        let mut triangles = vec![[0; 3]; self.count];
        let wrong = AtomicBool::new(false);
        parallel::pieces(&mut triangles, BLOCK, &|block, part| {
            let mut highest = 0;
            for (triangle, row) in part.iter_mut().zip(self.bytes[block * BLOCK * row..].chunks_exact(row)) {
                *triangle = words(&row[start..]).map(u32::from_le_bytes);
                highest = triangle.iter().fold(highest, |highest: u32, index| highest.max(*index));
            }
            wrong.fetch_or(highest as usize >= below, Ordering::Relaxed);
        });
        (!wrong.into_inner()).then_some(triangles)
    }

    /// Returns the numbers of consecutive slots in all rows, if they are `float`, adjacent, in this order, and all
    /// rows have equal length; else `None`.
    pub fn floats<const N: usize>(&self, slot: usize) -> Option<Vec<[f32; N]>> {
        let start = self.start_of_slots(slot..slot + N, &ScalarType::Float)?;
        Some(self.columns(|row| words(&row[start..]).map(f32::from_le_bytes)))
    }

    /// Applies `of` to the numbers of consecutive slots as in [`Self::floats`], if they are `uchar`.
    pub fn bytes<const N: usize>(
        &self,
        slot: usize,
        of: impl Fn([u8; N]) -> [f32; 4] + Sync,
    ) -> Option<Vec<[f32; 4]>> {
        let start = self.start_of_slots(slot..slot + N, &ScalarType::UChar)?;
        Some(self.columns(|row| of(std::array::from_fn(|i| row[start + i]))))
    }

    /// Returns `true` if rows have a number for this slot.
    pub fn has_slot(&self, slot: usize) -> bool {
        self.properties.iter().any(|p| p.role == Role::Slot(slot))
    }

    /// Applies `of` to each row; all rows have equal length.
    fn columns<const N: usize>(&self, of: impl Fn(&[u8]) -> [f32; N] + Sync) -> Vec<[f32; N]> {
        let row = self.row.unwrap_or(1).max(1);
        let mut columns = vec![[0.0; N]; self.count];
        parallel::pieces(&mut columns, BLOCK, &|block, part| {
            for (column, row) in part.iter_mut().zip(self.bytes[block * BLOCK * row..].chunks_exact(row)) {
                *column = of(row);
            }
        });
        columns
    }

    /// Returns the offset of the slots in each row, if they have this type, are little-endian and adjacent, and each
    /// occurs once.
    fn start_of_slots(&self, slots: std::ops::Range<usize>, scalar: &ScalarType) -> Option<usize> {
        let of = |p: &Property| matches!(p.role, Role::Slot(slot) if slots.contains(&slot));
        self.row.filter(|_| !self.big_endian)?;
        let first = self.properties.iter().position(of)?;
        let fields = self.properties[first..].get(..slots.len())?;
        let fits =
            |(field, slot): (&Property, usize)| field.role == Role::Slot(slot) && field.scalar == *scalar;
        let fit = fields.iter().zip(slots.clone()).all(fits);
        let once = self.properties.iter().filter(|p| of(p)).count() == slots.len();
        let start = self.properties[..first].iter().map(Property::length_of_three).sum();
        (fit && once).then_some(start)
    }

    /// Reads the blocks in parallel, a few at a time, and passes on the results in file order.
    pub fn blocks<T: Send>(
        &self,
        read: impl Fn(Rows) -> T + Sync,
        mut take: impl FnMut(T) -> Result<()>,
    ) -> Result<()> {
        let rows = |block: usize| Rows {
            properties: &self.properties,
            big_endian: self.big_endian,
            rest: &self.bytes[self.starts[block]..],
            left: BLOCK.min(self.count - block * BLOCK),
        };
        let blocks: Vec<usize> = (0..self.starts.len()).collect();
        for group in blocks.chunks(4 * rayon::current_num_threads()) {
            let done = parallel::tasks(group.len(), &|i| read(rows(group[i])));
            done.into_iter().try_for_each(&mut take)?;
        }
        Ok(())
    }
}

impl<'a> Rows<'a> {
    /// Passes the properties of the next row to `see`; returns `false` if there is none.
    #[inline(always)]
    pub fn next(&mut self, see: impl FnMut(Role, Values<'a>)) -> bool {
        self.left > 0 && self.try_next(see).is_ok()
    }

    #[inline(always)]
    fn try_next(&mut self, mut see: impl FnMut(Role, Values<'a>)) -> std::result::Result<(), &'static str> {
        for property in self.properties {
            let count = match &property.length {
                None => 1,
                Some(scalar) => length(self.take(1, scalar)?)?,
            };
            see(property.role, self.take(count, &property.scalar)?);
        }
        self.left -= 1;
        Ok(())
    }

    #[inline(always)]
    fn take(
        &mut self,
        count: usize,
        scalar: &'a ScalarType,
    ) -> std::result::Result<Values<'a>, &'static str> {
        let length = count.checked_mul(size(scalar));
        let (bytes, rest) = length
            .and_then(|length| self.rest.split_at_checked(length))
            .ok_or("the file ends within it; it is truncated or damaged")?;
        self.rest = rest;
        Ok(Values { count, scalar, bytes, big_endian: self.big_endian })
    }
}

impl<'a> Values<'a> {
    /// Returns the number of a scalar property; the first of a list, or 0.
    #[inline(always)]
    pub fn number(self) -> f64 {
        if self.count > 0 { number(self.scalar, self.big_endian, self.bytes) } else { 0.0 }
    }

    /// Returns all numbers.
    pub fn numbers(self) -> impl Iterator<Item = f64> + 'a {
        let words = self.bytes.chunks_exact(size(self.scalar));
        words.map(move |word| number(self.scalar, self.big_endian, word))
    }

    /// Appends all numbers as indices; invalid ones become `u32::MAX`.
    #[inline(always)]
    pub fn push_indices(self, to: &mut Vec<u32>) {
        let words = self.bytes.as_chunks::<4>().0.iter();
        match self.scalar {
            ScalarType::Int if !self.big_endian => {
                to.extend(words.map(|w| u32::try_from(i32::from_le_bytes(*w)).unwrap_or(u32::MAX)));
            }
            ScalarType::UInt if !self.big_endian => to.extend(words.map(|w| u32::from_le_bytes(*w))),
            _ => to
                .extend(self.numbers().map(|v| if v >= 0.0 && v == v.floor() { v as u32 } else { u32::MAX })),
        }
    }
}

/// Returns the length of a list.
#[inline(always)]
fn length(values: Values) -> std::result::Result<usize, &'static str> {
    if *values.scalar == ScalarType::UChar {
        return Ok(usize::from(values.bytes[0]));
    }
    let length = values.number();
    let is_whole = length >= 0.0 && length == length.floor();
    is_whole.then_some(length as usize).ok_or("the list length is not an integer of at least 0; fix the file")
}

/// Returns the size of a number in bytes.
#[inline(always)]
pub(super) fn size(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Returns the number at the start of `bytes`; exact, since no type has more bits than the result holds.
#[inline(always)]
fn number(scalar: &ScalarType, big_endian: bool, bytes: &[u8]) -> f64 {
    match scalar {
        ScalarType::Char => f64::from(bytes[0] as i8),
        ScalarType::UChar => f64::from(bytes[0]),
        ScalarType::Short => f64::from(i16::from_le_bytes(word(bytes, big_endian))),
        ScalarType::UShort => f64::from(u16::from_le_bytes(word(bytes, big_endian))),
        ScalarType::Int => f64::from(i32::from_le_bytes(word(bytes, big_endian))),
        ScalarType::UInt => f64::from(u32::from_le_bytes(word(bytes, big_endian))),
        ScalarType::Float => f64::from(f32::from_le_bytes(word(bytes, big_endian))),
        ScalarType::Double => f64::from_le_bytes(word(bytes, big_endian)),
    }
}

/// Returns the first `N` four-byte words.
#[inline(always)]
fn words<const N: usize>(bytes: &[u8]) -> [[u8; 4]; N] {
    let (words, _) = bytes.as_chunks::<4>();
    let mut first = [[0; 4]; N];
    first.copy_from_slice(&words[..N]);
    first
}

/// Returns the first `N` of `bytes`, least significant first.
#[inline(always)]
fn word<const N: usize>(bytes: &[u8], big_endian: bool) -> [u8; N] {
    let mut word = [0; N];
    word.copy_from_slice(&bytes[..N]);
    if big_endian {
        word.reverse();
    }
    word
}

/// Rejects a count that the rest of the file is too short for, before anything is allocated.
fn check_length(path: &Path, element: &ElementDef, left: usize) -> Result<()> {
    let least = |property: &PropertyType| match property {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
    };
    let row: usize = element.properties.iter().map(|(_, p)| least(&p.data_type)).sum();
    if element.count.saturating_mul(row) <= left {
        return Ok(());
    }
    let what = format!(
        "{} of at least {row} bytes each, but only {left} bytes follow; the file is truncated or damaged",
        element.count
    );
    Err(error(path, element, what))
}

fn error(path: &Path, element: &ElementDef, what: impl Into<String>) -> Error {
    Error::parse(path, format!("element {}", element.name), what)
}
