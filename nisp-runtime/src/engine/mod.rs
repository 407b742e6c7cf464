//! The engine: values, gradients and Jacobian rows of all groups, tile by tile, on all threads.
//!
//! Work is cut into a fixed number of chunks, whatever the number of threads; each chunk sums its own gradient and the
//! chunks are added in a fixed tree. Results are therefore bitwise the same for any number of threads.

mod adjoint;
mod assign;
mod buffers;
mod chamfer;
mod chunks;
mod doubled;
pub(crate) mod factors;
mod fit;
mod form;
mod group;
mod grow;
mod heads;
mod integral;
mod jacobian;
mod judged;
mod learned;
mod lift;
mod objective;
mod predict;
mod reading;
mod resample;
mod scaling;
mod sites;
mod tile;
mod weigh;

use std::sync::Mutex;

use rayon::prelude::*;

use buffers::{Buffers, Extent, with_buffers};
pub(crate) use chamfer::Chamfer;
use chunks::{Chunk, TileRange, add_up, cut, tile_points};
pub use group::BoundGroup;
pub(crate) use group::Powers;
use integral::{Integral, Integrals, covers, seed_integrals};
pub(crate) use learned::{Learned, LearnedMap};
use resample::Resampler;
pub use resample::Resampling;
pub(crate) use resample::is_exchangeable;
pub use scaling::Scaling;
use tile::{Network, Tile};
use weigh::weigh;

use crate::aligned::AlignedVec;
use crate::kernel::Precision;
use crate::network::{Layout, Weights};
use crate::simd::Isa;
use crate::solve::fault::Fault;
use crate::solve::objective::Block;
use crate::solve::vector;

/// A scene bound to points and data, ready to be evaluated at any parameters.
pub struct Engine<E: Precision> {
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

impl<E: Precision> Engine<E> {
    /// An engine for `groups`, whose kernels, points and data are bound; the layout is padded for `isa`. `scalars` are in the
    /// engine's units.
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
                reading.tile = tile_points::<E>(&layout, reading.rows() * sites, points);
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
        let weights = Weights::new(isa, &layout, extent.doubled);
        for group in &mut groups {
            if let Some(features) = &weights.features {
                group.network.tabulate(features);
            }
            let features = weights.doubled().and_then(|weights| weights.features.as_ref());
            if let (Some(sites), Some(features)) = (&mut group.doubled, features) {
                sites.tabulate(features);
            }
        }
        let workers = rayon::current_num_threads() + 1;
        let buffers = (0..workers).map(|_| Mutex::new(Buffers::new(&layout, extent))).collect();
        let integrals = Integrals::new(&groups, scalars.len(), learned.len());
        let mut engine = Self {
            isa,
            weights,
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
        for term in self.groups.iter_mut().flat_map(|group| &mut group.terms) {
            term.grow(&self.learned, &theta[self.layout.learned.clone()]);
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
        self.slope_targets();
        let total = &mut self.chunks[0].gradient;
        for integral in &self.integrals.rows {
            for (i, slope) in integral.target_slopes.iter().enumerate() {
                total[self.layout.learned_at + i] -= E::from_f64(integral.seed * slope);
            }
        }
        self.shrink_shares();
        let total = &mut self.chunks[0].gradient;
        for (i, learned) in self.learned.iter().enumerate() {
            let slope = learned.map.at(theta[self.layout.learned.start + i].to_f64()).1;
            total[self.layout.learned_at + i] *= E::from_f64(slope);
        }
        self.layout.pad_adjoint(theta, total, gradient);
        if vector::all_finite(gradient) { Ok(loss) } else { Err(Fault::gradient("gradient", None)) }
    }

    /// Runs all chunks: forward only, or with the adjoint, which adds their gradients up in the first.
    fn run(&mut self, adjoint: bool) {
        let network = Network { isa: self.isa, layout: &self.layout, weights: &self.weights, scalars: &self.scalars };
        let (groups, buffers, integrals) = (&self.groups, &self.buffers, &self.integrals.rows);
        let first_term = &self.first_terms;
        let work = |chunk: &mut Chunk<E>| {
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
        };
        if adjoint { add_up(&mut self.chunks, &work) } else { self.chunks.par_iter_mut().for_each(work) }
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

/// First term of each group, counted over all groups.
fn first_terms<E: Precision>(groups: &[BoundGroup<E>]) -> Vec<usize> {
    groups
        .iter()
        .scan(0, |next, group| {
            let first = *next;
            *next += group.terms.len();
            Some(first)
        })
        .collect()
}
