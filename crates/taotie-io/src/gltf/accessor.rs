//! Typed elements from buffers: any component type, normalised or not, interleaved, sparse.

use super::document::Document;
use super::resources::Supplied;
use crate::reading::{Reason, no_such};
use gltf::json::accessor::{Accessor as Json, ComponentType, Type};
use gltf::json::validation::Checked;

/// Maximum number of elements of an accessor without stored data.
const MAX_IMPLICIT: u64 = 1 << 24;

/// Elements of up to 16 components, read one at a time.
pub(super) struct Accessor<'a> {
    /// The number of elements.
    pub count: usize,
    /// The number of components of an element.
    pub width: usize,
    /// The bytes of the dense elements; `None` if all are zero.
    dense: Option<Strided<'a>>,
    /// Index and position in `sparse_values` of replaced elements, by ascending index.
    sparse: Vec<(u32, u32)>,
    sparse_values: &'a [u8],
    component: ComponentType,
    normalized: bool,
}

struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Accessor<'a> {
    /// Opens and checks the accessor `index`: afterwards, every element can be read.
    pub fn open(document: &'a Document, index: usize) -> Reason<Self> {
        let json = document.root.accessors.get(index).ok_or_else(|| no_such("accessor", index))?;
        let accessor = match document.supplied(index) {
            Ok(Some(supplied)) => Ok(Self::of_supplied(supplied, json.normalized)),
            Ok(None) => Self::check(document, json),
            Err(why) => Err(why),
        };
        accessor.map_err(|why| format!("accessor {index}: {why}"))
    }

    /// Returns true if its numbers are integers, not floats or codes of them.
    pub fn holds_integers(&self) -> bool {
        !self.normalized && self.component != ComponentType::F32
    }

    fn of_supplied(supplied: &'a Supplied, normalized: bool) -> Self {
        let &Supplied { component, width, ref bytes } = supplied;
        Self {
            count: supplied.count(),
            width,
            dense: Some(Strided { bytes, stride: width * component.size() }),
            sparse: Vec::new(),
            sparse_values: &[],
            component,
            normalized,
        }
    }

    fn check(document: &'a Document, json: &Json) -> Reason<Self> {
        let Checked::Valid(kind) = json.type_ else { return Err("unknown type".into()) };
        let Checked::Valid(component) = json.component_type else {
            return Err("unknown component type".into());
        };
        if matches!(kind, Type::Mat2 | Type::Mat3) {
            return Err("2×2 and 3×3 matrices are not used here".into());
        }
        let (count, width, component) = (json.count.0, kind.multiplicity(), component.0);
        let size = width * component.size();
        let dense = match json.buffer_view {
            Some(view) => {
                let offset = json.byte_offset.map_or(0, |o| o.0);
                Some(strided(document, view.value(), offset, Elements { count, size })?)
            }
            None if count > MAX_IMPLICIT => {
                return Err(format!("{count} elements without data; the maximum is {MAX_IMPLICIT}"));
            }
            None => None,
        };
        let count = count as usize;
        let mut accessor = Self {
            count,
            width,
            dense,
            sparse: Vec::new(),
            sparse_values: &[],
            component,
            normalized: json.normalized,
        };
        accessor.read_sparse(document, json).map_err(|why| format!("sparse: {why}"))?;
        Ok(accessor)
    }

    fn read_sparse(&mut self, document: &'a Document, json: &Json) -> Reason<()> {
        let Some(sparse) = &json.sparse else { return Ok(()) };
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err("unknown component type of the indices".into());
        };
        let count = sparse.count.0;
        let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
        let indices = strided(document, view, offset, Elements { count, size: kind.0.size() })?;
        let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
        self.sparse_values = strided(document, view, offset, Elements { count, size: self.size() })?.bytes;
        for place in 0..count as usize {
            let index = unsigned(&indices.bytes[place * indices.stride..], kind.0);
            if index as usize >= self.count {
                return Err(format!("replaces element {index} of {}", self.count));
            }
            self.sparse.push((index, place as u32));
        }
        self.sparse.sort_by_key(|(index, _)| *index);
        Ok(())
    }

    /// Returns `true` if neither a buffer view nor sparse values define the elements.
    pub fn is_implicit(&self) -> bool {
        self.dense.is_none() && self.sparse.is_empty()
    }

    /// Returns element `i` as floating-point numbers, integers mapped to [0, 1] or [−1, 1] if normalised. Components
    /// beyond its width are zero. Source: glTF 2.0, 3.11 (Skinned Mesh Attributes uses the same mapping).
    #[inline]
    pub fn floats<const N: usize>(&self, i: usize) -> [f32; N] {
        let mut values = [0.0; N];
        if let Some(bytes) = self.element(i) {
            let step = self.component.size();
            for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(step)) {
                *value = float(bytes, self.component, self.normalized);
            }
        }
        values
    }

    /// Returns element `i` as unsigned integers; signed and float components give zero.
    #[inline]
    pub fn unsigned<const N: usize>(&self, i: usize) -> [u32; N] {
        let mut values = [0; N];
        if let Some(bytes) = self.element(i) {
            let step = self.component.size();
            for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(step)) {
                *value = unsigned(bytes, self.component);
            }
        }
        values
    }

    /// Returns all elements as they are stored, without gaps.
    pub fn stored(&self) -> Supplied {
        let size = self.size();
        let mut bytes = vec![0; self.count * size];
        for (i, element) in bytes.chunks_exact_mut(size).enumerate() {
            if let Some(stored) = self.element(i) {
                element.copy_from_slice(stored);
            }
        }
        Supplied { component: self.component, width: self.width, bytes }
    }

    /// Returns `true` if integers represent numbers in [0, 1] or [−1, 1].
    pub fn is_normalized(&self) -> bool {
        self.normalized
    }

    /// Returns the largest number of its type, which restarts a primitive as an index; `None` unless it is unsigned.
    pub fn restart(&self) -> Option<u32> {
        match self.component {
            ComponentType::U8 => Some(u8::MAX.into()),
            ComponentType::U16 => Some(u16::MAX.into()),
            ComponentType::U32 => Some(u32::MAX),
            _ => None,
        }
    }

    /// Returns `true` if the components are unsigned integers.
    pub fn is_unsigned(&self) -> bool {
        matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    }

    fn size(&self) -> usize {
        self.width * self.component.size()
    }

    /// Returns the bytes of element `i`, or `None` if it is zero.
    #[inline]
    fn element(&self, i: usize) -> Option<&'a [u8]> {
        let size = self.size();
        if !self.sparse.is_empty() {
            // If an element is replaced several times, the last value counts.
            let after = self.sparse.partition_point(|(index, _)| *index as usize <= i);
            if let Some((_, place)) =
                after.checked_sub(1).map(|j| self.sparse[j]).filter(|s| s.0 as usize == i)
            {
                return self.sparse_values.get(place as usize * size..)?.get(..size);
            }
        }
        let dense = self.dense.as_ref()?;
        dense.bytes.get(i * dense.stride..)?.get(..size)
    }
}

/// The number of elements, and the size of each in bytes.
struct Elements {
    count: u64,
    size: usize,
}

/// Returns the part of a buffer view that holds `elements`, starting at `offset`.
fn strided(document: &Document, view: usize, offset: u64, elements: Elements) -> Reason<Strided<'_>> {
    let Elements { count, size } = elements;
    let (bytes, stride) = document.view(view)?;
    let stride = stride.filter(|s| *s != 0).unwrap_or(size);
    if stride < size {
        return Err(format!(
            "the stride of buffer view {view} is {stride}, less than an element's {size} bytes"
        ));
    }
    let last = count.saturating_sub(1).checked_mul(stride as u64);
    let end = last.and_then(|l| l.checked_add(if count == 0 { 0 } else { size as u64 }));
    let end = end.and_then(|e| e.checked_add(offset)).filter(|e| *e <= bytes.len() as u64);
    if end.is_none() {
        let what = format!("{count} elements of {size} bytes, {stride} apart, starting at byte {offset},");
        return Err(format!("{what} do not fit in the {} bytes of buffer view {view}", bytes.len()));
    }
    Ok(Strided { bytes: &bytes[offset as usize..], stride })
}

pub(super) fn float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, one) = match (component, bytes) {
        (ComponentType::I8, [a, ..]) => (f64::from(*a as i8), 127.0),
        (ComponentType::U8, [a, ..]) => (f64::from(*a), 255.0),
        (ComponentType::I16, [a, b, ..]) => (f64::from(i16::from_le_bytes([*a, *b])), 32767.0),
        (ComponentType::U16, [a, b, ..]) => (f64::from(u16::from_le_bytes([*a, *b])), 65535.0),
        (ComponentType::U32, [a, b, c, d, ..]) => {
            (f64::from(u32::from_le_bytes([*a, *b, *c, *d])), 4294967295.0)
        }
        (ComponentType::F32, [a, b, c, d, ..]) => return f32::from_le_bytes([*a, *b, *c, *d]),
        _ => return 0.0,
    };
    if normalized { (value / one).max(-1.0) as f32 } else { value as f32 }
}

fn unsigned(bytes: &[u8], component: ComponentType) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, [a, ..]) => u32::from(*a),
        (ComponentType::U16, [a, b, ..]) => u32::from(u16::from_le_bytes([*a, *b])),
        (ComponentType::U32, [a, b, c, d, ..]) => u32::from_le_bytes([*a, *b, *c, *d]),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normalised_integers_reach_both_ends() {
        let f = |bytes: &[u8], c| float(bytes, c, true);
        assert_eq!(f(&[127], ComponentType::I8), 1.0);
        assert_eq!(f(&[128], ComponentType::I8), -1.0);
        assert_eq!(f(&[129], ComponentType::I8), -1.0);
        assert_eq!(f(&[51], ComponentType::U8), 0.2);
        assert_eq!(f(&[0, 0x80], ComponentType::I16), -1.0);
        assert_eq!(f(&[0xff, 0xff], ComponentType::U16), 1.0);
        assert_eq!(float(&[0xfe, 0xff], ComponentType::I16, false), -2.0);
        assert_eq!(float(&[200], ComponentType::U8, false), 200.0);
    }
}
