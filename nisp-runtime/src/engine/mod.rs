//! The engine: values, gradients and Jacobian rows of all groups, tile by tile, on all threads.
//!
//! Work is cut into a fixed number of chunks, whatever the number of threads; each chunk sums its own gradient and the
//! chunks are added in a fixed tree. Results are therefore bitwise the same for any number of threads.

mod assign;
mod chamfer;
mod fit;
mod form;
mod group;
mod heads;
mod integral;
mod jacobian;
mod lift;
mod objective;
mod predict;
mod reading;
mod resample;
mod tile;

use std::sync::Mutex;

use rayon::prelude::*;

pub(crate) use chamfer::Chamfer;
pub(crate) use group::BoundTerm;
pub use group::{BoundGroup, Scaling};
use integral::{Integral, Integrals, covers, seed_integrals};
use resample::Resampler;
pub(crate) use resample::is_exchangeable;
use tile::{Buffers, Extent, Network, Tile};

use crate::aligned::AlignedVec;
use crate::layer::row_distance;
use crate::network::{Layout, Weights};
use crate::real::Real;
use crate::residual::Points;
use crate::schema::TermKind;
use crate::simd::Isa;
use crate::solve::fault::Fault;
use crate::solve::objective::Block;
use crate::wide::add_rows;

/// Most chunks that a step is cut into; more threads than this find no work.
const CHUNKS: usize = 16;

/// Rows that a chunk should have at least, for its products to outweigh the addition of its gradient.
const CHUNK_ROWS: usize = 400;

/// Bytes that the rows of a tile may take together: within the second-level cache of one core.
const TILE_BYTES: usize = 640 << 10;

/// A scene bound to points and data, ready to be evaluated at any parameters.
pub struct Engine<E: Real> {
    isa: Isa,
    pub(crate) layout: Layout,
    pub(crate) groups: Vec<BoundGroup<E>>,
    weights: Weights<E>,
    /// The parameters that weights and scalars are of.
    theta: Vec<E>,
    /// True if clouds are assigned to the surfaces that these parameters predict.
    is_assigned: bool,
    /// Scalars that programs read, in the engine's units; learned ones are refreshed from the parameters.
    pub(crate) scalars: Vec<E>,
    pub(crate) learned: Vec<Learned>,
    chunks: Vec<Chunk<E>>,
    buffers: Vec<Mutex<Buffers<E>>>,
    /// First term of each group, counted over all groups.
    first_terms: Vec<usize>,
    /// Half the sum of squares of each term at the last evaluation, in the order of groups and terms.
    pub(crate) shares: Vec<f64>,
    /// Weighted sums of integral terms and their misfits.
    integrals: Integrals,
    blocks: Vec<Block>,
    resampler: Option<Box<Resampler<E>>>,
}

/// A learned scalar: its slot, and the map from its parameter to its value in the engine's units.
#[derive(Clone, Debug)]
pub(crate) struct Learned {
    pub(crate) slot: usize,
    pub(crate) map: LearnedMap,
}

/// How a learned scalar follows from its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LearnedMap {
    /// `start * exp(theta)`: positive quantities.
    Positive(f64),
    /// `start + scale * theta`
    Linear(f64, f64),
    /// `lower + (upper - lower) / (1 + exp(-(theta + shift)))`
    Between(f64, f64, f64),
}

impl LearnedMap {
    /// Value and derivative.
    pub(crate) fn at(self, theta: f64) -> (f64, f64) {
        match self {
            Self::Positive(start) => (start * theta.exp(), start * theta.exp()),
            Self::Linear(start, scale) => (start + scale * theta, scale),
            Self::Between(lower, upper, shift) => {
                let s = 1.0 / (1.0 + (-(theta + shift)).exp());
                (lower + (upper - lower) * s, (upper - lower) * s * (1.0 - s))
            }
        }
    }
}

/// A share of a step: consecutive tiles, their gradient and their part of every term.
struct Chunk<E: Real> {
    tiles: Vec<TileRange>,
    gradient: AlignedVec<E>,
    shares: Vec<f64>,
    fault: Option<(usize, usize)>,
}

#[derive(Clone, Copy)]
struct TileRange {
    group: usize,
    first: usize,
    count: usize,
}

impl<E: Real> Engine<E> {
    /// An engine for `groups`, whose kernels, points and data are bound; the layout is padded for `isa`. `scalars` are in the engine's units.
    pub(crate) fn new(
        isa: Isa,
        layout: Layout,
        mut groups: Vec<BoundGroup<E>>,
        scalars: Vec<E>,
        learned: Vec<Learned>,
    ) -> Self {
        for group in &mut groups {
            let (sites, points) = (group.sites(), group.points);
            for reading in std::iter::once(&mut group.reading).chain(&mut group.values) {
                reading.tile = tile_points::<E>(&layout, reading.layers.channels() * sites, points);
            }
        }
        let terms = groups.iter().map(|g| g.terms.len()).sum();
        let chunks = cut(&groups)
            .into_iter()
            .map(|tiles| Chunk {
                tiles,
                gradient: AlignedVec::zeros(layout.padded_len),
                shares: vec![0.0; terms],
                fault: None,
            })
            .collect();
        let extent = Extent::of(groups.iter());
        let workers = rayon::current_num_threads() + 1;
        let buffers = (0..workers).map(|_| Mutex::new(Buffers::new(&layout, extent))).collect();
        let integrals = Integrals::new(&groups, scalars.len(), learned.len());
        let mut engine = Self {
            isa,
            weights: Weights::new(isa, &layout),
            theta: vec![E::from_f64(f64::NAN); layout.len],
            is_assigned: false,
            layout,
            scalars,
            learned,
            chunks,
            buffers,
            first_terms: first_terms(&groups),
            groups,
            shares: vec![0.0; terms],
            integrals,
            blocks: Vec::new(),
            resampler: None,
        };
        engine.blocks = engine.make_blocks();
        engine
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.layout.len
    }

    /// The instruction set in use.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// The network's layout.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Takes over parameters: weights are materialised and packed once, for all tiles and calls.
    pub(crate) fn set(&mut self, theta: &[E]) {
        if self.theta == theta {
            return;
        }
        self.theta.copy_from_slice(theta);
        self.is_assigned = false;
        self.weights.set(&self.layout, theta);
        for (learned, &theta) in self.learned.iter().zip(&theta[self.layout.learned.clone()]) {
            self.scalars[learned.slot] = E::from_f64(learned.map.at(theta.to_f64()).0);
        }
        if self.chamfers().any(|chamfer| !chamfer.is_assigned()) {
            self.assign();
        }
    }

    /// The loss at `theta`.
    ///
    /// # Errors
    /// A term that is not finite.
    pub fn loss(&mut self, theta: &[E]) -> Result<f64, Fault> {
        self.set(theta);
        self.integrate()?;
        self.run(false);
        self.collect()
    }

    /// The loss at `theta`, and its gradient.
    ///
    /// # Errors
    /// A term or a derivative that is not finite.
    pub fn loss_and_gradient(&mut self, theta: &[E], gradient: &mut [E]) -> Result<f64, Fault> {
        self.set(theta);
        self.integrate()?;
        self.run(true);
        let loss = self.collect()?;
        self.reduce();
        self.slope_targets();
        let total = &mut self.chunks[0].gradient;
        for integral in &self.integrals.rows {
            for (i, slope) in integral.target_slopes.iter().enumerate() {
                total[self.layout.learned_at + i] -= E::from_f64(integral.seed * slope);
            }
        }
        for (i, learned) in self.learned.iter().enumerate() {
            let slope = learned.map.at(theta[self.layout.learned.start + i].to_f64()).1;
            total[self.layout.learned_at + i] *= E::from_f64(slope);
        }
        self.layout.pad_adjoint(theta, total, gradient);
        match gradient.iter().all(|g| g.is_finite()) {
            true => Ok(loss),
            false => Err(Fault::gradient("gradient", None)),
        }
    }

    /// Runs all chunks, forward only or with the adjoint.
    fn run(&mut self, adjoint: bool) {
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let (groups, buffers, integrals) = (&self.groups, &self.buffers, &self.integrals.rows);
        let first_term = &self.first_terms;
        self.chunks.par_iter_mut().for_each(|chunk| {
            with_buffers(buffers, |buffers| {
                if adjoint {
                    chunk.gradient.fill(E::ZERO);
                }
                chunk.shares.fill(0.0);
                chunk.fault = None;
                for range in &chunk.tiles {
                    let group = &groups[range.group];
                    let tile = Tile::new(group, range.first, range.count);
                    network.forward(&tile, buffers);
                    let shares = &mut chunk.shares[first_term[range.group]..][..group.terms.len()];
                    let fault = weigh(&network, &tile, buffers, shares);
                    if let (Some((term, point)), None) = (fault, chunk.fault) {
                        chunk.fault = Some((first_term[range.group] + term, point));
                    }
                    if adjoint {
                        seed_integrals(integrals, range.group, &tile, buffers);
                        network.adjoint(&tile, buffers, &mut chunk.gradient, false);
                    }
                }
            });
        });
    }

    /// Adds up the chunks' shares of the loss.
    fn collect(&mut self) -> Result<f64, Fault> {
        for (term, share) in self.shares.iter_mut().enumerate() {
            *share = self.chunks.iter().map(|chunk| chunk.shares[term]).sum();
        }
        if let Some((term, point)) = self.chunks.iter().find_map(|chunk| chunk.fault) {
            return Err(Fault::residual(self.term_name(term), Some(point)));
        }
        let mut whole = 0.0;
        let terms = self.groups.iter().flat_map(|group| &group.terms);
        for (share, term) in self.shares.iter_mut().zip(terms) {
            let scatter = term.scatter().powi(2) / 2.0;
            *share += scatter;
            whole += scatter;
        }
        for integral in &self.integrals.rows {
            let misfit = integral.misfit;
            self.shares[self.first_terms[integral.group] + integral.term] += misfit * misfit / 2.0;
            whole += misfit * misfit / 2.0;
        }
        let loss: f64 = self.chunks.iter().flat_map(|chunk| &chunk.shares).sum::<f64>() + whole;
        if loss.is_finite() { Ok(loss) } else { Err(Fault::residual("loss", None)) }
    }

    /// Adds the chunks' gradients in a fixed tree into the first.
    fn reduce(&mut self) {
        let mut distance = 1;
        while distance < self.chunks.len() {
            self.chunks.par_chunks_mut(2 * distance).for_each(|pair| {
                if pair.len() > distance {
                    let (left, right) = pair.split_at_mut(distance);
                    add_rows(&mut left[0].gradient, &right[0].gradient, self.layout.padded_len);
                }
            });
            distance *= 2;
        }
    }

    /// `group.term`, for messages.
    pub(crate) fn term_name(&self, term: usize) -> String {
        let mut first = 0;
        for group in &self.groups {
            if let Some(bound) = group.terms.get(term - first) {
                return format!("{}.{}", group.schema.name, bound.schema.name);
            }
            first += group.terms.len();
        }
        String::from("loss")
    }
}

/// Lends a worker's buffers.
fn with_buffers<E: Real, T>(buffers: &[Mutex<Buffers<E>>], work: impl FnOnce(&mut Buffers<E>) -> T) -> T {
    let worker = rayon::current_thread_index().map_or(buffers.len() - 1, |at| at % buffers.len());
    // A panic in another worker leaves scratch behind, nothing that could be torn.
    let mut own = buffers[worker].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    work(&mut own)
}

/// First term of each group, counted over all groups.
fn first_terms<E: Real>(groups: &[BoundGroup<E>]) -> Vec<usize> {
    groups
        .iter()
        .scan(0, |next, group| {
            let first = *next;
            *next += group.terms.len();
            Some(first)
        })
        .collect()
}

/// Rows of a tile, their shares of the loss, and the seeds of the adjoint. Gives the first row that is not finite.
fn weigh<E: Real>(
    network: &Network<'_, E>,
    tile: &Tile<'_, E>,
    buffers: &mut Buffers<E>,
    shares: &mut [f64],
) -> Option<(usize, usize)> {
    let stride = tile.stride();
    let Buffers { jets, points, columns, rows, seeds, row_slopes, .. } = buffers;
    let inputs =
        Points { count: tile.count, stride, jets, coordinates: points, columns, scalars: network.scalars, seeds: &[] };
    tile.group.programs.residual(network.isa, inputs, rows);
    let mut fault = None;
    for ((index, term), share) in tile.group.terms.iter().enumerate().zip(shares) {
        if term.schema.kind == TermKind::Integral {
            continue;
        }
        let mut judge = |sum: f64, values: &[E]| {
            *share += sum;
            if !sum.is_finite() && fault.is_none() {
                let point = (0..tile.count).find(|p| values[*p..].iter().step_by(stride).any(|x| !x.is_finite()));
                fault = Some((index, tile.first + point.unwrap_or(0)));
            }
        };
        if let Some(chamfer) = &term.chamfer {
            let (at, len) = (term.schema.first * stride, term.schema.rows * stride);
            let (values, seeds) = (&mut rows[at..][..len], &mut seeds[at..][..len]);
            let points = tile.first..tile.first + tile.count;
            let scale = E::from_f64(term.factor / term.size);
            let sum = chamfer.weigh(points.clone(), stride, scale, values);
            seeds.fill(E::ZERO);
            for (i, row) in values.chunks_exact(stride).enumerate() {
                chamfer.seed(i, points.clone(), stride, |p| row[p] * scale, seeds);
            }
            judge(sum, values);
            continue;
        }
        for row in term.schema.first..term.schema.first + term.schema.rows {
            let values = &mut rows[row * stride..][..stride];
            let (seeds, slopes) = (&mut seeds[row * stride..][..stride], &mut row_slopes[row * stride..][..stride]);
            let sum = term.weigh(tile.first, tile.count, values, seeds, slopes);
            judge(sum, values);
        }
    }
    fault
}

impl<E: Real> BoundTerm<E> {
    /// Replaces the raw rows of a tile by what counts, and gives half the sum of their squares.
    fn weigh(&self, first: usize, count: usize, values: &mut [E], seeds: &mut [E], slopes: &mut [E]) -> f64 {
        let mut sum = 0.0;
        for p in 0..count {
            let weight = self.point_weights.as_ref().map_or(E::ONE, |w| w[first + p]);
            let (value, slope) = self.row(values[p], weight);
            values[p] = value;
            slopes[p] = slope;
            seeds[p] = value * slope;
            let value = value.to_f64();
            sum += value * value;
        }
        seeds[count..].fill(E::ZERO);
        sum / 2.0
    }
}

/// Points of a tile: as many as keep its rows in cache, and enough tiles to share out.
fn tile_points<E: Real>(layout: &Layout, channels: usize, points: usize) -> usize {
    let buffers = layout.affine.len() + layout.hidden.len() + 6;
    let bytes = channels * row_distance(layout.width) * size_of::<E>() * buffers;
    let fit = (TILE_BYTES / bytes).clamp(4, 64);
    let share = points.div_ceil(CHUNKS).next_multiple_of(4);
    fit.min(share).max(4).min(points.max(1))
}

/// Cuts all tiles of all groups into chunks of about equal work.
fn cut<E: Real>(groups: &[BoundGroup<E>]) -> Vec<Vec<TileRange>> {
    let tiles: Vec<(TileRange, usize)> = groups
        .iter()
        .enumerate()
        .flat_map(|(at, group)| {
            let cost = group.sites() * group.reading.layers.channels();
            group.tiles().map(move |(first, count)| (TileRange { group: at, first, count }, count * cost))
        })
        .collect();
    let total: usize = tiles.iter().map(|(_, cost)| cost).sum();
    let chunks = (total / CHUNK_ROWS).clamp(CHUNKS / 2, CHUNKS);
    let mut chunks: Vec<Vec<TileRange>> = vec![Vec::new(); chunks.min(tiles.len()).max(1)];
    let mut done = 0;
    let count = chunks.len();
    for (tile, cost) in tiles {
        let at = (done * count / total.max(1)).min(count - 1);
        chunks[at].push(tile);
        done += cost;
    }
    chunks.retain(|chunk| !chunk.is_empty());
    if chunks.is_empty() {
        chunks.push(Vec::new());
    }
    chunks
}
