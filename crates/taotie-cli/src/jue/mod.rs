//! The demonstration's object: a Shang bronze *jue* (爵), a tripod for warm wine, made by code alone.

mod atlas;
mod builder;
mod limbs;
mod vessel;

use taotie::mesh::Mesh;

/// The low mesh: 251 vertices, metres, standing on y = 0 with its spout along +x and its handle towards −z.
///
/// Every part is closed and turned outward; the one uv set has no mirrored and no overlapping charts. Tangents are
/// left to the renderer.
pub fn low_mesh() -> Mesh {
    let mut builder = builder::Builder::default();
    vessel::add(&mut builder);
    limbs::add(&mut builder);
    builder.finish()
}

#[cfg(test)]
mod tests;
