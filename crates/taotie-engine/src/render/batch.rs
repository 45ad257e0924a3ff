//! A few hundred fragments in columns, so that eight neighbours load as one pack; and the columns: numbers and
//! vectors of a batch's fragments, and the values at the corners of each fragment's triangle.

use super::lookups::{Lookups, UvSet};
pub(super) use crate::math::{BATCH, Column};
use crate::math::{MOST_LANES, Pack, Quads, Vec3};
use crate::pixel::Texel;
use crate::shade::dfg::Dfg;
use crate::shade::environment::{EnvironmentLookup, LookupDirections};
use arrayvec::ArrayVec;
use std::slice::from_mut;

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
    pub spare: [Column; 4],
    /// The groups of [`texel_columns`] to fill in each batch of a draw: ranges of their indices.
    pub groups: ArrayVec<[usize; 2], TEXELS>,
    /// Roughness, and the clearcoat's, before subpixel detail widens them.
    pub roughness: [Column; 2],
    /// The first triangle of the draw whose constants fill the columns without textures; none while the content is
    /// undefined.
    pub constants_of: Option<u32>,
    /// The stored vector of the normal map, each component in [0, 1].
    pub map: Column3,
    /// Height derivatives in model units per uv unit; for `bump-printed`, the first is half the grey difference.
    pub dh_du: Column,
    pub dh_dv: Column,
    /// The variance of the normal map's vectors, if there is one.
    pub normal_variance: Column,
}

/// The columns of [`crate::pixel::MaterialValues`], alpha and transmission.
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
    /// The transmission, if the material has any.
    pub transmission: Column,
    /// The sum of the variances of curvature and normal map.
    pub variance: Column,
}

/// The number of texels that have columns.
pub(super) const TEXELS: usize = 18;

/// The columns that take the texels of materials, times their factors, those of a texture together.
#[inline]
pub(super) fn texel_columns<'b>(
    material: &'b mut MaterialColumns,
    layers: &'b mut Layers,
    [roughness, coat_roughness]: &'b mut [Column; 2],
) -> [(Texel, &'b mut [Column]); TEXELS] {
    let [red, green] = &mut layers.anisotropy_texel;
    [
        (Texel::BaseColor, &mut material.tint[..]),
        (Texel::Alpha, from_mut(&mut material.alpha)),
        (Texel::Emissive, &mut material.emissive[..]),
        (Texel::Metallic, from_mut(&mut material.metallic)),
        (Texel::Roughness, from_mut(roughness)),
        (Texel::Occlusion, from_mut(&mut material.occlusion)),
        (Texel::Specular, from_mut(&mut material.specular)),
        (Texel::SpecularColor, &mut material.specular_color[..]),
        (Texel::Clearcoat, from_mut(&mut layers.coat)),
        (Texel::ClearcoatRoughness, from_mut(coat_roughness)),
        (Texel::ClearcoatNormal, &mut layers.coat_map[..]),
        (Texel::ClearcoatVariance, from_mut(&mut layers.coat_variance)),
        (Texel::SheenColor, &mut layers.sheen_color[..]),
        (Texel::SheenRoughness, from_mut(&mut layers.sheen_roughness)),
        (Texel::Anisotropy, from_mut(&mut layers.anisotropy)),
        (Texel::AnisotropyRed, from_mut(red)),
        (Texel::AnisotropyGreen, from_mut(green)),
        (Texel::Transmission, from_mut(&mut material.transmission)),
    ]
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
    /// The variance of the vectors of that map, if there is one.
    pub coat_variance: Column,
    /// The clearcoat's normal: unit, in world space.
    pub coat_n: Column3,
    pub coat_albedo: Column,
    pub sheen_color: Column3,
    pub sheen_roughness: Column,
    pub sheen_albedo: Column,
    /// The strength of anisotropy.
    pub anisotropy: Column,
    /// Red and green of its texture, if there is one.
    pub anisotropy_texel: [Column; 2],
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
                spare: [ZERO; 4],
                groups: ArrayVec::new(),
                roughness: [ZERO; 2],
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
                transmission: ZERO,
                variance: ZERO,
            },
            layers: Layers {
                coat: ZERO,
                coat_roughness: ZERO,
                coat_map: ZERO3,
                coat_variance: ZERO,
                coat_n: ZERO3,
                coat_albedo: ZERO,
                sheen_color: ZERO3,
                sheen_roughness: ZERO,
                sheen_albedo: ZERO,
                anisotropy: ZERO,
                anisotropy_texel: [ZERO; 2],
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

/// A vector per fragment.
pub(super) type Column3 = [Column; 3];

pub(super) const ZERO: Column = Column::ZERO;
pub(super) const ZERO3: Column3 = [ZERO; 3];

#[inline(always)]
pub(super) fn set3(column: &mut Column3, i: usize, value: Vec3) {
    column[0][i] = value.x;
    column[1][i] = value.y;
    column[2][i] = value.z;
}

#[inline(always)]
pub(super) fn get3(column: &Column3, i: usize) -> Vec3 {
    Vec3::new(column[0][i], column[1][i], column[2][i])
}

#[inline(always)]
pub(super) fn load<P: Pack>(token: P::Token, column: &Column, i: usize) -> P {
    P::load(token, &column[i..])
}

#[inline(always)]
pub(super) fn load3<P: Pack>(token: P::Token, column: &Column3, i: usize) -> Vec3<P> {
    Vec3::new(load(token, &column[0], i), load(token, &column[1], i), load(token, &column[2], i))
}

#[inline(always)]
pub(super) fn store3<P: Pack>(value: Vec3<P>, column: &mut Column3, i: usize) {
    value.x.store(&mut column[0][i..]);
    value.y.store(&mut column[1][i..]);
    value.z.store(&mut column[2][i..]);
}

#[inline(always)]
pub(super) fn splat3<P: Pack>(token: P::Token, value: Vec3) -> Vec3<P> {
    Vec3::new(P::splat(token, value.x), P::splat(token, value.y), P::splat(token, value.z))
}

/// The fragments of one triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// The triangle's index over all draws.
    pub triangle: u32,
    pub start: usize,
    pub end: usize,
}

/// The maximum number of fragments that are written one by one, which is faster than a pack that crosses cache lines.
const SHORT: usize = 2;

/// Up to four numbers of each corner, side by side with the fragments of a batch.
///
/// Triangles may be smaller than a pixel. Written out per fragment, the values of their corners can be weighted in
/// packs over all fragments, regardless of their triangles.
#[derive(Debug, Clone)]
pub(super) struct VertexAttributes([[Column; 4]; 3]);

impl VertexAttributes {
    pub(super) const ZERO: Self = Self([[Column::ZERO; 4]; 3]);

    /// Writes numbers of the three corners unchanged. Runs come in the order of their fragments, since the end of a
    /// pack may overwrite the next run.
    #[inline(always)]
    pub(super) fn write<P: Pack, const N: usize>(
        &mut self,
        token: P::Token,
        run: Run,
        numbers: [[f32; N]; 3],
    ) {
        let Run { start, end, .. } = run;
        if end - start <= SHORT {
            for (columns, numbers) in self.0.iter_mut().zip(&numbers) {
                for (column, number) in columns.iter_mut().zip(numbers) {
                    column[start..end].iter_mut().for_each(|value| *value = *number);
                }
            }
            return;
        }
        for i in (run.start..run.end).step_by(P::LANES) {
            for (columns, numbers) in self.0.iter_mut().zip(&numbers) {
                for (column, number) in columns.iter_mut().zip(numbers) {
                    P::splat(token, *number).store(&mut column[i..]);
                }
            }
        }
    }

    /// Writes the first corner's numbers and their differences to the others: two weights then suffice, and a value
    /// that is equal at all corners stays exact.
    #[inline(always)]
    pub(super) fn write_differences<P: Pack, const N: usize>(
        &mut self,
        token: P::Token,
        run: Run,
        [first, mut second, mut third]: [[f32; N]; 3],
    ) {
        for n in 0..N {
            second[n] -= first[n];
            third[n] -= first[n];
        }
        self.write::<P, N>(token, run, [first, second, third]);
    }

    /// A number as written, at the fragments from `i` onwards.
    #[inline(always)]
    pub(super) fn written<P: Pack>(&self, token: P::Token, corner: usize, n: usize, i: usize) -> P {
        load(token, &self.0[corner][n], i)
    }

    /// The first three numbers as written.
    #[inline(always)]
    pub(super) fn written3<P: Pack>(&self, token: P::Token, corner: usize, i: usize) -> Vec3<P> {
        let [x, y, z, _] = &self.0[corner];
        Vec3::new(load(token, x, i), load(token, y, i), load(token, z, i))
    }

    /// A number written by [`Self::write_differences`], for these weights of the corners.
    #[inline(always)]
    pub(super) fn at<P: Pack>(&self, token: P::Token, weights: &Column3, n: usize, i: usize) -> P {
        self.written::<P>(token, 0, n, i) + self.change(token, weights, n, i)
    }

    /// Returns the change of the number for these changes of the weights.
    #[inline(always)]
    pub(super) fn change<P: Pack>(&self, token: P::Token, weights: &Column3, n: usize, i: usize) -> P {
        let (second, third): (P, P) = (load(token, &weights[1], i), load(token, &weights[2], i));
        self.written::<P>(token, 1, n, i) * second + self.written::<P>(token, 2, n, i) * third
    }

    /// The first three numbers written by [`Self::write_differences`], for these weights of the corners.
    #[inline(always)]
    pub(super) fn at3<P: Pack>(&self, token: P::Token, weights: &Column3, i: usize) -> Vec3<P> {
        let (x, y) = (self.at(token, weights, 0, i), self.at(token, weights, 1, i));
        Vec3::new(x, y, self.at(token, weights, 2, i))
    }

    /// Returns the change of the numbers for these changes of the weights.
    #[inline(always)]
    pub(super) fn change3<P: Pack>(&self, token: P::Token, weights: &Column3, i: usize) -> Vec3<P> {
        let (x, y) = (self.change(token, weights, 0, i), self.change(token, weights, 1, i));
        Vec3::new(x, y, self.change(token, weights, 2, i))
    }
}
