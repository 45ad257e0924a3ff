//! A few hundred fragments in columns, so that eight neighbours load as one pack.

use super::columns::{Column, Column3, Run, VertexAttributes, ZERO, ZERO3, load, load3, splat3};
use super::lookups::{Lookups, UvSet};
pub(super) use crate::math::BATCH;
use crate::math::{MOST_LANES, Pack, Quads, Vec3};
use crate::shade::dfg::Dfg;
use crate::shade::environment::{EnvironmentLookup, LookupDirections};

/// Fragments of one draw between interpolation and film, those of a triangle together. Each stage has separate
/// columns, which it fills for later stages. Entries from `len` onwards contain leftovers of packs, which only packs
/// read.
#[derive(Debug, Clone)]
pub struct Batch {
    pub(super) len: usize,
    pub(super) points: Points,
    pub(super) geometry: GeometryColumns,
    pub(super) texels: TexelColumns,
    pub(super) material: MaterialColumns,
    pub(super) layers: Layers,
    pub(super) frame: FrameColumns,
    pub(super) albedos: Albedos,
    pub(super) environment: EnvironmentColumns,
    pub(super) lit: Lit,
    /// `true` if the normal turns to a viewer behind the surface even if the material is single-sided.
    pub(super) both_sides: bool,
}

/// Points of triangles, and the values at their corners.
#[derive(Debug, Clone)]
pub(super) struct Points {
    pub runs: Vec<Run>,
    /// Screen positions, in pixels from the tile's corner; of the rasteriser's fragments.
    pub place: [Column; 2],
    /// Barycentric weights of the three corners, and their changes one sample to the right and one down.
    pub weights: Column3,
    pub d_x: Column3,
    pub d_y: Column3,
    pub corners: VertexAttributes,
    /// The uv sets of the mesh.
    pub uv_sets: Vec<UvSet>,
    /// Vertex colours, if the mesh has any.
    pub color: [Column; 4],
}

/// The columns of [`crate::pixel::Geometry`], and other interpolated values.
#[derive(Debug, Clone)]
pub(super) struct GeometryColumns {
    /// The position, in world space.
    pub position: Column3,
    pub n_geom: Column3,
    pub normal: Column3,
    pub tangent: Column3,
    pub handedness: Column,
    pub facing: Column,
    pub v: Column3,
    /// The derivatives of the position by the uv of a height map, in model units.
    pub dp_du: Column3,
    pub dp_dv: Column3,
    /// The variance within a pixel that the curvature of the smooth surface adds to α².
    pub curvature: Column,
}

/// The texels of normal and height maps, and scratch memory for reading textures.
#[derive(Debug, Clone)]
pub(super) struct TexelColumns {
    pub lookups: Lookups,
    /// Columns for the channels of textures that are not needed.
    pub spare: [Column; 3],
    /// The first triangle of the draw whose constants fill the columns without textures; none while the content is
    /// undefined.
    pub constants_of: Option<u32>,
    /// The stored vector of the normal map, each component in [0, 1].
    pub map: Column3,
    /// Height derivatives in model units per uv unit; for `bump-printed`, the first is half the grey difference.
    pub dh_du: Column,
    pub dh_dv: Column,
    /// The variance within a pixel that the normal map adds to α².
    pub normal_variance: Column,
}

/// The columns of [`crate::pixel::MaterialValues`], and alpha.
#[derive(Debug, Clone)]
pub(super) struct MaterialColumns {
    pub tint: Column3,
    pub alpha: Column,
    pub metallic: Column,
    pub roughness: Column,
    pub occlusion: Column,
    pub emissive: Column3,
    pub specular: Column,
    pub specular_color: Column3,
    /// The sum of the variances of curvature and normal map.
    pub variance: Column,
}

/// The columns of [`crate::pixel::Frame`].
#[derive(Debug, Clone)]
pub(super) struct FrameColumns {
    pub n: Column3,
    pub smooth: Column3,
}

/// The directional albedos of the lobe.
#[derive(Debug, Clone)]
pub(super) struct Albedos {
    /// Scale, bias, edge, diffuse edge; valid once they were looked up.
    pub dfg: Quads,
    /// `true` to add light that scatters several times.
    pub compensated: bool,
}

/// The columns of [`crate::pixel::EnvironmentTexels`], and their lookup positions.
#[derive(Debug, Clone)]
pub(super) struct EnvironmentColumns {
    pub radiance: EnvironmentRadiance,
    pub directions: LookupDirections,
    pub lookup: EnvironmentLookup,
}

/// The results of lighting.
#[derive(Debug, Clone)]
pub(super) struct Lit {
    /// Base colour times its factor.
    pub albedo: Column3,
    /// The radiance towards the viewer, linear RGB.
    pub radiance: Column3,
    /// The visibility of each light: 1 if it is visible, otherwise 0.
    pub visibility: Vec<Column>,
}

/// The layers over or in the surface; filled if the material has them.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    pub coat: Column,
    pub coat_roughness: Column,
    /// The stored vector of the clearcoat's normal map.
    pub coat_map: Column3,
    /// The clearcoat's normal: unit, in world space.
    pub coat_n: Column3,
    pub coat_albedo: Column,
    pub sheen_color: Column3,
    pub sheen_roughness: Column,
    pub sheen_albedo: Column,
    /// The strength of anisotropy.
    pub anisotropy: Column,
    /// Cosine and sine of the angle from the tangent to the direction of anisotropy.
    pub anisotropy_turn: [Column; 2],
    /// The direction of anisotropy: unit, in world space.
    pub anisotropy_direction: Column3,
}

/// The light of the environment at a fragment, linear RGB.
#[derive(Debug, Clone)]
pub(super) struct EnvironmentRadiance {
    /// The radiance gathered by the highlight.
    pub specular: Column3,
    /// The irradiance divided by π.
    pub mean: Column3,
    /// The radiance gathered by the clearcoat's highlight.
    pub coat: Column3,
}

impl Batch {
    pub(super) fn new(lights: usize) -> Box<Self> {
        Box::new(Self {
            len: 0,
            points: Points {
                runs: Vec::new(),
                place: [ZERO; 2],
                weights: ZERO3,
                d_x: ZERO3,
                d_y: ZERO3,
                corners: VertexAttributes::ZERO,
                uv_sets: Vec::new(),
                color: [ZERO; 4],
            },
            geometry: GeometryColumns {
                position: ZERO3,
                n_geom: ZERO3,
                normal: ZERO3,
                tangent: ZERO3,
                handedness: ZERO,
                facing: ZERO,
                v: ZERO3,
                dp_du: ZERO3,
                dp_dv: ZERO3,
                curvature: ZERO,
            },
            texels: TexelColumns {
                lookups: Lookups::default(),
                spare: [ZERO; 3],
                constants_of: None,
                map: ZERO3,
                dh_du: ZERO,
                dh_dv: ZERO,
                normal_variance: ZERO,
            },
            material: MaterialColumns {
                tint: ZERO3,
                alpha: ZERO,
                metallic: ZERO,
                roughness: ZERO,
                occlusion: ZERO,
                emissive: ZERO3,
                specular: ZERO,
                specular_color: ZERO3,
                variance: ZERO,
            },
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
            frame: FrameColumns { n: ZERO3, smooth: ZERO3 },
            albedos: Albedos { dfg: Quads::ZERO, compensated: false },
            environment: EnvironmentColumns {
                radiance: EnvironmentRadiance { specular: ZERO3, mean: ZERO3, coat: ZERO3 },
                directions: LookupDirections::default(),
                lookup: EnvironmentLookup::default(),
            },
            lit: Lit { albedo: ZERO3, radiance: ZERO3, visibility: vec![Column::ONE; lights] },
            both_sides: false,
        })
    }

    /// Prepares for a tile: allocates the visibility of `lights` lights, and forgets earlier materials.
    pub(super) fn begin(&mut self, lights: usize) {
        self.lit.visibility.resize(lights, Column::ONE);
        self.texels.constants_of = None;
    }

    /// Texture coordinates of an entry in the first set; zero if the mesh has none.
    pub(super) fn first_uv(&self, i: usize) -> [f32; 2] {
        self.points.uv_sets.first().map_or([0.0; 2], |set| [set.uv[0][i], set.uv[1][i]])
    }

    /// The number of fragments.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true if there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The entries read by packs: the fragments, up to the next multiple of the longest pack.
    pub(super) fn entries(&self) -> std::ops::Range<usize> {
        0..self.len.next_multiple_of(MOST_LANES)
    }

    /// The fragments from entry `i` onwards.
    #[inline(always)]
    pub(super) fn lanes<P: Pack>(&self, token: P::Token, i: usize) -> Lanes<'_, P> {
        Lanes { token, batch: self, i }
    }

    /// The first entries of the packs that contain the fragments.
    pub(super) fn packs<P: Pack>(&self) -> impl Iterator<Item = usize> + use<P> {
        (0..self.len).step_by(P::LANES)
    }
}

/// The fragments of a batch in one pack: those from entry `i` onwards.
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
        let [scale, bias, edge, diffuse_edge] = P::load_pixels(self.token, &self.batch.albedos.dfg[self.i..]);
        Dfg { scale, bias, edge, diffuse_edge }
    }
}
