//! What an answer says at the points of a group, and what its programs make of it.

use nalgebra::Vector3;

use crate::noise::SharedNoise;
use crate::residual::Points;
use crate::residual::Programs;
use crate::schema;
use crate::simd::Isa;
use crate::solve::vector::root_mean_square;

/// What is left of an equation, beside the sum of the magnitudes of its terms, where these balance each other.
const BALANCED: f64 = 0.5;

/// Values and derivatives of an answer at a group's points, in the engine's units.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    /// Number of points.
    pub(crate) points: usize,
    /// Distance between quantities: a multiple of every vector length.
    pub(crate) stride: usize,
    /// `[jet][point]`
    pub(crate) jets: Vec<f64>,
    /// `[coordinate][point]`, then those of partners.
    pub(crate) coordinates: Vec<f64>,
    /// `[column][point]`
    pub(crate) columns: Vec<f64>,
    /// Weighted means that equations are asked of instead of points; empty if of points.
    pub(crate) means: Vec<Vec<(u32, f64)>>,
}

impl Facts {
    /// Raw rows, `[row][place]`: places are points, or means over points.
    pub(crate) fn rows(&self, programs: &dyn Programs<f64>, group: &schema::Group, scalars: &[f64]) -> Vec<Vec<f64>> {
        self.rows_with(programs, group, (&self.jets, &self.columns), scalars)
    }

    /// Raw rows with other jets and columns.
    pub(crate) fn rows_with(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        (jets, columns): (&[f64], &[f64]),
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut rows = vec![0.0; group.rows * self.stride];
        programs.residual(Isa::detect(), self.inputs(jets, columns, scalars, &[]), &mut rows);
        (0..group.rows).map(|row| self.at_places(&rows[row * self.stride..][..self.stride])).collect()
    }

    /// What a program gives at all points, `[row][point]`.
    fn by_row(
        &self,
        group: &schema::Group,
        scalars: &[f64],
        program: impl FnOnce(Points<'_, f64>, &mut [f64]),
    ) -> Vec<Vec<f64>> {
        let mut rows = vec![0.0; group.rows * self.stride];
        program(self.inputs(&self.jets, &self.columns, scalars, &[]), &mut rows);
        rows.chunks_exact(self.stride).map(|row| row[..self.points].to_vec()).collect()
    }

    /// Raw rows at all points, `[row][point]`.
    pub(crate) fn plain_rows(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        self.by_row(group, scalars, |points, rows| programs.residual(Isa::detect(), points, rows))
    }

    /// Sums of the magnitudes of what the rows at all points add up, `[row][point]`.
    pub(crate) fn magnitudes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        self.by_row(group, scalars, |points, rows| programs.magnitude(points, rows))
    }

    /// Sizes of all rows, as the sum of the magnitudes of what they add up; at least the `natural` ones of their terms where
    /// nothing balances this yet, or ever, as in a quantity that vanishes. Of terms with `within` the natural ones.
    pub(crate) fn sizes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
        natural: &[f64],
    ) -> Vec<f64> {
        let [sizes, misfits] = [self.magnitudes(programs, group, scalars), self.plain_rows(programs, group, scalars)]
            .map(|rows| rows.iter().map(|row| root_mean_square(row.iter().copied())).collect::<Vec<f64>>());
        let mut found = vec![0.0; group.rows];
        for (term, &natural) in group.terms.iter().zip(natural) {
            for row in term.first..term.first + term.rows {
                let (size, is_balanced) = (sizes[row], misfits[row] < BALANCED * sizes[row]);
                found[row] = match term.within {
                    None if is_balanced => size,
                    None if size.is_finite() => size.max(natural),
                    _ => natural,
                };
            }
        }
        found
    }

    /// By row, how far noise of its columns puts it off (root mean square).
    pub(crate) fn blurs(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        scalars: &[f64],
        noise: &[f64],
    ) -> Vec<f64> {
        let mut squares = vec![0.0; group.rows];
        if noise.iter().all(|noise| *noise == 0.0) {
            return squares;
        }
        let own = self.rows(programs, group, scalars);
        for (column, noise) in noise.iter().enumerate().filter(|(_, noise)| **noise > 0.0) {
            let mut moved = self.columns.clone();
            moved[column * self.stride..][..self.stride].iter_mut().for_each(|value| *value += noise);
            let moved = self.rows_with(programs, group, (&self.jets, &moved), scalars);
            for (square, (own, moved)) in squares.iter_mut().zip(own.iter().zip(moved)) {
                let off = root_mean_square(own.iter().zip(moved).map(|(own, moved)| moved - own));
                *square += if off.is_finite() { off * off } else { 0.0 };
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }

    /// Derivatives of a row by the jets, `[jet][point]`.
    pub(crate) fn slopes(
        &self,
        programs: &dyn Programs<f64>,
        group: &schema::Group,
        row: usize,
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut seeds = vec![0.0; group.rows * self.stride];
        seeds[row * self.stride..][..self.stride].fill(1.0);
        let mut bars = vec![0.0; (group.jets.len() + scalars.len()) * self.stride];
        programs.adjoint(Isa::detect(), self.inputs(&self.jets, &self.columns, scalars, &seeds), &mut bars);
        (0..group.jets.len()).map(|jet| bars[jet * self.stride..][..self.points].to_vec()).collect()
    }

    fn inputs<'a>(
        &'a self,
        jets: &'a [f64],
        columns: &'a [f64],
        scalars: &'a [f64],
        seeds: &'a [f64],
    ) -> Points<'a, f64> {
        let Self { points, stride, ref coordinates, .. } = *self;
        Points { count: points, stride, jets, coordinates, columns, scalars, seeds }
    }

    fn at_places(&self, values: &[f64]) -> Vec<f64> {
        if self.means.is_empty() {
            return values[..self.points].to_vec();
        }
        self.means.iter().map(|mean| mean.iter().map(|&(p, share)| share * values[p as usize]).sum()).collect()
    }
}

/// A cloud, and how far its points are off a surface, in the engine's units.
#[derive(Clone)]
pub(crate) struct CloudFacts {
    pub(crate) group: usize,
    pub(crate) term: &'static str,
    pub(crate) points: Vec<[f64; 3]>,
    /// Where on the surface at rest each point belongs: neighbours there are neighbours whatever the noise.
    pub(crate) places: Vec<[f64; 3]>,
    /// Distance of every point to the surface; nothing where the surface has no place for it.
    pub(crate) misfits: Vec<Option<f64>>,
    /// True if distances have a sign, by the side of the surface.
    pub(crate) signed: bool,
    /// Distances that the carrier cannot resolve.
    pub(crate) resolution: f64,
}

/// Something that a problem takes for known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Known {
    /// The value of a given scalar, by its slot.
    Scalar(usize),
    /// Where a cloud is, along an axis.
    Place { cloud: usize, axis: usize },
    /// How a cloud is turned about an axis through its middle.
    Direction { cloud: usize, axis: usize },
    /// How large a cloud is.
    Size { cloud: usize },
}

/// What would come of it if something known were unknown, by Rao's score test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    pub(crate) known: Known,
    /// Whether a prior for few sources has a part in it.
    pub(crate) by_prior: bool,
    /// What the loss would be less.
    pub(crate) gain: f64,
    /// By how much it would be otherwise: a share of a value, of a cloud's size or of its radius, or an angle.
    pub(crate) change: f64,
}

impl Score {
    /// From the slope of the loss by a number, and its curvature, where all unknowns follow; nothing where they take all. Steps are no longer
    /// than the model may be trusted.
    pub(crate) fn by((known, by_prior): (Known, bool), slope: f64, curvature: f64) -> Option<Self> {
        /// The longest step: a share of a number or of a cloud's radius, or an angle.
        const FARTHEST: f64 = 0.3;
        let change = (-slope / curvature).clamp(-FARTHEST, FARTHEST);
        let gain = -change * (slope + 0.5 * curvature * change);
        (curvature > 0.0 && gain.is_finite()).then_some(Self { known, by_prior, gain, change })
    }
}

/// How much is told of a source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told {
    pub(crate) head: usize,
    /// Its root mean square in standard deviations of each place, over the time along which it is alike; nothing where there are no
    /// deviations.
    pub(crate) size: Option<f64>,
    /// Deviations by which the true source is nearer to it than to none, in the mean square.
    pub(crate) nearer: f64,
    /// Share that the data leave of what was not known of its mean beforehand, as a variance; zero where that is not asked.
    pub(crate) open: f64,
}

impl Told {
    /// Of a source without deviations.
    pub(crate) fn unasked(head: usize) -> Self {
        Self { head, size: None, nearer: 0.0, open: 0.0 }
    }
}

/// The middle of a cloud, and its radius: the root mean square of the distances from there.
pub(crate) fn spread(points: impl ExactSizeIterator<Item = Vector3<f64>> + Clone) -> (Vector3<f64>, f64) {
    let count = points.len().max(1) as f64;
    let middle = points.clone().sum::<Vector3<f64>>() / count;
    let square = points.map(|point| (point - middle).norm_squared()).sum::<f64>() / count;
    (middle, square.sqrt())
}

/// How much larger a source may be than the evidence says, for what learned scalars would be then.
pub(crate) const LARGER: f64 = 3.0;

/// What is known of a scalar that is learned beside sources, of its parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaning {
    /// How far it moves where sources may be [`LARGER`] times as large; nothing where there was no time.
    pub(crate) moved: Option<f64>,
    /// Its deviation; nothing without error bars.
    pub(crate) deviation: Option<f64>,
    /// Whether it was found by the whole evidence, so that its deviation says how far it may move. Where only sums of squares were,
    /// it is the one whose sources are smallest, and more sure than it should be.
    pub(crate) is_weighed: bool,
}

/// What a carrier says of its answer, in the engine's units.
#[derive(Clone)]
pub(crate) struct Answer {
    /// By group.
    pub(crate) facts: Vec<Facts>,
    /// Numbers of groups of equations, and their facts at places where the solver did not ask them: of lattices, and of networks where
    /// nothing is measured.
    pub(crate) between: Vec<(usize, Facts)>,
    pub(crate) clouds: Vec<CloudFacts>,
    /// Scalars that programs read, learned ones at their found values.
    pub(crate) scalars: Vec<f64>,
    /// What is known, doubted; empty where the carrier does not tell.
    pub(crate) scores: Vec<Score>,
    /// How much is told of sources; empty where the carrier does not say.
    pub(crate) told: Vec<Told>,
    /// By learned scalar; empty without sources, and where the carrier does not tell.
    pub(crate) leaning: Vec<Leaning>,
    /// The largest change of a learned scalar's parameter in one more whole Gauss-Newton step; nothing at the end of the steps, and
    /// where the carrier does not tell.
    pub(crate) ahead: Option<f64>,
    /// How far the last step moved a source, over its size, at most; nothing at the end of the steps, and where the carrier does not
    /// tell.
    pub(crate) moved: Option<f64>,
    /// How far the cells hold the answer back, over what may be, where the budget ended before finer ones were tried.
    pub(crate) strain: Option<f64>,
    /// By group and term, the noise that neighbouring rows share; nothing where each has its own. Empty where the carrier knows no such noise.
    pub(crate) shared: Vec<Vec<Option<SharedNoise>>>,
    /// How much the last finer lattice has changed an answer without noise, as a share; nothing where there was none.
    pub(crate) refined: Option<f64>,
    /// Share of the measurements that the answer was made from.
    pub(crate) used: f64,
    /// What to do where the carrier may be too coarse.
    pub(crate) finer: &'static str,
}

impl Answer {
    /// The noise that neighbouring rows of an observation share.
    pub(crate) fn shared(&self, group: usize, term: usize) -> Option<SharedNoise> {
        *self.shared.get(group)?.get(term)?
    }
}

/// What to do where splines, on a line or a lattice, may be too coarse: no option makes their cells finer.
pub(crate) const OTHER_THAN_SPLINES: &str = "--carrier network tries another one";
