//! What a pass over a group reads of the network.

use super::scaling::Scaling;
use crate::kernel::Precision;
use crate::layer::{Layers, MOST_COORDINATES};
use crate::schema::{self, TermKind};

/// From coordinates to jets: through which layers, and what is read of the last.
pub(crate) struct Reading<E: Precision> {
    pub(crate) layers: &'static dyn Layers<E>,
    /// Head channels to evaluate, sorted by channel.
    pub(crate) outputs: Vec<Output>,
    /// How jets are made of head channels; those that are not read are zero.
    pub(crate) jets: Vec<JetMap<E>>,
    /// Points of a tile.
    pub(crate) tile: usize,
}

/// A channel of a head.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Output {
    pub(crate) channel: usize,
    pub(crate) head: usize,
}

/// A jet in the engine's units: `offset + sum(factor * output)`.
#[derive(Clone, Debug)]
pub(crate) struct JetMap<E> {
    pub(crate) offset: E,
    /// 0 for the point itself, 1 for its partner.
    pub(crate) site: usize,
    pub(crate) parts: Vec<(usize, E)>,
}

impl<E: Precision> Reading<E> {
    /// All jets of a group, by its own layers.
    pub(super) fn whole(layers: &'static dyn Layers<E>, group: &schema::Group, scaling: &Scaling) -> Self {
        Self::of(layers, group, scaling, &(0..group.jets.len()).collect::<Vec<usize>>())
    }

    /// What has to be known of a group before the pass that takes gradients, the surfaces of clouds and the terms of
    /// integrals, by layers of values; nothing if there is no such term, or if values do not suffice.
    pub(super) fn ahead(group: &schema::Group, scaling: &Scaling) -> Option<Self> {
        let is_ahead = |term: &&schema::Term| matches!(term.kind, TermKind::Chamfer { .. } | TermKind::Integral);
        let jets: Vec<usize> = group.terms.iter().filter(is_ahead).flat_map(|term| term.jets).copied().collect();
        let suffice = jets.iter().all(|&at| group.jets[at].is_value());
        let inputs = scaling.half.len();
        let is_there = suffice && inputs <= MOST_COORDINATES && group.terms.iter().any(|term| is_ahead(&term));
        is_there.then(|| Self::of(E::values(inputs), group, scaling, &jets))
    }

    fn of(layers: &'static dyn Layers<E>, group: &schema::Group, scaling: &Scaling, read: &[usize]) -> Self {
        let read = read.iter().map(|&at| &group.jets[at]);
        let channels = |jet: &schema::Jet| {
            let head = jet.head;
            jet.combination.iter().map(move |&(channel, _)| Output { channel, head })
        };
        let mut outputs: Vec<Output> = read.flat_map(channels).collect();
        outputs.sort_unstable();
        outputs.dedup();
        let jets = group.jets.iter().map(|jet| JetMap::new(jet, &outputs, scaling)).collect();
        Self { layers, outputs, jets, tile: 1 }
    }

    /// Rows of a point in every layer, as many as take their room in memory: activations and slopes in double precision
    /// take that of four.
    pub(super) fn rows(&self) -> usize {
        self.layers.channels() + if self.layers.takes_values() { 4 } else { 0 }
    }

    /// First point and number of points of every tile of so many points.
    pub(super) fn tiles(&self, points: usize) -> impl Iterator<Item = (usize, usize)> + use<E> {
        let tile = self.tile;
        (0..points).step_by(tile).map(move |first| (first, tile.min(points - first)))
    }
}

impl<E: Precision> JetMap<E> {
    fn new(jet: &schema::Jet, outputs: &[Output], scaling: &Scaling) -> Self {
        let shrink: f64 = jet.degree.iter().zip(&scaling.half).map(|(&n, half)| half.powi(i32::from(n))).product();
        let scale = scaling.scale[jet.head] / shrink;
        let parts = jet
            .combination
            .iter()
            .filter_map(|&(channel, coefficient)| {
                let at = outputs.binary_search(&Output { channel, head: jet.head }).ok()?;
                Some((at, E::from_f64(coefficient * scale)))
            })
            .collect();
        let offset = if jet.is_value() { scaling.offset[jet.head] } else { 0.0 };
        Self { site: jet.site, offset: E::from_f64(offset), parts }
    }
}
