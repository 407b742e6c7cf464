//! Points, and the splines at them, which do not change while coefficients do.

use super::heads::Heads;
use super::lattice::{Lattice, MOST_COORDINATES};
use super::tabled::Splines;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// Points as programs read them, and the splines of the heads at them.
pub(super) struct Sites {
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) coordinates: Vec<f64>,
    pub(super) columns: Vec<f64>,
    /// By head; of heads that nobody reads here, no points.
    pub(super) splines: Vec<Splines>,
}

impl Sites {
    /// Points given flat, point by point, with columns `[column][point]`; `highest` has, by head, the highest derivative that
    /// is read, or nothing.
    pub(super) fn new(heads: &Heads, highest: &[Option<u8>], flat: &[f64], columns: &[Vec<f64>]) -> Self {
        let inputs = heads.lattices[0].inputs();
        let count = flat.len() / inputs;
        let stride = count.next_multiple_of(LANES);
        let spread = |value: &dyn Fn(usize) -> f64| (0..stride).map(|p| value(p.min(count - 1))).collect::<Vec<_>>();
        let splines = |(lattice, highest): (&Lattice, &Option<u8>)| {
            highest.map(|highest| Splines::new(lattice, usize::from(highest), flat)).unwrap_or_default()
        };
        Self {
            count,
            stride,
            coordinates: (0..inputs).flat_map(|i| spread(&|p| flat[p * inputs + i])).collect(),
            columns: columns.iter().flat_map(|column| spread(&|p| column[p])).collect(),
            splines: heads.lattices.iter().zip(highest).map(splines).collect(),
        }
    }

    /// The cells of all heads that a point lies in.
    pub(super) fn cells(&self, p: u32) -> impl Iterator<Item = [usize; MOST_COORDINATES]> + '_ {
        self.splines.iter().filter_map(move |splines| splines.places.get(p as usize)).map(|place| place.cell)
    }
}
