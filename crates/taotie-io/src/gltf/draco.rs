//! KHR_draco_mesh_compression: primitives compressed by Draco.
//!
//! Every compressed primitive is unpacked when the file is opened. Its accessors get the unpacked elements instead of
//! those in their buffer views, so that no other code has to know about it.

use super::super::reading::caught;
use super::super::reading::{Reading, Reason, no_such};
use super::raw::{DRACO, extension};
use super::resources::{Buffers, Supplied, Supply};
use draco_core::draco_types::DataType;
use draco_core::geometry_indices::PointIndex;
use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute};
use gltf::json::accessor::ComponentType;
use gltf::json::mesh::{Mode, Primitive};
use gltf::json::validation::Checked;
use gltf::json::{Root, Value};
use std::collections::BTreeMap;
use taotie_engine::error::Warnings;

/// Maximum number of bytes that all packed primitives unpack to, per byte of the buffers, plus a constant for small
/// files.
const MAX_UNPACKED_PER_BYTE: u64 = 64;
const MAX_UNPACKED_OF_SMALL: u64 = 1 << 28;

const TOO_MANY: &str = "the file unpacks to too many bytes";

/// Unpacks every packed primitive of the file.
pub(super) fn supply(root: &Root, buffers: &Buffers, reading: &Reading, warnings: &mut Warnings) -> Supply {
    let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if primitives.all(|primitive| extension(primitive, DRACO).is_none()) {
        return Supply::new();
    }
    let usual = MAX_UNPACKED_OF_SMALL + MAX_UNPACKED_PER_BYTE * buffers.total_bytes() as u64;
    let mut unpacker = Unpacker {
        root,
        buffers,
        budget: usual.min(reading.left()),
        meshes: BTreeMap::new(),
        supply: Supply::new(),
    };
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let Some(json) = extension(primitive, DRACO) else { continue };
            if let Err(why) = unpacker.primitive(primitive, json) {
                let why = format!("Draco compression: {why}");
                if unpacker.refuse(primitive, &why) {
                    let what = format!("mesh {m}, primitive {p}: {why}; using its uncompressed data");
                    warnings.note(what, 1);
                }
            }
        }
    }
    let unpacked: usize = unpacker.supply.values().flatten().map(|supplied| supplied.bytes.len()).sum();
    reading.take(unpacked as u64);
    unpacker.supply
}

struct Unpacker<'a> {
    root: &'a Root,
    buffers: &'a Buffers,
    /// The number of bytes that may still be unpacked.
    budget: u64,
    /// The meshes unpacked from buffer views that primitives refer to.
    meshes: BTreeMap<usize, Reason<Mesh>>,
    supply: Supply,
}

impl Unpacker<'_> {
    fn primitive(&mut self, primitive: &Primitive, json: &Value) -> Reason<()> {
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            return Err("only triangle lists are supported; export the model without strips".into());
        }
        let indices = primitive.indices.ok_or("indices are missing")?.value();
        let view = json.get("bufferView").and_then(Value::as_u64).ok_or("bufferView is missing")?;
        let attributes = json.get("attributes").and_then(Value::as_object).ok_or("attributes are missing")?;
        let view = usize::try_from(view).map_err(|e| e.to_string())?;
        if !self.meshes.contains_key(&view) {
            let mesh = self.unpack(view);
            self.meshes.insert(view, mesh);
        }
        let mesh = self.meshes[&view].as_ref().map_err(Clone::clone)?;
        let mut take = |size: usize| {
            self.budget = self.budget.checked_sub(size as u64).ok_or(TOO_MANY)?;
            Ok::<(), String>(())
        };
        take(12 * mesh.num_faces())?;
        let mut supplied = vec![(indices, faces(mesh))];
        for (semantic, accessor) in &primitive.attributes {
            let Checked::Valid(semantic) = semantic else { continue };
            let Some(id) = attributes.get(&semantic.to_string()) else { continue };
            let id = id.as_u64().and_then(|id| u32::try_from(id).ok());
            let attribute = id.and_then(|id| mesh.attribute_by_unique_id(id));
            let attribute =
                attribute.ok_or_else(|| format!("attribute {} is missing", semantic.to_string()))?;
            take(mesh.num_points().saturating_mul(value_size(attribute)?))?;
            supplied.push((accessor.value(), values(mesh, attribute)?));
        }
        for (accessor, elements) in supplied {
            self.supply.entry(accessor).or_insert(Ok(elements));
        }
        Ok(())
    }

    /// Notes `why` for the accessors without other data. Returns `true` if all of them do have other data.
    fn refuse(&mut self, primitive: &Primitive, why: &str) -> bool {
        let mut all = true;
        let accessors = primitive.attributes.values().chain(&primitive.indices).map(|index| index.value());
        for accessor in accessors {
            let json = self.root.accessors.get(accessor);
            if json.is_some_and(|json| json.buffer_view.is_none()) {
                self.supply.entry(accessor).or_insert_with(|| Err(why.to_owned()));
                all = false;
            }
        }
        all
    }

    fn unpack(&mut self, view: usize) -> Reason<Mesh> {
        let json = self.root.buffer_views.get(view).ok_or_else(|| no_such("buffer view", view))?;
        let mesh = decode(self.buffers.view(view, json)?, self.budget)?;
        let sizes = (0..mesh.num_attributes()).map(|i| mesh.attribute(i).buffer().data_size() as u64);
        let size = sizes.sum::<u64>().saturating_add(12 * mesh.num_faces() as u64);
        self.budget = self.budget.checked_sub(size).ok_or(TOO_MANY)?;
        Ok(mesh)
    }
}

/// Unpacks a mesh that needs at most `budget` bytes. The decoder (`draco-core` 2.3) is safe code, but a port of many
/// thousand lines of array indexing; if damage makes it panic, the panic is caught here and becomes an error.
fn decode(bytes: &[u8], budget: u64) -> Reason<Mesh> {
    let limits = DecodeLimits::default();
    let limits =
        limits.with_max_points(budget / 4).with_max_faces(budget / 12).with_max_decoded_bytes(budget);
    let attempt = caught(|| {
        let mut mesh = Mesh::new();
        MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut mesh)?;
        Ok::<Mesh, draco_core::DracoError>(mesh)
    });
    match attempt {
        Some(Ok(mesh)) => Ok(mesh),
        Some(Err(error)) => {
            let what = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
            Err(format!("cannot read the stream ({what}); re-export the model"))
        }
        None => Err("the stream is inconsistent; re-export the model".into()),
    }
}

fn faces(mesh: &Mesh) -> Supplied {
    let corners = mesh.faces().iter().flatten();
    let bytes = corners.flat_map(|point| point.0.to_le_bytes()).collect();
    Supplied { component: ComponentType::U32, width: 1, bytes }
}

/// Returns the size in bytes of a value of an attribute, at least 1.
fn value_size(attribute: &PointAttribute) -> Reason<usize> {
    match usize::from(attribute.num_components()) {
        0 => Err("an attribute has no components".into()),
        width => Ok(width * component(attribute.data_type())?.size()),
    }
}

/// Returns the values of an attribute, one per point.
fn values(mesh: &Mesh, attribute: &PointAttribute) -> Reason<Supplied> {
    let component = component(attribute.data_type())?;
    let width = usize::from(attribute.num_components());
    let (size, stride) = (value_size(attribute)?, usize::try_from(attribute.byte_stride()).unwrap_or(0));
    let stored = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(size * mesh.num_points());
    for point in 0..mesh.num_points() {
        let value = attribute.mapped_index(PointIndex(point as u32)).0 as usize;
        let value = value.checked_mul(stride).and_then(|start| stored.get(start..)?.get(..size));
        bytes.extend_from_slice(value.ok_or("a point has no value")?);
    }
    Ok(Supplied { component, width, bytes })
}

fn component(data_type: DataType) -> Reason<ComponentType> {
    match data_type {
        DataType::Int8 => Ok(ComponentType::I8),
        DataType::Uint8 => Ok(ComponentType::U8),
        DataType::Int16 => Ok(ComponentType::I16),
        DataType::Uint16 => Ok(ComponentType::U16),
        DataType::Uint32 => Ok(ComponentType::U32),
        DataType::Float32 => Ok(ComponentType::F32),
        other => Err(format!("component type {other:?} does not exist in glTF")),
    }
}
