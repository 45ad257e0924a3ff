//! Devices that cast the rays of bakes: what they find is checked or used, and their failures are reported.

use crate::angle::angle;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::bake::{
    BakeInput, BakeSettings, Baked, Cage, CastRay, MapKind, Open, Plane, RayCaster, RayDevice, Scan,
    SkyPoint, SkyRays, TexelStatus, bake,
};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Material, Scene};
use taotie_engine::surface::with_frames;
use taotie_engine::{Error, Result};

/// A device whose every projection ray finds these triangles, and half of whose sky is open.
#[derive(Clone, Default)]
struct Fake {
    named: [Option<u32>; 2],
    /// True to fail.
    fails: bool,
    /// The rays and points that it was asked for.
    asked: Arc<[AtomicUsize; 2]>,
}

impl RayDevice for Fake {
    fn load(&self, _: &Scan) -> Result<Box<dyn RayCaster>> {
        Ok(Box::new(self.clone()))
    }
}

impl RayCaster for Fake {
    fn nearest(&self, rays: &[CastRay], _: &[Option<u32>]) -> Result<Vec<[Option<u32>; 2]>> {
        self.asked[0].fetch_add(rays.len(), Ordering::Relaxed);
        if self.fails { Err(Error::unsupported("rays", "none")) } else { Ok(vec![self.named; rays.len()]) }
    }

    fn open(&self, sky: SkyRays<'_>, points: &[SkyPoint], _: &[Option<u32>]) -> Result<Vec<Open>> {
        self.asked[1].fetch_add(points.len(), Ordering::Relaxed);
        assert!(points.iter().all(|point| point.class < sky.classes) && sky.directions.len() == 128);
        let up = Vec3::new(0.0, 0.0, 1.0);
        Ok(vec![Open { looked: 2.0, seen: 1.0, direction: up }; points.len()])
    }
}

fn scan() -> Scan {
    let wave = |v: f32| scalar::sin(8.0 * f64::from(v)) as f32;
    let bump = |p: &Vec3| *p * (1.0 + 0.05 * wave(p.x) * wave(p.y) * wave(p.z));
    let data = Mesh::sphere(1.0, 96, 48).into_data();
    let positions = data.positions.iter().map(bump).collect();
    let mesh = Mesh::new(MeshData { positions, triangles: data.triangles, ..MeshData::default() }).unwrap();
    Scan::new(Scene::of_mesh(mesh, Material::default()).unwrap()).unwrap()
}

fn baked(scan: &Scan) -> Result<Baked> {
    let low = with_frames(&Mesh::sphere(1.0, 16, 8), 0, None).unwrap().0.into_owned();
    let cage = Cage::automatic(&low, scan);
    let maps = [MapKind::Normal, MapKind::Occlusion].into_iter().collect();
    let settings = BakeSettings { size: [64; 2], maps, ..BakeSettings::default() };
    bake(BakeInput { low: &low, cage: &cage, scan }, &settings, Progress::SILENT)
}

#[test]
fn triangles_that_rays_miss_are_not_believed() {
    let expected = baked(&scan()).unwrap();
    let covered: Vec<usize> =
        (0..expected.maps.texels.len()).filter(|i| expected.maps.texels[*i] != TexelStatus::Free).collect();
    for named in [[None, None], [Some(7), None], [Some(u32::MAX), Some(0)]] {
        let fake = Fake { named, ..Fake::default() };
        let found = baked(&scan().cast_by(Some(Arc::new(fake.clone())))).unwrap();
        assert_eq!(found.counts, expected.counts, "{named:?}");
        let vector =
            |baked: &Baked, i: usize| Vec3::from_array(baked.maps.vectors(Plane::Normal)[i]).to_f64();
        let most =
            covered.iter().map(|i| angle(vector(&expected, *i), vector(&found, *i))).fold(0.0, f64::max);
        assert!(most.to_degrees() < 1e-4, "{named:?}: {most}");
        let [rays, points] = [&fake.asked[0], &fake.asked[1]].map(|asked| asked.load(Ordering::Relaxed));
        assert_eq!([rays, points], [found.counts.samples; 2], "each sample is asked for once");
        assert!(covered.iter().all(|i| found.maps.numbers(Plane::Occlusion)[*i] == 0.5), "{named:?}");
    }
}

#[test]
fn failures_of_a_device_are_those_of_the_bake() {
    let fake = Fake { fails: true, ..Fake::default() };
    let error = baked(&scan().cast_by(Some(Arc::new(fake)))).unwrap_err();
    assert_eq!(error.to_string(), "rays is not supported: none");
}
