//! Gradients of the whole pixel program, compared with differences: all models, methods and layers, under lights and
//! a sky.

use crate::exact::Exact;
use crate::random::Random;
use crate::skies::equirect;
use std::array::from_fn;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::pixel::{
    AnisotropyInputs, CoatInputs, EnvironmentSource, Geometry, Gradient, Incidence, IncidentLight,
    LayerInputs, MappedNormal, MaterialUniforms, MaterialValues, NormalValues, PixelInputs, SheenInputs,
    Turn, is_cook_torrance,
};
use taotie_engine::shade::Shading;
use taotie_engine::shade::environment::Environment;
use taotie_engine::surface::SurfaceMethod;

/// Number of pixels for each model, method and set of layers.
const PIXELS: usize = 12;

/// The layers of a pixel by name.
const LAYERS: [(&str, [bool; 3]); 5] = [
    ("no layer", [false; 3]),
    ("clearcoat", [true, false, false]),
    ("sheen", [false, true, false]),
    ("anisotropy", [false, false, true]),
    ("all layers", [true; 3]),
];

/// A pixel with its light.
struct Pixel<'e> {
    inputs: PixelInputs<Exact>,
    light: IncidentLight<'e, Exact>,
}

/// A number on which radiance depends.
#[derive(Debug, Clone, Copy)]
enum Input {
    Roughness,
    BaseColor(usize),
    F0(usize),
    Normal(usize),
    ShadingNormal(usize),
    Light(usize, usize),
}

fn moved(vector: &mut Vec3<Exact>, i: usize, by: f64) {
    let mut components = vector.to_array();
    components[i].0 += by;
    *vector = Vec3::from_array(components);
}

impl Pixel<'_> {
    /// All inputs by which radiance is differentiated.
    fn variables(&self) -> Vec<Input> {
        let lights =
            (0..self.light.arriving.len()).flat_map(|light| (0..3).map(move |i| Input::Light(light, i)));
        let of = |input: fn(usize) -> Input| (0..3).map(input);
        let vectors = of(Input::BaseColor)
            .chain(of(Input::F0))
            .chain(of(Input::Normal))
            .chain(of(Input::ShadingNormal));
        [Input::Roughness].into_iter().chain(vectors).chain(lights).collect()
    }

    /// Returns the radiance with an input increased by `by`.
    fn radiance(&self, input: Input, by: f64) -> [f64; 3] {
        let (mut inputs, mut light) = (self.inputs, self.light.clone());
        match input {
            Input::Roughness => inputs.values.roughness.0 += by,
            Input::BaseColor(i) => moved(&mut inputs.uniforms.base_color, i, by),
            Input::F0(i) => match &mut inputs.uniforms.f0 {
                Some(f0) => moved(f0, i, by),
                None => moved(&mut inputs.values.specular_color, i, by / inputs.uniforms.dielectric_f0.0),
            },
            Input::Normal(i) => match inputs.method {
                SurfaceMethod::Facet => moved(&mut inputs.geometry.n_geom, i, by),
                _ => moved(&mut inputs.geometry.normal, i, by),
            },
            Input::ShadingNormal(_) => {}
            Input::Light(number, i) => moved(&mut light.arriving[number].l, i, by),
        }
        let mut front = inputs.front_normal();
        if let Input::ShadingNormal(i) = input {
            moved(&mut front, i, by);
        }
        inputs.shaded(front).radiance(&light).map(|channel| channel.0).to_array()
    }

    /// Returns the derivative by an input from five points `step` apart.
    fn difference(&self, input: Input, step: f64) -> [f64; 3] {
        let at = |steps: f64| self.radiance(input, steps * step);
        let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(at);
        from_fn(|i| (far_below[i] - far_above[i] + 8.0 * (above[i] - below[i])) / (12.0 * step))
    }
}

fn derivative(gradient: &Gradient<Exact>, input: Input) -> [f64; 3] {
    let by = match input {
        Input::Roughness => gradient.roughness,
        Input::BaseColor(i) => gradient.base_color[i],
        Input::F0(i) => gradient.f0[i],
        Input::Normal(i) => gradient.normal[i],
        Input::ShadingNormal(i) => gradient.shading_normal[i],
        Input::Light(light, i) => gradient.lights[light][i],
    };
    by.map(|channel| channel.0).to_array()
}

/// Random pixels.
struct Maker<'e> {
    random: Random,
    sky: &'e Environment,
}

impl<'e> Maker<'e> {
    /// Returns a number within a material's ranges and away from their ends.
    fn number(&mut self) -> Exact {
        Exact(0.2 + 0.6 * self.random.next())
    }

    fn color(&mut self) -> Vec3<Exact> {
        Vec3::new(self.number(), self.number(), self.number())
    }

    fn unit(&mut self) -> Vec3<Exact> {
        self.random.unit().map(Exact)
    }

    /// Returns a unit vector not far from `n`.
    fn near(&mut self, n: Vec3<Exact>) -> Vec3<Exact> {
        (n + self.unit() * Exact(0.4)).normalize()
    }

    /// Returns a direction on the side of `n`.
    fn above(&mut self, n: Vec3<Exact>) -> Vec3<Exact> {
        let w = self.unit();
        if w.dot(n).0 < 0.0 { -w } else { w }
    }

    fn texel(&mut self) -> MappedNormal<Exact> {
        let half = |offset: f64| Exact(0.5 + 0.3 * (offset - 0.5));
        let stored = Vec3::new(half(self.random.next()), half(self.random.next()), Exact(0.95));
        MappedNormal { stored, scale: Exact(0.8), green: Exact(-1.0) }
    }

    fn geometry(&mut self) -> Geometry<Exact> {
        let n_geom = self.unit();
        Geometry {
            n_geom,
            normal: self.near(n_geom) * Exact(0.9),
            tangent: self.unit(),
            handedness: Exact(1.0),
            facing: Exact(if self.random.next() < 0.5 { -1.0 } else { 1.0 }),
            v: self.above(n_geom),
        }
    }

    /// The inputs that a method uses.
    fn normal(&mut self, method: SurfaceMethod, geometry: &Geometry<Exact>) -> NormalValues<Exact> {
        let normal_matrix = [self.unit(), self.unit(), self.unit()];
        let none = NormalValues::none(Exact(0.0));
        match method {
            SurfaceMethod::Facet | SurfaceMethod::Smooth => none,
            SurfaceMethod::Bump => {
                let dp = [self.unit(), self.unit()];
                NormalValues { dp, dh: [self.number() * Exact(0.4), self.number() * Exact(-0.3)], ..none }
            }
            SurfaceMethod::BumpPrinted => {
                NormalValues { printed: [Exact(2.0), self.number() * Exact(0.1)], normal_matrix, ..none }
            }
            SurfaceMethod::ObjectNormal => {
                let half = |component: Exact| Exact(0.5 + 0.5 * component.0);
                let stored = self.near(geometry.normal).map(half);
                NormalValues { texel: MappedNormal { stored, ..none.texel }, ..none }
            }
            SurfaceMethod::TangentNormal => NormalValues { texel: self.texel(), ..none },
        }
    }

    fn uniforms(&mut self, shading: Shading) -> MaterialUniforms<Exact> {
        let authored = self.random.next() < 0.5;
        MaterialUniforms {
            base_color: self.color(),
            f0: authored.then(|| self.color()),
            f82: authored.then(|| self.color()),
            dielectric_f0: Exact(0.06),
            ambient: None,
            diffuse: None,
            specular: Some(self.color()).filter(|_| authored && is_cook_torrance(shading)),
            slope: None,
            shininess: None,
        }
    }

    fn layers(&mut self, [coat, sheen, anisotropy]: [bool; 3]) -> LayerInputs<Exact> {
        let angle = self.random.next();
        LayerInputs {
            clearcoat: coat.then(|| CoatInputs {
                factor: self.number(),
                roughness: self.number(),
                normal: Some(self.texel()),
            }),
            sheen: sheen.then(|| SheenInputs { color: self.color(), roughness: self.number() }),
            anisotropy: anisotropy.then(|| AnisotropyInputs {
                turn: [taotie_engine::math::scalar::cos(angle), taotie_engine::math::scalar::sin(angle)]
                    .map(Exact),
                strength: self.number(),
            }),
        }
    }

    fn light(&mut self, n: Vec3<Exact>) -> IncidentLight<'e, Exact> {
        let mut arriving = || Incidence { l: self.above(n), irradiance: self.color() * Exact(3.0) };
        let arriving = vec![arriving(), arriving()];
        let turn = Turn { sin: Exact(0.6), cos: Exact(0.8) };
        let environment = EnvironmentSource { environment: self.sky, turn, intensity: Exact(0.7) };
        IncidentLight { arriving, ambient: self.color(), environment: Some(environment) }
    }

    fn pixel(&mut self, shading: Shading, method: SurfaceMethod, layers: [bool; 3]) -> Pixel<'e> {
        let geometry = self.geometry();
        let values = MaterialValues {
            tint: self.color(),
            metallic: self.number(),
            roughness: self.number(),
            specular: self.number(),
            specular_color: self.color(),
            occlusion: self.number(),
            emissive: self.color(),
            variance: Exact(0.01),
        };
        let inputs = PixelInputs {
            shading,
            method,
            normal: self.normal(method, &geometry),
            geometry,
            turns: false,
            softened: method != SurfaceMethod::Facet && method != SurfaceMethod::Smooth,
            compensated: true,
            uniforms: self.uniforms(shading),
            values,
            layers: self.layers(layers),
        };
        Pixel { inputs, light: self.light(geometry.n_geom) }
    }
}

/// The counts of derivatives: all, those at smooth points, and the nonzero ones among them.
#[derive(Debug, Default)]
struct Tally {
    all: usize,
    smooth: usize,
    nonzero: usize,
    largest: f64,
}

fn compare(pixel: &Pixel<'_>, name: &str, tally: &mut Tally) {
    let gradient = pixel.inputs.gradient(&pixel.light);
    let radiance = pixel.radiance(Input::Roughness, 0.0);
    assert_eq!(gradient.radiance.map(|channel| channel.0).to_array(), radiance, "{name}");
    for input in pixel.variables() {
        let found = derivative(&gradient, input);
        let [coarse, fine] = [2e-5, 1e-5].map(|step| pixel.difference(input, step));
        for i in 0..3 {
            let small = 1e-9 * (1.0 + radiance[i].abs());
            tally.all += 1;
            // A kink between the points: the difference itself depends on the step.
            if (coarse[i] - fine[i]).abs() > 1e-6 * fine[i].abs() + small {
                continue;
            }
            let error = (found[i] - fine[i]).abs();
            let inputs = &pixel.inputs;
            assert!(
                error <= 1e-5 * fine[i].abs() + small,
                "{name}, {input:?}, channel {i}: {}, {} of {inputs:?}",
                found[i],
                fine[i]
            );
            tally.smooth += 1;
            if fine[i].abs() > 1e-3 {
                tally.nonzero += 1;
                tally.largest = tally.largest.max(error / fine[i].abs());
            }
        }
    }
}

fn sky() -> Environment {
    let picture = equirect(64, |n| Vec3::new(1.0 + 0.5 * n.x, 1.0 + 0.3 * n.y, 1.2 - 0.4 * n.z));
    Environment::new(picture).expect("a valid environment")
}

#[test]
fn gradients_of_pixels_are_their_differences() {
    let sky = sky();
    let mut maker = Maker { random: Random(11), sky: &sky };
    for (model, shading) in Shading::NAMES.iter().copied() {
        for method in SurfaceMethod::ALL {
            let sets = if shading == Shading::Ggx { &LAYERS[..] } else { &LAYERS[..1] };
            for (layer, layers) in sets.iter().copied() {
                let (name, mut tally) = (format!("{model}, {}, {layer}", method.name()), Tally::default());
                for _ in 0..PIXELS {
                    compare(&maker.pixel(shading, method, layers), &name, &mut tally);
                }
                println!("{name}: {tally:?}");
                assert!(tally.smooth * 100 >= tally.all * 90, "{name}: {tally:?} are smooth");
                assert!(tally.nonzero * 4 >= tally.all, "{name}: too few nonzero: {tally:?}");
            }
        }
    }
}
