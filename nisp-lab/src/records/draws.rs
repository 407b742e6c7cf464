//! Truths of records, drawn at random.

use super::drive::Drive;
use crate::random::Random;
use crate::rk4::integrate;

/// What is true of a record at some places.
pub(super) struct Course {
    /// What is measured, without noise.
    pub(super) columns: Vec<Vec<f64>>,
    pub(super) source: Vec<f64>,
    /// Parameters that the scene is told.
    pub(super) told: Vec<(&'static str, f64)>,
}

/// The first states of a course are measured.
pub(super) fn course<const N: usize>(drive: &Drive, times: &[f64], states: Vec<[f64; N]>, measured: usize) -> Course {
    let columns = (0..measured).map(|at| states.iter().map(|state| state[at]).collect()).collect();
    Course { columns, source: times.iter().map(|&t| drive.at(t)).collect(), told: Vec::new() }
}

/// The circuit starts anywhere.
pub(super) fn circuit(random: &mut Random, t: &[f64]) -> Course {
    let drive = Drive::draw(random, 2.0, 4.0);
    let start = [4.0 * random.normal(), 4.0 * random.normal()];
    let slope = |t: f64, [v, r]: [f64; 2]| [r, drive.slope(t) + 6.0 * drive.at(t) - 7.0 * r - 10.0 * v];
    Course { told: vec![("f0", drive.at(0.0))], ..course(&drive, t, integrate(slope, start, t), 1) }
}

/// Sums of half waves: deflection in mm, and load.
pub(super) fn bent(random: &mut Random, places: &[f64]) -> Course {
    let sizes = [1.0, 0.3, 0.1, 0.03].map(|size| size * random.normal());
    let sum = |x: f64, factor: &dyn Fn(f64) -> f64| -> f64 {
        let own = |(n, size): (usize, &f64)| {
            let pace = (n + 1) as f64 * std::f64::consts::PI;
            factor(pace) * size * (pace * x).sin()
        };
        sizes.iter().enumerate().map(own).sum()
    };
    let of = |factor: &dyn Fn(f64) -> f64| places.iter().map(|&x| sum(x, factor)).collect::<Vec<f64>>();
    Course { columns: vec![of(&|_| 1.0)], source: of(&|pace| 0.1 * pace.powi(4)), told: Vec::new() }
}

/// Temperatures in closed form, of which the heat follows.
pub(super) fn heated(random: &mut Random, places: &[f64]) -> Course {
    let drive = Drive::draw(random, 1.0, 10.0);
    let bend = |x: f64| (drive.slope(x + 1e-5) - drive.slope(x - 1e-5)) / 2e-5;
    let temperature = |x: f64| 20.0 + drive.at(x);
    let source = places.iter().map(|&x| -0.02 * bend(x) + 0.2 * temperature(x)).collect();
    Course { columns: vec![places.iter().map(|&x| temperature(x)).collect()], source, told: Vec::new() }
}

/// The double pendulum balanced by a regulator near that of `data/pendulum/pendulum.toml`, from anywhere near upright.
pub(super) fn regulated(random: &mut Random, times: &[f64]) -> Course {
    balanced(random, times, 0.0)
}

/// The same with a sine on the regulator's force.
pub(super) fn pushed(random: &mut Random, times: &[f64]) -> Course {
    balanced(random, times, 3e-3)
}

/// Forces of the regulator by the state, those of the pendulum's file, about.
const GAIN: [f64; 6] =
    [0.0816496580928, 2.48160443754, -3.5552099403, 0.164279087644, 0.0625859883633, -0.603640337824];

pub(super) fn balanced(random: &mut Random, times: &[f64], disturbance: f64) -> Course {
    loop {
        let gain = GAIN.map(|gain| gain * (1.0 + 0.1 * (2.0 * random.uniform() - 1.0)));
        let start = [0.0, 0.03, 0.03, 0.0, 0.03, 0.03].map(|size| size * (2.0 * random.uniform() - 1.0));
        let (amplitude, pace) = (disturbance * random.uniform(), 2.0 + 10.0 * random.uniform());
        let force = |t: f64, x: &[f64; 6]| {
            amplitude * (pace * t).sin() - gain.iter().zip(x).map(|(gain, x)| gain * x).sum::<f64>()
        };
        let states = integrate(|t, x| links(force(t, &x), x), start, times);
        if states.iter().all(|state| state[1].abs() < 0.5 && state[2].abs() < 0.5) {
            let source = times.iter().zip(&states).map(|(&t, state)| force(t, state)).collect();
            let columns = (0..3).map(|at| states.iter().map(|state| state[at]).collect()).collect();
            return Course { columns, source, told: Vec::new() };
        }
    }
}

/// Rates of q, psi, phi and their own rates under a force: the equations of motion over m l^2, with s = q'' / l, by Cramer.
pub(super) fn links(force: f64, [_, psi, phi, dq, dpsi, dphi]: [f64; 6]) -> [f64; 6] {
    let (m, l, g) = (0.005, 0.5, 9.81);
    let across = (psi - phi).cos();
    let right = [
        force / (m * l) - 2.0 * dpsi * dpsi * psi.sin() - dphi * dphi * phi.sin(),
        2.0 * g / l * psi.sin() - dphi * dphi * (psi - phi).sin(),
        g / l * phi.sin() + dpsi * dpsi * (psi - phi).sin(),
    ];
    let mass = [[3.0, -2.0 * psi.cos(), -phi.cos()], [-2.0 * psi.cos(), 2.0, across], [-phi.cos(), across, 1.0]];
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(&mass);
    let found = [0, 1, 2].map(|column| {
        let mut own = mass;
        (0..3).for_each(|row| own[row][column] = right[row]);
        determinant(&own) / whole
    });
    [dq, dpsi, dphi, l * found[0], found[1], found[2]]
}
