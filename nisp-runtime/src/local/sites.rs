//! Points, and the splines at them, which do not change while coefficients do.

use super::heads::Heads;
use super::lattice::MOST_COORDINATES;
use super::tabled::Splines;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// Points as programs read them, and the splines of the heads at them.
pub(super) struct Sites {
    pub(super) count: usize,
    pub(super) stride: usize,
    pub(super) coordinates: Vec<f64>,
    pub(super) columns: Vec<f64>,
    /// By head, then by head at the points' partners; of heads that nobody reads here, no points.
    pub(super) splines: Vec<Splines>,
}

impl Sites {
    /// Points and their partners, if there are any, given flat, point by point, with columns `[column][point]`; `highest` has, by head
    /// and then by head at the partners, the highest derivative that is read, or nothing.
    pub(super) fn new(heads: &Heads, highest: &[Option<u8>], flat: [&[f64]; 2], columns: &[Vec<f64>]) -> Self {
        let inputs = heads.lattices[0].inputs();
        let count = flat[0].len() / inputs;
        let stride = count.next_multiple_of(LANES);
        let spread = |value: &dyn Fn(usize) -> f64| (0..stride).map(|p| value(p.min(count - 1))).collect::<Vec<_>>();
        let splines = |(slot, highest): (usize, &Option<u8>)| {
            let (lattice, flat) = (&heads.lattices[slot % heads.lattices.len()], flat[slot / heads.lattices.len()]);
            highest.map(|highest| Splines::new(lattice, usize::from(highest), flat)).unwrap_or_default()
        };
        let along = flat.iter().filter(|flat| !flat.is_empty());
        Self {
            count,
            stride,
            coordinates: along.flat_map(|flat| (0..inputs).flat_map(|i| spread(&|p| flat[p * inputs + i]))).collect(),
            columns: columns.iter().flat_map(|column| spread(&|p| column[p])).collect(),
            splines: highest.iter().enumerate().map(splines).collect(),
        }
    }

    /// The cells of all heads that a point lies in.
    pub(super) fn cells(&self, p: u32) -> impl Iterator<Item = [usize; MOST_COORDINATES]> + '_ {
        self.splines.iter().filter_map(move |splines| splines.places.get(p as usize)).map(|place| place.cell)
    }
}
