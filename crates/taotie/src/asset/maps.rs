//! The maps of one low-poly mesh: cage, projection, storing.

use super::inputs::Rays;
use super::judgement::{Pair, refuse_no_hit};
use super::low::LowPoly;
use super::options::BakeOptions;
use super::scan::Scan;
use super::textures::Textures;
use crate::bake::{self, BakeCounts, BakeInput, BakeSettings, Baked, Cage, Maps};
use crate::error::Result;
use crate::progress::Progress;

/// Maps after baking.
pub(super) struct StoredMaps {
    pub textures: Textures,
    /// The outcomes of the samples.
    pub counts: BakeCounts,
    /// The cage from which the scan was searched for.
    pub cage: Cage,
}

impl StoredMaps {
    /// Returns no maps, with the cage of a mesh without any.
    pub fn none(Pair { scan, low }: Pair<'_>) -> Self {
        let cage = Cage::automatic(&low.shape(), scan.sorted());
        Self { textures: Textures::default(), counts: BakeCounts::default(), cage }
    }
}

/// The options of a bake, with the cage that they name.
#[derive(Clone, Copy)]
pub(super) struct Recipe<'a> {
    pub options: &'a BakeOptions,
    pub rays: &'a Rays,
}

/// Bakes the requested maps at this size.
pub(super) fn bake_maps(
    Recipe { options, rays }: Recipe<'_>,
    size: [u32; 2],
    pair: Pair<'_>,
    progress: Progress<'_>,
) -> Result<StoredMaps> {
    let Pair { scan, low } = pair;
    scan.sort(progress)?;
    progress.begin("measure the gap")?;
    let cage = cage(rays, low, scan)?;
    let settings = BakeSettings {
        size,
        side: options.side,
        maps: options.maps.iter().copied().collect::<Maps>(),
        space: options.space,
        sky_rays: options.ao_rays,
        sky_distance: options.ao_distance.map(|distance| distance as f32),
        roughness: options.roughness.map(|v| v as f32),
        dilation: options.dilation,
    };
    let input = BakeInput { low: &low.mesh, cage: &cage, scan: scan.sorted() };
    let Baked { maps, counts } = bake::bake(input, &settings, progress.begin("bake")?)?;
    refuse_no_hit(pair, &cage, &counts)?;
    progress.begin("store")?;
    let textures = Textures::new(&maps, options, pair)?;
    Ok(StoredMaps { textures, counts, cage })
}

fn cage(rays: &Rays, low: &LowPoly, scan: &Scan) -> Result<Cage> {
    match rays {
        Rays::Auto => Ok(Cage::automatic(&low.shape(), scan.sorted())),
        Rays::Uniform(distance) => Cage::uniform(&low.shape(), *distance as f32),
        Rays::Cage(cage) => {
            let made = match &low.own {
                Some(own) => Cage::from_mesh(&low.mesh, &cage.part(&own.triangles)?),
                None => Cage::from_mesh(&low.mesh, &cage.mesh),
            };
            made.map_err(|error| cage.named(error))
        }
    }
}
