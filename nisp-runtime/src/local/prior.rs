//! What is known of a source before any data: it is zero, or well above zero, and changes along few lines.
//!
//! Three parts, all majorised by quadratic forms about the present source (iteratively reweighted least squares):
//! - total variation of the source's logarithm, `ln(1 + f / cap)`: edges of a patch count, heights of peaks hardly do;
//! - a concave penalty that is linear up to about `level` and constant above, which leaves what is well above zero alone;
//! - the bound, as a steep wall.

use super::heads::Heads;
use super::lattice::Lattice;
use super::normal::Normal;
use super::unseen::Unseen;
use crate::problem::Bound;
use crate::units::Number;

/// A prior for a source that is zero nearly everywhere. Its penalties are those for clouds that are as noisy as a cell is
/// wide: finer data can pretend smaller patches, so that penalties rise as noise falls, that of an area as the square of that
/// of a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patches {
    /// The least that the source is where it is not zero, in its declared unit.
    pub level: f64,
    /// Penalty of an edge, by its length over one cell of the state and its height over `level`.
    pub edges: f64,
    /// Penalty of a patch by its area over that of one cell of the state and its height over `level`, up to `end`.
    pub area: f64,
    /// Height over `level` beyond which a patch costs no more. What is lower is taken for noise.
    pub end: f64,
}

impl Patches {
    /// The least that a head is where it is not zero, in the engine's units.
    pub(crate) fn least(&self, bound: &Bound, head: usize) -> f64 {
        let unit = &bound.problem.scene().schema.heads[head].unit;
        bound.system.inward(unit).of(Number::declared(self.level)).as_engine()
    }
}

/// Heights above this many levels are compressed.
const CAP: f64 = 10.0;
/// Differences of less than this share of a level are smoothed.
const SMOOTH: f64 = 0.02;
/// How the penalty of a length depends on the noise in cells, and the noise below which it rises no more.
const FALL: f64 = -0.3;
const FINEST: f64 = 0.1;
/// Stiffness of the wall at the bound, by area as above.
const WALL: f64 = 200.0;
/// How softly the penalty of small sources ends, over where it does.
const SOFTLY: f64 = 0.17;

/// A source's prior at work.
pub(super) struct Sparse<'a> {
    pub(super) heads: &'a Heads,
    pub(super) head: usize,
    pub(super) prior: Patches,
    /// `level` in units of the head's coefficients, with the bound's sign.
    pub(super) level: f64,
    /// Cells of the source along one of the state's.
    pub(super) finer: usize,
    /// Coordinates along which the source is spread.
    pub(super) dimensions: usize,
    /// Noise of the clouds over the size of a cell.
    pub(super) noise: f64,
    /// Where it is not at work, as nothing is known there.
    pub(super) unseen: Option<Unseen>,
}

impl Sparse<'_> {
    fn lattice(&self) -> &Lattice {
        &self.heads.lattices[self.head]
    }

    /// Area of a node, and length of an edge between two, over those of one cell of the state.
    fn measures(&self) -> (f64, f64) {
        let finer = self.finer as f64;
        (finer.powi(-(self.dimensions as i32)), finer.powi(1 - self.dimensions as i32))
    }

    /// Adds the majorant about the present source. Only if `concave` are heights compressed, and the penalty of small sources
    /// ends at the level: before, the prior is convex, so that no single node can draw a whole patch's force.
    pub(super) fn add(&self, normal: &mut Normal, theta: &[f64], concave: bool) {
        let first = self.heads.first[self.head];
        let (area, length) = self.measures();
        let f: Vec<f64> = theta[first..first + self.lattice().len()].iter().map(|c| c / self.level).collect();
        let steepness = self.steepness(&f);
        let (edges, patch) = self.penalties();
        let square = 1.0 / (self.level * self.level);
        let seen = |at: usize| self.unseen.as_ref().is_none_or(|unseen| !unseen.functions[at]);
        let before = normal.draws.is_some().then(|| normal.gradient[first..first + f.len()].to_vec());
        for axis in 0..self.lattice().dimensions() {
            for (a, b) in self.lattice().neighbours(axis).filter(|(a, b)| seen(*a as usize) && seen(*b as usize)) {
                let (i, j) = (a as usize, b as usize);
                let slope = if concave { compression(0.5 * (f[i] + f[j])) } else { 1.0 };
                let weight = edges * length * slope / steepness[i].max(SMOOTH);
                let difference = (f[j] - f[i]) * self.level;
                normal.add_difference([first + i, first + j], weight * square, difference);
            }
        }
        for (at, &f) in f.iter().enumerate().filter(|(at, _)| seen(*at)) {
            let slope = patch * area * if concave { small(f, self.prior.end) } else { 1.0 };
            normal.gradient[first + at] += slope / self.level;
            // For error bars the wall holds what rests at zero, too.
            if f < 0.0 || f == 0.0 && normal.draws.is_some() {
                normal.gradient[first + at] += WALL * area * f / self.level;
                normal.add_stiffness(first + at, WALL * area * square);
            }
        }
        // Without the penalties what is above zero would be larger by an unknown part of what they take. Draws count their gradient there as
        // one more row of unit variance.
        if let (Some(draws), Some(before)) = (&mut normal.draws, &before) {
            let pulls = normal.gradient[first..].iter().zip(before).map(|(after, before)| after - before);
            let is_pulled = |at: usize| f[at] > 0.0 && seen(at);
            let pulls = pulls.enumerate().filter(|(at, _)| is_pulled(*at)).map(|(at, pull)| (first + at, pull));
            draws.add(&pulls.collect::<Vec<_>>());
        }
        if let Some(unseen) = &self.unseen {
            unseen.add(normal, self.heads, self.head, self.level);
        }
    }

    /// What the prior adds to the loss, but for a constant.
    pub(super) fn value(&self, theta: &[f64], concave: bool) -> f64 {
        let first = self.heads.first[self.head];
        let f: Vec<f64> = theta[first..first + self.lattice().len()].iter().map(|c| c / self.level).collect();
        let (area, length) = self.measures();
        let (edges, patch) = self.penalties();
        let heights: Vec<f64> = f.iter().map(|&f| if concave { compressed(f) } else { f }).collect();
        let areas = f
            .iter()
            .map(|&f| patch * if concave { charge(f, self.prior.end) } else { f } + 0.5 * WALL * f.min(0.0).powi(2));
        edges * length * self.steepness(&heights).iter().sum::<f64>() + area * areas.sum::<f64>()
    }

    /// What the edge of a square patch of one level costs, so many nodes along each coordinate, by node.
    pub(super) fn edge_of_square(&self, nodes: f64) -> f64 {
        self.penalties().0 * self.measures().1 * 2.0 * self.dimensions as f64 / nodes
    }

    /// Penalties of an edge and of a patch at this noise.
    fn penalties(&self) -> (f64, f64) {
        let per_length = self.noise.max(FINEST).powf(FALL);
        (self.prior.edges * per_length, self.prior.area * per_length * per_length)
    }

    /// Steepness of the source at every node: the root of the sum of squares of the differences to the next nodes.
    fn steepness(&self, f: &[f64]) -> Vec<f64> {
        let mut squares = vec![SMOOTH * SMOOTH; f.len()];
        for axis in 0..self.lattice().dimensions() {
            for (a, b) in self.lattice().neighbours(axis) {
                squares[a as usize] += (f[b as usize] - f[a as usize]).powi(2);
            }
        }
        squares.iter().map(|s| s.sqrt()).collect()
    }
}

/// A height as it counts, both in levels.
fn compressed(height: f64) -> f64 {
    if height > 0.0 { CAP * (height / CAP).ln_1p() } else { height }
}

/// Integral of [`small`] from zero to a height.
fn charge(height: f64, end: f64) -> f64 {
    if height < 0.0 {
        return small(height, end) * height;
    }
    let width = SOFTLY * end;
    let soft = |height: f64| crate::functions::softplus((height - end) / width) * width;
    height - soft(height) + soft(0.0)
}

/// How much a difference counts at a height, both in levels.
fn compression(height: f64) -> f64 {
    1.0 / (1.0 + height.max(0.0) / CAP)
}

/// Slope of the concave penalty at a height in levels.
fn small(height: f64, end: f64) -> f64 {
    1.0 / (1.0 + ((height.max(0.0) / end - 1.0) / SOFTLY).exp())
}
