//! The two systems, written out by hand: an independent statement of the equations that `pde!` compiles.

use super::System;

/// A cart with two links; angles counterclockwise, as in `data/pendulum`.
#[derive(Debug, Clone)]
pub struct Pendulum {
    /// Masses of cart, first and second bob, in kg.
    pub masses: [f64; 3],
    /// Lengths of the links, in m.
    pub lengths: [f64; 2],
    /// Gravity, in m/s^2.
    pub gravity: f64,
}

impl Default for Pendulum {
    /// The constants of `data/pendulum`.
    fn default() -> Pendulum {
        Pendulum { masses: [0.005; 3], lengths: [0.5; 2], gravity: 9.81 }
    }
}

impl Pendulum {
    /// Force on the cart from `[y, y', y'']` of q, psi, phi.
    fn force(&self, [q, psi, phi]: [[f64; 3]; 3]) -> f64 {
        let ([m0, m1, m2], [l1, l2]) = (self.masses, self.lengths);
        (m0 + m1 + m2) * q[2]
            - (m1 + m2) * l1 * (psi[2] * psi[0].cos() - psi[1].powi(2) * psi[0].sin())
            - m2 * l2 * (phi[2] * phi[0].cos() - phi[1].powi(2) * phi[0].sin())
    }
}

impl System for Pendulum {
    fn states(&self) -> usize {
        3
    }

    fn equations(&self) -> usize {
        3
    }

    fn residual(&self, jet: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        let ([m0, m1, m2], [l1, l2], g) = (self.masses, self.lengths, self.gravity);
        let (a, total, both) = (m1 + m2, m0 + m1 + m2, m2 * l1 * l2);
        let &[q, dq, ddq, psi, dpsi, ddpsi, phi, dphi, ddphi, f, _] = jet else { return };
        let ((s1, c1), (s2, c2), (s, c)) = (psi.sin_cos(), phi.sin_cos(), (psi - phi).sin_cos());
        let rows = [
            self.force([[q, dq, ddq], [psi, dpsi, ddpsi], [phi, dphi, ddphi]]) - f,
            a * l1 * (l1 * ddpsi - ddq * c1 - g * s1) + both * (ddphi * c + dphi * dphi * s),
            m2 * l2 * (l2 * ddphi - ddq * c2 - g * s2) + both * (ddpsi * c - dpsi * dpsi * s),
        ];
        #[rustfmt::skip]
        let slopes = [
            [0.0, 0.0, total,
                a * l1 * (ddpsi * s1 + dpsi * dpsi * c1), 2.0 * a * l1 * dpsi * s1, -a * l1 * c1,
                m2 * l2 * (ddphi * s2 + dphi * dphi * c2), 2.0 * m2 * l2 * dphi * s2, -m2 * l2 * c2,
                -1.0, 0.0],
            [0.0, 0.0, -a * l1 * c1,
                a * l1 * (ddq * s1 - g * c1) + both * (dphi * dphi * c - ddphi * s), 0.0, a * l1 * l1,
                both * (ddphi * s - dphi * dphi * c), 2.0 * both * dphi * s, both * c,
                0.0, 0.0],
            [0.0, 0.0, -m2 * l2 * c2,
                -both * (ddpsi * s + dpsi * dpsi * c), -2.0 * both * dpsi * s, both * c,
                m2 * l2 * (ddq * s2 - g * c2) + both * (ddpsi * s + dpsi * dpsi * c), 0.0, m2 * l2 * l2,
                0.0, 0.0],
        ];
        // Divided by mass (and arm), every row is an acceleration.
        for (row, scale) in [total, a * l1, m2 * l2].into_iter().enumerate() {
            residual[row] = rows[row] / scale;
            for (column, slope) in slopes[row].iter().enumerate() {
                jacobian[row * slopes[row].len() + column] = slope / scale;
            }
        }
    }

    fn source(&self, _times: &[f64], jets: &[Vec<[f64; 3]>]) -> Vec<f64> {
        let triples = jets[0].iter().zip(&jets[1]).zip(&jets[2]);
        triples.map(|((q, psi), phi)| self.force([*q, *psi, *phi])).collect()
    }

    fn known_source(&self) -> Option<(f64, f64)> {
        None
    }
}

/// `v'' + a v' + b v = c f' + e f` with the source known at one time, without which it is open by
/// `exp(-e t / c)`.
#[derive(Debug, Clone)]
pub struct Rlc {
    /// a, in 1/s.
    pub damping: f64,
    /// b, in 1/s^2.
    pub stiffness: f64,
    /// c, in 1/s, not zero.
    pub rate_gain: f64,
    /// e, in 1/s^2.
    pub gain: f64,
    /// The first time, in s.
    pub start: f64,
    /// The source at that time, in V.
    pub source_at_start: f64,
}

impl Default for Rlc {
    /// The constants of `data/rlc`.
    fn default() -> Rlc {
        Rlc { damping: 7.0, stiffness: 10.0, rate_gain: 1.0, gain: 6.0, start: 0.0, source_at_start: 6.0 }
    }
}

impl System for Rlc {
    fn states(&self) -> usize {
        1
    }

    fn equations(&self) -> usize {
        1
    }

    fn residual(&self, jet: &[f64], residual: &mut [f64], jacobian: &mut [f64]) {
        let slopes = [self.stiffness, self.damping, 1.0, -self.gain, -self.rate_gain];
        residual[0] = slopes.iter().zip(jet).map(|(slope, value)| slope * value).sum();
        jacobian[..5].copy_from_slice(&slopes);
    }

    /// Integrates `c f' = g - e f` exactly for a `g` that is straight between the times.
    fn source(&self, times: &[f64], jets: &[Vec<[f64; 3]>]) -> Vec<f64> {
        let rate = self.gain / self.rate_gain;
        let drive = |[v, dv, ddv]: &[f64; 3]| (ddv + self.damping * dv + self.stiffness * v) / self.rate_gain;
        let drive: Vec<f64> = jets[0].iter().map(drive).collect();
        let mut f = self.source_at_start;
        let (mut before, mut g_before) = (self.start, drive.first().copied().unwrap_or(0.0));
        let step = |(&t, &g): (&f64, &f64)| {
            let h = t - before;
            let x = rate * h;
            let decay = (-x).exp();
            // Shares of the drive at either end of the step; their limit is half a step each.
            let late = if x.abs() < 1e-4 { h * (0.5 - x / 6.0) } else { (1.0 - (1.0 - decay) / x) / rate };
            let early = if x.abs() < 1e-4 { h * (0.5 - x / 3.0) } else { (1.0 - decay) / rate - late };
            f = decay * f + early * g_before + late * g;
            (before, g_before) = (t, g);
            f
        };
        times.iter().zip(&drive).map(step).collect()
    }

    fn known_source(&self) -> Option<(f64, f64)> {
        Some((self.start, self.source_at_start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes are written by hand, so they are checked by differences.
    #[test]
    fn slopes_match_differences() {
        let systems: [&dyn System; 2] = [&Pendulum::default(), &Rlc::default()];
        for system in systems {
            let width = 3 * system.states() + 2;
            let rows = system.equations();
            let jet: Vec<f64> = (0..width).map(|k| (1.7 * k as f64 + 0.4).sin()).collect();
            let evaluate = |jet: &[f64]| {
                let (mut residual, mut jacobian) = (vec![0.0; rows], vec![0.0; rows * width]);
                system.residual(jet, &mut residual, &mut jacobian);
                (residual, jacobian)
            };
            let (_, jacobian) = evaluate(&jet);
            for column in 0..width {
                let shifted = |by: f64| {
                    let mut jet = jet.clone();
                    jet[column] += by;
                    evaluate(&jet).0
                };
                let (up, down) = (shifted(1e-6), shifted(-1e-6));
                for row in 0..rows {
                    let slope = (up[row] - down[row]) / 2e-6;
                    assert!((slope - jacobian[row * width + column]).abs() < 1e-7, "row {row} column {column}");
                }
            }
        }
    }

    /// On the closed solution the residual vanishes and the source comes back.
    #[test]
    fn rlc_closed_solution() {
        let jet = |t: f64| {
            let part = |c: f64, rate: f64| [c, -c * rate, c * rate * rate].map(|x| x * (-rate * t).exp());
            let parts = [part(44.0 / 3.0, 2.0), part(1.0 / 3.0, 5.0), part(-9.0, 3.0)];
            std::array::from_fn::<f64, 3, _>(|k| parts.iter().map(|p| p[k]).sum())
        };
        let system = Rlc::default();
        let times: Vec<f64> = (0..=400).map(|k| f64::from(k) * 0.005).collect();
        let source = system.source(&times, &[times.iter().map(|&t| jet(t)).collect()]);
        let truth: Vec<f64> = times.iter().map(|t| 6.0 * (-3.0 * t).exp()).collect();
        assert!(super::super::mean_abs_error(&source, &truth) < 1e-4);
        let [v, dv, ddv] = jet(0.3);
        let (mut residual, mut jacobian) = ([0.0], [0.0; 5]);
        let f = 6.0 * (-0.9f64).exp();
        system.residual(&[v, dv, ddv, f, -3.0 * f], &mut residual, &mut jacobian);
        assert!(residual[0].abs() < 1e-12);
    }
}
