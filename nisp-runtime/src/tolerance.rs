//! How far equations may be off in a step of splines: a state that is far off finds its way along loose ones.

/// The tolerance of the first step, and the largest.
pub(crate) const LOOSE: f64 = 1e-2;
/// Its fall from step to step, and its rise after a step that led nearly nowhere.
const TIGHTER: f64 = 0.1;
/// Shares of a step that were taken: below the first it led nearly nowhere, below the second it had to be short.
const STUCK: f64 = 0.1;
const SHORT: f64 = 0.5;

/// The tolerance after a step of which a share was taken. Strict equations that are not linear leave steps no room: where they lead
/// nowhere, looser ones do.
pub(crate) fn after(tolerance: f64, share: f64, strictest: f64) -> f64 {
    let times = match share {
        ..STUCK => TIGHTER.recip(),
        ..SHORT => 1.0,
        _ => TIGHTER,
    };
    (tolerance * times).clamp(strictest, LOOSE)
}
