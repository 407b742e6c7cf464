//! What a step of each method costs, and how the methods compare on a small network:
//! `cargo run --release -p nisp-runtime --example solver_timing`.

#[path = "../tests/solve_common/mod.rs"]
mod solve_common;

use nisp_runtime::solve::adam::{Adam, AdamSettings};
use nisp_runtime::solve::broyden::{Broyden, Update};
use nisp_runtime::solve::driver::{Flow, Limits, run};
use nisp_runtime::solve::fault::Fault;
use nisp_runtime::solve::gauss_newton::GaussNewton;
use nisp_runtime::solve::lbfgs::Lbfgs;
use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::{Block, LeastSquares, Objective};
use nisp_runtime::solve::prior::WeightPrior;
use solve_common::rows::Rows;
use std::time::Instant;

/// A diagonal quadratic: costs next to nothing beside a step.
struct Cheap<E>(Vec<E>);

macro_rules! cheap {
    ($type:ident) => {
        impl Objective<$type> for Cheap<$type> {
            fn len(&self) -> usize {
                self.0.len()
            }
            fn value(&mut self, _: &[$type]) -> Result<f64, Fault> {
                Ok(0.0)
            }
            fn gradient(&mut self, theta: &[$type], gradient: &mut [$type]) -> Result<f64, Fault> {
                let mut sum = 0.0;
                for ((g, x), k) in gradient.iter_mut().zip(theta).zip(&self.0) {
                    *g = k * (x - 1.0);
                    sum += 0.5 * *g * (x - 1.0);
                }
                Ok(sum.into())
            }
        }
    };
}
cheap!(f32);
cheap!(f64);

fn weights(len: usize) -> Vec<f64> {
    (0..len).map(|i| 1e6_f64.powf(i as f64 / len as f64)).collect()
}

fn main() {
    broyden_update();
    adam_update();
    marquardt_step();
    methods_on_a_network();
}

fn broyden_update() {
    for len in [436, 844, 1380, 2000, 2836] {
        let mut method = Broyden::new(vec![0.0; len], Update::SelfScaledBroyden);
        let mut function = Cheap(weights(len));
        let step = |method: &mut Broyden, function: &mut Cheap<f64>| method.step(function).unwrap().evaluations;
        (0..20).for_each(|_| {
            step(&mut method, &mut function);
        });
        let start = Instant::now();
        let evaluations: usize = (0..200).map(|_| step(&mut method, &mut function)).sum();
        let each = start.elapsed().as_secs_f64() * 1e3 / 200.0;
        println!("ssbroyden {len}: {each:.3} ms a step, {:.2} evaluations", evaluations as f64 / 200.0);
    }
}

fn adam_update() {
    for len in [436, 330_000] {
        let mut method = Adam::new(vec![0.0_f32; len], AdamSettings::default());
        let mut function = Cheap(vec![1.0_f32; len]);
        let start = Instant::now();
        (0..500).for_each(|_| assert!(method.step(&mut function).is_ok()));
        let each = start.elapsed().as_secs_f64() * 1e3 / 500.0;
        println!("adam f32 {len}: {each:.4} ms a step with a scalar gradient");
    }
}

fn marquardt_step() {
    for (rows, len) in [(1500, 436), (1500, 844), (1500, 1380), (1500, 2836), (300, 436)] {
        let mut problem = TanhRows { rows, len };
        let start = (0..len).map(|i| (i as f64).sin()).collect();
        let mut method = Marquardt::new(start, WeightPrior::uniform(1e-6, len));
        method.step(&mut problem).unwrap();
        let (mut r, mut j) = (vec![0.0; rows], vec![0.0; rows * len]);
        let theta = Method::<f64, TanhRows>::theta(&method).to_vec();
        let start = Instant::now();
        (0..10).for_each(|_| assert!(problem.jacobian(&theta, &mut r, &mut j).is_ok()));
        let jacobian = start.elapsed().as_secs_f64() * 1e2;
        let start = Instant::now();
        let moved = (0..10).filter(|_| method.step(&mut problem).unwrap().verdict == Verdict::Moved).count();
        let each = start.elapsed().as_secs_f64() * 1e2;
        println!("lm {rows} x {len}: {each:.2} ms a step ({moved} of 10 moved), of which jacobian {jacobian:.2} ms");
    }
}

/// Rows without structure, cheap to evaluate.
struct TanhRows {
    rows: usize,
    len: usize,
}

impl Objective<f64> for TanhRows {
    fn len(&self) -> usize {
        self.len
    }
    fn value(&mut self, _: &[f64]) -> Result<f64, Fault> {
        Ok(0.0)
    }
    fn gradient(&mut self, _: &[f64], _: &mut [f64]) -> Result<f64, Fault> {
        Ok(0.0)
    }
}

impl LeastSquares for TanhRows {
    fn rows(&self) -> usize {
        self.rows
    }
    fn residuals(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        for (i, r) in r.iter_mut().enumerate() {
            let mut sum = -1.0;
            let mut c = 0.3 + i as f64 * 1e-4;
            for x in theta {
                c = (c * 3.999) * (1.0 - c);
                sum += (c - 0.5) * (x + 0.1 * x * x);
            }
            *r = sum;
        }
        Ok(0.5 * r.iter().map(|r| r * r).sum::<f64>())
    }
    fn jacobian(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        for (i, row) in j.chunks_exact_mut(self.len).enumerate() {
            let mut c = 0.3 + i as f64 * 1e-4;
            for (j, x) in row.iter_mut().zip(theta) {
                c = (c * 3.999) * (1.0 - c);
                *j = (c - 0.5) * (1.0 + 0.2 * x);
            }
        }
        self.residuals(theta, r)
    }
    fn blocks(&self) -> &[Block] {
        &[]
    }
    fn set_sigma(&mut self, _: usize, _: f64) {}
    fn jacobian_vector(&mut self, _: &[f64], _: &[f64], _: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }
    fn vector_jacobian(&mut self, _: &[f64], _: &[f64], _: &mut [f64]) -> Result<(), Fault> {
        Ok(())
    }
}

/// One hidden layer of tanh, fitted to a function with a layer: `theta = (w, b, v)` by unit.
fn network(units: usize) -> Rows {
    let points = 200;
    Rows::new(3 * units, points, move |i, theta, row| {
        let x = -1.0 + 2.0 * i as f64 / (points - 1) as f64;
        let mut y = 0.0;
        for (unit, d) in theta.chunks_exact(3).zip(row.chunks_exact_mut(3)) {
            let t = (unit[0] * x + unit[1]).tanh();
            let slope = unit[2] * (1.0 - t * t);
            d.copy_from_slice(&[slope * x, slope, t]);
            y += unit[2] * t;
        }
        row.iter_mut().for_each(|d| *d *= 0.1);
        0.1 * (y - (3.0 * x).sin() - (-20.0 * (x + 1.0)).exp())
    })
}

fn methods_on_a_network() {
    let units = 20;
    for seed in [1.0, 2.0, 3.0] {
        let start: Vec<f64> = (0..3 * units).map(|i| 2.0 * (12.9898 * (i as f64 + seed) * seed).sin()).collect();
        let methods: [Box<dyn Method<f64, Rows>>; 6] = [
            Box::new(Lbfgs::new(start.clone(), 20)),
            Box::new(Broyden::new(start.clone(), Update::Bfgs)),
            Box::new(Broyden::new(start.clone(), Update::SelfScaledBfgs)),
            Box::new(Broyden::new(start.clone(), Update::SelfScaledBroyden)),
            Box::new(Marquardt::new(start.clone(), WeightPrior::default())),
            Box::new(GaussNewton::new(start.clone(), WeightPrior::default(), 100)),
        ];
        for mut method in methods {
            let mut rows = network(units);
            let mut report = format!("{:12}", method.name());
            for _ in 0..4 {
                let limits = Limits { iterations: 500, ..Limits::default() };
                let outcome = run(&mut *method, &mut rows, limits, &mut |_| Flow::Continue);
                report +=
                    &format!("  {:.2e} ({} evals, {:.0} ms)", outcome.loss, outcome.evaluations, outcome.wall_s * 1e3);
            }
            println!("{report}");
        }
    }
}
