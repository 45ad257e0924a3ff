//! Models to be written: a sphere with every vertex attribute, and bitmaps for every slot.

use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns a sphere with normals, UVs, tangents along rising u, and colours.
pub fn sphere(columns: usize, rows: usize) -> Mesh {
    let mut data = without_ends(Mesh::sphere(1.5, columns, rows).into_data());
    data.tangents = data
        .normals
        .iter()
        .map(|n| {
            let length = (n.x * n.x + n.z * n.z).sqrt();
            if length < 1e-6 { [1.0, 0.0, 0.0, -1.0] } else { [n.z / length, 0.0, -n.x / length, -1.0] }
        })
        .collect();
    data.colors = data.uvs[0].iter().map(|uv| [uv.x, uv.y, 0.5, 1.0]).collect();
    Mesh::new(data).expect("a sphere with attributes is a mesh")
}

/// Returns a sphere's data without its first and last vertex, which no triangle uses and readers drop.
fn without_ends(mut data: MeshData) -> MeshData {
    fn inner<T>(values: &mut Vec<T>) {
        values.pop();
        values.remove(0);
    }
    inner(&mut data.positions);
    inner(&mut data.normals);
    inner(&mut data.uvs[0]);
    data.triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| v - 1));
    data
}

/// Returns a wavy sheet of `columns` × `rows` vertices, each in a triangle, with one UV set.
pub fn sheet(columns: u32, rows: u32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        data.positions.push(Vec3::new(x as f32 * 0.1, y as f32 * 0.1, ((x + 2 * y) % 7) as f32 * 0.01));
        data.normals.push(Vec3::new(0.0, 0.0, 1.0));
        data.uvs[0].push(Vec2::new(x as f32 / (columns - 1) as f32, y as f32 / (rows - 1) as f32));
    }
    for (x, y) in (0..rows - 1).flat_map(|y| (0..columns - 1).map(move |x| (x, y))) {
        let corner = y * columns + x;
        data.triangles.push([corner, corner + 1, corner + columns]);
        data.triangles.push([corner + 1, corner + columns + 1, corner + columns]);
    }
    Mesh::new(data).expect("a sheet is a mesh")
}

/// Returns a bitmap of RGB texels, 8 bits.
pub fn bitmap(side: u32, texel: impl Fn(u32, u32) -> [u8; 3]) -> Bitmap {
    let texels = (0..side * side).map(|i| {
        let [r, g, b] = texel(i % side, i / side);
        [r, g, b, 255]
    });
    Bitmap::new(side, side, 3, Texels::U8(texels.collect())).expect("the size fits")
}

/// Returns a bitmap of RGB texels, 16 bits.
pub fn deep_bitmap(side: u32, texel: impl Fn(u32, u32) -> [u16; 3]) -> Bitmap {
    let texels = (0..side * side).map(|i| {
        let [r, g, b] = texel(i % side, i / side);
        [r, g, b, 65535]
    });
    Bitmap::new(side, side, 3, Texels::U16(texels.collect())).expect("the size fits")
}

/// Returns a tangent-space normal of round bumps, `across` of them along each side; z is at least 0.6.
pub fn bump(x: u32, y: u32, (side, across): (u32, u32)) -> [f64; 3] {
    let period = f64::from(side / across);
    let place = |i: u32| (f64::from(i) + 0.5).rem_euclid(period) / period * 2.0 - 1.0;
    let (u, v) = (place(x), place(y));
    let inside = (1.0 - u * u - v * v).max(0.0);
    let (nx, ny) = (0.8 * u * inside, -0.8 * v * inside);
    [nx, ny, (1.0 - nx * nx - ny * ny).sqrt()]
}

/// Returns normals of bumps, 8 bits.
pub fn normals(side: u32, across: u32) -> Bitmap {
    bitmap(side, |x, y| bump(x, y, (side, across)).map(|v| ((v * 0.5 + 0.5) * 255.0).round() as u8))
}

/// Returns normals of bumps, 16 bits.
pub fn deep_normals(side: u32, across: u32) -> Bitmap {
    deep_bitmap(side, |x, y| bump(x, y, (side, across)).map(|v| ((v * 0.5 + 0.5) * 65535.0).round() as u16))
}

/// Returns colours that encode their position: red along u, green along v.
pub fn colors(side: u32) -> Bitmap {
    let step = |i: u32| (i * 255 / (side - 1)) as u8;
    bitmap(side, |x, y| [step(x), step(y), 90])
}

/// Returns occlusion, roughness and metallic.
pub fn orm(side: u32) -> Bitmap {
    let step = |i: u32| (i * 255 / (side - 1)) as u8;
    bitmap(side, |x, y| [255 - step(y) / 2, 100 + step(x) / 4, 30])
}
