//! The errors of maps: small for what was baked, and as large as the fault for maps that were spoiled.

use std::sync::Arc;
use taotie_engine::bake::{
    BakeInput, BakeSettings, BakedMaps, Cage, CageGroups, MapKind, Maps, Plane, Scan, UvIndex, bake,
};
use taotie_engine::math::{Mat4, Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::progress::Progress;
use taotie_engine::proof::{MapCheck, StoredMap};
use taotie_engine::scene::{Instance, Material, NormalSpace, Scene, SceneData};
use taotie_engine::surface::with_frames;

const SIDE: u32 = 128;

/// A ball with bumps, its colours along x.
fn bumpy() -> Mesh {
    let data = Mesh::sphere(1.0, 192, 96).into_data();
    let wave = |v: f32| scalar::sin(8.0 * f64::from(v)) as f32;
    let bump = |p: &Vec3| 1.0 + 0.08 * wave(p.x) * wave(p.y) * wave(p.z);
    let positions: Vec<Vec3> = data.positions.iter().map(|p| *p * bump(p)).collect();
    let colors = positions.iter().map(|p| [p.x * 0.5 + 0.5, 0.5, 0.2, 1.0]).collect();
    let bare = MeshData { positions, colors, normals: Vec::new(), tangents: Vec::new(), ..data };
    with_frames(&Mesh::new(bare).unwrap(), 0, None).unwrap().0.into_owned()
}

/// The triangles of a mesh on either side of the plane x = 0.
fn halves(mesh: &Mesh) -> Vec<Mesh> {
    let half = |is_right: bool| {
        let is_own = |t: &usize| (mesh.corners(*t).iter().map(|p| p.x).sum::<f32>() > 0.0) == is_right;
        let triangles = (0..mesh.triangles().len()).filter(is_own).map(|t| mesh.triangles()[t]).collect();
        Mesh::new(MeshData { triangles, ..mesh.clone().into_data() }).unwrap()
    };
    [true, false].map(half).into()
}

/// A scan of these meshes, each an object with its own material.
fn scan(meshes: Vec<Mesh>) -> Scan {
    let instances =
        (0..meshes.len()).map(|i| Instance { mesh: i, material: i, world_from_object: Mat4::IDENTITY });
    let (instances, materials) = (instances.collect(), vec![Material::default(); meshes.len()]);
    Scan::new(Scene::new(SceneData { meshes, instances, materials, ..SceneData::default() }).unwrap())
        .unwrap()
}

fn low(radius: f64) -> Mesh {
    with_frames(&Mesh::sphere(radius, 32, 16), 0, None).unwrap().0.into_owned()
}

fn baked(low: &Mesh, (scan, cage): (&Scan, &Cage), settings: BakeSettings) -> BakedMaps {
    let settings = BakeSettings { size: [SIDE; 2], ..settings };
    bake(BakeInput { low, cage, scan }, &settings, Progress::SILENT).unwrap().maps
}

fn check<'a>(low: &'a Mesh, (scan, cage): (&'a Scan, &'a Cage)) -> MapCheck<'a> {
    MapCheck { low, cage, scan, isolated: false, sky_distance: None, bevel_radius: None, roughness: None }
}

/// Returns the value of a plane in the texel at a uv.
fn value(maps: &BakedMaps, plane: Plane, uv: Vec2) -> Vec3 {
    let [x, y] = [uv.x, uv.y].map(|v| ((v * SIDE as f32) as usize).min(SIDE as usize - 1));
    let i = y * SIDE as usize + x;
    match plane.channels() {
        3 => Vec3::from_array(maps.vectors(plane)[i]),
        _ => Vec3::splat(maps.numbers(plane)[i]),
    }
}

const KINDS: [MapKind; 15] = [
    MapKind::Occlusion,
    MapKind::Height,
    MapKind::Bent,
    MapKind::Curvature,
    MapKind::Convexity,
    MapKind::Concavity,
    MapKind::Position,
    MapKind::Gradient,
    MapKind::WorldNormal,
    MapKind::Thickness,
    MapKind::VertexColor,
    MapKind::MaterialId,
    MapKind::ObjectId,
    MapKind::Bevel,
    MapKind::VectorDisplacement,
];

#[test]
fn errors_are_small_and_spoiled_maps_are_found() {
    let (scan, low) = (scan(halves(&bumpy())), low(1.0));
    let cage = Cage::automatic(&low, &scan);
    let settings =
        BakeSettings { maps: KINDS.into_iter().collect(), sky_rays: 64, ..BakeSettings::default() };
    let maps = baked(&low, (&scan, &cage), settings.clone());
    let of_sky = Maps::default().with(MapKind::Occlusion);
    let near = BakeSettings { sky_distance: Some(0.05), maps: of_sky, ..settings };
    let near = baked(&low, (&scan, &cage), near);
    let extent = scan.mesh().vertical_extent();
    let check = check(&low, (&scan, &cage));
    let stored = |kind: MapKind, maps: &BakedMaps, uv: Vec2| {
        let v = value(maps, kind.planes()[0], uv);
        match kind {
            MapKind::Convexity | MapKind::Concavity => Vec3::splat(kind.of_curvature(v.x)),
            MapKind::Gradient => Vec3::splat(MapKind::gradient(v.y, extent)),
            _ => v,
        }
    };
    let error = |kind: MapKind, value: &(dyn Fn(Vec2) -> Vec3 + Sync)| {
        let map = StoredMap { kind, space: NormalSpace::Tangent, component: None, value };
        let found = check.error(&map, "").unwrap().expect("it sees the scan");
        assert!(found.unseen < 0.01, "{kind:?}: {}", found.unseen);
        found.summary.mean
    };
    // Each error, and that of the map moved by three texels.
    let moved = 3.0 / SIDE as f32;
    let mut faults = Vec::new();
    for kind in KINDS {
        let own = error(kind, &|uv| stored(kind, &maps, uv));
        let spoiled = error(kind, &|uv| {
            stored(kind, &maps, Vec2::new((uv.x + moved).min(1.0), (uv.y + moved).min(1.0)))
        });
        println!("{kind:?}: {own:.5}, moved {spoiled:.5}");
        let most = match kind {
            MapKind::Occlusion => 0.004,
            MapKind::Height | MapKind::VectorDisplacement => 0.004,
            MapKind::Bent | MapKind::WorldNormal | MapKind::Bevel => 2.5,
            MapKind::Curvature | MapKind::Convexity | MapKind::Concavity => 0.4,
            MapKind::Position => 0.016,
            MapKind::Gradient => 0.004,
            MapKind::Thickness => 0.01,
            MapKind::VertexColor => 0.3,
            _ => 0.0,
        };
        // A position elsewhere on the scan is still on it; the nearest texel of a gradient is a step away.
        let is_seen = spoiled > 2.0 * own;
        if own > most || !is_seen {
            faults.push(format!("{kind:?}: {own}, at most {most}; moved: {spoiled}"));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
    // A fault is as large as it is.
    let nearby = error(MapKind::Occlusion, &|uv| stored(MapKind::Occlusion, &near, uv));
    assert!(nearby > 0.008, "occlusion within another distance: {nearby}");
    let higher = error(MapKind::Height, &|uv| stored(MapKind::Height, &maps, uv) + Vec3::splat(0.01));
    assert!((higher / 0.01 - 1.0).abs() < 0.1, "{higher}");
    let shifted = error(MapKind::Position, &|uv| stored(MapKind::Position, &maps, uv) * 1.02);
    assert!((0.018..0.03).contains(&shifted), "{shifted}");
    assert_eq!(error(MapKind::MaterialId, &|_| Vec3::splat(7.0)), 1.0);
    let map = StoredMap {
        kind: MapKind::Wireframe,
        space: NormalSpace::Tangent,
        component: None,
        value: &|_| Vec3::default(),
    };
    assert!(check.error(&map, "").unwrap().is_none(), "wireframes are not of the scan");
}

/// The components of a vector, of which a packed texture may hold any.
#[test]
fn a_single_component_is_compared_with_that_of_the_scan() {
    let (scan, low) = (scan(halves(&bumpy())), low(1.0));
    let cage = Cage::automatic(&low, &scan);
    let kinds = [
        MapKind::Normal,
        MapKind::WorldNormal,
        MapKind::Bent,
        MapKind::Bevel,
        MapKind::Position,
        MapKind::VectorDisplacement,
        MapKind::VertexColor,
        MapKind::Albedo,
    ];
    for space in [NormalSpace::Tangent, NormalSpace::Object] {
        let maps = kinds.into_iter().collect();
        let maps = baked(&low, (&scan, &cage), BakeSettings { maps, space, ..BakeSettings::default() });
        let check = check(&low, (&scan, &cage));
        let error = |kind: MapKind, component: usize, stored: usize| {
            let plane = kind.planes()[0];
            let value = |uv: Vec2| Vec3::splat(value(&maps, plane, uv).to_array()[stored]);
            let map = StoredMap { kind, space, component: Some(component), value: &value };
            check.error(&map, "").unwrap().expect("it sees the scan").summary.mean
        };
        for kind in kinds {
            for component in 0..3 {
                let own = error(kind, component, component);
                // Along the first two, displacements in tangent space are both small.
                let other = error(kind, component, if component < 2 { 2 } else { 0 });
                println!("{kind:?} {component} in {space:?} space: {own:.5}, another component {other:.5}");
                assert!(own < 0.03 && other > 3.0 * own, "{kind:?} {component}: {own}, {other}");
            }
        }
    }
}

/// A rectangle with a corner and two sides; its uvs are the shares of the sides.
fn rectangle(corner: Vec3, [a, b]: [Vec3; 2]) -> Mesh {
    let positions = vec![corner, corner + a, corner + a + b, corner + b];
    let uvs = vec![[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec2::new(x, y)).to_vec()];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let bare = Mesh::new(MeshData { positions, uvs, triangles, ..MeshData::default() }).unwrap();
    with_frames(&bare, 0, None).unwrap().0.into_owned()
}

/// A floor in front of a long wall of height 1, whose open share is (1 + d / √(d² + 1)) / 2 at a distance d: the map has no
/// error, so what is measured is the noise of the reference.
#[test]
fn the_reference_of_occlusion_has_little_noise() {
    const HALF: f32 = 40.0;
    let [x, y, z] = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
    let floor = rectangle(z * -HALF, [z * (2.0 * HALF), x * 4.0]);
    let wall = rectangle(z * -HALF, [y, z * (2.0 * HALF)]);
    let scan = scan(vec![floor, wall]);
    let low = rectangle(z * -1.0, [z * 2.0, x * 2.0]);
    let cage = Cage::automatic(&low, &scan);
    let check = check(&low, (&scan, &cage));
    let open = |uv: Vec2| {
        let d = uv.y * 2.0;
        Vec3::splat((1.0 + d / (d * d + 1.0).sqrt()) / 2.0)
    };
    let map =
        StoredMap { kind: MapKind::Occlusion, space: NormalSpace::Tangent, component: None, value: &open };
    let found = check.error(&map, "").unwrap().expect("it sees the scan");
    println!("{found:?}");
    assert!(found.unseen == 0.0 && found.summary.mean < 0.003 && found.summary.max < 0.015, "{found:?}");
}

#[test]
fn isolated_objects_are_not_shaded_by_others() {
    let shell = |radius: f64| with_frames(&Mesh::sphere(radius, 96, 48), 0, None).unwrap().0.into_owned();
    let (scan, low) = (scan(vec![shell(1.0), shell(1.3), shell(0.7)]), low(1.0));
    let groups = CageGroups {
        of_triangle: vec![Some(0); low.triangles().len()],
        of_object: Arc::from([Some(0), Some(1), Some(2)].as_slice()),
    };
    let cage = Cage::automatic_in(&low, &scan, Some(Arc::new(groups)));
    let maps = [MapKind::Occlusion, MapKind::Thickness].into_iter().collect();
    let of = |isolated: bool| {
        let maps = baked(&low, (&scan, &cage), BakeSettings { maps, isolated, ..BakeSettings::default() });
        let check = MapCheck { isolated, ..check(&low, (&scan, &cage)) };
        let value = |uv: Vec2| value(&maps, Plane::Occlusion, uv);
        let map = StoredMap {
            kind: MapKind::Occlusion,
            space: NormalSpace::Tangent,
            component: None,
            value: &value,
        };
        let error = check.error(&map, "").unwrap().unwrap().summary;
        let open = maps.covered(Plane::Occlusion);
        (open.iter().sum::<f32>() / open.len() as f32, error.max, maps.covered(Plane::Thickness))
    };
    let [(shut, error, thickness), (open, own_error, own_thickness)] = [false, true].map(of);
    assert!(shut < 0.001 && error < 0.05, "{shut}: the outer shell hides the sky; {error}");
    assert!(open > 0.98 && own_error < 0.05, "{open}, {own_error}");
    // To the innermost shell, or through to its own other side: 4/3 of the radius.
    let mean = |all: &[f32]| all.iter().sum::<f32>() / all.len() as f32;
    assert!(mean(&thickness) < 0.9, "{}", mean(&thickness));
    assert!((mean(&own_thickness) - 4.0 / 3.0).abs() < 0.03, "{}", mean(&own_thickness));
}

#[test]
fn points_of_the_same_uv_correspond_wherever_they_are() {
    let away = |mesh: Mesh| {
        let data = mesh.into_data();
        let positions = data.positions.iter().map(|p| *p + Vec3::new(9.0, 0.0, 0.0)).collect();
        Mesh::new(MeshData { positions, ..data }).unwrap()
    };
    let low = low(1.0);
    let maps = [MapKind::WorldNormal, MapKind::VertexColor].into_iter().collect();
    let of = |scan: &Scan, cage: &Cage| {
        baked(&low, (scan, cage), BakeSettings { maps, ..BakeSettings::default() })
    };
    let (here, there) = (scan(vec![bumpy()]), scan(vec![away(bumpy())]));
    let uvs = Some(Arc::new(UvIndex::of(there.mesh()).unwrap()));
    let by_uv = of(&there, &Cage::automatic(&low, &there).with_uvs(uvs));
    assert!(by_uv.texels.iter().all(|texel| *texel != taotie_engine::bake::TexelStatus::Lost));
    let by_ray = of(&here, &Cage::automatic(&low, &here));
    let apart = |plane: Plane| {
        let pairs = by_uv.vectors(plane).iter().zip(by_ray.vectors(plane));
        let apart = pairs.map(|(a, b)| f64::from((Vec3::from_array(*a) - Vec3::from_array(*b)).length()));
        apart.sum::<f64>() / f64::from(SIDE * SIDE)
    };
    // Both are the same parametrisation of a sphere, so rays from the centre meet the same uv.
    let [normals, colors] = [Plane::WorldNormal, Plane::VertexColor].map(apart);
    assert!(normals < 0.02 && colors < 0.003, "{normals}, {colors}");
    // UVs repeat beyond the map.
    let data = there.mesh().clone().into_data();
    let shifted = data.uvs[0].iter().map(|uv| Vec2::new(uv.x + 3.0, uv.y - 1.0)).collect();
    let shifted = Mesh::new(MeshData { uvs: vec![shifted], ..data }).unwrap();
    let uvs = Some(Arc::new(UvIndex::of(&shifted).unwrap()));
    let again = of(&there, &Cage::automatic(&low, &there).with_uvs(uvs));
    let plane = Plane::VertexColor;
    let pairs = again.vectors(plane).iter().zip(by_uv.vectors(plane));
    let apart =
        pairs.map(|(a, b)| (Vec3::from_array(*a) - Vec3::from_array(*b)).length()).fold(0.0, f32::max);
    assert!(apart < 0.01, "{apart}");
    let bare = Mesh::new(MeshData { uvs: Vec::new(), tangents: Vec::new(), ..bumpy().into_data() }).unwrap();
    assert!(UvIndex::of(&bare).unwrap_err().to_string().contains("no uvs to match"));
}
