//! The radiance of points by the pixel program, in `f64` as the ground truth, and in `f32`.

use super::cases::Case;
use super::lighting::{Lighting, TURN};
use super::points::{OBJECT_NORMALS, Point, Points, WIDTH};
use taotie_engine::math::{Number, Vec3, scalar};
use taotie_engine::pixel::{
    AnisotropyInputs, CoatInputs, EnvironmentSource, Geometry, IncidentLight, LayerInputs, MappedNormal,
    MaterialUniforms, MaterialValues, NormalValues, PixelInputs, SheenInputs, anisotropy_turn,
    height_derivative, height_step, occluded,
};
use taotie_engine::scene::{Material, NormalMap, TextureRole};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::{SubPixelVariance, curvature_variance};
use taotie_engine::surface::SurfaceMethod;

/// Points of a surface under a kind of light.
#[derive(Clone, Copy)]
pub struct Scene<'s> {
    pub case: &'s Case,
    pub material: &'s Material,
    pub points: &'s Points,
    pub lighting: &'s Lighting,
    pub sky: &'s Environment,
}

/// A point of a scene, in one precision.
struct At<'s, L> {
    scene: Scene<'s>,
    at: usize,
    of: fn(f32) -> L,
}

impl Scene<'_> {
    /// Returns the radiance of point `at`, linear RGB.
    pub fn radiance<L: Number + From<f32>>(&self, at: usize) -> Vec3<L> {
        let point = At { scene: *self, at, of: <L as From<f32>>::from };
        point.inputs().radiance(&point.light())
    }
}

impl<L: Number> At<'_, L> {
    fn vector(&self, vector: Vec3) -> Vec3<L> {
        vector.map(self.of)
    }

    fn array(&self, [x, y, z]: [f32; 3]) -> Vec3<L> {
        self.vector(Vec3::new(x, y, z))
    }

    fn point(&self) -> Point {
        self.scene.points.point(self.at)
    }

    /// Returns the differences of a vertex value to the next points of the square in x and y.
    fn steps(&self, value: impl Fn(Point) -> Vec3) -> [Vec3<L>; 2] {
        let first = self.at - self.at % 2 - (self.at / WIDTH % 2) * WIDTH;
        let of = |at: usize| self.vector(value(self.scene.points.point(at)));
        [of(first + 1) - of(first), of(first + WIDTH) - of(first)]
    }

    fn texel(&self, role: TextureRole) -> [L; 4] {
        let object = role == TextureRole::Normal && self.scene.case.method == SurfaceMethod::ObjectNormal;
        let name = if object { OBJECT_NORMALS } else { role.name() };
        self.scene.points.textures[name][self.at].map(self.of)
    }

    fn color(&self, role: TextureRole) -> Vec3<L> {
        let [r, g, b, _] = self.texel(role);
        Vec3::new(r, g, b)
    }

    fn geometry(&self) -> Geometry<L> {
        let (point, [dx, dy]) = (self.point(), self.steps(|point| point.position));
        let one = (self.of)(1.0);
        let facet = dx.cross(dy).normalize_or(Vec3::new(one.lit(0.0), one.lit(0.0), one));
        let [x, y, z, w] = self.scene.lighting.eye;
        let eye = self.array([x, y, z]);
        let v = if w == 0.0 { eye } else { (eye - self.vector(point.position)).normalize_or(facet) };
        let away = facet.dot(v).lt(one.lit(0.0));
        Geometry {
            n_geom: Vec3::select(away, -facet, facet),
            normal: self.vector(point.normal),
            tangent: self.vector(point.tangent),
            handedness: (self.of)(point.handedness),
            facing: if point.front { one } else { -one },
            v,
        }
    }

    /// Returns the derivatives of the height by u and v.
    fn slopes(&self) -> [L; 2] {
        let Points { rows, textures, .. } = self.scene.points;
        let heights = &textures[TextureRole::Height.name()];
        let (x, y) = (self.at % WIDTH, self.at / WIDTH);
        let height = |x: usize, y: usize| (self.of)(heights[(y % rows) * WIDTH + x % WIDTH][0]);
        let step = |size: usize| height_step((self.of)(1.0), (self.of)(size as f32));
        let by_u = height_derivative(height(x + 1, y), height(x + WIDTH - 1, y), step(WIDTH));
        [by_u, height_derivative(height(x, y + 1), height(x, y + rows - 1), step(*rows))]
    }

    /// Returns the inputs of the surface method.
    fn normal(&self) -> NormalValues<L> {
        let (case, material) = (self.scene.case, self.scene.material);
        let factors = case.factors(material);
        let bump = (self.of)(factors.bump);
        let none = NormalValues {
            normal_matrix: factors.normal_matrix.map(|column| self.vector(column)),
            ..NormalValues::none(bump)
        };
        match case.method {
            SurfaceMethod::Facet | SurfaceMethod::Smooth => none,
            SurfaceMethod::Bump => {
                let [by_u, by_v] = self.slopes().map(|slope| slope * bump);
                let [dx, dy] = self.steps(|point| point.uv);
                let dh = [by_u * dx.x + by_v * dx.y, by_u * dy.x + by_v * dy.y];
                NormalValues { dp: self.steps(|point| point.position), dh, ..none }
            }
            SurfaceMethod::BumpPrinted => {
                let [by_u, _] = self.slopes();
                NormalValues { printed: [bump, by_u * (bump.lit(255.0) / bump.lit(WIDTH as f64))], ..none }
            }
            SurfaceMethod::ObjectNormal | SurfaceMethod::TangentNormal => {
                NormalValues { texel: self.mapped(TextureRole::Normal, material.normal), ..none }
            }
        }
    }

    fn mapped(&self, role: TextureRole, map: Option<NormalMap>) -> MappedNormal<L> {
        let green = map.map_or(1.0, |map| map.green.sign());
        MappedNormal {
            stored: self.color(role),
            scale: (self.of)(map.map_or(1.0, |map| map.scale)),
            green: (self.of)(green),
        }
    }

    /// Returns the variance within the pixel, including that of a normal map.
    fn hidden(&self, role: Option<TextureRole>, scale: f32) -> SubPixelVariance<L> {
        let (case, zero) = (self.scene.case, (self.of)(0.0));
        if case.shading.is_printed() {
            return SubPixelVariance { curvature: zero, normal_variance: zero };
        }
        let [dx, dy] = self.steps(|point| point.normal);
        let bends = case.method != SurfaceMethod::Facet;
        let scale = (self.of)(scale);
        SubPixelVariance {
            curvature: if bends { curvature_variance(dx, dy) } else { zero },
            normal_variance: role.map_or(zero, |role| self.texel(role)[3] * (scale * scale)),
        }
    }

    fn values(&self) -> MaterialValues<L> {
        let (case, material) = (self.scene.case, self.scene.material);
        let of = self.of;
        let is_mapped = matches!(case.method, SurfaceMethod::ObjectNormal | SurfaceMethod::TangentNormal);
        let scale = material.normal.map_or(1.0, |map| map.scale);
        let hidden = self.hidden(is_mapped.then_some(TextureRole::Normal), scale);
        let [occlusion, roughness, metallic, _] = self.texel(TextureRole::MetallicRoughness);
        let tint = self.color(TextureRole::BaseColor).mul_elements(self.vector(self.point().color));
        let specular_color = self.color(TextureRole::SpecularColor);
        let emitted = self.array(material.emissive);
        MaterialValues {
            tint,
            metallic: metallic * of(material.metallic),
            roughness: hidden.widened(roughness * of(material.roughness)),
            specular: self.texel(TextureRole::Specular)[3] * of(material.specular.factor),
            specular_color: specular_color.mul_elements(self.array(material.specular.color)),
            occlusion: occluded(occlusion, of(material.occlusion_strength)),
            emissive: self.color(TextureRole::Emissive).mul_elements(emitted),
            variance: hidden.variance(),
        }
    }

    fn layers(&self) -> LayerInputs<L> {
        let (material, of) = (self.scene.material, self.of);
        LayerInputs {
            clearcoat: material.clearcoat.as_ref().map(|coat| {
                let scale = coat.normal.map_or(1.0, |map| map.scale);
                let hidden = self.hidden(Some(TextureRole::ClearcoatNormal), scale);
                let roughness = self.texel(TextureRole::ClearcoatRoughness)[1] * of(coat.roughness);
                CoatInputs {
                    factor: self.texel(TextureRole::Clearcoat)[0] * of(coat.factor),
                    roughness: hidden.widened(roughness),
                    normal: Some(self.mapped(TextureRole::ClearcoatNormal, coat.normal)),
                }
            }),
            sheen: material.sheen.map(|sheen| SheenInputs {
                color: self.color(TextureRole::SheenColor).mul_elements(self.array(sheen.color)),
                roughness: self.texel(TextureRole::SheenRoughness)[3] * of(sheen.roughness),
            }),
            anisotropy: material.anisotropy.map(|anisotropy| {
                let [red, green, blue, _] = self.texel(TextureRole::Anisotropy);
                // In 32 bits, like files and uniforms.
                let angle = f64::from(anisotropy.rotation as f32);
                let own = [scalar::cos(angle) as f32, scalar::sin(angle) as f32].map(of);
                let turn = anisotropy_turn(own, [red, green]);
                AnisotropyInputs { turn, strength: blue * of(anisotropy.strength) }
            }),
        }
    }

    fn inputs(&self) -> PixelInputs<L> {
        let (case, material) = (self.scene.case, self.scene.material);
        let softened = case.method.is_mapped();
        PixelInputs {
            shading: case.shading,
            geometry: self.geometry(),
            method: case.method,
            normal: self.normal(),
            turns: true,
            softened: softened && !case.shading.is_printed(),
            compensated: true,
            uniforms: MaterialUniforms::new(material).map(self.of),
            values: self.values(),
            layers: self.layers(),
        }
    }

    fn light(&self) -> IncidentLight<'_, L> {
        let (lighting, position) = (self.scene.lighting, self.vector(self.point().position));
        let arriving = lighting.lights.iter().map(|light| light.map(self.of).incidence(position)).collect();
        let environment = EnvironmentSource {
            environment: self.scene.sky,
            turn: TURN.map(self.of),
            intensity: (self.of)(lighting.intensity),
        };
        IncidentLight { arriving, ambient: self.vector(lighting.ambient), environment: Some(environment) }
    }
}
