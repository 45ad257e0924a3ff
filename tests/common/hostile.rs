//! Surfaces that break code written for tidy ones.
use crate::random::Random;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};

/// Returns a mesh of only positions and triangles.
pub fn bare(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    Mesh::new(MeshData { positions, triangles, ..MeshData::default() }).expect("a sound mesh")
}

/// Returns the mesh with three separate vertices for every triangle.
pub fn unwelded(mesh: &Mesh) -> Mesh {
    let positions: Vec<Vec3> = (0..mesh.triangles().len()).flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    bare(positions, triangles)
}

/// Returns a grid of `columns` by `rows` squares whose corners `place` puts at (0 to 1, 0 to 1).
pub fn sheet(columns: u32, rows: u32, place: impl Fn(f64, f64) -> Vec3<f64>) -> Mesh {
    let part = |i: u32, count: u32| f64::from(i) / f64::from(count);
    let corner = |i: u32| place(part(i % (columns + 1), columns), part(i / (columns + 1), rows)).to_f32();
    let positions = (0..(columns + 1) * (rows + 1)).map(corner).collect();
    let square = |i: u32| {
        let a = i / columns * (columns + 1) + i % columns;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        [[a, b, c], [a, c, d]]
    };
    bare(positions, (0..columns * rows).flat_map(square).collect())
}

/// Returns a sphere with bosses, closed without a gap at the seam, of about `triangles` triangles.
pub fn embossed_ball(triangles: usize) -> Mesh {
    let rows = (triangles as f64 / 4.0).sqrt() as usize;
    let ball = Mesh::sphere(1.0, 2 * rows, rows);
    let emboss = |p: &Vec3| {
        let n = p.to_f64();
        let height = 0.03 * scalar::sin(9.0 * n.x) * scalar::sin(9.0 * n.y) * scalar::sin(9.0 * n.z);
        (n * (1.0 + height)).map(|v| (v * 1e6).round() * 1e-6).to_f32()
    };
    bare(ball.positions().iter().map(emboss).collect(), ball.triangles().to_vec())
}

/// Returns triangles at random positions, none touching another.
pub fn soup(triangles: u32) -> Mesh {
    let mut random = Random(7);
    let mut positions = Vec::new();
    for _ in 0..triangles {
        let middle = random.vector();
        positions.extend((0..3).map(|_| (middle + random.vector() * 0.02).to_f32()));
    }
    bare(positions, (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

/// Returns tetrahedra in a grid, `side` along each of its three directions.
pub fn tetrahedra(side: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..side * side * side {
        let at = |x: u32, y: u32, z: u32| {
            let cell = [i % side, i / side % side, i / side / side].map(|v| v as f32);
            Vec3::new(cell[0] + 0.3 * x as f32, cell[1] + 0.3 * y as f32, cell[2] + 0.3 * z as f32)
        };
        positions.extend([at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)]);
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        triangles.extend(faces.map(|face: [u32; 3]| face.map(|v| 4 * i + v)));
    }
    bare(positions, triangles)
}

/// Returns the pages of a book: many squares, split finely, that meet in one edge.
pub fn book(pages: u32) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for page in 0..pages {
        let angle = f64::from(page) / f64::from(pages) * std::f64::consts::TAU;
        let leaf = sheet(8, 8, |u, v| Vec3::new(u * scalar::cos(angle), u * scalar::sin(angle), v));
        let first = positions.len() as u32;
        positions.extend_from_slice(leaf.positions());
        triangles.extend(leaf.triangles().iter().map(|t| t.map(|v| v + first)));
    }
    bare(positions, triangles)
}

/// Returns a band with one side, its ends joined by equal positions.
pub fn moebius(columns: u32, rows: u32) -> Mesh {
    let mut data = sheet(columns, rows, |u, v| {
        let (turn, across) = (u * std::f64::consts::TAU, v - 0.5);
        let out = 1.0 + across * scalar::cos(turn / 2.0);
        Vec3::new(out * scalar::cos(turn), out * scalar::sin(turn), across * scalar::sin(turn / 2.0))
    })
    .into_data();
    // The last column is the first one upside down, to the bit.
    for row in 0..=rows {
        let (last, first) = (row * (columns + 1) + columns, (rows - row) * (columns + 1));
        data.positions[last as usize] = data.positions[first as usize];
    }
    Mesh::new(data).expect("a sound mesh")
}

/// Returns a ball with slivers, zero-area triangles, and copies of triangles from both sides.
pub fn littered(triangles: usize) -> Mesh {
    let mut data = embossed_ball(triangles).into_data();
    let mut random = Random(5);
    let count = data.positions.len();
    let mut any = || (random.next() * count as f64) as u32;
    for _ in 0..50 {
        let (a, b) = (any(), any());
        data.triangles.extend([[a, a, b], [a, a, a], [a, b, any()]]);
    }
    let copies: Vec<[u32; 3]> = data.triangles.iter().step_by(7).copied().collect();
    data.triangles.extend(copies.iter().map(|[a, b, c]| [*b, *c, *a]));
    data.triangles.extend(copies.iter().map(|[a, b, c]| [*c, *b, *a]));
    Mesh::new(data).expect("a sound mesh")
}

/// Returns all of them, by name.
pub fn all() -> Vec<(&'static str, Mesh)> {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let one = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)];
    let mut random = Random(11);
    let thick = (0..60).map(|_| random.vector().to_f32()).collect();
    let any = |random: &mut Random| (random.next() * 60.0) as u32;
    let tangle = (0..2000).map(|_| [any(&mut random), any(&mut random), any(&mut random)]).collect();
    let line = |i: u32| Vec3::new(i as f32, 0.0, 0.0);
    let thin = |u: f64, v: f64| Vec3::new(u, 1e-6 * v, 0.0);
    let huge = |u: f64, v: f64| Vec3::new(u - 0.5, v - 0.5, 0.5 * u * v) * 6e38;
    let tiny = |u: f64, v: f64| Vec3::new(u, v, u * v) * 1e-40;
    vec![
        ("one triangle", bare(one, vec![[0, 1, 2]])),
        ("soup", soup(3000)),
        ("tetrahedra", tetrahedra(12)),
        ("book", book(24)),
        ("moebius", moebius(80, 12)),
        ("littered ball", littered(20_000)),
        ("tangle", bare(thick, tangle)),
        ("line", bare((0..100).map(line).collect(), (0..98).map(|i| [i, i + 1, i + 2]).collect())),
        ("slivers", sheet(200, 20, thin)),
        ("huge", sheet(40, 40, huge)),
        ("tiny", sheet(40, 40, tiny)),
        ("far away", sheet(60, 60, |u, v| Vec3::new(1e7 + u, 1e7 + v, 1e7 + u * v))),
    ]
}
