//! Points of equations drawn anew where the equations are most off (Wu, Zhu, Tan, Kartha and Lu 2023, "RAD").

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};

use super::{BoundGroup, Engine};
use crate::kernel::Precision;
use crate::schema::{self, TermKind};

/// How points of equations are drawn from all that were bound: with a chance of `r^power / mean(r^power) + floor`, `r` being
/// the residual at a point over its natural size (Wu et al. 2023). Only groups that hold equations and no data take part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resampling {
    /// Share of the points that a step sees.
    pub share: f64,
    /// Accepted steps between draws.
    pub every: u64,
    /// How strongly large residuals are preferred.
    pub power: f64,
    /// What keeps the other points in the draw.
    pub floor: f64,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { share: 1.0 / 3.0, every: 100, power: 1.0, floor: 1.0 }
    }
}

/// All points that were bound, and the turns of drawing from them.
pub(super) struct Resampler<E: Precision> {
    settings: Resampling,
    pool: Engine<E>,
    accepted: u64,
    random: StdRng,
}

/// True if a group's points may be exchanged: they carry equations only, no data, no weights, no partners.
pub(crate) fn is_exchangeable(group: &schema::Group) -> bool {
    !group.paired && group.terms.iter().all(|term| term.kind == TermKind::Residual)
}

impl<E: Precision> Engine<E> {
    /// Exchanges the points of this engine for others of `pool`, which has them all, now and then.
    pub(crate) fn resample_from(&mut self, pool: Engine<E>, settings: Resampling, seed: u64) {
        let random = StdRng::seed_from_u64(seed);
        self.resampler = Some(Box::new(Resampler { settings, pool, accepted: 0, random }));
    }

    /// Counts an accepted step, and draws points where it is time to. Returns true if they have changed.
    pub(super) fn resample(&mut self, theta: &[E]) -> bool {
        let Some(resampler) = &mut self.resampler else { return false };
        resampler.accepted += 1;
        if !resampler.accepted.is_multiple_of(resampler.settings.every) {
            return false;
        }
        let mut changed = false;
        for (at, group) in self.groups.iter_mut().enumerate() {
            if group.points < resampler.pool.groups[at].points {
                let chosen = resampler.draw(at, group, theta);
                group.take(&resampler.pool.groups[at], &chosen);
                changed = true;
            }
        }
        changed
    }
}

impl<E: Precision> Resampler<E> {
    /// As many points of the pool as a group has, without repetition: each with a chance that rises with its residual.
    fn draw(&mut self, group: usize, own: &BoundGroup<E>, theta: &[E]) -> Vec<usize> {
        let rows = self.pool.raw_rows(group, theta);
        let all = self.pool.groups[group].points;
        let mut off = vec![0.0; all];
        for term in &own.terms {
            for row in term.schema.first..term.schema.first + term.schema.rows {
                let values = rows[row * all..][..all].iter();
                off.iter_mut().zip(values).for_each(|(sum, r)| *sum += (r * term.scale()).powi(2));
            }
        }
        let powers: Vec<f64> = off.iter().map(|square| square.powf(self.settings.power / 2.0)).collect();
        let mean = powers.iter().sum::<f64>() / all as f64;
        let weight = |power: f64| self.settings.floor + if mean > 0.0 { power / mean } else { 1.0 };
        // The first arrivals of Poisson processes with these rates (Efraimidis and Spirakis 2006).
        let arrival = |(at, &power): (usize, &f64)| (-(1.0 - self.random.random::<f64>()).ln() / weight(power), at);
        let mut arrivals: Vec<(f64, usize)> = powers.iter().enumerate().map(arrival).collect();
        arrivals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut chosen: Vec<usize> = arrivals[..own.points].iter().map(|&(_, at)| at).collect();
        chosen.sort_unstable();
        chosen
    }
}

impl<E: Precision> BoundGroup<E> {
    /// Takes over the chosen points of a group that has more of them.
    fn take(&mut self, pool: &Self, chosen: &[usize]) {
        let sites = self.sites();
        self.network.take(&pool.network, sites, pool.points, chosen);
        if let (Some(own), Some(all)) = (&mut self.doubled, &pool.doubled) {
            own.take(all, sites, pool.points, chosen);
        }
        for (own, all) in [(&mut self.coordinates, &pool.coordinates), (&mut self.columns, &pool.columns)] {
            for (own, all) in own.chunks_exact_mut(self.points).zip(all.chunks_exact(pool.points)) {
                own.iter_mut().zip(chosen).for_each(|(to, &from)| *to = all[from]);
            }
        }
    }
}
