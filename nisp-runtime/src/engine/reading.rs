//! What a pass over a group reads of the network.

use super::group::Scaling;
use crate::kernel::Layers;
use crate::real::Real;
use crate::schema::{self, TermKind};
use crate::values::Precompiled;

/// From coordinates to jets: through which layers, and what is read of the last.
pub(crate) struct Reading<E: Real> {
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

impl<E: Real> Reading<E> {
    /// All jets of a group, by its own layers.
    pub(super) fn whole(layers: &'static dyn Layers<E>, group: &schema::Group, scaling: &Scaling) -> Self {
        Self::of(layers, group, scaling, &(0..group.jets.len()).collect::<Vec<usize>>())
    }

    /// What has to be known of a group before the pass that takes gradients, the surfaces of clouds and the terms of
    /// integrals, by layers of values; nothing if there is no such term, or if values do not suffice.
    pub(super) fn ahead(group: &schema::Group, scaling: &Scaling) -> Option<Self> {
        let is_ahead = |term: &&schema::Term| matches!(term.kind, TermKind::Chamfer { .. } | TermKind::Integral);
        let jets: Vec<usize> = group.terms.iter().filter(is_ahead).flat_map(|term| term.jets).copied().collect();
        let suffice = jets.iter().all(|&at| is_value(&group.jets[at]));
        let layers =
            values(scaling.half.len()).filter(|_| suffice && group.terms.iter().any(|term| is_ahead(&term)))?;
        Some(Self::of(layers, group, scaling, &jets))
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

/// Layers of values over so many coordinates.
pub(super) fn values<E: Real>(coordinates: usize) -> Option<&'static dyn Layers<E>> {
    Some(match coordinates {
        1 => <E as Precompiled<1>>::values(),
        2 => <E as Precompiled<2>>::values(),
        3 => <E as Precompiled<3>>::values(),
        4 => <E as Precompiled<4>>::values(),
        _ => return None,
    })
}

fn is_value(jet: &schema::Jet) -> bool {
    jet.degree.iter().all(|&n| n == 0)
}

impl<E: Real> JetMap<E> {
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
        let offset = if is_value(jet) { scaling.offset[jet.head] } else { 0.0 };
        Self { site: jet.site, offset: E::from_f64(offset), parts }
    }
}
