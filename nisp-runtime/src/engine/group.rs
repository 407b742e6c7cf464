//! A point group bound to its points and data.

use std::sync::Arc;

use super::chamfer::Chamfer;
use super::reading::Reading;
use super::scaling::Scaling;
use super::sites::Sites;
use crate::kernel::{GroupKernel, Precision};
use crate::loss::Loss;
use crate::residual::Programs;
use crate::schema::{self, TermKind};

/// A power for each learned scalar, by which a term's size goes with it; empty where it goes with none.
pub(crate) type Powers = Arc<[f64]>;

/// A group, its points and how its rows count. All quantities are in the engine's own units.
pub struct BoundGroup<E: Precision> {
    pub(crate) programs: &'static dyn Programs<E>,
    pub(crate) schema: &'static schema::Group,
    /// Number of points.
    pub(crate) points: usize,
    /// Where the network is evaluated.
    pub(super) network: Sites<E>,
    /// The same in double precision, where values are needed in it.
    pub(super) doubled: Option<Sites<f64>>,
    /// Coordinates in the engine's units, `[site][coordinate][point]`.
    pub(crate) coordinates: Vec<E>,
    /// Data, `[column][point]`.
    pub(crate) columns: Vec<E>,
    /// How each term's rows count.
    pub(crate) terms: Vec<BoundTerm<E>>,
    /// What its programs read.
    pub(crate) reading: Reading<E>,
    /// What has to be known ahead of a step's pass, if that takes values only.
    pub(crate) values: Option<Reading<E>>,
}

/// How the rows of a term count.
pub(crate) struct BoundTerm<E> {
    pub(crate) schema: &'static schema::Term,
    /// How misfits count.
    pub(crate) loss: Loss,
    /// Standard deviation of the rows, where it is declared.
    pub(crate) within: Option<f64>,
    /// Rows are divided by this.
    pub(crate) size: f64,
    /// Rows are multiplied by this after the division.
    pub(crate) factor: f64,
    /// Powers of the learned scalars that the size goes with.
    pub(crate) powers: Powers,
    /// What the size is multiplied by because of them.
    pub(crate) grown: f64,
    /// Derivatives of the size's logarithm by the learned scalars.
    pub(crate) growth: Vec<f64>,
    /// A weight for each point, or nothing for one.
    pub(crate) point_weights: Option<Vec<E>>,
    /// The cloud that rows are compared with, of a Chamfer term.
    pub(crate) chamfer: Option<Chamfer<E>>,
}

impl<E: Precision> BoundGroup<E> {
    /// Binds a group to its points (engine units, `[point][coordinate]`), their partners (likewise; none unless the
    /// group is paired) and columns (`[column][point]`).
    pub(crate) fn new(
        kernel: GroupKernel<E>,
        schema: &'static schema::Group,
        scaling: &Scaling,
        coordinates: &[f64],
        partners: &[f64],
        columns: &[Vec<f64>],
    ) -> Self {
        let inputs = scaling.half.len();
        let points = coordinates.len() / inputs;
        let sites = [coordinates, partners];
        let scaled = |(at, x): (usize, &f64)| (x - scaling.centre[at % inputs]) / scaling.half[at % inputs];
        // Zero is the middle of a coordinate's range.
        let held = |held: &'static schema::Held| {
            let value = move |(at, x)| if held.coordinates.contains(&(at % inputs)) { 0.0 } else { scaled((at, x)) };
            sites[held.of].iter().enumerate().map(value)
        };
        let network = || {
            let own = sites.iter().flat_map(|site| site.iter().enumerate().map(scaled));
            own.chain(schema.held.iter().flat_map(held))
        };
        let transposed = |site: &[f64], i: usize| -> Vec<E> {
            site.iter().skip(i).step_by(inputs).map(|&x| E::from_f64(x)).collect()
        };
        let transposed = sites.iter().flat_map(|site| (0..inputs).flat_map(|i| transposed(site, i))).collect();
        let terms = schema
            .terms
            .iter()
            .map(|schema| BoundTerm {
                schema,
                loss: schema.loss,
                within: None,
                size: 1.0,
                factor: 1.0,
                powers: Powers::default(),
                grown: 1.0,
                growth: Vec::new(),
                point_weights: None,
                chamfer: None,
            })
            .collect();
        Self {
            programs: kernel.programs,
            schema,
            points,
            network: Sites::new(network()),
            doubled: kernel.layers.takes_values().then(|| Sites::new(network())),
            coordinates: transposed,
            columns: columns.iter().flatten().map(|&x| E::from_f64(x)).collect(),
            terms,
            reading: Reading::whole(kernel.layers, schema, scaling),
            values: Reading::ahead(schema, scaling),
        }
    }

    /// What has to be known ahead of a step's pass.
    pub(super) fn ahead(&self) -> &Reading<E> {
        self.values.as_ref().unwrap_or(&self.reading)
    }

    /// First point and number of points of every tile.
    pub(super) fn tiles(&self) -> impl Iterator<Item = (usize, usize)> + use<E> {
        self.reading.tiles(self.points)
    }

    /// Points of the network for each point.
    pub(crate) fn sites(&self) -> usize {
        self.schema.sites()
    }
}

impl<E: Precision> BoundTerm<E> {
    /// Number of rows that solvers see, for a group of so many points.
    pub(crate) fn row_count(&self, points: usize) -> usize {
        match self.schema.kind {
            TermKind::Integral => self.schema.rows,
            TermKind::Chamfer { .. } => self.schema.rows * points + 1,
            TermKind::Residual | TermKind::Observation => self.schema.rows * points,
        }
    }

    /// Number of independent data that the rows stand for.
    pub(crate) fn data_count(&self, points: usize) -> usize {
        let measured =
            |weights: &Vec<E>| weights.iter().filter(|weight| **weight != E::ZERO).count() * self.schema.rows;
        let lacking = self.point_weights.as_ref().filter(|_| self.schema.kind == TermKind::Observation);
        let rows = || lacking.map_or_else(|| self.row_count(points), measured);
        self.chamfer.as_ref().map_or_else(rows, Chamfer::data)
    }

    /// What raw rows are multiplied by.
    pub(crate) fn scale(&self) -> f64 {
        self.factor / (self.size * self.grown)
    }

    /// The row that a Chamfer term's loss has beyond what its points can mend.
    pub(crate) fn scatter(&self) -> f64 {
        self.chamfer.as_ref().map_or(0.0, |chamfer| chamfer.scatter() * self.scale())
    }

    /// Value and derivative of a row, as counted, for a misfit `r` at a point of weight `m`: half the square of the
    /// value is the row's share of the loss, robust or not.
    #[inline(always)]
    pub(crate) fn row(&self, r: E, m: E) -> (E, E) {
        let scale = E::from_f64(self.scale()) * m;
        match self.loss {
            Loss::Square => (scale * r, scale),
            loss => {
                let (value, slope) = loss.row(r.to_f64() * m.to_f64() / self.size);
                (E::from_f64(self.factor * value), E::from_f64(slope) * scale)
            }
        }
    }
}
