//! The rows of a group: misfits of its terms, and their derivatives by the coefficients around each point.
//!
//! Where points come with weights, they stand for a piece of space, and equations are tested: a row is the weighted mean
//! of the residual, with a spline of low degree on the lattice as weight (Petrov-Galerkin). A kink of the solution inside
//! a cell then costs nothing, while a residual asked to vanish at every point would smooth it away.
//! Points without weights give a row each.

use rayon::prelude::*;

use super::block::Block;
use super::heads::Heads;
use super::lattice::{Exponents, Lattice, MOST_COORDINATES, NONE, Place, Span};
use crate::kernel::GroupKernel;
use crate::residual::Points;
use crate::schema::{self, TermKind};
use crate::simd::Isa;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

/// Tests whose hats see less than this share of the fullest one's weight are left out.
const LEAST_MASS: f64 = 0.05;

/// A group at its points.
pub(super) struct Group {
    pub(super) schema: &'static schema::Group,
    kernel: GroupKernel<f64>,
    pub(super) sites: Sites,
    operators: Vec<Vec<(Exponents, f64)>>,
    /// By row: what it is divided by.
    pub(super) sigma: Vec<f64>,
    /// Weights of the points; empty if each has rows of its own.
    pub(super) weights: Vec<f64>,
    nodes: Vec<Node>,
    /// Degree of the tests.
    tests: usize,
    /// Heads that the group reads.
    heads: Vec<usize>,
}

/// Points as programs read them, and their places.
pub(super) struct Sites {
    pub(super) count: usize,
    stride: usize,
    coordinates: Vec<f64>,
    columns: Vec<f64>,
    /// `[head][point]`
    places: Vec<Vec<Place>>,
}

/// A test: the points around a node with their shares, which add up to one.
struct Node {
    points: Vec<(u32, f64)>,
    /// First of the cells around it.
    cell: [usize; MOST_COORDINATES],
    weight: f64,
}

/// Values of all rows at all points, and their derivatives.
pub(super) struct Evaluated {
    stride: usize,
    /// `[row][point]`
    pub(super) rows: Vec<f64>,
    /// By row: `[jet or learned scalar][point]`.
    bars: Vec<Vec<f64>>,
}

impl Sites {
    /// Points given flat, point by point, with columns `[column][point]`.
    pub(super) fn new(heads: &Heads, flat: &[f64], columns: &[Vec<f64>]) -> Self {
        let inputs = heads.lattices[0].dimensions();
        let count = flat.len() / inputs;
        let stride = count.next_multiple_of(LANES);
        let spread = |value: &dyn Fn(usize) -> f64| (0..stride).map(|p| value(p.min(count - 1))).collect::<Vec<_>>();
        Self {
            count,
            stride,
            coordinates: (0..inputs).flat_map(|i| spread(&|p| flat[p * inputs + i])).collect(),
            columns: columns.iter().flat_map(|column| spread(&|p| column[p])).collect(),
            places: heads.lattices.iter().map(|l| flat.chunks_exact(inputs).map(|x| l.place(x)).collect()).collect(),
        }
    }
}

impl Group {
    /// A group whose points' weights are given, or none.
    pub(super) fn new(
        schema: &'static schema::Group,
        kernel: GroupKernel<f64>,
        sites: Sites,
        weights: Vec<f64>,
        (base, tests): (&Lattice, usize),
        flat: &[f64],
    ) -> Self {
        let operator = |jet: &schema::Jet| {
            let term = |(index, coefficient): &(&[u8], f64)| {
                let mut exponents = Exponents::default();
                exponents[..index.len()].copy_from_slice(index);
                (exponents, *coefficient)
            };
            jet.operator.iter().map(term).collect()
        };
        let mut heads: Vec<usize> = schema.jets.iter().map(|jet| jet.head).collect();
        heads.sort_unstable();
        heads.dedup();
        let nodes = if weights.is_empty() { Vec::new() } else { nodes(base, tests, flat, &weights) };
        Self {
            schema,
            kernel,
            operators: schema.jets.iter().map(operator).collect(),
            sigma: vec![1.0; schema.rows],
            sites,
            weights,
            nodes,
            tests,
            heads,
        }
    }

    /// Rows of the group at other points, and their derivatives if `slopes`.
    pub(super) fn evaluate_at(
        &self,
        sites: &Sites,
        heads: &Heads,
        theta: &[f64],
        scalars: &[f64],
        slopes: bool,
    ) -> Evaluated {
        let stride = sites.stride;
        let count = self.schema.jets.len();
        let mut jets = vec![0.0; count * stride];
        // Bounded heads: the slope of the jet by the head, and what the program does not see of it.
        let mut bounded: Vec<Vec<(f64, f64)>> = vec![Vec::new(); count];
        jets.par_chunks_mut(stride).zip(&mut bounded).enumerate().for_each(|(at, (jets, bounded))| {
            let (jet, operator) = (&self.schema.jets[at], &self.operators[at]);
            let is_value = jet.degree.iter().all(|&n| n == 0);
            let mut scratch = Vec::new();
            for (p, out) in jets.iter_mut().enumerate().take(sites.count) {
                let value = heads.derivative(jet.head, &sites.places[jet.head][p], operator, theta, &mut scratch);
                *out = if heads.bound[jet.head].is_some() && is_value {
                    let (raw, slope, rest) = heads.raw(jet.head, value);
                    bounded.push((slope, rest));
                    raw
                } else if is_value {
                    heads.offset[jet.head] + value
                } else {
                    value
                };
            }
            let last = jets[sites.count - 1];
            jets[sites.count..].fill(last);
        });
        let points = Points {
            count: sites.count,
            stride,
            jets: &jets,
            coordinates: &sites.coordinates,
            columns: &sites.columns,
            scalars,
            seeds: &[],
        };
        let mut rows = vec![0.0; self.schema.rows * stride];
        self.kernel.programs.residual(Isa::detect(), points, &mut rows);
        let straight = bounded.iter().all(|b| b.iter().all(|&(_, rest)| rest == 0.0));
        if !slopes && straight {
            return Evaluated { stride, rows, bars: Vec::new() };
        }
        let mut bars: Vec<Vec<f64>> = (0..self.schema.rows)
            .into_par_iter()
            .map(|row| {
                let mut seeds = vec![0.0; self.schema.rows * stride];
                seeds[row * stride..][..stride].fill(1.0);
                let mut bars = vec![0.0; (count + scalars.len()) * stride];
                self.kernel.programs.adjoint(Isa::detect(), Points { seeds: &seeds, ..points }, &mut bars);
                bars
            })
            .collect();
        for (jet, bounded) in bounded.iter().enumerate() {
            for (row, bars) in bars.iter_mut().enumerate() {
                for (p, &(slope, rest)) in bounded.iter().enumerate() {
                    let bar = &mut bars[jet * stride + p];
                    *bar *= slope;
                    rows[row * stride + p] += *bar * rest;
                }
            }
        }
        Evaluated { stride, rows, bars }
    }

    fn evaluate(&self, heads: &Heads, theta: &[f64], scalars: &[f64], slopes: bool) -> Evaluated {
        self.evaluate_at(&self.sites, heads, theta, scalars, slopes)
    }

    /// Rows whose terms are tested or asked for at every point.
    fn own_rows(&self) -> Vec<usize> {
        let terms = self.schema.terms.iter();
        let own = terms.filter(|term| matches!(term.kind, TermKind::Residual | TermKind::Observation));
        own.flat_map(|term| term.first..term.first + term.rows).collect()
    }

    /// Name of the term of one of [`Group::own_rows`], as the user wrote it.
    pub(super) fn name(&self, at: usize) -> String {
        let row = self.own_rows()[at];
        let term = self.schema.terms.iter().find(|term| (term.first..term.first + term.rows).contains(&row));
        format!("{}.{}", self.schema.name, term.map_or("", |term| term.name))
    }

    /// Rows over their tolerances and their derivatives.
    pub(super) fn blocks(&self, heads: &Heads, theta: &[f64], scalars: &[f64], learned: &[f64]) -> Vec<Block> {
        let rows = self.own_rows();
        if rows.is_empty() {
            return Vec::new();
        }
        let evaluated = self.evaluate(heads, theta, scalars, true);
        let at_point = |p: usize| {
            let mut block = self.empty(heads, rows.len(), learned, |lattice| {
                heads.lattices[lattice].cell_span(&self.sites.places[lattice][p])
            });
            self.add(&mut block, heads, &evaluated, &rows, p, 1.0);
            block
        };
        let mut points: Vec<Block> = (0..self.sites.count).into_par_iter().map(at_point).collect();
        if self.weights.is_empty() {
            points.par_iter_mut().for_each(|block| block.divide(rows.iter().map(|&row| self.sigma[row])));
            return points;
        }
        let dimensions = heads.lattices[0].dimensions();
        self.nodes
            .par_iter()
            .map(|node| {
                let mut block = self.empty(heads, rows.len(), learned, |head| self.span(heads, node, head));
                node.points.iter().for_each(|&(p, share)| block.add_share(&points[p as usize], share, dimensions));
                block.divide(rows.iter().map(|&row| self.sigma[row] / node.weight));
                block
            })
            .collect()
    }

    /// Half the sum of squares of the rows over their tolerances, integrals among them.
    pub(super) fn loss(&self, heads: &Heads, theta: &[f64], scalars: &[f64]) -> f64 {
        let evaluated = self.evaluate(heads, theta, scalars, false);
        let square = |row: usize, value: f64| 0.5 * (value / self.sigma[row]).powi(2);
        let mut own = 0.0;
        for row in self.own_rows() {
            own += match self.weights.is_empty() {
                true => (0..self.sites.count).map(|p| square(row, evaluated.row(row, p))).sum::<f64>(),
                false => self.nodes.iter().map(|node| square(row, node.weight * node.mean(&evaluated, row))).sum(),
            };
        }
        let integrals = self.targets(scalars).into_iter().map(|(row, target)| {
            let sum: f64 = (0..self.sites.count).map(|p| self.weight(p) * evaluated.row(row, p)).sum();
            square(row, sum - target)
        });
        own + integrals.sum::<f64>()
    }

    /// Weight of a point in integrals.
    fn weight(&self, p: usize) -> f64 {
        self.weights.get(p).copied().unwrap_or(1.0)
    }

    /// Rows of integral terms, and what they are to be.
    fn targets(&self, scalars: &[f64]) -> Vec<(usize, f64)> {
        let terms = self.schema.terms.iter().filter(|term| term.kind == TermKind::Integral);
        let rows: Vec<usize> = terms.flat_map(|term| term.first..term.first + term.rows).collect();
        if rows.is_empty() {
            return Vec::new();
        }
        let mut targets = vec![0.0; self.schema.rows];
        self.kernel.programs.target(scalars, &mut targets);
        rows.into_iter().map(|row| (row, targets[row])).collect()
    }

    /// Functions of a head around a test.
    fn span(&self, heads: &Heads, node: &Node, head: usize) -> Span {
        let lattice = &heads.lattices[head];
        let times = lattice.cells[0] / heads.lattices.iter().map(|l| l.cells[0]).min().unwrap_or(1);
        Span { first: node.cell.map(|cell| cell * times), count: (self.tests + 1) * times + lattice.degree }
    }

    /// One row at a point, of nothing yet.
    pub(super) fn at_point(&self, heads: &Heads, sites: &Sites, p: usize, learned: &[f64]) -> Block {
        self.empty(heads, 1, learned, |head| heads.lattices[head].cell_span(&sites.places[head][p]))
    }

    fn empty(&self, heads: &Heads, rows: usize, learned: &[f64], span: impl Fn(usize) -> Span) -> Block {
        let mut block = Block::new(rows, learned);
        for &head in &self.heads {
            let span = span(head);
            let first = heads.first[head] as u32;
            let numbers = heads.lattices[head].kept(span);
            block.add_head(head, span, numbers.map(|n| if n == NONE { NONE } else { first + n }));
        }
        block
    }

    /// Adds a point's rows and their derivatives, times its share.
    fn add(&self, block: &mut Block, heads: &Heads, evaluated: &Evaluated, rows: &[usize], p: usize, share: f64) {
        for (at, &row) in rows.iter().enumerate() {
            block.misfits[at] += share * evaluated.rows[row * evaluated.stride + p];
        }
        self.add_slopes(block, heads, &self.sites, p, |at, bar| share * evaluated.bar(rows[at], bar, p));
    }

    /// Adds the derivatives of rows, of which `seed(row, jet or learned scalar)` gives the derivative by a jet.
    pub(super) fn add_slopes(
        &self,
        block: &mut Block,
        heads: &Heads,
        sites: &Sites,
        p: usize,
        seed: impl Fn(usize, usize) -> f64,
    ) {
        let mut values = Vec::new();
        for (number, (jet, operator)) in self.schema.jets.iter().zip(&self.operators).enumerate() {
            let lattice = &heads.lattices[jet.head];
            let place = &sites.places[jet.head][p];
            values.resize(lattice.per_cell(), 0.0);
            for (exponents, coefficient) in operator {
                lattice.values(place, exponents, &mut values);
                let factor = coefficient * heads.scale[jet.head];
                block.add_cell(jet.head, lattice, place, &values, |row| factor * seed(row, number));
            }
        }
        block.add_learned(|row, learned| seed(row, self.schema.jets.len() + learned));
    }

    /// The weighted sums of integral terms over the points, and their derivatives by every coefficient.
    pub(super) fn integrals(&self, heads: &Heads, theta: &[f64], scalars: &[f64]) -> Vec<Integral> {
        let rows = self.targets(scalars);
        if rows.is_empty() {
            return Vec::new();
        }
        let evaluated = self.evaluate(heads, theta, scalars, true);
        rows.into_iter()
            .map(|(row, target)| {
                let mut sum = Integral { misfit: -target, slopes: vec![0.0; heads.len()], sigma: self.sigma[row] };
                for p in 0..self.sites.count {
                    sum.misfit += self.weight(p) * evaluated.rows[row * evaluated.stride + p];
                    let mut block =
                        self.empty(heads, 1, &[], |head| heads.lattices[head].cell_span(&self.sites.places[head][p]));
                    self.add(&mut block, heads, &evaluated, &[row], p, self.weight(p));
                    for (&dof, slope) in block.dofs.iter().zip(&block.slopes) {
                        if dof != NONE {
                            sum.slopes[dof as usize] += slope;
                        }
                    }
                }
                sum
            })
            .collect()
    }
}

/// An integral's misfit, and its derivative by every coefficient.
pub(super) struct Integral {
    pub(super) misfit: f64,
    pub(super) slopes: Vec<f64>,
    pub(super) sigma: f64,
}

impl Node {
    /// Weighted mean of a row.
    fn mean(&self, evaluated: &Evaluated, row: usize) -> f64 {
        self.points.iter().map(|&(p, share)| share * evaluated.row(row, p as usize)).sum()
    }
}

impl Evaluated {
    /// Value of a row at a point.
    pub(super) fn row(&self, row: usize, p: usize) -> f64 {
        self.rows[row * self.stride + p]
    }

    /// Derivative of a row at a point by a jet or learned scalar.
    pub(super) fn bar(&self, row: usize, bar: usize, p: usize) -> f64 {
        self.bars[row][bar * self.stride + p]
    }
}

/// The tests of a group: splines of a degree on the base lattice, each with the points that it sees.
fn nodes(base: &Lattice, degree: usize, flat: &[f64], weights: &[f64]) -> Vec<Node> {
    let tests = base.refined(degree, 1);
    let mut found: std::collections::BTreeMap<usize, Node> = std::collections::BTreeMap::new();
    let mut values = vec![0.0; tests.per_cell()];
    for (p, point) in flat.chunks_exact(tests.dimensions()).enumerate() {
        let place = tests.place(point);
        tests.values(&place, &Exponents::default(), &mut values);
        let span = tests.cell_span(&place);
        for ((number, value), cell) in tests.numbers(span).zip(&values).zip(base.around(&place, degree)) {
            let node = found.entry(number).or_insert_with(|| Node { points: Vec::new(), cell, weight: 0.0 });
            node.points.push((p as u32, weights[p] * value));
            node.weight += weights[p] * value;
        }
    }
    let most = found.values().map(|node| node.weight).fold(0.0, f64::max);
    let mut nodes: Vec<Node> = found.into_values().filter(|node| node.weight > LEAST_MASS * most).collect();
    for node in &mut nodes {
        node.points.iter_mut().for_each(|(_, share)| *share /= node.weight);
        node.weight = (node.weight / most).sqrt();
    }
    nodes
}
