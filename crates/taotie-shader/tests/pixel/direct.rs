//! The stages as computed by `taotie_engine::pixel` itself, as the renderer runs them.

use crate::variants::Case;
use std::collections::BTreeMap;
use taotie_engine::math::{Lane, Vec3};
use taotie_engine::pixel::{
    Anisotropic, Coat, EnvironmentTexels, Frame, Geometry, Highlight, MappedNormal, MaterialPoint,
    MaterialUniforms, MaterialValues, Model, PassedLight, PointLayers, Sheen, SurfacePoint,
    anisotropy_direction, anisotropy_turn, coat_albedo, coat_highlight, coat_normal, highlight,
    is_cook_torrance, lobe_roughness, lobe_slope, occluded, sheen_albedo, takes_compensation,
    takes_roughness,
};
use taotie_engine::scene::Material;
use taotie_engine::shade::dfg::{Dfg, TablePosition};
use taotie_engine::shade::{
    AnisotropicLobe, Compensation, MaterialSample, SubPixelVariance, curvature_variance,
};
use taotie_engine::surface::SurfaceMethod;

/// The outputs of a stage by the names of fields; `result` if it returns no structure.
pub type Results<L> = BTreeMap<&'static str, Vec<L>>;

/// A stage of a case with the inputs of its recording. Inputs that the recording does not take must not matter.
pub struct Direct<'c, L> {
    pub case: &'c Case,
    pub numbers: &'c BTreeMap<&'static str, Vec<L>>,
    pub like: L,
}

fn flat<L: Lane>(vector: Vec3<L>) -> Vec<L> {
    vector.to_array().to_vec()
}

impl<L: Lane> Direct<'_, L> {
    fn lit(&self, value: f64) -> L {
        self.like.lit(value)
    }

    fn number(&self, path: &str) -> L {
        self.numbers.get(path).map_or(self.lit(0.37), |values| values[0])
    }

    fn vector(&self, path: &str) -> Vec3<L> {
        let Some(values) = self.numbers.get(path) else {
            return Vec3::new(self.lit(0.48), self.lit(0.6), self.lit(0.64));
        };
        Vec3::new(values[0], values[1], values[2])
    }

    fn material(&self) -> &Material {
        &self.case.material
    }

    /// The results of a stage.
    pub fn stage(&self, name: &str) -> Results<L> {
        let result = |vector: Vec3<L>| Results::from([("result", flat(vector))]);
        match name {
            "opacity" => Results::from([("result", vec![self.alpha()])]),
            "passed_light" => Results::from([("result", vec![self.passed_light()])]),
            "unlit_color" => result(self.tint().mul_elements(self.vector("u.base_color"))),
            "shading_frame" => self.shading_frame(),
            "material_values" => self.material_values(),
            "albedo_position" => self.albedo_position(),
            "coat_albedo_position" => self.position(self.vector("f.coat_n"), self.number("m.coat_roughness")),
            "sheen_albedo_position" => self.position(self.vector("f.n"), self.number("m.sheen_roughness")),
            "surface_point" => self.surface_point(),
            "highlight" => gathered(highlight(
                &self.point().frame,
                self.number("p.lobe_roughness"),
                self.anisotropic().as_ref(),
            )),
            "coat_highlight" => gathered(coat_highlight(
                self.vector("p.coat_n"),
                self.vector("p.v"),
                self.number("p.coat_roughness"),
            )),
            "reflect_environment" => {
                let light = EnvironmentTexels {
                    specular: self.vector("e.specular"),
                    mean: self.vector("e.mean"),
                    coat: self.vector("e.coat"),
                };
                result(self.point().reflect_environment(&light, &self.dfg("dfg")))
            }
            "own_radiance" => result(self.point().own(self.vector("ambient"))),
            "reflect_light" => result(self.point().reflect(self.vector("l"))),
            other => panic!("{other} has no counterpart here: add it"),
        }
    }

    fn geometry(&self) -> Geometry<L> {
        let tangents = self.case.options.tangents;
        let none = Vec3::splat(self.lit(0.0));
        Geometry {
            n_geom: self.vector("g.n_geom"),
            normal: self.vector("g.normal"),
            tangent: if tangents { self.vector("g.tangent") } else { none },
            handedness: if tangents { self.number("g.handedness") } else { self.lit(1.0) },
            facing: self.number("g.facing"),
            v: self.vector("g.v"),
        }
    }

    fn side(&self) -> L {
        let turns = self.material().double_sided || self.case.options.both_sides;
        if turns { self.number("g.facing") } else { self.lit(1.0) }
    }

    fn softened(&self) -> bool {
        let options = &self.case.options;
        let mapped = matches!(
            options.method,
            SurfaceMethod::Bump | SurfaceMethod::ObjectNormal | SurfaceMethod::TangentNormal
        );
        options.softened && mapped && !options.shading.is_printed()
    }

    fn matrix(&self) -> [Vec3<L>; 3] {
        ["u.normal_matrix_x", "u.normal_matrix_y", "u.normal_matrix_z"].map(|path| self.vector(path))
    }

    fn front_normal(&self, geometry: &Geometry<L>) -> Vec3<L> {
        match self.case.options.method {
            SurfaceMethod::Facet => geometry.facet(),
            SurfaceMethod::Smooth => geometry.smooth(),
            SurfaceMethod::Bump => {
                let factor = self.number("u.bump");
                let [u, v] = ["t.height_du", "t.height_dv"].map(|path| self.number(path) * factor);
                let dh = [
                    u * self.number("g.du_dx") + v * self.number("g.dv_dx"),
                    u * self.number("g.du_dy") + v * self.number("g.dv_dy"),
                ];
                geometry.bumped([self.vector("g.position_dx"), self.vector("g.position_dy")], dh)
            }
            SurfaceMethod::BumpPrinted => {
                let grey = self.number("t.height_du") * (self.lit(255.0) / self.number("g.height_width"));
                geometry.bumped_as_printed(self.number("u.bump"), grey, self.matrix())
            }
            SurfaceMethod::ObjectNormal => Geometry::object_mapped(self.vector("t.normal"), self.matrix()),
            SurfaceMethod::TangentNormal => geometry.tangent_mapped(self.mapped("t.normal", "u.normal")),
        }
    }

    fn mapped(&self, stored: &str, factors: &str) -> MappedNormal<L> {
        MappedNormal {
            stored: self.vector(stored),
            scale: self.number(&format!("{factors}_scale")),
            green: self.number(&format!("{factors}_green")),
        }
    }

    fn shading_frame(&self) -> Results<L> {
        let geometry = self.geometry();
        let frame = Frame::new(&geometry, self.front_normal(&geometry), self.side(), self.softened());
        let coat = self.material().clearcoat.as_ref();
        let map = coat.and_then(|coat| coat.normal).filter(|_| self.case.options.tangents);
        let coat_n = match map {
            Some(_) => {
                geometry.tangent_mapped(self.mapped("t.clearcoat_normal", "u.clearcoat_normal")) * self.side()
            }
            None => frame.smooth,
        };
        let own = [self.number("u.anisotropy_cos"), self.number("u.anisotropy_sin")];
        let texture = self.material().anisotropy.and_then(|anisotropy| anisotropy.texture);
        let turn = match texture {
            Some(_) => {
                anisotropy_turn(own, [self.number("t.anisotropy_red"), self.number("t.anisotropy_green")])
            }
            None => own,
        };
        Results::from([
            ("n", flat(frame.n)),
            ("n_smooth", flat(frame.smooth)),
            ("coat_n", flat(coat_normal(coat_n, &frame))),
            ("tangent", flat(anisotropy_direction(&geometry, frame.n, turn))),
        ])
    }

    fn scaled(&self, has_texture: bool, name: &str, texel: &str) -> L {
        let factor = self.number(&format!("u.{name}"));
        if has_texture { self.number(&format!("t.{texel}")) * factor } else { factor }
    }

    fn colored(&self, has_texture: bool, name: &str) -> Vec<L> {
        let factor = self.vector(&format!("u.{name}"));
        flat(if has_texture { self.vector(&format!("t.{name}")).mul_elements(factor) } else { factor })
    }

    fn tint(&self) -> Vec3<L> {
        let one = Vec3::splat(self.lit(1.0));
        let texel = match self.material().base_color_texture {
            Some(_) => self.vector("t.base_color"),
            None => one,
        };
        if self.case.options.vertex_color { texel.mul_elements(self.vector("t.color")) } else { texel }
    }

    fn alpha(&self) -> L {
        let alpha = self.scaled(self.material().base_color_texture.is_some(), "alpha", "alpha");
        if self.case.options.vertex_color { alpha * self.number("t.color_alpha") } else { alpha }
    }

    fn transmission(&self) -> L {
        let texture = self.material().transmission.and_then(|transmission| transmission.texture);
        self.scaled(texture.is_some(), "transmission", "transmission")
    }

    fn passed_light(&self) -> L {
        let material = self.material();
        let has_specular = material.specular.factor_texture.is_some();
        let passed = PassedLight {
            transmission: self.transmission(),
            metallic: self.scaled(material.metallic_roughness_texture.is_some(), "metallic", "metallic"),
            base_color: self.tint().mul_elements(self.vector("u.base_color")),
            f0: self.number("u.dielectric_f0") * self.scaled(has_specular, "specular", "specular"),
        };
        passed.share()
    }

    /// The variance within the pixel, including that of a normal map.
    fn hidden(&self, map: Option<(&str, &str)>) -> SubPixelVariance<L> {
        let options = &self.case.options;
        let aa = options.specular_aa && !options.shading.is_printed();
        let bends = aa && options.method != SurfaceMethod::Facet;
        let curvature = match bends {
            true => curvature_variance(self.vector("g.normal_dx"), self.vector("g.normal_dy")),
            false => self.lit(0.0),
        };
        let normal_variance = match map.filter(|_| aa) {
            Some((texel, scale)) => self.number(texel) * (self.number(scale) * self.number(scale)),
            None => self.lit(0.0),
        };
        SubPixelVariance { curvature, normal_variance }
    }

    fn material_values(&self) -> Results<L> {
        let (material, options) = (self.material(), &self.case.options);
        let is_mapped = matches!(options.method, SurfaceMethod::ObjectNormal | SurfaceMethod::TangentNormal);
        let hidden = self.hidden(is_mapped.then_some(("t.normal_variance", "u.normal_scale")));
        let packed = material.metallic_roughness_texture.is_some();
        let mut roughness = self.scaled(packed, "roughness", "roughness");
        if options.environment || takes_roughness(options.shading, material) {
            roughness = hidden.widened(roughness);
        }
        let occlusion = match material.occlusion_texture {
            Some(_) => occluded(self.number("t.occlusion"), self.number("u.occlusion_strength")),
            None => self.lit(1.0),
        };
        let specular = &material.specular;
        let mut results = Results::from([
            ("tint", flat(self.tint())),
            ("metallic", vec![self.scaled(packed, "metallic", "metallic")]),
            ("roughness", vec![roughness]),
            ("specular", vec![self.scaled(specular.factor_texture.is_some(), "specular", "specular")]),
            ("specular_color", self.colored(specular.color_texture.is_some(), "specular_color")),
            ("occlusion", vec![occlusion]),
            ("emissive", self.colored(material.emissive_texture.is_some(), "emissive")),
            ("variance", vec![hidden.variance()]),
            ("transmission", vec![self.transmission()]),
        ]);
        results.extend(self.layer_values());
        results
    }

    fn layer_values(&self) -> Results<L> {
        let material = self.material();
        let coat = material.clearcoat.as_ref();
        let map = coat.and_then(|coat| coat.normal);
        let hidden = self.hidden(map.map(|_| ("t.clearcoat_variance", "u.clearcoat_normal_scale")));
        let has = |texture: Option<_>| texture.is_some();
        let coated = has(coat.and_then(|coat| coat.factor_texture));
        let rough_coat = has(coat.and_then(|coat| coat.roughness_texture));
        let coat_roughness = self.scaled(rough_coat, "clearcoat_roughness", "clearcoat_roughness");
        let sheen_color = has(material.sheen.and_then(|sheen| sheen.color_texture));
        let sheen = has(material.sheen.and_then(|sheen| sheen.roughness_texture));
        let turned = has(material.anisotropy.and_then(|anisotropy| anisotropy.texture));
        Results::from([
            ("coat", vec![self.scaled(coated, "clearcoat", "clearcoat")]),
            ("coat_roughness", vec![hidden.widened(coat_roughness)]),
            ("sheen_color", self.colored(sheen_color, "sheen_color")),
            ("sheen_roughness", vec![self.scaled(sheen, "sheen_roughness", "sheen_roughness")]),
            ("anisotropy", vec![self.scaled(turned, "anisotropy", "anisotropy")]),
        ])
    }

    fn position(&self, n: Vec3<L>, roughness: L) -> Results<L> {
        placed(TablePosition::of_ggx(n.dot(self.vector("g.v")), roughness))
    }

    fn albedo_position(&self) -> Results<L> {
        let n_dot_v = self.vector("f.n").dot(self.vector("g.v"));
        if !is_cook_torrance(self.case.options.shading) {
            return self.position(self.vector("f.n"), self.number("m.roughness"));
        }
        let slope = lobe_slope(&self.uniforms(), &self.values());
        placed(TablePosition::of_cook_torrance(n_dot_v, slope))
    }

    fn uniforms(&self) -> MaterialUniforms<L> {
        let material = self.material();
        let classic = &material.classic;
        MaterialUniforms {
            base_color: self.vector("u.base_color"),
            f0: material.f0.map(|_| self.vector("u.f0")),
            f82: material.f82.map(|_| self.vector("u.f82")),
            dielectric_f0: self.number("u.dielectric_f0"),
            ambient: classic.ambient.map(|_| self.vector("u.k_ambient")),
            diffuse: classic.diffuse.map(|_| self.vector("u.k_diffuse")),
            specular: classic.specular.map(|_| self.vector("u.k_specular")),
            slope: classic.slope.map(|_| self.number("u.slope")),
            shininess: classic.shininess.map(|_| self.number("u.shininess")),
        }
    }

    fn values(&self) -> MaterialValues<L> {
        let (material, options) = (self.material(), &self.case.options);
        let one = self.lit(1.0);
        let tinted = material.base_color_texture.is_some() || options.vertex_color;
        let aa = options.specular_aa && !options.shading.is_printed();
        let flat = options.method == SurfaceMethod::Facet;
        MaterialValues {
            tint: if tinted { self.vector("m.tint") } else { Vec3::splat(one) },
            metallic: self.number("m.metallic"),
            roughness: self.number("m.roughness"),
            specular: self.number("m.specular"),
            specular_color: self.vector("m.specular_color"),
            occlusion: material.occlusion_texture.map_or(one, |_| self.number("m.occlusion")),
            emissive: self.vector("m.emissive"),
            variance: if aa && !flat { self.number("m.variance") } else { self.lit(0.0) },
        }
    }

    fn dfg(&self, name: &str) -> Dfg<L> {
        let [scale, bias, edge, diffuse_edge] =
            ["scale", "bias", "edge", "diffuse_edge"].map(|field| self.number(&format!("{name}.{field}")));
        Dfg { scale, bias, edge, diffuse_edge }
    }

    fn compensated(&self) -> bool {
        self.case.options.compensated && takes_compensation(self.case.options.shading)
    }

    fn surface_point(&self) -> Results<L> {
        let (shading, n) = (self.case.options.shading, self.vector("f.n"));
        let (uniforms, values) = (self.uniforms(), self.values());
        let dfg = self.compensated().then(|| self.dfg("dfg"));
        let mut point = MaterialPoint::new(shading, &uniforms, &values, dfg);
        if self.material().transmits() {
            point = point.transmitting(shading, self.number("m.transmission"));
        }
        let s = &point.sample;
        let mut results = Results::from([
            ("n", flat(n)),
            ("n_smooth", flat(self.vector("f.n_smooth"))),
            ("v", flat(self.vector("g.v"))),
            ("base_color", flat(s.base_color)),
            ("metallic", vec![s.metallic]),
            ("roughness", vec![s.roughness]),
            ("f0", flat(s.f0)),
            ("f90", vec![s.f90]),
            ("f82_drop", flat(s.f82_drop)),
            ("diffuse", flat(s.diffuse)),
            ("specular", flat(s.specular)),
            ("shininess", vec![s.shininess]),
            ("slope", vec![s.slope]),
            ("ambient", flat(point.ambient)),
            ("emissive", flat(point.emissive)),
            ("occlusion", vec![point.occlusion]),
            ("lobe_roughness", vec![lobe_roughness(shading, &uniforms, &values)]),
        ]);
        if let Some(compensation) = s.compensation {
            results.insert("gain", flat(compensation.gain));
            results.insert("transmitted", vec![compensation.transmitted]);
        }
        results.extend(self.point_layers(n));
        results
    }

    fn point_layers(&self, n: Vec3<L>) -> Results<L> {
        let tangent = self.vector("f.tangent");
        let strength = self.number("m.anisotropy");
        let lobe = AnisotropicLobe::new(tangent, n.cross(tangent), self.number("m.roughness"), strength);
        Results::from([
            ("tangent", flat(lobe.tangent)),
            ("bitangent", flat(lobe.bitangent)),
            ("along", vec![lobe.along]),
            ("across", vec![lobe.across]),
            ("anisotropy", vec![strength]),
            ("coat_n", flat(self.vector("f.coat_n"))),
            ("coat", vec![self.number("m.coat")]),
            ("coat_roughness", vec![self.number("m.coat_roughness")]),
            ("coat_albedo", vec![coat_albedo(&self.dfg("coat_dfg"))]),
            ("sheen_color", flat(self.vector("m.sheen_color"))),
            ("sheen_roughness", vec![self.number("m.sheen_roughness")]),
            ("sheen_albedo", vec![sheen_albedo(self.number("sheen_table"))]),
        ])
    }

    fn point(&self) -> SurfacePoint<L> {
        let shading = self.case.options.shading;
        let frame = Frame { n: self.vector("p.n"), smooth: self.vector("p.n_smooth"), v: self.vector("p.v") };
        let occlusion = self.material().occlusion_texture;
        let material = MaterialPoint {
            sample: self.sample(),
            ambient: self.vector("p.ambient"),
            emissive: self.vector("p.emissive"),
            occlusion: occlusion.map_or(self.lit(1.0), |_| self.number("p.occlusion")),
        };
        let layers = match Model::new(shading, self.material()).layered {
            true => self.layers(),
            false => PointLayers { anisotropic: None, coat: None, sheen: None },
        };
        SurfacePoint { shading, material, frame, layers }
    }

    fn sample(&self) -> MaterialSample<L> {
        let (material, shading) = (self.material(), self.case.options.shading);
        let (zero, one) = (self.lit(0.0), self.lit(1.0));
        let white = is_cook_torrance(shading) && material.classic.specular.is_none();
        MaterialSample {
            base_color: self.vector("p.base_color"),
            metallic: self.number("p.metallic"),
            roughness: self.number("p.roughness"),
            f0: self.vector("p.f0"),
            f90: if material.f0.is_some() { one } else { self.number("p.f90") },
            f82_drop: material.f82.map_or(Vec3::splat(zero), |_| self.vector("p.f82_drop")),
            diffuse: self.vector("p.diffuse"),
            specular: if white { Vec3::splat(one) } else { self.vector("p.specular") },
            shininess: self.number("p.shininess"),
            slope: self.number("p.slope"),
            compensation: self.compensated().then(|| Compensation {
                gain: self.vector("p.gain"),
                transmitted: self.number("p.transmitted"),
            }),
        }
    }

    fn layers(&self) -> PointLayers<L> {
        let material = self.material();
        PointLayers {
            anisotropic: material.anisotropy.map(|_| AnisotropicLobe {
                tangent: self.vector("p.tangent"),
                bitangent: self.vector("p.bitangent"),
                along: self.number("p.along"),
                across: self.number("p.across"),
            }),
            coat: material.clearcoat.as_ref().map(|_| Coat {
                n: self.vector("p.coat_n"),
                factor: self.number("p.coat"),
                roughness: self.number("p.coat_roughness"),
                albedo: self.number("p.coat_albedo"),
            }),
            sheen: material.sheen.map(|_| Sheen {
                color: self.vector("p.sheen_color"),
                roughness: self.number("p.sheen_roughness"),
                albedo: self.number("p.sheen_albedo"),
            }),
        }
    }

    fn anisotropic(&self) -> Option<Anisotropic<L>> {
        self.material().anisotropy.map(|_| Anisotropic {
            direction: self.vector("p.tangent"),
            strength: self.number("p.anisotropy"),
            roughness: self.number("p.roughness"),
        })
    }
}

fn placed<L: Lane>(at: TablePosition<L>) -> Results<L> {
    Results::from([("node", vec![at.node]), ("across", vec![at.across]), ("down", vec![at.down])])
}

fn gathered<L: Lane>(highlight: Highlight<L>) -> Results<L> {
    Results::from([("direction", flat(highlight.direction)), ("roughness", vec![highlight.roughness])])
}
