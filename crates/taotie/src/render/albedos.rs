//! The directional albedos of each fragment's lobes, from the tables.

use super::batch::{Batch, get3};
use super::prepare::Draw;
use super::substance::takes_layers;
use crate::math::Vec3;
use crate::scene::Material;
use crate::shade::dfg::{self, Dfg};
use crate::shade::{COAT_F0, Energy, Shading, ndf};

/// Fills `batch.dfg` and the albedos of the layers.
pub(super) fn look_up(shading: Shading, energy: Energy, draw: &Draw<'_>, batch: &mut Batch) {
    batch.compensated = energy == Energy::Compensated;
    for i in batch.entries() {
        let (n, v) = (get3(&batch.n, i), get3(&batch.v, i));
        let n_dot_v = n.dot(v);
        let Dfg { scale, bias, edge, diffuse_edge } = match shading {
            Shading::CookTorrance | Shading::CookTorrancePrinted => {
                dfg::of_cook_torrance(n_dot_v, slope(draw.material, batch, i))
            }
            _ => dfg::of_ggx(n_dot_v, batch.roughness[i]),
        };
        for (column, value) in batch.dfg.iter_mut().zip([scale, bias, edge, diffuse_edge]) {
            column[i] = value;
        }
        if takes_layers(shading) {
            look_up_layers(draw.material, batch, i);
        }
    }
}

/// Fills the lacquer's albedo of entry `i` as seen from `v`.
pub(super) fn look_up_coat(material: &Material, batch: &mut Batch, i: usize, v: Vec3) {
    if material.clearcoat.is_some() {
        let cosine = get3(&batch.layers.coat_n, i).dot(v);
        let albedo = dfg::of_ggx(cosine, batch.layers.coat_roughness[i]);
        batch.layers.coat_albedo[i] = COAT_F0 as f32 * albedo.scale + albedo.bias;
    }
}

fn look_up_layers(material: &Material, batch: &mut Batch, i: usize) {
    let v = get3(&batch.v, i);
    look_up_coat(material, batch, i, v);
    if material.sheen.is_some() {
        let cosine = get3(&batch.n, i).dot(v);
        // Edge-on the lobe sends back more than arrives; nothing negative may be left for what lies below.
        batch.layers.sheen_albedo[i] = dfg::of_sheen(cosine, batch.layers.sheen_roughness[i]).min(1.0);
    }
}

/// Beckmann's slope of entry `i`.
fn slope(material: &Material, batch: &Batch, i: usize) -> f32 {
    match material.classic.slope {
        Some(slope) => (slope * slope + batch.variance[i]).sqrt(),
        None => batch.roughness[i] * batch.roughness[i],
    }
}

/// The roughness of the GGX lobe that comes nearest to the model's highlight, [0, 1].
pub(super) fn lobe_roughness(shading: Shading, material: &Material, batch: &Batch, i: usize) -> f32 {
    match shading {
        Shading::Ggx | Shading::GgxPrinted | Shading::Lambert => batch.roughness[i],
        Shading::CookTorrance | Shading::CookTorrancePrinted => slope(material, batch, i).sqrt().min(1.0),
        _ => match material.classic.shininess {
            Some(shininess) => ndf::alpha_from_shininess(shininess).sqrt(),
            None => batch.roughness[i],
        },
    }
}
