//! How noisy clouds are about the present surface.

use super::solver::Solver;
use super::surface::{EDGE_ON, Surface};
use crate::loss::{Loss, deviation_of_clean};

/// Noise that clouds are credited with at least, as a share of a cell: what splines cannot follow.
const LEAST_NOISE: f64 = 1e-2;

impl Solver {
    /// True where every cloud says how noisy it is.
    pub(super) fn knows_noise(&self) -> bool {
        self.surfaces.iter().all(|surface| surface.within().is_some())
    }

    /// Standard deviation of the clouds about the surface, without outliers; the largest declared where all are.
    pub(super) fn noise(&self, used: f64) -> f64 {
        let unknown = self.surfaces.iter().filter(|surface| surface.within().is_none());
        let misfits: Vec<f64> = unknown.flat_map(Surface::misfits).collect();
        let declared = || self.surfaces.iter().filter_map(Surface::within).fold(0.0, f64::max);
        let found = if misfits.is_empty() { declared() } else { deviation_of_clean(misfits, used) };
        found.max(LEAST_NOISE * self.cell)
    }

    /// The noise in other directions than a cloud's view, as a share of that along it: the likeliest by how much more points are off
    /// where the surface is seen from the front than where it is steep.
    pub(super) fn noise_across(&self, used: f64) -> f64 {
        /// Shares that are tried, from none to all.
        const SHARES: usize = 20;
        /// Points that are far off cost a constant. It is more than a point gains by a small deviation where the surface is seen edge on.
        const CLEAN: Loss = Loss::Tukey(5.0);
        let seen: Vec<(f64, f64)> = self.surfaces.iter().flat_map(Surface::facing).collect();
        if seen.is_empty() {
            return 0.0;
        }
        let unlikeliness = |share: f64| {
            let spread = |facing: f64| (facing + share * share * (1.0 - facing)).sqrt().max(EDGE_ON);
            let sigma =
                deviation_of_clean(seen.iter().map(|(misfit, facing)| misfit / spread(*facing)).collect(), used);
            let of_point = |&(misfit, facing): &(f64, f64)| {
                let own = sigma * spread(facing);
                own.ln() + CLEAN.rho(misfit / own)
            };
            seen.iter().map(of_point).sum::<f64>()
        };
        let all = (0..=SHARES).map(|at| at as f64 / SHARES as f64).map(|share| (unlikeliness(share), share));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, share)| share)
    }
}
