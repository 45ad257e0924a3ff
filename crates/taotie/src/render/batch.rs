//! A few hundred fragments in columns, so that eight neighbours load as one pack.

use super::columns::{Column, Column3, ZERO, ZERO3, load, load3, splat3};
use super::corners::{Run, VertexAttributes};
use super::lookups::{Lookups, UvSet};
pub use crate::math::BATCH;
use crate::math::{MOST_LANES, Pack, Quads, Vec3};
use crate::shade::dfg::Dfg;
use crate::shade::environment::{EnvironmentLookup, LookupDirections};

/// Fragments of one draw between interpolation and film, those of a triangle together. Entries from `len` on hold what
/// packs leave there, which only packs read.
#[derive(Debug, Clone)]
pub struct Batch {
    pub(super) len: usize,
    pub(super) runs: Vec<Run>,
    /// Places on the screen, pixels from the tile's corner; of the rasteriser's fragments.
    pub(super) place: [Column; 2],
    /// Barycentric weights of the three corners, and their changes a sample to the right and down.
    pub(super) weights: Column3,
    pub(super) d_x: Column3,
    pub(super) d_y: Column3,
    pub(super) corners: VertexAttributes,
    /// The uv sets, as many as the mesh has.
    pub(super) uv_sets: Vec<UvSet>,
    /// Vertex colours, where the mesh has some.
    pub(super) color: [Column; 4],
    /// The variance within a pixel that is added to α²: by the curvature of the smooth surface, and by the normal map.
    pub(super) curvature: Column,
    pub(super) normal_variance: Column,
    pub(super) lookups: Lookups,
    /// The first triangle of the draw whose constants fill the columns that no texture does; none while they may hold
    /// anything.
    pub(super) constants_of: Option<u32>,
    /// Columns for the channels of textures that nothing needs.
    pub(super) spare: [Column; 3],
    /// The position, world space.
    pub(super) position: Column3,
    /// The geometric normal: unit, world space, on the side of the face that is seen.
    pub(super) n_geom: Column3,
    /// The interpolated normal, not normalised; object space for `bump-printed`, else world space.
    pub(super) normal: Column3,
    /// The interpolated tangent, not normalised, world space.
    pub(super) tangent: Column3,
    pub(super) handedness: Column,
    /// The side that is seen: 1 for the front, −1 for the back.
    pub(super) facing: Column,
    /// `true` where the normal turns to a viewer behind the surface even where the material is single-sided.
    pub(super) both_sides: bool,
    /// The normal map's stored vector, each component in [0, 1].
    pub(super) map: Column3,
    pub(super) dp_du: Column3,
    pub(super) dp_dv: Column3,
    /// Height derivatives in model units a uv unit; for `bump-printed` the first holds half the grey difference.
    pub(super) dh_du: Column,
    pub(super) dh_dv: Column,
    /// Base colour texture times vertex colour.
    pub(super) tint: Column3,
    pub(super) alpha: Column,
    pub(super) metallic: Column,
    pub(super) roughness: Column,
    pub(super) occlusion: Column,
    pub(super) emissive: Column3,
    /// Strength of a dielectric's reflection, and the colour that its F0 is multiplied by.
    pub(super) specular: Column,
    pub(super) specular_color: Column3,
    /// The sum of `curvature` and `normal_variance`.
    pub(super) variance: Column,
    pub(super) layers: Layers,
    /// Unit: the normal before any map, on the side that `n` is on.
    pub(super) smooth: Column3,
    /// Squared slope that a map adds, for the softened terminator.
    pub(super) bump: Column,
    /// Directional albedos of the lobe: scale, bias, edge, diffuse edge; valid once they were looked up.
    pub(super) dfg: Quads,
    /// `true` where light that scatters several times is added.
    pub(super) compensated: bool,
    pub(super) environment_radiance: EnvironmentRadiance,
    pub(super) lookup_directions: LookupDirections,
    pub(super) environment_lookup: EnvironmentLookup,
    /// Unit to viewer, world space.
    pub(super) v: Column3,
    /// The shading normal: unit but for `bump-printed`.
    pub(super) n: Column3,
    /// Base colour with its factor.
    pub(super) albedo: Column3,
    /// The radiance that leaves towards the viewer, linear RGB.
    pub(super) radiance: Column3,
    /// The visibility of each light: 1 where it is seen and 0 where it is not.
    pub(super) visibility: Vec<Column>,
}

/// The layers over or in the surface; filled where the material has them.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    pub coat: Column,
    pub coat_roughness: Column,
    /// The stored vector of the clearcoat's normal map.
    pub coat_map: Column3,
    /// The clearcoat's normal: unit, world space.
    pub coat_n: Column3,
    pub coat_albedo: Column,
    pub sheen_color: Column3,
    pub sheen_roughness: Column,
    pub sheen_albedo: Column,
    /// The strength of anisotropy.
    pub anisotropy: Column,
    /// Cosine and sine of the angle of anisotropy from the tangent.
    pub anisotropy_turn: [Column; 2],
    /// The direction of anisotropy: unit, world space.
    pub anisotropy_direction: Column3,
}

/// The light of the environment at a fragment, linear RGB.
#[derive(Debug, Clone)]
pub(super) struct EnvironmentRadiance {
    /// The radiance that the highlight gathers.
    pub specular: Column3,
    /// The irradiance over π.
    pub mean: Column3,
    /// The radiance that the clearcoat's highlight gathers.
    pub coat: Column3,
}

impl Batch {
    pub(super) fn new(lights: usize) -> Box<Self> {
        Box::new(Self {
            len: 0,
            runs: Vec::new(),
            place: [ZERO; 2],
            weights: ZERO3,
            d_x: ZERO3,
            d_y: ZERO3,
            corners: VertexAttributes::ZERO,
            uv_sets: Vec::new(),
            color: [ZERO; 4],
            curvature: ZERO,
            normal_variance: ZERO,
            lookups: Lookups::default(),
            constants_of: None,
            spare: [ZERO; 3],
            position: ZERO3,
            n_geom: ZERO3,
            normal: ZERO3,
            tangent: ZERO3,
            handedness: ZERO,
            facing: ZERO,
            both_sides: false,
            map: ZERO3,
            dp_du: ZERO3,
            dp_dv: ZERO3,
            dh_du: ZERO,
            dh_dv: ZERO,
            tint: ZERO3,
            alpha: ZERO,
            metallic: ZERO,
            roughness: ZERO,
            occlusion: ZERO,
            emissive: ZERO3,
            specular: ZERO,
            specular_color: ZERO3,
            variance: ZERO,
            layers: Layers {
                coat: ZERO,
                coat_roughness: ZERO,
                coat_map: ZERO3,
                coat_n: ZERO3,
                coat_albedo: ZERO,
                sheen_color: ZERO3,
                sheen_roughness: ZERO,
                sheen_albedo: ZERO,
                anisotropy: ZERO,
                anisotropy_turn: [ZERO; 2],
                anisotropy_direction: ZERO3,
            },
            smooth: ZERO3,
            bump: ZERO,
            dfg: Quads::ZERO,
            compensated: false,
            environment_radiance: EnvironmentRadiance { specular: ZERO3, mean: ZERO3, coat: ZERO3 },
            lookup_directions: LookupDirections::default(),
            environment_lookup: EnvironmentLookup::default(),
            v: ZERO3,
            n: ZERO3,
            albedo: ZERO3,
            radiance: ZERO3,
            visibility: vec![Column::ONE; lights],
        })
    }

    /// Begins with an image's tile: makes room for the visibility of so many lights, and forgets earlier materials.
    pub(super) fn begin(&mut self, lights: usize) {
        self.visibility.resize(lights, Column::ONE);
        self.constants_of = None;
    }

    /// Texture coordinates of an entry in the first set; zero where the mesh has none.
    pub(super) fn first_uv(&self, i: usize) -> [f32; 2] {
        self.uv_sets.first().map_or([0.0; 2], |set| [set.uv[0][i], set.uv[1][i]])
    }

    /// The number of fragments.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Says whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The entries that packs read: the fragments, up to the next multiple of the longest.
    pub(super) fn entries(&self) -> std::ops::Range<usize> {
        0..self.len.next_multiple_of(MOST_LANES)
    }

    /// The fragments from entry `i` on.
    #[inline(always)]
    pub(super) fn lanes<P: Pack>(&self, token: P::Token, i: usize) -> Lanes<'_, P> {
        Lanes { token, batch: self, i }
    }

    /// The first entries of the packs that hold the fragments.
    pub(super) fn packs<P: Pack>(&self) -> impl Iterator<Item = usize> + use<P> {
        (0..self.len).step_by(P::LANES)
    }
}

/// The fragments of a batch that a pack holds: those from entry `i` on.
pub(super) struct Lanes<'b, P: Pack> {
    pub token: P::Token,
    pub batch: &'b Batch,
    pub i: usize,
}

impl<P: Pack> Clone for Lanes<'_, P> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Pack> Copy for Lanes<'_, P> {}

impl<P: Pack> Lanes<'_, P> {
    /// The fragments' entries of a column.
    #[inline(always)]
    pub(super) fn load(&self, column: &Column) -> P {
        load(self.token, column, self.i)
    }

    #[inline(always)]
    pub(super) fn load3(&self, column: &Column3) -> Vec3<P> {
        load3(self.token, column, self.i)
    }

    #[inline(always)]
    pub(super) fn splat(&self, value: f32) -> P {
        P::splat(self.token, value)
    }

    #[inline(always)]
    pub(super) fn splat3(&self, value: Vec3) -> Vec3<P> {
        splat3(self.token, value)
    }

    /// The directional albedos of the fragments' lobe.
    #[inline(always)]
    pub(super) fn dfg(&self) -> Dfg<P> {
        let [scale, bias, edge, diffuse_edge] = P::load_pixels(self.token, &self.batch.dfg[self.i..]);
        Dfg { scale, bias, edge, diffuse_edge }
    }
}
