//! How much rows count: classes of rows whose size is known, or found by the evidence.

use crate::solve::fault::Fault;
use crate::solve::state::State;

/// Rows of one kind, over their size.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Class {
    /// What rows are divided by.
    pub(super) size: f64,
    /// How the size is found; nothing if it is known.
    pub(super) open: Option<Guess>,
    /// How far the logarithm of the size went in the last step.
    pub(super) went: f64,
    /// What the step gained in the logarithm of the evidence, to first order.
    pub(super) gain: f64,
    /// How much farther than the evidence says steps go while they keep their direction.
    pub(super) haste: f64,
}

/// What is believed of a size before any row is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Guess {
    /// Its value.
    pub(super) size: f64,
    /// Worth as much as so many rows.
    pub(super) count: f64,
    /// No size is smaller.
    pub(super) least: f64,
}

/// Sum of squares of a class's rows at their present size, how many there are, and how many of them the answer used up: the
/// trace of its influence matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    pub(super) squares: f64,
    pub(super) count: f64,
    pub(super) used: f64,
}

/// Rows that are left over at least, as a share: fewer say nothing of a size.
const LEAST_LEFT: f64 = 1e-3;
/// Farthest step of the logarithm of a size.
const FARTHEST: f64 = 3.0;
/// Growth of the haste, and the most of it.
const HASTIER: f64 = 1.5;
const MOST_HASTE: f64 = 8.0;

/// Classes as plain numbers.
pub(super) fn save_classes(classes: &[Class], saved: State, prefix: &str) -> State {
    let of = |part: fn(&Class) -> f64| classes.iter().map(part).collect::<Vec<f64>>();
    saved
        .with(&format!("{prefix}sizes"), &of(|class| class.size))
        .with(&format!("{prefix}went"), &of(|class| class.went))
        .with(&format!("{prefix}haste"), &of(|class| class.haste))
}

/// Takes over what [`save_classes`] gave of the same problem.
pub(super) fn restore_classes(classes: &mut [Class], saved: &State, prefix: &str) -> Result<(), Fault> {
    let of = |name: &str| saved.sized::<f64>(&format!("{prefix}{name}"), classes.len());
    let (sizes, went, haste) = (of("sizes")?, of("went")?, of("haste")?);
    for (class, ((size, went), haste)) in classes.iter_mut().zip(sizes.into_iter().zip(went).zip(haste)) {
        (class.size, class.went, class.haste) = (size, went, haste);
    }
    Ok(())
}

impl Class {
    pub(super) fn known(size: f64) -> Self {
        Self { size, open: None, went: 0.0, gain: 0.0, haste: 1.0 }
    }

    pub(super) fn open(size: f64, guess: Guess) -> Self {
        Self { open: Some(guess), ..Self::known(size.max(guess.least)) }
    }

    /// Begins anew from a size.
    pub(super) fn restart(&mut self, size: f64) {
        *self = Self { open: self.open, ..Self::known(size) };
    }

    /// Takes the size at which the evidence is stationary (MacKay 1992): the mean square of the rows, where those that the
    /// answer used up do not count.
    pub(super) fn renew(&mut self, tally: Tally) {
        self.gain = 0.0;
        let Some(guess) = self.open.filter(|_| tally.count > 0.0) else { return };
        let left = (tally.count - tally.used).max(LEAST_LEFT * tally.count) + guess.count;
        let square = (tally.squares * self.size.powi(2) + guess.count * guess.size.powi(2)) / left;
        let wanted = square.sqrt().max(guess.least);
        let step = (wanted / self.size).ln();
        self.haste = if step * self.went > 0.0 { (HASTIER * self.haste).min(MOST_HASTE) } else { 1.0 };
        self.went = (self.haste * step).clamp(-FARTHEST, FARTHEST);
        self.gain = (self.went * (tally.squares - (tally.count - tally.used))).abs();
        if step.is_finite() {
            self.size = (self.size * self.went.exp()).max(guess.least);
        }
    }
}
