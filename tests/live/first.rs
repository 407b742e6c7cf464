//! First rows: what a whole record of them would be doubted for, sensors that stand still, and where rows are.

use nisp::{FixedLagSmoother, LagSettings, Problem, Smoothed};
use nisp_interpreter::interpret;

use crate::noise;

interpret! {
    /// A level with two flows, of which it says the sum alone.
    mod mixed {
        units: off;
        coordinates: t;
        fields: y;
        sources: u, w;
        on tank { balance: d(y, t) + 0.5 * y == u + w; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// The same with one flow.
    mod fed {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on tank { balance: d(y, t) + 0.5 * y == u; }
        on samples { observe y; }
        scene recover { }
    }
}

/// Time between rows.
const STEP: f64 = 0.1;

fn level(at: usize) -> f64 {
    let t = STEP * at as f64;
    3.0 + (0.4 * t).sin() + 0.3 * (1.1 * t).cos()
}

/// What the level of [`level`] is fed with.
fn feed(t: f64) -> f64 {
    0.4 * (0.4 * t).cos() - 0.33 * (1.1 * t).sin() + 0.5 * (3.0 + (0.4 * t).sin() + 0.3 * (1.1 * t).cos())
}

fn answers(problem: Problem, rows: &[f64]) -> Vec<Smoothed> {
    let mut smoother = FixedLagSmoother::new(problem, LagSettings::default()).unwrap();
    let mut found = Vec::new();
    for (at, row) in rows.iter().enumerate() {
        found.extend(smoother.push(STEP * at as f64, &[*row]).unwrap());
    }
    found.extend(smoother.finish().unwrap());
    found
}

fn measured(seed: u64, rows: usize) -> Vec<f64> {
    let mut noise = noise(seed);
    (0..rows).map(|at| level(at) + 0.01 * noise()).collect()
}

#[test]
fn sources_that_nothing_tells_apart_are_named_in_every_row() {
    let found = answers(Problem::new(mixed::scene("recover")), &measured(1, 500));
    assert_eq!(found.len(), 500);
    let is_named = |found: &Smoothed| {
        let doubt = found.doubt.as_deref().unwrap_or_default();
        !found.is_sound() && doubt.starts_with("nothing tells `u` from `w`")
    };
    assert!(found.iter().all(is_named));
}

#[test]
fn values_that_are_read_too_often_are_named() {
    let mut rows = measured(2, 600);
    rows.chunks_mut(5).for_each(|rows| rows.fill(rows[0]));
    let found = answers(Problem::new(fed::scene("recover")), &rows);
    let doubt = |found: &Smoothed| found.doubt.clone().unwrap_or_default();
    let other = found.iter().find(|found| found.is_sound() || !doubt(found).contains("each value of `y`"));
    assert_eq!(other, None);
}

/// The level stands still for longer than the first rows would wait, and then moves.
#[test]
fn a_record_that_begins_at_rest_waits_for_rows_that_move() {
    const STILL: usize = 360;
    let mut rows = measured(3, 900);
    rows[..STILL].fill(3.0);
    let found = answers(Problem::new(fed::scene("recover")), &rows);
    assert_eq!(found.len(), 900);
    assert!(found[..STILL].iter().all(|found| found.is_held && !found.is_sound()));
    let later = &found[STILL + 40..];
    assert!(later.iter().filter(|found| found.is_sound()).count() > 9 * later.len() / 10);
    let (mut far, mut square) = (0, 0.0);
    for found in later {
        let (value, deviation) = found.heads[1];
        let off = value - feed(found.at);
        far += usize::from(off.abs() > 4.0 * deviation);
        square += off * off;
    }
    assert!(far < later.len() / 50 && (square / later.len() as f64).sqrt() < 0.1, "{far} {square}");
}

#[test]
fn a_state_that_leaps_to_nothing_is_no_state() {
    let mut rows = measured(4, 700);
    rows[400..].fill(0.0);
    let found = answers(Problem::new(fed::scene("recover")), &rows);
    assert!(found[400..].iter().all(|found| found.is_held));
    assert!(found[..400].iter().all(|found| !found.is_held));
}

/// Behind the leap of a sensor that was moved, every answer is about another level.
#[test]
fn a_record_that_leaps_is_doubted_from_there_on() {
    for (seed, moved) in [(6, 1.0), (7, -0.5), (8, 0.3)] {
        let mut rows = measured(seed, 600);
        rows[300..].iter_mut().for_each(|row| *row += moved);
        let found = answers(Problem::new(fed::scene("recover")), &rows);
        let sound = |part: &[Smoothed]| part.iter().filter(|found| found.is_sound()).count();
        assert_eq!(sound(&found[300..]), 0, "{moved}");
        let doubt = found[500].doubt.as_deref().unwrap_or_default();
        assert!(doubt.starts_with("`y` leaps from t = 29."), "{moved}: {doubt}");
        assert!(sound(&found[..250]) > 225, "{moved}: {}", sound(&found[..250]));
    }
}

#[test]
fn answers_are_where_rows_are_to_the_last_digit() {
    let found = answers(Problem::new(fed::scene("recover")), &measured(5, 400));
    assert!(found.iter().enumerate().all(|(at, found)| found.at == STEP * at as f64));
}
