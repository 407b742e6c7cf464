//! Over what length the noise that neighbouring rows share dies away: what the evidence says.
//!
//! The slope of the evidence by the logarithm of a length renews it as other sizes are renewed. Whether rows share noise at all is asked
//! when all kinds of smoothness have been tried without: their ends are tried again with it, unless the evidence does not grow with a slight
//! correlation, and what is likelier is kept.

use super::correlated::Link;
use super::iterate::{Phase, State};
use super::place::Place;
use super::prior::KINDS;
use super::solver::Solver;
use super::triangle::Row;
use super::triangle::covariance::Covariance;
use crate::noise::{Noise, ObservationNoise, beside_those_before, spacing};
use crate::rhythm::{FAINT, rhythm};
use crate::solve::driver::Warning;
use crate::solve::fault::Fault;
use crate::units::Number;
use crate::weighed::{Class, Guess, Tally};

/// Length at which the steps start, and the least one, over the mean distance of rows.
const BEGINS: f64 = 4.0;
const LEAST: f64 = 0.1;
/// Ratio of two lengths that are compared.
const LONGER: f64 = 1.5;
/// Longest length, as a share of the record.
const LONGEST: f64 = 0.25;
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
        let spacing = |(group, term): (usize, usize)| {
            let declared = &self.groups[group].schema.terms[term];
            spacing(&self.bound.measured(group, declared, &self.bound.coordinates[group])).unwrap_or(self.length)
        };
        let open = |spacing: f64| {
            let guess = Guess { size: 0.0, count: 0.0, yields: false, least: LEAST * spacing };
            Class::open(BEGINS * spacing, guess)
        };
        terms.map(spacing).map(open).collect()
    }

    /// The slope of the logarithm of the evidence by the logarithm of a term's length, about an iterate with its covariance, and what is
    /// known of that logarithm where the noise is seen as it is (the inverse of its variance).
    fn slope(&mut self, state: &State, at: (usize, usize), covariance: &Covariance) -> Result<(f64, f64), Fault> {
        let Some(class) = self.lengths[at.0][at.1] else { return Ok((0.0, 0.0)) };
        let slopes = self.set_learned(&state.learned);
        let length = state.classes[class].size;
        let worth = |length: f64| {
            let mut other = state.clone();
            other.classes[class].size = length;
            let mut used = 0.0;
            let mut count = |row: Row<'_>| used += covariance.of(row.first, row.slopes, row.shared);
            let half = self.chained(&other, at, (length, &slopes), &mut count)?;
            Ok::<f64, Fault>(-half - 0.5 * used - self.log_rest(&other, at))
        };
        let slope = (worth(length * STEP.exp())? - worth(length)?) / STEP;
        let known = |link: Link| {
            let shared = link.before.map_or(0.0, |(_, shared)| shared);
            if shared == 0.0 { 0.0 } else { (shared * shared.ln() / link.rest()).powi(2) * (1.0 + shared * shared) }
        };
        let rows = self.groups[at.0].schema.terms[at.1].rows as f64;
        Ok((slope, rows * self.links(at, length).into_iter().map(known).sum::<f64>()))
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
                let Some(class) = self.lengths[group][term].filter(|_| state.correlated) else { continue };
                let (slope, known) = self.slope(state, (group, term), covariance)?;
                let left = 0.5 * known;
                let is_longest = state.classes[class].size >= LONGEST * self.length && slope > 0.0;
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
        for (group, terms) in self.all_lengths(state).into_iter().enumerate() {
            for (term, length) in terms.into_iter().enumerate() {
                let Some(length) = length.map(|length| LONGER * length).filter(|own| *own <= LONGEST * self.length)
                else {
                    continue;
                };
                let Some(class) = self.lengths[group][term] else { continue };
                longer.classes[class].size = length;
                longer.classes[self.classes[group][term]].size *= LONGER.sqrt();
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
        let lengths = self.all_lengths(state).into_iter().enumerate();
        let of = |(group, terms): (usize, Vec<Option<f64>>)| {
            let own = terms.into_iter().enumerate().filter_map(|(term, length)| Some(words(group, term, length?)));
            own.collect::<Vec<Warning>>()
        };
        lengths.flat_map(of).collect()
    }

    /// Whether an end leaves a rhythm of a term whose noise is shared: a source that goes to and fro all along is not smooth, and such noise
    /// is likelier than it, but makes none.
    pub(super) fn leaves_rhythm(&mut self, state: &State) -> bool {
        let misfits = self.misfits(state);
        let leaves = |(group, term): (usize, usize), length: f64| {
            let declared = &self.groups[group].schema.terms[term];
            let places = self.bound.measured(group, declared, &self.bound.coordinates[group]);
            let deviation = state.classes[self.classes[group][term]].size;
            let noise = ObservationNoise { group, term, deviation, spread: deviation };
            misfits[group][term].0.chunks_exact(places.len().max(1)).any(|row| {
                let own = beside_those_before(&places, row, length);
                rhythm(&places, &own, noise).is_some_and(|swing| swing.amplitude > FAINT * deviation)
            })
        };
        let lengths = self.all_lengths(state);
        let all =
            lengths.iter().enumerate().flat_map(|(group, terms)| terms.iter().enumerate().map(move |at| (group, at)));
        all.filter_map(|(group, (term, length))| Some(((group, term), (*length)?)))
            .any(|(at, length)| leaves(at, length))
    }

    /// Where steps start again with noise that neighbouring rows share; nothing where the evidence does not grow with it at the best end,
    /// and where the data are exact.
    pub(super) fn correlated(&mut self, noise: &Noise, place: &Place) -> Result<Option<State>, Fault> {
        let Some(best) = place.best().filter(|best| !best.state.correlated && !noise.is_exact()).cloned() else {
            return Ok(None);
        };
        let lengths = self.lengths.iter().enumerate().flat_map(|(group, terms)| {
            terms.iter().enumerate().filter_map(move |(term, class)| Some(((group, term), (*class)?)))
        });
        let lengths: Vec<((usize, usize), usize)> = lengths.collect();
        if lengths.is_empty() {
            return Ok(None);
        }
        let mut slight = State { correlated: true, ..best.state.clone() };
        for &(_, class) in &lengths {
            let length = slight.classes[class].size / BEGINS / -SLIGHT.ln();
            slight.classes[class].restart(length);
        }
        self.set_smoothness(KINDS[best.kind], &best.state);
        let Some(found) = self.step(&slight, Phase::Solve)? else { return Ok(None) };
        let slight = State { classes: slight.classes, ..found.next };
        let mut grows = false;
        for &(at, _) in &lengths {
            grows |= self.slope(&slight, at, &found.covariance)?.0 > 0.0;
        }
        if !grows {
            return Ok(None);
        }
        // Sources begin as smooth as those of the first start.
        self.set_smoothness(KINDS[0], &State { uneven: Vec::new(), ..best.state.clone() });
        let mut first = State { correlated: true, blurred: best.state.blurred, ..self.first(noise) };
        for &((group, term), _) in &lengths {
            // Differences of neighbours see what they do not share.
            let alike = (-BEGINS.recip()).exp();
            let own = self.classes[group][term];
            let size = first.classes[own].size;
            first.classes[own].restart(size * ((1.0 + alike) / (1.0 - alike)).sqrt());
        }
        Ok(Some(State { step: place.state.step, ..first }))
    }
}
