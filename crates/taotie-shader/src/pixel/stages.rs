//! The stages of a variant's pixel, in the order in which they run, and what each of them computes.

use super::structures::Inputs;
use crate::graph::Graph;
use crate::program::{Formula, part};
use crate::recorder::{Callee, Recorded, record};
use crate::variant::{Alpha, Variant};
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{
    EnvironmentTexels, Frame, Geometry, Highlight, MappedNormal, MaterialPoint, NormalInputs, PassedLight,
    Texel, anisotropy_direction, anisotropy_turn, coat_albedo, coat_highlight, coat_normal, highlight,
    is_cook_torrance, lobe_roughness, lobe_slope, mapped_variance, occluded, sheen_albedo, takes_albedos,
};
use taotie_engine::shade::dfg::{Dfg, TablePosition};
use taotie_engine::shade::{Angles, AnisotropicLobe, SubPixelVariance, curvature_variance};

/// A recorded stage, and what it feeds.
pub(super) struct Stage {
    pub formula: Formula,
    pub feeds: Feeds,
}

/// The consumer of a stage's result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Feeds {
    /// The pixel's own colour or opacity.
    Pixel,
    /// Stages that take its structure.
    Structure,
    /// Stages that take this argument, or this field of one, which is looked up at the result of the stage.
    Path(&'static str),
}

/// The stages of a variant; `angles` is the index of that function.
pub(super) fn stages(variant: &Variant, angles: &Callee<'_>) -> Vec<Stage> {
    let mut stages = Vec::new();
    if variant.alpha != Alpha::Opaque {
        stages.push(stage(variant, ALPHA, |inputs| vec![inputs.alpha()]));
    }
    if variant.transmits {
        stages.push(stage(variant, PASSED, |inputs| inputs.passed_light()));
    }
    if variant.unlit {
        stages.push(stage(variant, UNLIT, |inputs| inputs.unlit()));
        return stages;
    }
    stages.push(stage(variant, FRAME, |inputs| inputs.shading_frame()));
    stages.push(stage(variant, VALUES, |inputs| inputs.material_values()));
    stages.extend(tables(variant));
    stages.push(stage(variant, POINT, |inputs| inputs.surface_point()));
    if variant.environment {
        stages.push(stage(variant, HIGHLIGHT, |inputs| inputs.highlight()));
        stages.extend(
            has_coat(variant).then(|| stage(variant, COAT_HIGHLIGHT, |inputs| inputs.coat_highlight())),
        );
        stages.push(stage(variant, ENVIRONMENT, |inputs| inputs.reflect_environment()));
    }
    stages.push(stage(variant, OWN, |inputs| inputs.own()));
    let graph = record(|scope| Inputs { scope, variant }.reflect_light(angles));
    stages.push(of(LIGHT, graph));
    stages
}

/// The stages that compute lookup positions in tables.
fn tables(variant: &Variant) -> Vec<Stage> {
    let mut tables = Vec::new();
    if takes_albedos(variant.shading) {
        tables.push(stage(variant, ALBEDO, |inputs| inputs.albedo_position()));
    }
    if has_coat(variant) {
        tables.push(stage(variant, COAT_ALBEDO, |inputs| inputs.coat_position()));
    }
    if variant.layers.taken && variant.layers.sheen {
        tables.push(stage(variant, SHEEN_ALBEDO, |inputs| inputs.sheen_position()));
    }
    tables
}

/// Returns true if the model supports a clearcoat that the material has.
fn has_coat(variant: &Variant) -> bool {
    variant.layers.taken && variant.layers.clearcoat
}

/// A stage's name, the name of its result, its structure, what it feeds, and its documentation.
#[derive(Clone, Copy)]
struct Title {
    name: &'static str,
    symbol: &'static str,
    structure: Option<&'static str>,
    feeds: Feeds,
    doc: &'static str,
}

fn stage(
    variant: &Variant,
    title: Title,
    run: impl for<'g> Fn(Inputs<'g, '_>) -> Vec<Recorded<'g>>,
) -> Stage {
    of(title, record(|scope| run(Inputs { scope, variant })))
}

fn of(title: Title, graph: Graph) -> Stage {
    let Title { name, symbol, structure, feeds, doc } = title;
    Stage { formula: Formula { structure, ..part(name, symbol, doc, graph) }, feeds }
}

const ALPHA: Title = Title {
    name: "opacity",
    symbol: "alpha",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Opacity, [0, 1]: factor, texture and vertex colour.",
};

const PASSED: Title = Title {
    name: "passed_light",
    symbol: "passed",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "The share of light from behind that passes through a thin surface, at most 0.99.
Source: KHR_materials_transmission.",
};

const UNLIT: Title = Title {
    name: "unlit_color",
    symbol: "color",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "The colour of an unlit surface, linear RGB.
Source: KHR_materials_unlit.",
};

const FRAME: Title = Title {
    name: "shading_frame",
    symbol: "f",
    structure: Some("ShadingFrame"),
    feeds: Feeds::Structure,
    doc: "The shading normal, by the method of the surface, and the other directions at a point.
Source: Mikkelsen 2008 and 2020.",
};

const VALUES: Title = Title {
    name: "material_values",
    symbol: "m",
    structure: Some("MaterialValues"),
    feeds: Feeds::Structure,
    doc: "The values of the material: textures times factors, roughness widened by subpixel detail.
Source: glTF 2.0, §3.9; Tokuyoshi and Kaplanyan 2019; Toksvig 2005.",
};

const ALBEDO: Title = Title {
    name: "albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("dfg"),
    doc: "The position at which the table of the lobe's directional albedos is sampled.",
};

const COAT_ALBEDO: Title = Title {
    name: "coat_albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("coat_dfg"),
    doc: "The position at which the table of GGX is sampled for the clearcoat.",
};

const SHEEN_ALBEDO: Title = Title {
    name: "sheen_albedo_position",
    symbol: "q",
    structure: Some("TablePosition"),
    feeds: Feeds::Path("sheen_table"),
    doc: "The position at which the sheen's table is sampled.",
};

const POINT: Title = Title {
    name: "surface_point",
    symbol: "p",
    structure: Some("SurfacePoint"),
    feeds: Feeds::Structure,
    doc: "Everything that reflection depends on.
Source: glTF 2.0, appendix B; KHR_materials_ior; KHR_materials_specular; Turquin 2019 for compensation.",
};

const HIGHLIGHT: Title = Title {
    name: "highlight",
    symbol: "highlight",
    structure: Some("Highlight"),
    feeds: Feeds::Path("e.specular"),
    doc: "The highlight of the base that gathers the environment's light.
Source: McAuley 2015, \"Rendering the World of Far Cry 4\", for anisotropy.",
};

const COAT_HIGHLIGHT: Title = Title {
    name: "coat_highlight",
    symbol: "highlight",
    structure: Some("Highlight"),
    feeds: Feeds::Path("e.coat"),
    doc: "The highlight of the clearcoat that gathers the environment's light.",
};

const ENVIRONMENT: Title = Title {
    name: "reflect_environment",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Radiance to the viewer from the environment, linear RGB.
Source: Karis 2013, \"Real Shading in Unreal Engine 4\", the split sum; Lagarde and de Rousiers 2014 for occlusion.",
};

const OWN: Title = Title {
    name: "own_radiance",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Emission and reflection of the `ambient` light, linear RGB.",
};

const LIGHT: Title = Title {
    name: "reflect_light",
    symbol: "radiance",
    structure: None,
    feeds: Feeds::Pixel,
    doc: "Radiance to the viewer per unit of irradiance on a plane facing the light in direction `l` (unit, world
space), linear RGB: f · n·l.",
};

type Number<'g> = Recorded<'g>;
type Vector<'g> = Vec3<Recorded<'g>>;

/// The shading frame of a point, by the method of its normals.
impl<'g> Inputs<'g, '_> {
    /// The directions, in the order of the structure's fields.
    fn shading_frame(self) -> Vec<Number<'g>> {
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
        if !(self.has(Texel::ClearcoatNormal) && self.variant.tangents) {
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
        match self.has(Texel::AnisotropyRed) {
            true => {
                anisotropy_turn(own, [Texel::AnisotropyRed, Texel::AnisotropyGreen].map(|t| self.texel_of(t)))
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

/// The values of a material at a point: textures times factors, widened by subpixel detail.
impl<'g> Inputs<'g, '_> {
    fn has(self, texel: Texel) -> bool {
        let role = texel.role(self.variant.packed_occlusion);
        role.is_some_and(|role| self.variant.textures.contains_key(&role))
    }

    fn texel_of(self, texel: Texel) -> Number<'g> {
        self.number(texel.parameters()[0])
    }

    /// A texel times its factor; only the factor if there is no texture.
    fn scaled(self, texel: Texel) -> Number<'g> {
        let [value, factor] = texel.parameters();
        match self.has(texel) {
            true => self.number(value) * self.number(factor),
            false => self.number(factor),
        }
    }

    /// A colour's texel times its factor; only the factor if there is no texture.
    fn colored(self, texel: Texel) -> Vector<'g> {
        let [value, factor] = texel.parameters();
        match self.has(texel) {
            true => self.vector(value).mul_elements(self.vector(factor)),
            false => self.vector(factor),
        }
    }

    /// Base colour texture times vertex colour.
    fn tint(self) -> Vector<'g> {
        let texel = self.vector_or(self.has(Texel::BaseColor), "t.base_color", 1.0);
        texel.mul_elements(self.vector_or(self.variant.vertex_color, "t.color", 1.0))
    }

    /// Opacity.
    fn alpha(self) -> Number<'g> {
        let alpha = self.scaled(Texel::Alpha);
        if self.variant.vertex_color { alpha * self.texel_of(Texel::ColorAlpha) } else { alpha }
    }

    /// The light that passes through a thin surface.
    fn passed_light(self) -> Vec<Number<'g>> {
        let passed = PassedLight {
            transmission: self.scaled(Texel::Transmission),
            metallic: self.scaled(Texel::Metallic),
            base_color: self.tint().mul_elements(self.vector("u.base_color")),
            f0: self.number("u.dielectric_f0") * self.scaled(Texel::Specular),
        };
        vec![passed.share()]
    }

    fn occlusion(self) -> Number<'g> {
        match self.has(Texel::Occlusion) {
            true => occluded(self.texel_of(Texel::Occlusion), self.number("u.occlusion_strength")),
            false => self.constant(1.0),
        }
    }

    fn curvature(self) -> Number<'g> {
        match self.variant.has_curvature() {
            true => curvature_variance(self.vector("g.normal_dx"), self.vector("g.normal_dy")),
            false => self.constant(0.0),
        }
    }

    /// The subpixel detail of the surface, with the variance of this normal map.
    fn hidden(self, map: Texel, scale: &'static str) -> SubPixelVariance<Number<'g>> {
        let normal_variance = match self.variant.specular_aa && self.has(map) {
            true => mapped_variance(self.texel_of(map), self.number(scale)),
            false => self.constant(0.0),
        };
        SubPixelVariance { curvature: self.curvature(), normal_variance }
    }

    /// All values, in the order of the structure's fields.
    fn material_values(self) -> Vec<Number<'g>> {
        let hidden = || self.hidden(Texel::NormalVariance, "u.normal_scale");
        let metallic = self.scaled(Texel::Metallic);
        let specular = self.scaled(Texel::Specular);
        let specular_color = self.colored(Texel::SpecularColor);
        let emissive = self.colored(Texel::Emissive);
        let sheen_color = self.colored(Texel::SheenColor);
        let sheen = self.scaled(Texel::SheenRoughness);
        let mut values = self.tint().to_array().to_vec();
        let roughness = self.scaled(Texel::Roughness);
        let roughness = if self.variant.widens { hidden().widened(roughness) } else { roughness };
        values.extend([metallic, roughness, specular]);
        values.extend(specular_color.to_array());
        values.push(self.occlusion());
        values.extend(emissive.to_array());
        values.push(hidden().variance());
        values.push(self.scaled(Texel::Clearcoat));
        let coat_roughness = self.scaled(Texel::ClearcoatRoughness);
        let in_coat = self.hidden(Texel::ClearcoatVariance, "u.clearcoat_normal_scale");
        values.push(in_coat.widened(coat_roughness));
        values.extend(sheen_color.to_array());
        values.push(sheen);
        values.push(self.scaled(Texel::Anisotropy));
        values.push(self.scaled(Texel::Transmission));
        values
    }
}

/// A point of the surface, the positions of its table lookups, and its reflection.
impl<'g> Inputs<'g, '_> {
    /// The position at which the lobe's table is read.
    fn albedo_position(self) -> Vec<Number<'g>> {
        let n_dot_v = self.vector("f.n").dot(self.vector("g.v"));
        if is_cook_torrance(self.variant.shading) {
            let slope = lobe_slope(&self.uniforms(), &self.values());
            return position(TablePosition::of_cook_torrance(n_dot_v, slope));
        }
        position(TablePosition::of_ggx(n_dot_v, self.number("m.roughness")))
    }

    /// The position at which the clearcoat's table is read.
    fn coat_position(self) -> Vec<Number<'g>> {
        let n_dot_v = self.vector("f.coat_n").dot(self.vector("g.v"));
        position(TablePosition::of_ggx(n_dot_v, self.number("m.coat_roughness")))
    }

    /// The position at which the sheen's table is read.
    fn sheen_position(self) -> Vec<Number<'g>> {
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
    fn surface_point(self) -> Vec<Number<'g>> {
        let variant = self.variant;
        let (frame, uniforms, values) = (self.frame(), self.uniforms(), self.values());
        let dfg = variant.compensated.then(|| self.lobe_dfg());
        let mut point = MaterialPoint::new(variant.shading, &uniforms, &values, dfg);
        if variant.transmits {
            point = point.transmitting(variant.shading, self.number("m.transmission"));
        }
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
    fn reflect_light(self, angles: &Callee<'_>) -> Vec<Number<'g>> {
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
    fn own(self) -> Vec<Number<'g>> {
        self.point().own(self.vector("ambient")).to_array().to_vec()
    }

    /// The highlight that gathers the environment's light.
    fn highlight(self) -> Vec<Number<'g>> {
        let frame = self.point().frame;
        let roughness = self.number("p.lobe_roughness");
        gathered(highlight(&frame, roughness, self.anisotropic().as_ref()))
    }

    /// The clearcoat's highlight that gathers the environment's light.
    fn coat_highlight(self) -> Vec<Number<'g>> {
        let coat = self.coat();
        gathered(coat_highlight(coat.n, self.vector("p.v"), coat.roughness))
    }

    /// The reflection of the environment.
    fn reflect_environment(self) -> Vec<Number<'g>> {
        let light = EnvironmentTexels {
            specular: self.vector("e.specular"),
            mean: self.vector("e.mean"),
            coat: self.vector("e.coat"),
        };
        self.point().reflect_environment(&light, &self.lobe_dfg()).to_array().to_vec()
    }

    /// The colour of an unlit surface.
    fn unlit(self) -> Vec<Number<'g>> {
        self.tint().mul_elements(self.vector("u.base_color")).to_array().to_vec()
    }
}

fn gathered(highlight: Highlight<Number<'_>>) -> Vec<Number<'_>> {
    let mut numbers = highlight.direction.to_array().to_vec();
    numbers.push(highlight.roughness);
    numbers
}

/// The scalars of vectors, one after the other.
fn flat<'g, const N: usize>(vectors: [Vector<'g>; N]) -> Vec<Number<'g>> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}

fn position(position: TablePosition<Number<'_>>) -> Vec<Number<'_>> {
    vec![position.node, position.across, position.down]
}
