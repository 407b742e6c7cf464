//! Where the network is evaluated for a group.

use super::buffers::Buffers;
use super::tile::Tile;
use crate::network::Mapping;
use crate::real::Real;

/// The points of a group, then their partners if they have any, then those at which coordinates are held.
pub(crate) struct Sites<E: Real> {
    /// Network coordinates, `[site][point][coordinate]`.
    coordinates: Vec<E>,
    /// What features of them are made of, `[site][point][2][feature]`, if there are any: the same in every step.
    table: Vec<E>,
}

impl<E: Real> Sites<E> {
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

    /// Copies what belongs to a tile, site by site.
    pub(super) fn load(&self, tile: &Tile<'_, impl Real>, buffers: &mut Buffers<E>) {
        let (sites, points) = (tile.group.sites(), tile.group.points);
        for (from, to) in [(&self.coordinates, &mut buffers.coordinates), (&self.table, &mut buffers.table)] {
            let length = from.len() / (sites * points);
            for site in 0..sites {
                let from = &from[(site * points + tile.first) * length..][..tile.count * length];
                to[site * tile.count * length..][..from.len()].copy_from_slice(from);
            }
        }
    }
}
