//! The reflectance formulas over tables of numbers, with derivatives.
//!
//! Each is the library's own, generic over the number type: `f32`, `f64`, or a dual number of either for derivatives.

use crate::arrays::{self, Table};
use crate::work;
use numpy::{Element, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;
use taotie_engine::math::{Dual, Lane, Vec3};
use taotie_engine::names::Named;
use taotie_engine::pixel::{MaterialPoint, MaterialUniforms, MaterialValues};
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric, f_f82, f_schlick, f_schlick_f90, f82_drop};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::microfacets::{
    alpha_from_roughness, alpha_from_shininess, d_beckmann, d_blinn, d_ggx, shininess_from_alpha,
};
use taotie_engine::shade::microfacets::{
    g_v_cavity, g1_schlick_ggx, k_for_environment, k_for_lights, v_schlick_ggx, v_smith_ggx,
};
use taotie_engine::shade::sheen::{d_charlie, v_neubelt};
use taotie_engine::shade::{Angles, Shading, coat_fresnel, reflect, specular_occlusion};

/// A formula by name.
enum Formula {
    /// On plain numbers.
    Named(String),
    /// On a material under a light, with the names of the columns after the fixed ones.
    Reflect(Shading, Vec<String>),
}

/// The fixed columns of [`Formula::Reflect`]: n, v, l, base colour, metallic, roughness, index.
const REFLECT_COLUMNS: usize = 15;

impl Formula {
    /// Parses `d_ggx` and the like, or `reflect ggx slope f0`.
    fn named(name: &str) -> PyResult<Self> {
        let mut words = name.split(' ');
        if words.next() != Some("reflect") {
            return Ok(Self::Named(name.to_owned()));
        }
        let shading = Shading::from_name(words.next().unwrap_or_default());
        let shading = shading.map_err(|error| Python::attach(|py| crate::error::exception(py, &error)))?;
        Ok(Self::Reflect(shading, words.map(str::to_owned).collect()))
    }

    /// Evaluates the formula for a row; `None` for an unknown name or number of columns.
    fn value<L: Lane>(&self, row: &[L]) -> Option<Value<L>> {
        match self {
            Self::Named(name) => {
                number(name, row).map(Value::Number).or_else(|| color(name, row).map(Value::Color))
            }
            Self::Reflect(shading, extra) => reflected(*shading, row, extra).map(Value::Color),
        }
    }
}

/// The result of a formula: a number or a colour.
enum Value<L> {
    Number(L),
    Color(Vec3<L>),
}

impl<L: Copy> Value<L> {
    fn numbers(self) -> Vec<L> {
        match self {
            Self::Number(number) => vec![number],
            Self::Color(color) => color.to_array().to_vec(),
        }
    }
}

/// Evaluates a formula with a scalar result.
fn number<L: Lane>(name: &str, row: &[L]) -> Option<L> {
    Some(match (name, row) {
        ("alpha_from_roughness", &[r]) => alpha_from_roughness(r),
        ("alpha_from_shininess", &[s]) => alpha_from_shininess(s),
        ("shininess_from_alpha", &[a]) => shininess_from_alpha(a),
        ("d_beckmann", &[h, s, m]) => d_beckmann(h, s, m),
        ("d_ggx", &[h, s, a]) => d_ggx(h, s, a),
        ("d_blinn", &[h, s]) => d_blinn(h, s),
        ("d_charlie", &[s, r]) => d_charlie(s, r),
        ("g_v_cavity", &[l, v, h, vh]) => g_v_cavity(l, v, h, vh),
        ("v_smith_ggx", &[l, v, a]) => v_smith_ggx(l, v, a),
        ("g1_schlick_ggx", &[c, k]) => g1_schlick_ggx(c, k),
        ("v_schlick_ggx", &[l, v, k]) => v_schlick_ggx(l, v, k),
        ("k_for_lights", &[r]) => k_for_lights(r),
        ("k_for_environment", &[r]) => k_for_environment(r),
        ("v_neubelt", &[l, v]) => v_neubelt(l, v),
        ("f_dielectric", &[c, eta]) => f_dielectric(c, eta),
        ("f_conductor", &[c, eta, k]) => f_conductor(c, eta, k),
        ("coat_fresnel", &[c]) => coat_fresnel(c),
        ("specular_occlusion", &[v, o, r]) => specular_occlusion(v, o, r),
        ("inverse_square", &[d2]) => inverse_square(d2),
        ("range_window", &[d2, range]) => range_window(d2, range),
        ("spot_cone", &[c, inner, outer]) => spot_cone(c, inner, outer),
        _ => return None,
    })
}

/// Evaluates a formula with a colour result.
fn color<L: Lane>(name: &str, row: &[L]) -> Option<Vec3<L>> {
    let vec = |at: usize| Some(Vec3::new(*row.get(at)?, *row.get(at + 1)?, *row.get(at + 2)?));
    Some(match (name, row.len()) {
        ("f_schlick", 4) => f_schlick(vec(0)?, row[3]),
        ("f_schlick_f90", 7) => f_schlick_f90(vec(0)?, vec(3)?, row[6]),
        ("f82_drop", 6) => f82_drop(vec(0)?, vec(3)?),
        ("f_f82", 8) => f_f82(vec(0)?, row[3], vec(4)?, row[7]),
        _ => return None,
    })
}

/// Returns outgoing radiance per unit of irradiance, single scattering. `extra` names additional columns, in order:
/// `f0`, `f82` with three columns each, `slope`, `shininess` with one each.
fn reflected<L: Lane>(shading: Shading, row: &[L], extra: &[String]) -> Option<Vec3<L>> {
    let vec = |at: usize| Some(Vec3::new(*row.get(at)?, *row.get(at + 1)?, *row.get(at + 2)?));
    let one = row.first()?.lit(1.0);
    let ratio = (*row.get(14)? - one) / (*row.get(14)? + one);
    let mut uniforms = MaterialUniforms { dielectric_f0: ratio * ratio, ..MaterialUniforms::white(one) };
    let mut at = REFLECT_COLUMNS;
    for name in extra {
        match name.as_str() {
            "f0" => uniforms.f0 = Some(vec(at)?),
            "f82" => uniforms.f82 = Some(vec(at)?),
            "slope" => uniforms.slope = Some(*row.get(at)?),
            "shininess" => uniforms.shininess = Some(*row.get(at)?),
            _ => return None,
        }
        at += if name.starts_with('f') { 3 } else { 1 };
    }
    let values =
        MaterialValues { tint: vec(9)?, metallic: row[12], roughness: row[13], ..MaterialValues::rough(one) };
    let point = MaterialPoint::new(shading, &uniforms, &values, None);
    Some(reflect(shading, &point.sample, &Angles::new(vec(0)?, vec(3)?, vec(6)?)))
}

/// Evaluates a formula for each row of a table: its values, `(rows, outputs)`, and their derivatives with respect to
/// the columns `by`, `(rows, outputs, columns)`.
#[pyfunction]
pub fn shade<'py>(
    py: Python<'py>,
    formula: &str,
    table: Table<'py>,
    by: Vec<usize>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
    let name = formula;
    let task = Task { formula: Formula::named(name)?, by };
    let computed = match table {
        Table::Single(rows) => of_rows(py, (rows.as_slice()?, rows.shape()), &task)?,
        Table::Double(rows) => of_rows(py, (rows.as_slice()?, rows.shape()), &task)?,
    };
    computed.ok_or_else(|| PyValueError::new_err(format!("unknown formula {name}, or wrong column count")))
}

/// A formula, and the columns to differentiate by.
struct Task {
    formula: Formula,
    by: Vec<usize>,
}

/// A pair of arrays.
type Arrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

fn of_rows<'py, L: Lane + Element + Default + Sync>(
    py: Python<'py>,
    (numbers, shape): (&[L], &[usize]),
    Task { formula, by }: &Task,
) -> PyResult<Option<Arrays<'py>>> {
    let (count, columns) = (shape[0], shape[1]);
    let rows: Vec<&[L]> = if columns == 0 { Vec::new() } else { numbers.chunks_exact(columns).collect() };
    let Some(probe) = formula.value(&vec![L::default(); columns.max(1)]) else { return Ok(None) };
    let outputs = probe.numbers().len();
    let (values, derivatives) = work::detached(py, || {
        let values = rows.par_iter().flat_map_iter(|row| value(formula, row)).collect::<Vec<L>>();
        let derivatives =
            rows.par_iter().flat_map_iter(|row| derivative(formula, row, by)).collect::<Vec<L>>();
        Ok((values, derivatives))
    })?;
    let values = arrays::array(py, values, &[count, outputs])?;
    Ok(Some((values, arrays::array(py, derivatives, &[count, outputs, by.len()])?)))
}

fn value<L: Lane>(formula: &Formula, row: &[L]) -> Vec<L> {
    formula.value(row).map_or_else(Vec::new, Value::numbers)
}

/// Returns the derivatives of each output with respect to each of the columns, grouped by output.
fn derivative<L: Lane>(formula: &Formula, row: &[L], by: &[usize]) -> Vec<L> {
    let along = |column: &usize| {
        let dual = |(i, number): (usize, &L)| match i == *column {
            true => Dual::<L, 1>::variable(*number, 0),
            false => Dual::constant(*number),
        };
        let row: Vec<_> = row.iter().enumerate().map(dual).collect();
        value(formula, &row).into_iter().map(|output| output.partials[0]).collect::<Vec<L>>()
    };
    let columns: Vec<Vec<L>> = by.iter().map(along).collect();
    let outputs = columns.first().map_or(0, Vec::len);
    (0..outputs)
        .flat_map(|output| columns.iter().map(move |column| column[output]).collect::<Vec<_>>())
        .collect()
}
