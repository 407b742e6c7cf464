//! Problems that others publish with their programs: texts, and data made anew from closed forms or by Runge and Kutta.

use std::f64::consts::PI;

use crate::random::Random;
use crate::rk4::integrate;

/// A problem.
pub(super) struct Problem {
    /// Name of its text.
    pub(super) name: &'static str,
    /// The equation.
    pub(super) text: &'static str,
    /// Makes its data.
    pub(super) data: fn(&mut Random) -> Data,
}

/// Measurements and the truth behind them.
pub(super) struct Data {
    /// A table of the measurements: names of its columns, and its rows.
    pub(super) columns: &'static [&'static str],
    pub(super) rows: Vec<Vec<f64>>,
    /// What is sought.
    pub(super) truth: Truth,
}

/// What is sought.
pub(super) enum Truth {
    /// A source by its name, at points.
    Source(&'static str, Vec<Vec<f64>>, Vec<f64>),
    /// Learned parameters.
    Parameters(Vec<(&'static str, f64)>),
}

macro_rules! problem {
    ($name:literal, $data:expr) => {
        Problem { name: $name, text: include_str!(concat!("../../../examples/peers/", $name, ".pde")), data: $data }
    };
}

/// All of them.
pub(super) fn problems() -> [Problem; 11] {
    [
        problem!("elliptic", elliptic),
        problem!("rate", rate),
        problem!("brinkman", brinkman),
        problem!("diffusion", diffusion),
        problem!("lorenz", |_| lorenz(|_| 0.0)),
        problem!("forced_lorenz", |_| lorenz(|t| 10.0 * (2.0 * PI * t).sin())),
        problem!("reaction", reaction),
        problem!("navier_stokes", navier_stokes),
        problem!("poisson", poisson),
        problem!("wrong_poisson", poisson),
        problem!("heat", heat),
    ]
}

/// So many places from `low` to `high`.
fn line(low: f64, high: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()
}

/// DeepXDE, elliptic_inverse_field.
fn elliptic(_: &mut Random) -> Data {
    let rows = line(-1.0, 1.0, 100).into_iter().map(|x| vec![x, (PI * x).sin()]).collect();
    let places = line(-1.0, 1.0, 201);
    let values = places.iter().map(|x| -PI * PI * (PI * x).sin()).collect();
    let truth = Truth::Source("q", places.into_iter().map(|x| vec![x]).collect(), values);
    Data { columns: &["x", "u"], rows, truth }
}

/// DeepXDE, diffusion_reaction_rate: the field as a sum of two solutions from the left end, so that it is zero at the right.
fn rate(_: &mut Random) -> Data {
    let k = |x: f64| 0.1 + (-0.5 * ((x - 0.5) / 0.15).powi(2)).exp();
    let at = line(0.0, 1.0, 100);
    let solve = |load: f64, slope: f64| {
        let second = move |x: f64, u: f64| (load * (2.0 * PI * x).sin() + k(x) * u) / 0.01;
        integrate(|x, [u, v]| [v, second(x, u)], [0.0, slope], &at)
    };
    let (forced, free) = (solve(1.0, 0.0), solve(0.0, 1.0));
    let share = forced[99][0] / free[99][0];
    let rows = (0..100).map(|i| vec![at[i], forced[i][0] - share * free[i][0]]).collect();
    let places = line(0.0, 1.0, 201);
    let values = places.iter().map(|x| k(*x)).collect();
    let truth = Truth::Source("k", places.into_iter().map(|x| vec![x]).collect(), values);
    Data { columns: &["x", "u"], rows, truth }
}

/// DeepXDE, brinkman_forchheimer.
fn brinkman(_: &mut Random) -> Data {
    let [viscosity, permeability, nu, porosity] = [1e-3, 1e-3, 1e-3, 0.4_f64];
    let r = (nu * porosity / (viscosity * permeability)).sqrt();
    let u = |x: f64| permeability / nu * (1.0 - (r * (x - 0.5)).cosh() / (r / 2.0).cosh());
    let rows = line(0.0, 1.0, 7).into_iter().map(|x| vec![x, u(x)]).collect();
    Data { columns: &["x", "u"], rows, truth: Truth::Parameters(vec![("ve", viscosity), ("K", permeability)]) }
}

/// DeepXDE, diffusion_1d_inverse.
fn diffusion(_: &mut Random) -> Data {
    let at_the_end = |x: f64| vec![x, 1.0, (-1.0_f64).exp() * (PI * x).sin()];
    let rows = line(-1.0, 1.0, 10).into_iter().map(at_the_end).collect();
    Data { columns: &["x", "t", "u"], rows, truth: Truth::Parameters(vec![("C", 1.0)]) }
}

/// DeepXDE, Lorenz_inverse and Lorenz_inverse_forced, without their rounding.
fn lorenz(force: fn(f64) -> f64) -> Data {
    let coefficients = [10.0, 15.0, 8.0 / 3.0];
    let [a, b, c] = coefficients;
    let slope = |t: f64, [x, y, z]: [f64; 3]| [a * (y - x), x * (b - z) - y, x * y - c * z + force(t)];
    let times = line(0.0, 3.0, 25);
    let states = integrate(slope, [-8.0, 7.0, 27.0], &times);
    let rows = times.iter().zip(states).map(|(t, [x, y, z])| vec![*t, x, y, z]).collect();
    let truth = Truth::Parameters(["C1", "C2", "C3"].into_iter().zip(coefficients).collect());
    Data { columns: &["t", "x", "y", "z"], rows, truth }
}

/// Cells of the layer for its differences, and how many of them to a measurement.
const CELLS: usize = 400;
const EVERY: usize = 2;

/// DeepXDE, reaction_inverse: second differences along the layer, both concentrations at 201 x 201 places and times.
fn reaction(_: &mut Random) -> Data {
    let [rate, diffusivity] = [0.1, 2.0];
    let width = 1.0 / CELLS as f64;
    let at = |cell: usize| cell as f64 * width;
    // Of both substances what is between the ends, where they are held.
    const INSIDE: usize = CELLS - 1;
    let whole = |state: &[f64; 2 * INSIDE], substance: usize, cell: usize| match cell {
        0 | CELLS => 1.0 - at(cell),
        _ => state[substance * INSIDE + cell - 1],
    };
    let slope = |_: f64, state: [f64; 2 * INSIDE]| {
        std::array::from_fn(|index| {
            let (substance, cell) = (index / INSIDE, index % INSIDE + 1);
            let [left, own, right] = [cell - 1, cell, cell + 1].map(|cell| whole(&state, substance, cell));
            let reacts = rate * state[cell - 1] * state[INSIDE + cell - 1].powi(2);
            1e-3 * diffusivity * (left - 2.0 * own + right) / (width * width) - (1 + substance) as f64 * reacts
        })
    };
    let start = std::array::from_fn(|index| (-20.0 * at(index % INSIDE + 1)).exp());
    let times = line(0.0, 10.0, 201);
    let states = integrate(slope, start, &times);
    let row = |(time, cell): (usize, usize)| {
        let own = |substance| if time == 0 { (-20.0 * at(cell)).exp() } else { whole(&states[time], substance, cell) };
        vec![at(cell), times[time], own(0), own(1)]
    };
    let cells = || (0..=CELLS).step_by(EVERY);
    let rows = (0..times.len()).flat_map(|time| cells().map(move |cell| (time, cell))).map(row).collect();
    Data { columns: &["x", "t", "a", "b"], rows, truth: Truth::Parameters(vec![("kf", rate), ("D", diffusivity)]) }
}

/// DeepXDE, Navier_Stokes_inverse, with a vortex of Taylor and Green in a stream in place of its wake, for which there is a closed form.
fn navier_stokes(random: &mut Random) -> Data {
    let (stream, viscosity) = ([1.0, 0.5], 0.01);
    let row = |_| {
        let [x, y, t] = [PI * random.uniform(), PI * random.uniform(), random.uniform()];
        let (along, across) = (x - stream[0] * t, y - stream[1] * t);
        let left = (-2.0 * viscosity * t).exp();
        let u = stream[0] + left * along.sin() * across.cos();
        vec![x, y, t, u, stream[1] - left * along.cos() * across.sin()]
    };
    let rows = (0..7000).map(row).collect();
    Data { columns: &["x", "y", "t", "u", "v"], rows, truth: Truth::Parameters(vec![("C1", 1.0), ("C2", viscosity)]) }
}

/// PINNacle, PoissonInv, with the source that its solution has.
fn poisson(random: &mut Random) -> Data {
    let axis = line(0.0, 1.0, 50);
    let places = || axis.iter().flat_map(|x| axis.iter().map(move |y| [*x, *y]));
    let rows = places().map(|[x, y]| vec![x, y, (PI * x).sin() * (PI * y).sin() + 0.1 * random.normal()]).collect();
    let conductivity = |[x, y]: [f64; 2]| 1.0 / (1.0 + x * x + y * y + (x - 1.0).powi(2) + (y - 1.0).powi(2));
    let truth = Truth::Source("a", places().map(Vec::from).collect(), places().map(conductivity).collect());
    Data { columns: &["x", "y", "u"], rows, truth }
}

/// PINNacle, HeatInv.
fn heat(random: &mut Random) -> Data {
    let shape = |x: f64, y: f64| (PI * x).sin() * (PI * y).sin();
    let places: Vec<[f64; 3]> =
        (0..2500).map(|_| [2.0 * random.uniform() - 1.0, 2.0 * random.uniform() - 1.0, random.uniform()]).collect();
    let rows = places.iter().map(|[x, y, t]| vec![*x, *y, *t, (-t).exp() * shape(*x, *y) + 0.1 * random.normal()]);
    let rows = rows.collect();
    let values = places.iter().map(|[x, y, _]| 2.0 + shape(*x, *y)).collect();
    Data {
        columns: &["x", "y", "t", "u"],
        rows,
        truth: Truth::Source("a", places.into_iter().map(Vec::from).collect(), values),
    }
}
