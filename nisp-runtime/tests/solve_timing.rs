//! Timings, to be run by hand: `cargo test --release --test solve_timing -- --ignored --nocapture --test-threads 1`.

mod solve_common;

use nisp_runtime::solve::adam::{Adam, AdamSettings};
use nisp_runtime::solve::broyden::{Broyden, Update};
use nisp_runtime::solve::fault::Fault;
use nisp_runtime::solve::method::Method;
use nisp_runtime::solve::objective::Objective;
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

#[test]
#[ignore = "a timing"]
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

#[test]
#[ignore = "a timing"]
fn adam_update() {
    for len in [436, 330_000] {
        let mut method = Adam::new(vec![0.0_f32; len], AdamSettings::default());
        let mut function = Cheap(vec![1.0_f32; len]);
        let start = Instant::now();
        (0..500).for_each(|_| drop(method.step(&mut function).unwrap()));
        let each = start.elapsed().as_secs_f64() * 1e3 / 500.0;
        println!("adam f32 {len}: {each:.4} ms a step with a scalar gradient");
    }
}
