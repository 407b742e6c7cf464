//! How much rows count: classes of rows whose size is known, or found by the evidence.

use nalgebra::{DMatrix, DVector};

use crate::noise::Noise;
use crate::problem::Bound;
use crate::schema::{self, TermKind};
use crate::solve::fault::Fault;
use crate::solve::state::State;

/// Rows of one kind, over their size.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Class {
    /// What rows are divided by.
    pub(crate) size: f64,
    /// How the size is found; nothing if it is known.
    pub(crate) open: Option<Guess>,
    /// What the last step gained in the logarithm of the evidence, to first order.
    pub(crate) gain: f64,
    /// Logarithms of the last sizes, and how far the evidence wanted to go from each; the latest first.
    past: [[f64; 2]; DEPTH],
    /// How many of them there are.
    known: usize,
}

/// What is believed of a size before any row is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guess {
    /// Its value.
    pub(crate) size: f64,
    /// Worth as much as so many rows.
    pub(crate) count: f64,
    /// True where no source can have followed the rows that are left over. The more of these there are, the less the guess is worth:
    /// nothing from [`ENOUGH`] times its count on.
    pub(crate) yields: bool,
    /// No size is smaller.
    pub(crate) least: f64,
}

impl Guess {
    /// How many rows it is worth beside those that are left over.
    fn worth(&self, left: f64) -> f64 {
        if self.yields { (self.count - left / ENOUGH).max(0.0) } else { self.count }
    }
}

/// Sum of squares of a class's rows at their present size, how many there are, and how many of them the answer used up: the
/// trace of its influence matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) squares: f64,
    pub(crate) count: f64,
    pub(crate) used: f64,
}

/// Rows left over, beside those that a guess is worth, that say all of a size where no source can follow them.
const ENOUGH: f64 = 2.0;
/// Rows that are left over at least, as a share: fewer say nothing of a size.
const LEAST_LEFT: f64 = 1e-3;
/// Farthest step of the logarithm of a size.
const FARTHEST: f64 = 3.0;
/// What keeps an extrapolation bounded, beside the squares of its wishes.
const RIDGE: f64 = 1e-6;
/// Sizes of the past that a step looks back at.
const DEPTH: usize = 2;

/// Classes as plain numbers.
pub(crate) fn save_classes(classes: &[Class], saved: State, prefix: &str) -> State {
    let sizes: Vec<f64> = classes.iter().map(|class| class.size).collect();
    let past: Vec<f64> = classes.iter().flat_map(|class| class.past.as_flattened()).copied().collect();
    let known: Vec<f64> = classes.iter().map(|class| class.known as f64).collect();
    let parts = [("sizes", sizes), ("past", past), ("known", known)];
    parts.iter().fold(saved, |saved, (name, part)| saved.with(&format!("{prefix}{name}"), part))
}

/// Takes over what [`save_classes`] gave of the same problem.
pub(crate) fn restore_classes(classes: &mut [Class], saved: &State, prefix: &str) -> Result<(), Fault> {
    let of = |name: &str, each: usize| saved.sized::<f64>(&format!("{prefix}{name}"), each * classes.len());
    let (sizes, past, known) = (of("sizes", 1)?, of("past", 2 * DEPTH)?, of("known", 1)?);
    let all = sizes.into_iter().zip(known).zip(past.chunks_exact(2 * DEPTH));
    for (class, ((size, known), past)) in classes.iter_mut().zip(all) {
        (class.size, class.known) = (size, (known as usize).min(DEPTH));
        class.past.as_flattened_mut().copy_from_slice(past);
    }
    Ok(())
}

/// Moves sizes toward those at which the evidence is stationary (MacKay 1992). His steps are short where two sizes of one source
/// make up for each other, so that they are extrapolated from the last ones (Anderson 1965).
pub(crate) fn renew(classes: &mut [Class], tallies: &[Tally], is_held: impl Fn(usize) -> bool) {
    let wished: Vec<f64> = classes
        .iter()
        .zip(tallies)
        .enumerate()
        .map(|(at, (class, tally))| if is_held(at) { 0.0 } else { class.wished(*tally) })
        .collect();
    let extrapolated = extrapolated(classes, &wished);
    let slope = |at: usize| tallies[at].squares - (tallies[at].count - tallies[at].used);
    let is_ascent = |steps: &Vec<f64>| steps.iter().zip(&wished).map(|(step, wished)| step * wished).sum::<f64>() > 0.0;
    let steps = extrapolated.filter(is_ascent).unwrap_or_else(|| wished.clone());
    let is_any_held = (0..classes.len()).any(&is_held);
    for (at, class) in classes.iter_mut().enumerate() {
        let step = steps[at].clamp(-FARTHEST, FARTHEST);
        class.past.rotate_right(1);
        class.past[0] = [class.size.ln(), wished[at]];
        // What is wished while others are held is no past of what is wished without.
        class.known = if is_any_held { 0 } else { (class.known + 1).min(DEPTH) };
        class.gain = if class.open.is_some() && !is_held(at) { (step * slope(at)).abs() } else { 0.0 };
        if let Some(guess) = class.open.filter(|_| step != 0.0) {
            class.size = (class.size * step.exp()).max(guess.least);
        }
    }
}

/// Steps to where the wishes of the present and of the past together would vanish, if they were linear in the logarithms of the
/// sizes; nothing without a past.
fn extrapolated(classes: &[Class], wished: &[f64]) -> Option<Vec<f64>> {
    let open = || classes.iter().zip(wished).filter(|(class, _)| class.open.is_some());
    let depth = open().map(|(class, _)| class.known).min().unwrap_or(0);
    let change = |class: &Class, wished: f64, back: usize| wished - class.past[back][1];
    let sum = |of: &dyn Fn(&Class, f64) -> f64| open().map(|(class, &wished)| of(class, wished)).sum::<f64>();
    let normal = DMatrix::from_fn(depth, depth, |i, j| {
        sum(&|class, wished| change(class, wished, i) * change(class, wished, j))
    });
    let right = DVector::from_fn(depth, |i, _| sum(&|class, wished| change(class, wished, i) * wished));
    let ridge = DMatrix::identity(depth, depth) * (RIDGE * normal.trace());
    let parts = (depth > 0).then(|| (normal + ridge).cholesky())??.solve(&right);
    let step = |(class, &wished): (&Class, &f64)| {
        let own =
            |(back, part): (usize, &f64)| part * (class.size.ln() - class.past[back][0] + change(class, wished, back));
        if class.open.is_some() { wished - parts.iter().enumerate().map(own).sum::<f64>() } else { 0.0 }
    };
    let steps: Vec<f64> = classes.iter().zip(wished).map(step).collect();
    steps.iter().all(|step| step.is_finite()).then_some(steps)
}

/// Rows that the noise's estimate from differences is worth.
const NOISE_COUNT: f64 = 2.0;
/// Least noise, as a share of the spread of the data: rounding.
const LEAST_NOISE: f64 = 1e-10;

/// Classes of all terms of a problem, group after group: sizes that are declared, and noise as neighbouring data say. Rows that
/// are left over where there are no sources say it better, down to a share `told` of the data's spread.
pub(crate) fn of_terms(bound: &Bound, noise: &Noise, told: Option<f64>) -> Vec<Class> {
    let schema = bound.problem.scene().schema;
    let told = told.filter(|_| !schema.heads.iter().any(|head| head.source));
    let yields = told.is_some();
    let groups = schema.groups.iter().enumerate();
    let terms = groups.flat_map(|(at, group)| group.terms.iter().enumerate().map(move |(term, own)| (at, term, own)));
    let class = |(at, term, declared): (usize, usize, &schema::Term)| {
        let known = bound.sizes[at][term] / declared.weight.sqrt();
        match noise.of(at, term) {
            _ if declared.within.is_some() => Class::known(known),
            Some(found) => {
                let least = told.unwrap_or(LEAST_NOISE) * found.spread.max(f64::MIN_POSITIVE);
                let size = found.deviation.max(least);
                Class::open(size, Guess { size, count: NOISE_COUNT, yields, least })
            }
            None if matches!(declared.kind, TermKind::Observation | TermKind::Chamfer { .. }) => {
                let size = 1e-2 * known;
                Class::open(size, Guess { size, count: NOISE_COUNT, yields, least: 1e-9 * known })
            }
            None => Class::known(known),
        }
    };
    terms.map(class).collect()
}

impl Class {
    pub(crate) fn known(size: f64) -> Self {
        Self { size, open: None, gain: 0.0, past: [[0.0; 2]; DEPTH], known: 0 }
    }

    pub(crate) fn open(size: f64, guess: Guess) -> Self {
        Self { open: Some(guess), ..Self::known(size.max(guess.least)) }
    }

    /// Begins anew from a size.
    pub(crate) fn restart(&mut self, size: f64) {
        *self = Self { open: self.open, ..Self::known(size) };
    }

    /// Rows that say how large the size is, those that the guess is worth included; nothing unless rows alone may say it.
    pub(crate) fn told_by(&self, tally: &Tally) -> Option<f64> {
        let guess = self.open.filter(|guess| guess.yields && tally.count > 0.0)?;
        let left = (tally.count - tally.used).max(0.0);
        Some(left + guess.worth(left))
    }

    /// How far the logarithm of the size is from that of the mean square of the rows, where those that the answer used up do not
    /// count.
    fn wished(&self, tally: Tally) -> f64 {
        let Some(guess) = self.open.filter(|_| tally.count > 0.0) else { return 0.0 };
        let left = (tally.count - tally.used).max(LEAST_LEFT * tally.count);
        let worth = guess.worth(left);
        let square = (tally.squares * self.size.powi(2) + worth * guess.size.powi(2)) / (left + worth);
        let step = (square.sqrt().max(guess.least) / self.size).ln();
        if step.is_finite() { step } else { 0.0 }
    }
}
