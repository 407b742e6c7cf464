//! Scalars that are learned: what is not known of them is in the deviations.

use nisp::{LagSettings, Smoothed};
use nisp_interpreter::interpret;

use crate::{noise, smoothed, smoother};

interpret! {
    /// What decays at a rate that nobody knows, and is fed.
    mod decay {
        units: off;
        coordinates: t;
        fields: c;
        sources: f;
        parameters: k > 0 = 0.3;
        on pot { balance: d(c, t) == f - k * c; }
        on samples { observe c; }
        scene recover { learn k; }
    }
}

/// The first rows tell the rate by a decay that nothing feeds. What is fed later, `A w sin(w s) + k A (1 - cos(w s))` for the time `s` since
/// it set in, makes `A (1 - cos(w s))` of what is there, and is known no better than the rate times that.
#[test]
fn a_source_is_known_no_better_than_the_rate_beside_it() {
    let (rate, begins, size, frequency) = (0.15, 35.0, 8.0, 0.25);
    let since = |t: f64| frequency * (t - begins).max(0.0);
    let level = |t: f64| 5.0 * (-rate * t).exp() + size * (1.0 - since(t).cos());
    let fed = |t: f64| size * (frequency * since(t).sin() + rate * (1.0 - since(t).cos()));
    let (mut asked, mut far) = (0, [0, 0]);
    for seed in 1..6 {
        let mut noise = noise(seed);
        let times = (0..700).map(|i| 0.1 * f64::from(i));
        let rows: Vec<(f64, f64)> = times.map(|t| (t, level(t) + 0.02 * noise())).collect();
        let found = smoothed(&mut smoother(decay::scene("recover"), LagSettings::default()), &rows);
        for Smoothed { at, heads, learned, .. } in found.iter().filter(|own| own.at > begins + 1.0 && own.is_sound()) {
            let [(value, deviation)] = learned[..] else { panic!("one rate is learned: {learned:?}") };
            assert!((value - rate).abs() < 4.0 * deviation && deviation < 0.1 * rate, "{value} +- {deviation}");
            let off = (heads[1].0 - fed(*at)).abs() / heads[1].1;
            asked += 1;
            [2.0, 4.0].iter().zip(&mut far).for_each(|(most, far)| *far += usize::from(off > *most));
        }
    }
    assert!(asked > 250 && 20 * far[0] < asked && 100 * far[1] < asked, "{far:?} of {asked}");
}
