//! Ascii payloads. `ply-rs-bw` reads one row a line by a grammar that refuses `.5`, `1.` and `nan`, which writers
//! do write, so words are taken one by one here, wherever lines end.

use super::super::text::quote;
use crate::error::{Error, Result};
use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyType, ScalarType};
use std::path::Path;

/// The words of a payload, with the line they stand in.
pub(super) struct Tokens<'a> {
    path: &'a Path,
    rest: &'a [u8],
    line: usize,
}

impl<'a> Tokens<'a> {
    /// The words of `payload`, which starts at the given line of the file.
    pub(super) fn new(path: &'a Path, payload: &'a [u8], line: usize) -> Self {
        Self { path, rest: payload, line }
    }

    /// Appends the rows of an element.
    pub(super) fn rows<E: PropertyAccess>(&mut self, element: &ElementDef, rows: &mut Vec<E>) -> Result<()> {
        for i in 0..element.count {
            let mut row = E::new();
            for (name, property) in &element.properties {
                let value = self.property(&property.data_type).map_err(|what| {
                    let what = format!("{what} in {} {i} of {}", element.name, element.count);
                    Error::parse(self.path, format!("line {}", self.line), what)
                })?;
                row.set_property(name, value);
            }
            rows.push(row);
        }
        Ok(())
    }

    fn property(&mut self, data_type: &PropertyType) -> std::result::Result<Property, String> {
        match data_type {
            PropertyType::Scalar(scalar) => Ok(typed(self.number()?, scalar)),
            PropertyType::List(_, scalar) => {
                let count = self.number()?;
                if count < 0.0 || count != count.floor() {
                    return Err(format!("a list of {count} values"));
                }
                let mut values = Vec::new();
                for _ in 0..count as u64 {
                    values.push(self.number()?);
                }
                Ok(typed_list(&values, scalar))
            }
        }
    }

    fn number(&mut self) -> std::result::Result<f64, String> {
        let word = self.word().ok_or("the file ends too early")?;
        let text = String::from_utf8_lossy(word);
        text.parse().map_err(|_| format!("{} is not a number", quote(&text)))
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace());
        let (space, rest) = self.rest.split_at(start.unwrap_or(self.rest.len()));
        self.line += space.iter().filter(|b| **b == b'\n').count();
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// A number as its declared type; out-of-range whole numbers take the nearest.
fn typed(value: f64, scalar: &ScalarType) -> Property {
    match scalar {
        ScalarType::Char => Property::Char(value as i8),
        ScalarType::UChar => Property::UChar(value as u8),
        ScalarType::Short => Property::Short(value as i16),
        ScalarType::UShort => Property::UShort(value as u16),
        ScalarType::Int => Property::Int(value as i32),
        ScalarType::UInt => Property::UInt(value as u32),
        ScalarType::Float => Property::Float(value as f32),
        ScalarType::Double => Property::Double(value),
    }
}

fn typed_list(values: &[f64], scalar: &ScalarType) -> Property {
    match scalar {
        ScalarType::Float | ScalarType::Double => Property::ListDouble(values.to_vec()),
        _ => {
            // What is no index is made one that is out of range.
            let index = |v: &f64| if *v >= 0.0 && *v == v.floor() { *v as u32 } else { u32::MAX };
            Property::ListUInt(values.iter().map(index).collect())
        }
    }
}
