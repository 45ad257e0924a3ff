//! Scans built by code: OBJ with its MTL, PLY and STL, each as text and in binary.

use super::seed::{File, Seed};
use std::fmt::Write;
use taotie_engine::mesh::Mesh;

/// Every MTL statement that the reader supports.
const MTL: &str = "newmtl m\nKa .1 .1 .1\nKd .5 .5 .5\nKs 1\nNs 20\nKe 0 0 0\nd .9\nTr .1\nPr .3\nPm .4\n\
    map_Kd -s 1 2 3 -o .1 -mm 0 1 a.png\nmap_Bump -bm 2 -imfchan g a.png\nnorm a.png\nmap_Pr a.png\n\
    map_Pm -clamp on a.png\nmap_d a.png\nmap_Ke a.png\nnewmtl n\nKd 1 0 0\n";

/// An OBJ with every feature of the format in addition to triangles.
const MIXED: &str = "mtllib a.mtl\no x\nv 0 0 0 .1 .2 .3\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nv .5 .5 1\nvt 0 0\nvt 1 0\nvt 1 1\n\
    vn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf -5//1 -4//-1 -3//1 -2//1\nf 1 2 3 \\\n 4 5\ns 1\np 1\nl 1 2\n\
    g y\nusemtl n\nf 5/1/1 4/2/1 3/3/1\n";

/// The facets of a text STL.
const FACETS: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
    endfacet\nfacet normal 0 1 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 1 0 0\nendloop\nendfacet\nendsolid a\n";

/// A PLY with colours, UVs at corners, polygons and strips.
const PLY: &str = "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
    property list uchar int vertex_indices\nproperty list uchar float texcoord\nelement tristrips 1\n\
    property list int int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n\
    4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n5 0 1 2 -1 3\n";

/// Returns all scans.
pub fn seeds() -> Vec<Seed> {
    let ball = Mesh::sphere(1.0, 10, 6);
    let utf16: Vec<u8> = MIXED.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let picture = File { name: "a.png".into(), bytes: super::pictures::WAVES.to_vec() };
    let materials = File { name: "a.mtl".into(), bytes: MTL.into() };
    vec![
        Seed { companions: vec![materials, picture.clone()], ..Seed::single("mixed.obj", MIXED) },
        Seed::single("ball.obj", obj(&ball)),
        Seed::single("utf16.obj", utf16),
        Seed { companions: vec![picture.clone()], ..Seed::single("all.mtl", MTL) },
        Seed { companions: vec![picture], ..Seed::single("text.ply", PLY) },
        Seed::single("little.ply", ply(&ball, false)),
        Seed::single("big.ply", ply(&ball, true)),
        Seed::single("text.stl", FACETS),
        Seed::single("binary.stl", stl(&ball)),
    ]
}

/// Writes a mesh with its UVs and normals as OBJ.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::from("mtllib none.mtl\n");
    for p in mesh.positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &mesh.uvs()[0] {
        let _ = writeln!(text, "vt {} {}", uv.x, uv.y);
    }
    for n in mesh.normals() {
        let _ = writeln!(text, "vn {} {} {}", n.x, n.y, n.z);
    }
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| corner + 1);
        let _ = writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}");
    }
    text
}

/// Writes a mesh with colours as binary PLY.
fn ply(mesh: &Mesh, big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let (vertices, faces) = (mesh.positions().len(), mesh.triangles().len());
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face {faces}\n\
         property list uchar uint vertex_indices\nend_header\n"
    )
    .into_bytes();
    let ordered = |mut digits: [u8; 4]| {
        if big {
            digits.reverse();
        }
        digits
    };
    for p in mesh.positions() {
        bytes.extend(p.to_array().iter().flat_map(|v| ordered(v.to_le_bytes())));
        bytes.extend([200, 100, 50]);
    }
    for triangle in mesh.triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| ordered(v.to_le_bytes())));
    }
    bytes
}

/// Writes a mesh as binary STL.
fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in 0..mesh.triangles().len() {
        bytes.extend([0; 12]);
        bytes.extend(mesh.corners(triangle).iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}
