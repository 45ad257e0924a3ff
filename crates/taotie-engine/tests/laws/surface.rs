//! Laws of normals and tangents, for any mesh.

use crate::angle::angle;
use crate::random::Random;
use serde_json::Value;
use taotie_engine::math::{Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::names::Named;
use taotie_engine::surface::*;

const METHODS: [TangentMethod; 3] = [TangentMethod::Face, TangentMethod::Averaged, TangentMethod::MikkTSpace];

fn mesh(data: MeshData) -> Mesh {
    Mesh::new(data).unwrap()
}

/// A unit sphere with uvs, cut along one meridian; u runs `turns` times around, backwards if negative.
fn sphere(rings: u32, segments: u32, turns: f32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for ring in 0..=rings {
        for segment in 0..=segments {
            let (u, v) = (segment as f32 / segments as f32, ring as f32 / rings as f32);
            // Positions at the seam and at the poles are equal to the last bit.
            let theta = f64::from(segment % segments) / f64::from(segments) * std::f64::consts::TAU;
            let phi = f64::from(v) * std::f64::consts::PI;
            let radius = if ring % rings == 0 { 0.0 } else { scalar::sin(phi) };
            let p = Vec3::new(radius * scalar::cos(theta), scalar::cos(phi), -radius * scalar::sin(theta));
            data.positions.push(p.to_f32());
            data.normals.push(p.to_f32());
            data.uvs[0].push(Vec2::new(u * turns, v));
        }
    }
    let index = |ring, segment| ring * (segments + 1) + segment;
    for ring in 0..rings {
        for segment in 0..segments {
            let [a, b] = [index(ring, segment), index(ring, segment + 1)];
            let [c, d] = [index(ring + 1, segment), index(ring + 1, segment + 1)];
            if ring > 0 {
                data.triangles.push([a, c, b]);
            }
            if ring + 1 < rings {
                data.triangles.push([b, c, d]);
            }
        }
    }
    mesh(data)
}

/// A corner's normal, tangent, handedness and position.
type CornerFrame = (Vec3<f64>, Vec3<f64>, f64, Vec3<f64>);

/// The corners of triangle `t`.
fn frames(mesh: &Mesh, t: usize) -> [CornerFrame; 3] {
    mesh.triangles()[t].map(|v| {
        let v = v as usize;
        let [x, y, z, w] = mesh.tangents()[v];
        let tangent = Vec3::new(x, y, z).to_f64();
        (mesh.normals()[v].to_f64(), tangent, f64::from(w), mesh.positions()[v].to_f64())
    })
}

#[test]
fn a_cube_has_corner_normals_however_it_is_cut() {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    for cut in 0..64 {
        let mut triangles = Vec::new();
        for (i, [a, b, c, d]) in quads.into_iter().enumerate() {
            let along_ac = cut >> i & 1 == 0;
            triangles.extend(if along_ac { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
        let cube =
            mesh(MeshData { positions: (0..8).map(corner).collect(), triangles, ..MeshData::default() });
        for (normal, position) in vertex_normals(&cube).iter().zip(cube.positions()) {
            let expected = (*position - Vec3::splat(0.5)).normalize();
            assert!((*normal - expected).length() < 1e-6, "cut {cut}: {normal:?} at {position:?}");
        }
    }
}

#[test]
fn normals_ignore_the_triangulation() {
    // The normal at a corner of a fan is weighted by angle, not by triangle: splitting one changes nothing.
    let positions = [(0.0, 0.0, 0.5), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, -0.2, 0.0), (0.5, 0.5, 0.0)];
    let positions: Vec<Vec3> = positions.iter().map(|(x, y, z)| Vec3::new(*x, *y, *z)).collect();
    let whole = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]];
    let split = vec![[0, 1, 4], [0, 4, 2], [0, 2, 3], [0, 3, 1]];
    let normal = |triangles| {
        vertex_normals(&mesh(MeshData { positions: positions.clone(), triangles, ..MeshData::default() }))[0]
    };
    assert!((normal(whole) - normal(split)).length() < 1e-6);
}

#[test]
fn sphere_normals_are_near_the_analytic_ones_across_the_seam() {
    let sphere = sphere(48, 96, 1.0);
    let normals = vertex_normals(&sphere);
    for (i, (normal, position)) in normals.iter().zip(sphere.positions()).enumerate() {
        let off = angle(normal.to_f64(), position.to_f64()).to_degrees();
        assert!(off < 0.1, "vertex {i} at {position:?}: {off}°");
    }
    for ring in 1..48 {
        assert_eq!(normals[ring * 97], normals[ring * 97 + 96], "the seam in ring {ring}");
    }
}

#[test]
fn what_has_no_area_has_a_stated_normal() {
    let positions = vec![
        Vec3::new(0.0, 0.0, 0.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(2.0, 0.0, 0.0),
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(9.0, 9.0, 9.0),
    ];
    // A line, a sheet visible from both sides, and a vertex without triangles.
    let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 3, 1]];
    let normals = vertex_normals(&mesh(MeshData { positions, triangles, ..MeshData::default() }));
    let up = Vec3::new(0.0, 0.0, 1.0);
    assert_eq!([normals[2], normals[4]], [up; 2]);
    assert_eq!([normals[0], normals[1], normals[3]], [Vec3::new(0.0, -1.0, 0.0); 3]);
    assert_eq!(facet_normal([Vec3::splat(1.0); 3]), None);
}

#[test]
fn frames_are_orthonormal_and_of_one_hand() {
    for (turns, hand) in [(1.0, 1.0), (-1.0, -1.0)] {
        let sphere = sphere(24, 48, turns);
        for method in METHODS {
            let made = with_tangents(&sphere, 0, method).unwrap();
            assert_eq!(made.mesh.triangles().len(), sphere.triangles().len());
            assert_eq!(made.degenerate_uvs, 0);
            for (t, corners) in sphere.triangles().iter().enumerate() {
                for ((n, tangent, w, position), old) in frames(&made.mesh, t).into_iter().zip(corners) {
                    assert_eq!(position, sphere.positions()[*old as usize].to_f64(), "triangle order");
                    assert!(n.dot(tangent).abs() < 1e-5, "{}", method.name());
                    assert!((tangent.length() - 1.0).abs() < 1e-5, "{}", method.name());
                    assert_eq!(w, hand, "{}: mirrored uvs flip handedness", method.name());
                }
            }
        }
    }
}

#[test]
fn tangents_follow_u_and_bitangents_point_up_the_picture() {
    let sphere = sphere(32, 64, 1.0);
    for method in METHODS {
        let made = with_tangents(&sphere, 0, method).unwrap();
        for t in 0..sphere.triangles().len() {
            for (n, tangent, w, p) in frames(&made.mesh, t) {
                if p.y.abs() > 0.9 {
                    continue;
                }
                let east = Vec3::new(0.0, 1.0, 0.0).cross(p).normalize();
                let north = p.cross(east);
                assert!(angle(tangent, east) < 0.1, "{}: {tangent:?} at {p:?}", method.name());
                assert!(angle(n.cross(tangent) * w, north) < 0.1, "{}", method.name());
            }
        }
    }
}

#[test]
fn averaged_tangents_are_near_mikktspace() {
    let sphere = sphere(32, 64, 1.0);
    let [a, b] = [TangentMethod::Averaged, TangentMethod::MikkTSpace]
        .map(|m| with_tangents(&sphere, 0, m).unwrap().mesh);
    for t in 0..sphere.triangles().len() {
        for ((_, ta, ..), (_, tb, ..)) in frames(&a, t).into_iter().zip(frames(&b, t)) {
            assert!(angle(ta, tb) < 1e-3);
        }
    }
    // Shared vertices stay shared: only the seam and the poles are split.
    assert_eq!(a.positions().len(), b.positions().len());
}

#[test]
fn mirrored_halves_split_where_they_meet() {
    // Two quads, the right one's uvs mirrored, sharing the two vertices between them.
    let positions =
        [-1.0, 0.0, 1.0].into_iter().flat_map(|x| [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)]);
    let uvs = [1.0, 0.0, 1.0].into_iter().flat_map(|u| [Vec2::new(u, 1.0), Vec2::new(u, 0.0)]);
    let sheet = mesh(MeshData {
        positions: positions.collect(),
        normals: vec![Vec3::new(0.0, 0.0, 1.0); 6],
        uvs: vec![uvs.collect()],
        triangles: vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]],
        ..MeshData::default()
    });
    for method in METHODS {
        let made = with_tangents(&sheet, 0, method).unwrap().mesh;
        let hands: Vec<f64> = (0..4).flat_map(|t| frames(&made, t)).map(|(_, _, w, _)| w).collect();
        let expected = [[-1.0; 6], [1.0; 6]].concat();
        assert_eq!(hands, expected, "{}", method.name());
        assert_eq!(made.positions().len(), 8, "{}: the two in the middle are split", method.name());
        for (tangent, position) in made.tangents().iter().zip(made.positions()) {
            assert_eq!([tangent[0].abs(), tangent[1], tangent[2]], [1.0, 0.0, 0.0], "{position:?}");
        }
    }
}

#[test]
fn equal_corners_become_one_vertex_whatever_the_indices() {
    let sphere = sphere(12, 24, 1.0);
    let mut soup = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for v in sphere.triangles().iter().flatten().map(|v| *v as usize) {
        soup.triangles.extend(
            soup.positions
                .len()
                .is_multiple_of(3)
                .then(|| [0, 1, 2].map(|i| soup.positions.len() as u32 + i)),
        );
        soup.positions.push(sphere.positions()[v]);
        soup.normals.push(sphere.normals()[v]);
        soup.uvs[0].push(sphere.uvs()[0][v]);
    }
    let soup = mesh(soup);
    for method in METHODS {
        let from_soup = with_tangents(&soup, 0, method).unwrap().mesh;
        let from_mesh = with_tangents(&sphere, 0, method).unwrap().mesh;
        assert_eq!(from_soup.triangles(), from_mesh.triangles(), "{}", method.name());
        assert_eq!(from_soup.tangents(), from_mesh.tangents(), "{}", method.name());
    }
}

#[test]
fn uvs_without_area_are_counted_and_framed() {
    let mut data = sphere(8, 16, 1.0).into_data();
    data.uvs = vec![vec![Vec2::new(0.5, 0.5); data.positions.len()]];
    let flat = mesh(data);
    for method in METHODS {
        let made = with_tangents(&flat, 0, method).unwrap();
        assert_eq!(made.degenerate_uvs, flat.triangles().len());
        for (n, tangent, w, _) in (0..flat.triangles().len()).flat_map(|t| frames(&made.mesh, t)) {
            assert!((tangent.length() - 1.0).abs() < 1e-6 && w.abs() == 1.0);
            assert!(n.cross(tangent).length() > 0.01, "{}: {n:?} {tangent:?} span no frame", method.name());
        }
    }
}

#[test]
fn hostile_meshes_end_in_valid_tangents() {
    let mut random = Random(5);
    let odd = [f32::NAN, f32::INFINITY, 0.0, -0.0, 1e38, -1e38, 1e-44, 1.0];
    for case in 0..200 {
        let count = 1 + (random.next() * 12.0) as usize;
        let scale = [1.0, 1e30, 1e-30, 3e38][case % 4];
        let mut wild = |strange: f64| {
            let r = random.next();
            if r < strange { odd[(r / strange * 8.0) as usize] } else { (random.next() - 0.5) as f32 }
        };
        let data = MeshData {
            positions: (0..count)
                .map(|_| Vec3::new(wild(0.0).signum(), wild(0.0), wild(0.0).round()) * scale)
                .collect(),
            normals: (0..count).map(|_| Vec3::new(wild(0.2), wild(0.2), wild(0.2))).collect(),
            uvs: vec![(0..count).map(|_| Vec2::new(wild(0.2), wild(0.2).round())).collect()],
            triangles: (0..60)
                .map(|_| [0; 3].map(|_| (f64::from(wild(0.0)) + 0.5) * count as f64))
                .map(|t| t.map(|i| (i as u32).min(count as u32 - 1)))
                .collect(),
            ..MeshData::default()
        };
        let wild = mesh(data);
        assert!(vertex_normals(&wild).iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "case {case}");
        for method in METHODS {
            let made = with_tangents(&wild, 0, method).unwrap();
            assert_eq!(made.mesh.triangles().len(), 60);
            for [x, y, z, w] in made.mesh.tangents() {
                let length = Vec3::new(*x, *y, *z).length();
                assert!(
                    (length - 1.0).abs() < 1e-3 && w.abs() == 1.0,
                    "case {case}, {}: {length}",
                    method.name()
                );
            }
        }
    }
}

#[test]
fn a_vertex_of_a_hundred_thousand_triangles_is_survived() {
    let count = 100_000;
    let rim = (0..count).map(|i| f64::from(i) / f64::from(count) * std::f64::consts::TAU);
    let rim = rim.map(|a| Vec2::new(scalar::cos(a) as f32, scalar::sin(a) as f32));
    let uvs: Vec<Vec2> = std::iter::once(Vec2::new(0.0, 0.0)).chain(rim).collect();
    let fan = mesh(MeshData {
        positions: uvs.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect(),
        normals: vec![Vec3::new(0.0, 0.0, 1.0); uvs.len()],
        uvs: vec![uvs],
        triangles: (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect(),
        ..MeshData::default()
    });
    for method in METHODS {
        let made = with_tangents(&fan, 0, method).unwrap().mesh;
        let along_x = made.tangents().iter().filter(|t| t[0] > 0.99).count();
        assert_eq!(along_x, made.positions().len(), "{}", method.name());
    }
}

#[test]
fn what_is_missing_is_named() {
    let mut data = sphere(3, 4, 1.0).into_data();
    let error = with_tangents(&mesh(data.clone()), 1, TangentMethod::Face).unwrap_err().to_string();
    assert!(error.contains("uv set 1"), "{error}");
    data.normals = Vec::new();
    let error = with_tangents(&mesh(data), 0, TangentMethod::Face).unwrap_err().to_string();
    assert!(error.contains("no normals"), "{error}");
    let empty = mesh(MeshData { uvs: vec![Vec::new()], ..MeshData::default() });
    assert!(METHODS.iter().all(|m| with_tangents(&empty, 0, *m).unwrap().mesh.triangles().is_empty()));
}

#[test]
fn object_and_tangent_maps_of_one_relief_agree_on_a_sphere() {
    let made = with_tangents(&sphere(24, 48, 1.0), 0, TangentMethod::MikkTSpace).unwrap().mesh;
    let identity = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let mut random = Random(8);
    for t in 0..made.triangles().len() {
        let [a, b, c] = frames(&made, t);
        let (x, y) = (random.next(), random.next());
        let bary = [1.0 - x.max(y), x.min(y), (x - y).abs()];
        let mix = |f: fn(&CornerFrame) -> Vec3<f64>| f(&a) * bary[0] + f(&b) * bary[1] + f(&c) * bary[2];
        let (n, tangent) = (mix(|f| f.0), mix(|f| f.1));
        let target = (n + random.unit() * 0.5).normalize();
        // The conversion of bakers: the inverse of the un-normalised frame.
        let bitangent = n.cross(tangent) * a.2;
        let rows = [bitangent.cross(n), n.cross(tangent), tangent.cross(bitangent)];
        let map = Vec3::new(target.dot(rows[0]), target.dot(rows[1]), target.dot(rows[2])).normalize();
        let by_tangent = tangent_normal(n, tangent, a.2, decode_normal(encode_normal(map), 1.0, 1.0));
        let by_object = object_normal(decode_object_normal(encode_normal(target)), identity);
        assert!((by_tangent - by_object).length() < 1e-9, "{by_tangent:?} against {by_object:?}");
    }
}

#[test]
fn formulas_agree_with_the_oracle() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/surface_oracle.json");
    let oracle: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    let vector = |v: &Value| Vec3::new(number(&v[0]), number(&v[1]), number(&v[2]));
    for case in oracle["cases"].as_array().unwrap() {
        let corners = [0, 1, 2].map(|i| vector(&case["corners"][i]));
        let uvs = [0, 1, 2]
            .map(|i| &case["uvs"][i])
            .map(|uv| Vec2::new(number(&uv[0]) as f32, number(&uv[1]) as f32));
        let d = uv_derivatives(corners.map(Vec3::to_f32), uvs).unwrap();
        let (dp_du, dp_dv) = (vector(&case["dp_du"]), vector(&case["dp_dv"]));
        assert!((d.dp_du.to_f64() - dp_du).length() < 1e-6 * dp_du.length());
        assert!((d.dp_dv.to_f64() - dp_dv).length() < 1e-6 * dp_dv.length());
        let n = facet_normal(corners.map(Vec3::to_f32)).unwrap().to_f64();
        assert!((n - vector(&case["n"])).length() < 1e-6);
        // v points down the picture, so b = −∂p/∂v side.
        assert_eq!(n.cross(dp_du).dot(-dp_dv).signum(), f64::from(d.handedness));
        let (n, dh) = (vector(&case["n"]), &case["dh"]);
        let gradient = surface_gradient(n, [dp_du, dp_dv], [number(&dh[0]), number(&dh[1])]);
        assert!((bump(n, gradient) - vector(&case["bumped"])).length() < 1e-9);
        let map = decode_normal(vector(&case["color"]), 1.0, 1.0);
        let mapped = tangent_normal(n, vector(&case["t"]), number(&case["w"]), map);
        assert!((mapped - vector(&case["mapped"])).length() < 1e-12);
    }
    for fan in oracle["fans"].as_array().unwrap() {
        let rim = fan["rim"].as_array().unwrap();
        let count = rim.len() as u32;
        let positions = std::iter::once(&fan["center"]).chain(rim).map(|v| vector(v).to_f32()).collect();
        let triangles = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
        let normal = vertex_normals(&mesh(MeshData { positions, triangles, ..MeshData::default() }))[0];
        assert!((normal.to_f64() - vector(&fan["normal"])).length() < 1e-6);
    }
}
