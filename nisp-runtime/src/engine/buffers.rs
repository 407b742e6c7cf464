//! Scratch of the workers.

use std::sync::Mutex;

use super::group::BoundGroup;
use crate::aligned::AlignedVec;
use crate::kernel::Precision;
use crate::layer::{Shape, row_distance};
use crate::network::Layout;

/// Points of a tile are padded to a multiple of this, so that every vector length divides it.
pub(crate) const POINT_LANES: usize = 16;

/// Scratch of one worker, large enough for a tile of any group.
pub(crate) struct Buffers<E: Precision> {
    pub(super) coordinates: AlignedVec<E>,
    /// What features of the coordinates are made of, and their channels, if there are any.
    pub(super) table: AlignedVec<E>,
    pub(super) features: AlignedVec<E>,
    /// The activation of the first layer and the gates (on features of the coordinates, their arguments), and its slope.
    pub(super) values: Vec<AlignedVec<E>>,
    pub(super) slopes: Vec<AlignedVec<E>>,
    /// Channels of the first layer, of `c - d`, and of `d`.
    pub(super) lifted: Vec<AlignedVec<E>>,
    pub(super) arguments: Vec<AlignedVec<E>>,
    pub(super) hidden_slopes: Vec<AlignedVec<E>>,
    pub(super) output: AlignedVec<E>,
    pub(super) seed: AlignedVec<E>,
    pub(super) bar: AlignedVec<E>,
    pub(super) next_bar: AlignedVec<E>,
    pub(super) difference_bar: AlignedVec<E>,
    pub(super) floor_bar: AlignedVec<E>,
    pub(crate) outputs: AlignedVec<E>,
    pub(crate) jets: AlignedVec<E>,
    pub(crate) points: AlignedVec<E>,
    pub(crate) columns: AlignedVec<E>,
    pub(crate) rows: AlignedVec<E>,
    pub(crate) seeds: AlignedVec<E>,
    pub(crate) bars: AlignedVec<E>,
    pub(super) output_bars: AlignedVec<E>,
    pub(crate) row_slopes: AlignedVec<E>,
    /// For values in double precision, where layers take them.
    pub(super) doubled: Option<Box<Buffers<f64>>>,
}

/// Largest sizes that a set of groups asks of [`Buffers`].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extent {
    /// Points of the network in a tile.
    points: usize,
    rows: usize,
    sites: usize,
    outputs: usize,
    jets: usize,
    columns: usize,
    residuals: usize,
    /// True if layers take values in double precision.
    pub(super) doubled: bool,
}

impl Extent {
    pub(crate) fn of<'a, E: Precision>(groups: impl Iterator<Item = &'a BoundGroup<E>>) -> Self {
        groups.fold(Self::default(), |extent, group| {
            let tiles = [&group.reading, group.ahead()].map(|reading| (reading.tile * group.sites(), reading));
            Self {
                points: tiles.iter().map(|(points, _)| *points).fold(extent.points, usize::max),
                rows: tiles.iter().map(|(points, r)| points * r.layers.channels()).fold(extent.rows, usize::max),
                sites: extent.sites.max(group.sites()),
                outputs: extent.outputs.max(group.reading.outputs.len()),
                jets: extent.jets.max(group.schema.jets.len()),
                columns: extent.columns.max(group.schema.columns.len()),
                residuals: extent.residuals.max(group.schema.rows),
                doubled: extent.doubled || group.reading.layers.takes_values(),
            }
        })
    }

    /// What values alone ask of the same tiles.
    fn of_values(self) -> Self {
        Self { points: self.points, rows: self.points, sites: self.sites, ..Self::default() }
    }
}

impl<E: Precision> Buffers<E> {
    pub(crate) fn new(layout: &Layout, extent: Extent) -> Self {
        let ld = row_distance(layout.width);
        let stride = extent.points.next_multiple_of(POINT_LANES);
        let rows = || AlignedVec::zeros(extent.rows * ld);
        let values = || AlignedVec::zeros(extent.points * ld);
        let quantities = |count: usize| AlignedVec::zeros(count * stride);
        let features = if layout.is_mapped() { layout.affine[0].columns.next_multiple_of(POINT_LANES) } else { 0 };
        Self {
            coordinates: AlignedVec::zeros(extent.points * layout.inputs),
            table: AlignedVec::zeros(extent.points * 2 * features),
            features: AlignedVec::zeros(extent.rows * row_distance(features)),
            values: layout.affine.iter().map(|_| if features == 0 { values() } else { rows() }).collect(),
            slopes: layout.affine.iter().map(|_| values()).collect(),
            lifted: layout.affine.iter().map(|_| rows()).collect(),
            arguments: layout.hidden.iter().map(|_| rows()).collect(),
            hidden_slopes: layout.hidden.iter().map(|_| values()).collect(),
            output: rows(),
            seed: rows(),
            bar: rows(),
            next_bar: rows(),
            difference_bar: rows(),
            floor_bar: rows(),
            outputs: quantities(extent.outputs),
            jets: quantities(extent.jets),
            points: quantities(layout.inputs * extent.sites),
            columns: quantities(extent.columns),
            rows: quantities(extent.residuals),
            seeds: quantities(extent.residuals),
            bars: quantities(extent.jets + layout.learned.len()),
            output_bars: quantities(extent.outputs),
            row_slopes: quantities(extent.residuals),
            doubled: extent.doubled.then(|| Box::new(Buffers::new(layout, extent.of_values()))),
        }
    }
}

/// Lends a worker's buffers.
pub(super) fn with_buffers<E: Precision, T>(
    buffers: &[Mutex<Buffers<E>>],
    work: impl FnOnce(&mut Buffers<E>) -> T,
) -> T {
    let worker = rayon::current_thread_index().map_or(buffers.len() - 1, |at| at % buffers.len());
    // A panic in another worker leaves scratch behind, nothing that could be torn: values in double precision that a tile had
    // taken out are gone, and the next tile that needs them panics instead of reading old ones.
    let mut own = buffers[worker].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    work(&mut own)
}

/// Rounds the row of each point into rows of which every `distance`-th is one's own.
pub(super) fn round_rows<E: Precision>(shape: Shape, from: &[f64], to: &mut [E], distance: usize) {
    for (from, to) in from.chunks_exact(shape.ld).zip(to.chunks_exact_mut(distance * shape.ld)).take(shape.points) {
        to[..shape.width].iter_mut().zip(from).for_each(|(to, from)| *to = E::from_f64(*from));
    }
}
