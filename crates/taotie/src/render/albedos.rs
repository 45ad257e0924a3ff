//! The directional albedos of each fragment's lobes, looked up in the tables.

use super::batch::{Batch, Lanes};
use super::columns::{Column, get3};
use super::draw::Draw;
use super::settings::RenderSettings;
use crate::math::{Pack, Vec3, Words, dispatch_pack};
use crate::pixel::{coat_albedo, is_cook_torrance, lobe_slope, sheen_albedo, takes_layers};
use crate::scene::Material;
use crate::shade::dfg::{self, Dfg, TablePosition};
use crate::shade::{Energy, Shading};
use fearless_simd::Level;

/// Fills `batch.albedos.dfg` and the albedos of the layers.
pub(super) fn look_up(level: Level, settings: &RenderSettings, draw: &Draw<'_>, batch: &mut Batch) {
    let shading = settings.shading;
    batch.albedos.compensated = settings.energy == Energy::Compensated;
    let mut places = Places { node: Words::ZERO, across: Column::ZERO, down: Column::ZERO };
    dispatch_pack!(level, P, token => places.find::<P>(token, shading, draw.material, batch));
    let shares = places.across.iter().zip(places.down.iter());
    let entries = batch.albedos.dfg[..batch.len].iter_mut().zip(places.node.iter().zip(shares));
    if is_cook_torrance(shading) {
        entries.for_each(|(dfg, (node, (x, y)))| *dfg = Dfg::of_cook_torrance_at(*node, [*x, *y]));
    } else {
        entries.for_each(|(dfg, (node, (x, y)))| *dfg = Dfg::of_ggx_at(*node, [*x, *y]));
    }
    let material = draw.material;
    if takes_layers(shading) && (material.clearcoat.is_some() || material.sheen.is_some()) {
        for i in 0..batch.len {
            look_up_layers(material, batch, i);
        }
    }
}

/// The table positions at which fragments are looked up.
struct Places {
    node: Words,
    across: Column,
    down: Column,
}

impl Places {
    #[inline(always)]
    fn find<P: Pack>(&mut self, token: P::Token, shading: Shading, material: &Material, batch: &Batch) {
        for i in batch.packs::<P>() {
            let at: Lanes<'_, P> = batch.lanes(token, i);
            let n_dot_v = at.load3(&batch.frame.n).dot(at.load3(&batch.geometry.v));
            let place = match is_cook_torrance(shading) {
                true => {
                    let slope = lobe_slope(&at.uniforms(material), &at.values());
                    TablePosition::of_cook_torrance(n_dot_v, slope)
                }
                false => TablePosition::of_ggx(n_dot_v, at.load(&batch.material.roughness)),
            };
            place.node.store_words(&mut self.node[i..]);
            place.across.store(&mut self.across[i..]);
            place.down.store(&mut self.down[i..]);
        }
    }
}

/// Fills the clearcoat's albedo of entry `i` as seen from `v`.
pub(super) fn look_up_coat(material: &Material, batch: &mut Batch, i: usize, v: Vec3) {
    if material.clearcoat.is_some() {
        let cosine = get3(&batch.layers.coat_n, i).dot(v);
        batch.layers.coat_albedo[i] = coat_albedo(&dfg::of_ggx(cosine, batch.layers.coat_roughness[i]));
    }
}

fn look_up_layers(material: &Material, batch: &mut Batch, i: usize) {
    let v = get3(&batch.geometry.v, i);
    look_up_coat(material, batch, i, v);
    if material.sheen.is_some() {
        let cosine = get3(&batch.frame.n, i).dot(v);
        batch.layers.sheen_albedo[i] = sheen_albedo(dfg::of_sheen(cosine, batch.layers.sheen_roughness[i]));
    }
}
