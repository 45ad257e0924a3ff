//! The inputs and outputs of formulas as sequences of numbers, and their bits.

use taotie_engine::math::{Lane, Vec3};
use taotie_engine::shade::dfg::Dfg;
use taotie_engine::shade::{Angles, AnisotropicLobe, MaterialSample};

/// Numbers that are taken one after the other.
pub struct Inputs<'x, L>(std::slice::Iter<'x, L>);

impl<'x, L: Lane> Inputs<'x, L> {
    pub fn of(numbers: &'x [L]) -> Self {
        Self(numbers.iter())
    }

    pub fn number(&mut self) -> L {
        *self.0.next().expect("there are enough numbers")
    }

    pub fn vector(&mut self) -> Vec3<L> {
        let [x, y, z] = [self.number(), self.number(), self.number()];
        Vec3::new(x, y, z)
    }

    pub fn angles(&mut self) -> Angles<L> {
        Angles {
            n_dot_l: self.number(),
            n_dot_v: self.number(),
            n_dot_h: self.number(),
            sin2_h: self.number(),
            v_dot_h: self.number(),
            r_dot_v: self.number(),
        }
    }

    pub fn material(&mut self) -> MaterialSample<L> {
        MaterialSample {
            base_color: self.vector(),
            metallic: self.number(),
            roughness: self.number(),
            f0: self.vector(),
            f90: self.number(),
            f82_drop: self.vector(),
            diffuse: self.vector(),
            specular: self.vector(),
            shininess: self.number(),
            slope: self.number(),
            compensation: None,
        }
    }

    pub fn dfg(&mut self) -> Dfg<L> {
        let [scale, bias, edge, diffuse_edge] = std::array::from_fn(|_| self.number());
        Dfg { scale, bias, edge, diffuse_edge }
    }

    pub fn anisotropic(&mut self) -> AnisotropicLobe<L> {
        let (tangent, bitangent) = (self.vector(), self.vector());
        AnisotropicLobe { tangent, bitangent, along: self.number(), across: self.number() }
    }
}

/// The numbers of the angles.
pub fn cosines<L: Lane>(a: &Angles<L>) -> [L; 6] {
    [a.n_dot_l, a.n_dot_v, a.n_dot_h, a.sin2_h, a.v_dot_h, a.r_dot_v]
}

/// The bits of numbers; single-precision numbers are widened, which is injective.
pub fn bits<L: Lane + Into<f64>>(numbers: &[L]) -> Vec<u64> {
    numbers.iter().map(|number| (*number).into().to_bits()).collect()
}
