//! The shading frame of a point, by the method of its normals.

use super::inputs::Inputs;
use crate::recorder::Recorded;
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    Frame, Geometry, MappedNormal, NormalInputs, anisotropy_direction, anisotropy_turn, coat_normal,
};
use taotie_engine::scene::TextureRole;

type Number<'g> = Recorded<'g>;
type Vector<'g> = Vec3<Recorded<'g>>;

impl<'g> Inputs<'g, '_> {
    /// The directions, in the order of the structure's fields.
    pub(super) fn shading_frame(self) -> Vec<Number<'g>> {
        let geometry = self.geometry();
        let frame = Frame::new(
            &geometry,
            geometry.front_normal(self.variant.method, &self),
            self.side(),
            self.variant.softened,
        );
        let coat_n = coat_normal(self.mapped_coat(&geometry, &frame), &frame);
        let tangent = anisotropy_direction(&geometry, frame.n, self.turn());
        let mut numbers: Vec<Number<'g>> = frame.n.to_array().to_vec();
        numbers.extend(frame.smooth.to_array());
        numbers.extend(coat_n.to_array());
        numbers.extend(tangent.to_array());
        numbers
    }

    /// The clearcoat's normal on the visible side, before it is turned towards the viewer.
    fn mapped_coat(self, geometry: &Geometry<Number<'g>>, frame: &Frame<Number<'g>>) -> Vector<'g> {
        let is_mapped = self.variant.textures.contains_key(&TextureRole::ClearcoatNormal);
        if !(is_mapped && self.variant.tangents) {
            return frame.smooth;
        }
        let map = MappedNormal {
            stored: self.vector("t.clearcoat_normal"),
            scale: self.number("u.clearcoat_normal_scale"),
            green: self.number("u.clearcoat_normal_green"),
        };
        geometry.tangent_mapped(map) * self.side()
    }

    /// Cosine and sine of the anisotropy angle.
    fn turn(self) -> [Number<'g>; 2] {
        let own = [self.number("u.anisotropy_cos"), self.number("u.anisotropy_sin")];
        match self.variant.textures.contains_key(&TextureRole::Anisotropy) {
            true => {
                anisotropy_turn(own, [self.number("t.anisotropy_red"), self.number("t.anisotropy_green")])
            }
            false => own,
        }
    }
}

impl<'g> NormalInputs<Number<'g>> for Inputs<'g, '_> {
    /// The gradient of a height map is a gradient on the surface, for any two parameters: here the steps to the next
    /// samples, since a shader does not see the triangle.
    fn bump(&self) -> ([Vector<'g>; 2], [Number<'g>; 2]) {
        let factor = self.number("u.bump");
        let (by_u, by_v) = (self.number("t.height_du") * factor, self.number("t.height_dv") * factor);
        let along = |du, dv| by_u * self.number(du) + by_v * self.number(dv);
        let dh = [along("g.du_dx", "g.dv_dx"), along("g.du_dy", "g.dv_dy")];
        ([self.vector("g.position_dx"), self.vector("g.position_dy")], dh)
    }

    fn printed_bump(&self) -> [Number<'g>; 2] {
        let grey = self.number("t.height_du") * (self.constant(255.0) / self.number("g.height_width"));
        [self.number("u.bump"), grey]
    }

    fn texel(&self) -> MappedNormal<Number<'g>> {
        MappedNormal {
            stored: self.vector("t.normal"),
            scale: self.number("u.normal_scale"),
            green: self.number("u.normal_green"),
        }
    }

    fn normal_matrix(&self) -> [Vector<'g>; 3] {
        ["u.normal_matrix_x", "u.normal_matrix_y", "u.normal_matrix_z"].map(|path| self.vector(path))
    }
}
