//! Where the network is evaluated for a group.

use crate::kernel::Precision;
use crate::network::Mapping;

/// The points of a group, then their partners if they have any, then those at which coordinates are held.
pub(crate) struct Sites<E: Precision> {
    /// Network coordinates, `[site][point][coordinate]`.
    coordinates: Vec<E>,
    /// What features of them are made of, `[site][point][2][feature]`, if there are any: the same in every step.
    table: Vec<E>,
}

impl<E: Precision> Sites<E> {
    pub(super) fn new(coordinates: impl Iterator<Item = f64>) -> Self {
        Self { coordinates: coordinates.map(E::from_f64).collect(), table: Vec::new() }
    }

    /// Prepares the features that the network sees.
    pub(super) fn tabulate(&mut self, features: &Mapping<E>) {
        self.table = features.table(&self.coordinates);
    }

    /// Takes over the chosen points of others, of which there are more, at each of their sites.
    pub(super) fn take(&mut self, pool: &Self, sites: usize, points: usize, chosen: &[usize]) {
        for (own, all) in [(&mut self.coordinates, &pool.coordinates), (&mut self.table, &pool.table)] {
            let length = all.len() / (sites * points);
            for site in 0..sites {
                for (at, &from) in chosen.iter().enumerate() {
                    let (to, from) = (site * chosen.len() + at, site * points + from);
                    own[to * length..][..length].copy_from_slice(&all[from * length..][..length]);
                }
            }
        }
    }

    /// Copies what belongs to a tile of `count` points from `first` on, of `points` in all with `sites` each: coordinates and
    /// features of its points, then of their partners.
    pub(super) fn load(
        &self,
        tile: (usize, usize),
        (points, sites): (usize, usize),
        coordinates: &mut [E],
        table: &mut [E],
    ) {
        let (first, count) = tile;
        for (from, to) in [(&self.coordinates, coordinates), (&self.table, table)] {
            let length = from.len() / (sites * points);
            for site in 0..sites {
                let from = &from[(site * points + first) * length..][..count * length];
                to[site * count * length..][..from.len()].copy_from_slice(from);
            }
        }
    }
}
