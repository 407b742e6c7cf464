//! Where the marks of an axis stand and what they say.

/// Round numbers that cover `low..high` with about `count` steps.
pub(super) fn linear(low: f64, high: f64, count: f64) -> Vec<f64> {
    let step = round_step((high - low) / count.max(1.0));
    if !(step.is_finite() && step > 0.0) {
        return vec![low];
    }
    let first = (low / step - 1e-6).ceil() as i64;
    let last = (high / step + 1e-6).floor() as i64;
    (first..=last).map(|index| index as f64 * step).collect()
}

/// The nearest of 1, 2, 5 times a power of ten that is not smaller.
fn round_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    let lead = rough / power;
    power * [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|nice| lead <= nice * (1.0 + 1e-9)).unwrap_or(10.0)
}

/// Tick texts with as many decimals as the step needs, and a true minus sign.
pub(super) fn texts(ticks: &[f64]) -> Vec<String> {
    let step = ticks.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
    let decimals = (0..=8).find(|&places| {
        let scaled = step * 10f64.powi(places);
        (scaled - scaled.round()).abs() < 1e-6 * scaled.abs()
    });
    let places = decimals.unwrap_or(8) as usize;
    ticks.iter().map(|tick| signed(&format!("{:.places$}", tick + 0.0))).collect()
}

fn signed(text: &str) -> String {
    let zero = text.chars().all(|letter| matches!(letter, '-' | '0' | '.'));
    if zero { text.trim_start_matches('-').into() } else { text.replace('-', "−") }
}

/// A decade mark, for instance 10 with a raised −3.
pub(super) fn decade(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        _ => format!("10^{{{}}}", exponent.to_string().replace('-', "−")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(linear(0.0, 4.0, 4.0), [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(texts(&linear(-0.11, 0.12, 3.0)), ["−0.1", "0.0", "0.1"]);
        assert_eq!(texts(&linear(0.0, 50.0, 2.0)), ["0", "25", "50"]);
        assert_eq!(linear(1.0, 1.0, 4.0), [1.0]);
    }
}
