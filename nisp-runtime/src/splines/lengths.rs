//! Over what length the noise that neighbouring rows share dies away: what the evidence says.
//!
//! The slope of the evidence by the logarithm of a length renews it as other sizes are renewed. Whether rows share noise at all is asked
//! when all kinds of smoothness have been tried without: their ends are tried again with it, unless the evidence does not grow with a slight
//! correlation, and what is likelier is kept.

use super::correlated::Link;
use super::iterate::{Phase, State};
use super::place::{Place, Tried};
use super::prior::KINDS;
use super::solver::Solver;
use super::triangle::Row;
use super::triangle::covariance::Covariance;
use crate::noise::{Noise, ObservationNoise};
use crate::rhythm::{FAINT, rhythm};
use crate::shared_noise::{Alike, SharedNoise, beside_those_before, spacing};
use crate::solve::driver::Warning;
use crate::solve::fault::Fault;
use crate::solve::vector::root_mean_square;
use crate::units::Number;
use crate::weighed::{Class, Guess, Tally};

/// Length at which the steps start, and the least one, over the mean distance of rows.
const BEGINS: f64 = 4.0;
const LEAST: f64 = 0.1;
/// Ratio of two lengths that are compared.
const LONGER: f64 = 1.5;
/// Longest length, as a share of the record.
const LONGEST: f64 = 0.25;
/// The same in rows, where no source follows what neighbours share.
const FEW_ROWS: f64 = 2.0;
/// Length of smooth noise over that of a walk which is as alike at half of its size.
const SMOOTHER: f64 = 1.4;
/// Rows below which noise is not asked whether it is smooth from row to row. Of shorter simulated records whose noise is each row's own, one in
/// ten would be called filtered: few rows that swing, or that lie in clusters, look so.
const MANY: usize = 100;
/// Correlation of neighbouring rows at which it is asked whether the evidence grows with it.
const SLIGHT: f64 = 0.02;
/// Change of the logarithm of a length over which the slope of the evidence is taken, and the farthest step of it.
const STEP: f64 = 1e-3;
const FARTHEST: f64 = 1.0;

impl Solver<'_> {
    /// The classes of lengths where steps start.
    pub(super) fn first_lengths(&self) -> Vec<Class> {
        let terms = self.lengths.iter().enumerate().flat_map(|(group, terms)| {
            terms.iter().enumerate().filter_map(move |(term, class)| class.map(|_| (group, term)))
        });
        let open = |spacing: f64| {
            let guess = Guess { size: 0.0, count: 0.0, yields: false, least: LEAST * spacing };
            Class::open(self.begins() * spacing, guess)
        };
        terms.map(|at| open(self.spacing(at))).collect()
    }

    /// The usual distance of a term's rows.
    fn spacing(&self, (group, term): (usize, usize)) -> f64 {
        let declared = &self.groups[group].schema.terms[term];
        spacing(&self.bound.measured(group, declared, &self.bound.coordinates[group])).unwrap_or(self.length)
    }

    /// The length at which the steps start, over the usual distance of rows.
    fn begins(&self) -> f64 {
        if self.has_sources() { BEGINS } else { 0.5 * FEW_ROWS }
    }

    /// The longest length of a term.
    fn longest(&self, at: (usize, usize)) -> f64 {
        let longest = LONGEST * self.length;
        if self.has_sources() { longest } else { longest.min(FEW_ROWS * self.spacing(at)) }
    }

    /// The slope of the logarithm of the evidence by the logarithm of a term's length, about an iterate with its covariance, and what is
    /// known of that logarithm where the noise is seen as it is (the inverse of its variance).
    fn slope(&mut self, state: &State, at: (usize, usize), covariance: &Covariance) -> Result<(f64, f64), Fault> {
        let (Some(class), Some(shared)) = (self.lengths[at.0][at.1], self.shared(state, at)) else {
            return Ok((0.0, 0.0));
        };
        let slopes = self.set_learned(&state.learned);
        let longer = SharedNoise { length: shared.length * STEP.exp(), ..shared };
        let worth = |noise: SharedNoise| {
            let mut other = state.clone();
            other.classes[class].size = noise.length;
            let mut used = 0.0;
            let mut count = |row: Row<'_>| used += covariance.of(row.first, row.slopes, row.shared);
            let half = self.chained(&other, at, (noise, &slopes), &mut count)?;
            Ok::<f64, Fault>(-half - 0.5 * used - self.log_rest(&other, at))
        };
        let slope = (worth(longer)? - worth(shared)?) / STEP;
        // Of a row beside those before it, the noise's size and what is expected change with the length (Fisher's information).
        let places = &self.groups[at.0].coordinates;
        let known = |(own, other): (Link, Link)| {
            let weights = own.expected.weights.iter().zip(&other.expected.weights);
            let change: Vec<f64> = weights.map(|(from, to)| (to - from) / STEP).collect();
            let alike = |(i, j): (usize, usize)| match i == j {
                true => 1.0,
                false => shared.correlation((places[own.before[i]] - places[own.before[j]]).abs()),
            };
            let all = (0..change.len()).flat_map(|i| (0..change.len()).map(move |j| (i, j)));
            let expected: f64 = all.map(|(i, j)| change[i] * alike((i, j)) * change[j]).sum();
            let size = (other.expected.rest / own.expected.rest).ln() / STEP;
            0.5 * size * size + expected / own.expected.rest
        };
        let links = self.links(at, shared).into_iter().zip(self.links(at, longer));
        let rows = self.groups[at.0].schema.terms[at.1].rows as f64;
        Ok((slope, rows * links.map(known).sum::<f64>()))
    }

    /// Counts the classes of lengths so that they are renewed as other sizes are.
    pub(super) fn count_lengths(
        &mut self,
        state: &State,
        covariance: &Covariance,
        tallies: &mut [Tally],
    ) -> Result<(), Fault> {
        for group in 0..self.lengths.len() {
            for term in 0..self.lengths[group].len() {
                let Some(class) = self.lengths[group][term].filter(|_| state.sharing.is_some()) else { continue };
                let (slope, known) = self.slope(state, (group, term), covariance)?;
                let left = 0.5 * known;
                let is_longest = state.classes[class].size >= self.longest((group, term)) && slope > 0.0;
                let share = if is_longest || left == 0.0 { 1.0 } else { 1.0 + slope / left };
                let squares = left * share.clamp((-2.0 * FARTHEST).exp(), (2.0 * FARTHEST).exp());
                tallies[class] = Tally { squares, count: left, used: 0.0 };
            }
        }
        Ok(())
    }

    /// The same state with noise that is shared over longer lengths, and as large from one row to the next; nothing where rows have their own,
    /// and where lengths are as long as they may be.
    pub(super) fn longer(&self, state: &State) -> Option<State> {
        let mut longer = state.clone();
        let mut is_longer = false;
        for (group, terms) in self.all_shared(state).into_iter().enumerate() {
            for (term, noise) in terms.into_iter().enumerate() {
                let Some(noise) = noise.filter(|own| LONGER * own.length <= self.longest((group, term))) else {
                    continue;
                };
                let Some(class) = self.lengths[group][term] else { continue };
                longer.classes[class].size = LONGER * noise.length;
                longer.classes[self.classes[group][term]].size *= LONGER.powf(noise.alike.growth());
                is_longer = true;
            }
        }
        is_longer.then_some(longer)
    }

    /// Warnings of noise that rows share.
    pub(super) fn shared_noise(&self, state: &State) -> Vec<Warning> {
        let coordinate = &self.bound.problem.scene().schema.coordinates[0];
        let words = |group: usize, term: usize, length: f64| {
            let length = self.bound.system.outward(&coordinate.unit).of(Number::engine(length));
            let unit = coordinate.unit.behind();
            Warning::shared_noise(self.groups[group].schema.terms[term].name, &format!("{length:.2e}{unit}"))
        };
        let lengths = self.all_shared(state).into_iter().enumerate();
        let of = |(group, terms): (usize, Vec<Option<SharedNoise>>)| {
            let own = terms.into_iter().enumerate().filter_map(|(term, noise)| Some(words(group, term, noise?.length)));
            own.collect::<Vec<Warning>>()
        };
        lengths.flat_map(of).collect()
    }

    /// Whether an end leaves a rhythm of a term whose noise may be shared, beside what neighbours share at this end: a source that goes to
    /// and fro all along is not smooth, and such noise is likelier than it, but makes none.
    pub(super) fn leaves_rhythm(&mut self, state: &State) -> bool {
        let misfits = self.misfits(state);
        let leaves = |(group, term): (usize, usize), shared: Option<SharedNoise>| {
            let declared = &self.groups[group].schema.terms[term];
            let places = self.bound.measured(group, declared, &self.bound.coordinates[group]);
            let deviation = state.classes[self.classes[group][term]].size;
            let noise = ObservationNoise { group, term, deviation, spread: deviation };
            misfits[group][term].0.chunks_exact(places.len().max(1)).any(|row| {
                let own = shared.map(|shared| beside_those_before(&places, row, shared));
                rhythm(&places, own.as_deref().unwrap_or(row), noise)
                    .is_some_and(|swing| swing.amplitude > FAINT * deviation)
            })
        };
        let shared = self.all_shared(state);
        let all = shared.iter().enumerate().flat_map(|(at, terms)| terms.iter().enumerate().map(move |own| (at, own)));
        let may_share = |at: &(usize, (usize, _))| self.lengths[at.0][at.1.0].is_some();
        all.filter(may_share).any(|(group, (term, shared))| leaves((group, term), *shared))
    }

    /// Where steps start again with noise that neighbouring rows share, as walks do; nothing where the evidence does not grow with it at the
    /// best end of those whose rows share none, and where the data are exact.
    pub(super) fn sharing(&mut self, noise: &Noise, place: &Place) -> Result<Option<State>, Fault> {
        let Some(best) = place.best_of(None).filter(|_| !noise.is_exact()).cloned() else { return Ok(None) };
        let lengths = self.lengths.iter().enumerate().flat_map(|(group, terms)| {
            terms.iter().enumerate().filter_map(move |(term, class)| Some(((group, term), (*class)?)))
        });
        let lengths: Vec<((usize, usize), usize)> = lengths.collect();
        // Without a source nothing but a wrong equation leaves a rhythm.
        if !self.has_sources() && self.leaves_rhythm(&best.state) {
            return Ok(None);
        }
        if lengths.is_empty() || self.goes_through(&best.state, &lengths, noise) || !self.grows(&best, &lengths)? {
            return Ok(None);
        }
        // Sources begin as smooth as those of the first start.
        self.set_smoothness(KINDS[0], &State { uneven: Vec::new(), ..best.state.clone() });
        let first = self.first(noise);
        let mut first = State { sharing: Some(Alike::Rough), blurred: best.state.blurred, ..first };
        for &((group, term), _) in &lengths {
            // Differences of neighbours see what they do not share.
            let alike = (-self.begins().recip()).exp();
            let own = self.classes[group][term];
            let size = first.classes[own].size;
            first.classes[own].restart(size * ((1.0 + alike) / (1.0 - alike)).sqrt());
        }
        Ok(Some(State { step: place.state.step, ..first }))
    }

    /// True at an end that goes through all data: what is left says nothing of their noise.
    fn goes_through(&mut self, state: &State, lengths: &[((usize, usize), usize)], noise: &Noise) -> bool {
        let misfits = self.misfits(state);
        lengths.iter().all(|&((group, term), _)| {
            let left = root_mean_square(misfits[group][term].0.iter().copied());
            noise.of(group, term).is_some_and(|noise| noise.is_followed(left))
        })
    }

    /// Whether rows are enough to tell smooth noise from a source that swings within few of them.
    pub(super) fn may_be_smooth(&self) -> bool {
        let shares = self.lengths.iter().enumerate().filter(|(_, terms)| terms.iter().any(Option::is_some));
        shares.into_iter().all(|(group, _)| self.bound.coordinates[group].len() >= MANY)
    }

    /// The same state with noise that is smooth from row to row.
    pub(super) fn smooth(&self, state: &State) -> State {
        let mut smooth = State { sharing: Some(Alike::Smooth), ..state.clone() };
        for class in self.lengths.iter().flatten().flatten() {
            smooth.classes[*class].restart(SMOOTHER * state.classes[*class].size);
        }
        smooth
    }

    /// Whether the evidence at an end whose rows share no noise grows with a slight correlation.
    fn grows(&mut self, best: &Tried, lengths: &[((usize, usize), usize)]) -> Result<bool, Fault> {
        let mut slight = State { sharing: Some(Alike::Rough), ..best.state.clone() };
        for &(_, class) in lengths {
            let length = slight.classes[class].size / self.begins() / -SLIGHT.ln();
            slight.classes[class].restart(length);
        }
        self.set_smoothness(KINDS[best.kind], &best.state);
        let Some(found) = self.step(&slight, Phase::Solve)? else { return Ok(false) };
        let slight = State { classes: slight.classes, ..found.next };
        for &(at, _) in lengths {
            if self.slope(&slight, at, &found.covariance)?.0 > 0.0 {
                return Ok(true);
            }
        }
        Ok(false)
    }
}
