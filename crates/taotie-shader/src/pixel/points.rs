//! A point of the surface, the positions of its table lookups, and its reflection.

use super::inputs::Inputs;
use crate::recorder::{Callee, Recorded};
use crate::variant::Variant;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    EnvironmentTexels, Highlight, MaterialPoint, coat_albedo, coat_highlight, highlight, is_cook_torrance,
    lobe_roughness, lobe_slope, sheen_albedo,
};
use taotie_engine::shade::dfg::{Dfg, TablePosition};
use taotie_engine::shade::{Angles, AnisotropicLobe};

type Number<'g> = Recorded<'g>;
type Vector<'g> = Vec3<Recorded<'g>>;

/// The scalars of vectors, one after the other.
fn flat<'g, const N: usize>(vectors: [Vector<'g>; N]) -> Vec<Number<'g>> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

fn position(position: TablePosition<Number<'_>>) -> Vec<Number<'_>> {
    vec![position.node, position.across, position.down]
}

impl<'g> Inputs<'g, '_> {
    /// The position at which the lobe's table is read.
    pub(super) fn albedo_position(self) -> Vec<Number<'g>> {
        let n_dot_v = self.vector("f.n").dot(self.vector("g.v"));
        if is_cook_torrance(self.variant.shading) {
            let slope = lobe_slope(&self.uniforms(), &self.values());
            return position(TablePosition::of_cook_torrance(n_dot_v, slope));
        }
        position(TablePosition::of_ggx(n_dot_v, self.number("m.roughness")))
    }

    /// The position at which the clearcoat's table is read.
    pub(super) fn coat_position(self) -> Vec<Number<'g>> {
        let n_dot_v = self.vector("f.coat_n").dot(self.vector("g.v"));
        position(TablePosition::of_ggx(n_dot_v, self.number("m.coat_roughness")))
    }

    /// The position at which the sheen's table is read.
    pub(super) fn sheen_position(self) -> Vec<Number<'g>> {
        let n_dot_v = self.vector("f.n").dot(self.vector("g.v"));
        position(TablePosition::of_ggx(n_dot_v, self.number("m.sheen_roughness")))
    }

    fn dfg(self, paths: [&'static str; 4]) -> Dfg<Number<'g>> {
        let [scale, bias, edge, diffuse_edge] = paths.map(|path| self.number(path));
        Dfg { scale, bias, edge, diffuse_edge }
    }

    /// The directional albedos of the lobe.
    fn lobe_dfg(self) -> Dfg<Number<'g>> {
        self.dfg(["dfg.scale", "dfg.bias", "dfg.edge", "dfg.diffuse_edge"])
    }

    /// The point, in the order of the structure's fields.
    pub(super) fn surface_point(self) -> Vec<Number<'g>> {
        let variant = self.variant;
        let (frame, uniforms, values) = (self.frame(), self.uniforms(), self.values());
        let dfg = variant.compensated.then(|| self.lobe_dfg());
        let point = MaterialPoint::new(variant.shading, &uniforms, &values, dfg);
        let sample = &point.sample;
        let none = self.constant(0.0);
        let (gain, transmitted) =
            sample.compensation.map_or((Vec3::splat(none), none), |c| (c.gain, c.transmitted));
        let mut numbers = flat([frame.n, frame.smooth, frame.v, sample.base_color]);
        numbers.extend([sample.metallic, sample.roughness]);
        numbers.extend(sample.f0.to_array());
        numbers.push(sample.f90);
        numbers.extend(flat([sample.f82_drop, sample.diffuse, sample.specular]));
        numbers.extend([sample.shininess, sample.slope]);
        numbers.extend(gain.to_array());
        numbers.push(transmitted);
        numbers.extend(flat([point.ambient, point.emissive]));
        numbers.extend([point.occlusion, lobe_roughness(variant.shading, &uniforms, &values)]);
        numbers.extend(self.point_layers(frame.n));
        numbers
    }

    /// The layers of the point, in the order of the structure's fields.
    fn point_layers(self, n: Vector<'g>) -> Vec<Number<'g>> {
        let tangent = self.vector("f.tangent");
        let (roughness, strength) = (self.number("m.roughness"), self.number("m.anisotropy"));
        let lobe = AnisotropicLobe::new(tangent, n.cross(tangent), roughness, strength);
        let coat_dfg =
            self.dfg(["coat_dfg.scale", "coat_dfg.bias", "coat_dfg.edge", "coat_dfg.diffuse_edge"]);
        let mut numbers = flat([lobe.tangent, lobe.bitangent]);
        numbers.extend([lobe.along, lobe.across, strength]);
        numbers.extend(self.vector("f.coat_n").to_array());
        numbers.extend([self.number("m.coat"), self.number("m.coat_roughness"), coat_albedo(&coat_dfg)]);
        numbers.extend(self.vector("m.sheen_color").to_array());
        numbers.extend([self.number("m.sheen_roughness"), sheen_albedo(self.number("sheen_table"))]);
        numbers
    }

    /// The reflection of a light; angles are those of the function with this name in the program. Equivalent to
    /// `SurfacePoint::reflect`, but names the angles of the clearcoat after the base is recorded.
    pub(super) fn reflect_light(self, angles: &Callee<'_>) -> Vec<Number<'g>> {
        let (point, l) = (self.point(), self.vector("l"));
        let v = point.frame.v;
        self.name_angles(angles, [point.frame.n, v, l]);
        let reflected = point.reflect_base(l);
        let reflected = match &point.layers.coat {
            Some(coat) => {
                self.name_angles(angles, [coat.n, v, l]);
                coat.over(reflected, v, l)
            }
            None => reflected,
        };
        reflected.to_array().to_vec()
    }

    /// Makes the angles of these directions a call.
    fn name_angles(self, angles: &Callee<'_>, [n, v, l]: [Vector<'g>; 3]) {
        self.scope.calling(angles, &[n, v, l], || {
            let a = Angles::new(n, v, l);
            vec![a.n_dot_l, a.n_dot_v, a.n_dot_h, a.sin2_h, a.v_dot_h, a.r_dot_v]
        });
    }

    /// Emission, and reflection of the ambient light.
    pub(super) fn own(self) -> Vec<Number<'g>> {
        self.point().own(self.vector("ambient")).to_array().to_vec()
    }

    /// The highlight that gathers the environment's light.
    pub(super) fn highlight(self) -> Vec<Number<'g>> {
        let frame = self.point().frame;
        let roughness = self.number("p.lobe_roughness");
        gathered(highlight(&frame, roughness, self.anisotropic().as_ref()))
    }

    /// The clearcoat's highlight that gathers the environment's light.
    pub(super) fn coat_highlight(self) -> Vec<Number<'g>> {
        let coat = self.coat();
        gathered(coat_highlight(coat.n, self.vector("p.v"), coat.roughness))
    }

    /// The reflection of the environment.
    pub(super) fn reflect_environment(self) -> Vec<Number<'g>> {
        let light = EnvironmentTexels {
            specular: self.vector("e.specular"),
            mean: self.vector("e.mean"),
            coat: self.vector("e.coat"),
        };
        self.point().reflect_environment(&light, &self.lobe_dfg()).to_array().to_vec()
    }

    /// The colour of an unlit surface.
    pub(super) fn unlit(self) -> Vec<Number<'g>> {
        self.tint().mul_elements(self.vector("u.base_color")).to_array().to_vec()
    }
}

fn gathered(highlight: Highlight<Number<'_>>) -> Vec<Number<'_>> {
    let mut numbers = highlight.direction.to_array().to_vec();
    numbers.push(highlight.roughness);
    numbers
}

/// Returns true if the model supports a clearcoat that the material has.
pub(super) fn has_coat(variant: &Variant) -> bool {
    variant.layers.taken && variant.layers.clearcoat
}
