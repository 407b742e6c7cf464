//! An elastic body in space: vectors, tensors, learned moduli.

use nisp::scene_in_both_precisions as scene;

use super::{group, scatter, wave};
use crate::number::Number;
use crate::reference::{Data, Model, Point};

nisp::pde! {
    mod sponge {
        units: off;
        coordinates: x, y, z;
        fields: u: vector;
        sources: f in -1 .. 4;
        parameters: E in 0.5 .. 5 = 2, nu in 0.1 .. 0.45 = 0.3;
        let mu = E / (2 * (1 + nu));
        let lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
        let eps = sym(grad(u));
        let sigma = lambda * tr(eps) * I + 2 * mu * eps;
        on volume { balance: div(sigma) + [0, 0, -1] == 0; }
        on surface {
            columns: n: vector;
            traction: sigma * n == -f * n with huber(0.4) weight 3;
            total: integral(f * dot(n, n)) == E * nu;
        }
        scene identify { learn E, nu; }
    }
}

/// An elastic body in space: vectors, tensors, learned moduli.
pub struct Sponge;

impl Model for Sponge {
    const ORDER: usize = 2;
    #[inline(never)]
    fn scene(&self) -> nisp::SceneRef {
        scene::<sponge::identify::Scene>()
    }
    fn groups(&self) -> Vec<Data> {
        let normals = vec![wave(29, 0.3), wave(29, 0.7), wave(29, 1.1)];
        let surface = group("surface", scatter(29, 3, 0.0, 2.0));
        let weights = (0..29).map(|i| 0.02 + 0.001 * f64::from(i)).collect();
        vec![group("volume", scatter(53, 3, 0.0, 2.0)), Data { columns: normals, weights, ..surface }]
    }
    fn learned<T: Number>(&self, theta: &[T]) -> Vec<T> {
        let between = |theta: T, low: f64, start: f64, high: f64| {
            let shift = ((start - low) / (high - start)).ln();
            T::of(low) + T::of(high - low) / ((-(theta + T::of(shift))).exp() + T::of(1.0))
        };
        vec![between(theta[0], 0.5, 2.0, 5.0), between(theta[1], 0.1, 0.3, 0.45)]
    }
    fn rows<T: Number>(&self, group: &str, at: &Point<'_, '_, T>) -> Vec<T> {
        let (one, two) = (T::of(1.0), T::of(2.0));
        let [e, nu] = [at.learned[0], at.learned[1]];
        let mu = e / (two * (one + nu));
        let lambda = e * nu / ((one + nu) * (one - two * nu));
        let u = &at.heads[..3];
        let trace = u[0].by(0) + u[1].by(1) + u[2].by(2);
        let sigma = |i: usize, j: usize| {
            let shear = (u[i].by(j) + u[j].by(i)).scale(mu);
            if i == j { shear + trace.clone().scale(lambda) } else { shear }
        };
        if group == "volume" {
            let load = [0.0, 0.0, -1.0];
            let balance = |i: usize| (0..3).fold(T::of(load[i]), |sum, j| sum + sigma(i, j).by(j).value());
            return (0..3).map(balance).collect();
        }
        let n: Vec<T> = at.columns.iter().map(|&n| T::of(n)).collect();
        let f = T::of(-1.0) + T::of(5.0) / ((-at.heads[3].value()).exp() + one);
        let traction = |i: usize| (0..3).fold(f * n[i], |sum, j| sum + sigma(i, j).value() * n[j]);
        let square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        vec![traction(0), traction(1), traction(2), f * square]
    }
    fn target<T: Number>(&self, _: usize, learned: &[T]) -> T {
        learned[0] * learned[1]
    }
}
