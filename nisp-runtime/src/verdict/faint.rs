//! Sources in patches that are not: contacts that cover a body, or press a little all over it.

use super::Check;

/// A tool that covers more than this share of a body has no edge to find.
const LARGEST: f64 = 0.5;
/// Regions along each coordinate.
const REGIONS: usize = 3;
/// What is less than half of the least that acts, in the mean over half of the regions, over that least. Of pressed bubbles, simulated and real,
/// right answers have up to 0.016, and those to a pressure five per cent too high 0.026 and more.
const FAINT: f64 = 0.02;

/// Whether a source that is known to be zero nearly everywhere covers a body: values over the domain, and the least that it is where
/// it acts. Meant for sources that may act anywhere in the domain.
pub(crate) fn patches(name: &'static str, values: &[f64], level: f64) -> Check {
    let acting = values.iter().filter(|value| value.abs() >= level / 2.0).count();
    let share = acting as f64 / values.len().max(1) as f64;
    let said = format!(
        "`{name}` acts on {:.0} % of the surface, where contacts are patches: check the sign and the pose of the data, and the \
         parameters that balance it",
        100.0 * share
    );
    Check::new("patch", ("", name), (share, LARGEST), said)
}

/// Whether such a source presses a little all over the body, at places. Meant for clouds that may be off over whole regions, of which no
/// given number is asked whether another would be likelier. Noise of a cloud that stands for itself leaves more.
pub(crate) fn faint(name: &'static str, (values, places): (&[f64], &[&[f64]]), level: f64) -> Check {
    let height = |value: &f64| Some(value.abs() / level).filter(|height| *height < 0.5).unwrap_or(0.0);
    let low: Vec<f64> = values.iter().map(height).collect();
    let mut means = means(&low, places);
    let middle = means.len() / 2;
    let faint = if means.is_empty() { 0.0 } else { *means.select_nth_unstable_by(middle, f64::total_cmp).1 };
    let thin = format!(
        "in most regions of the surface `{name}` is {:.1} % of the least that a contact presses with: no tool does that, but a wrong pressure, \
         stiffness, size or pose does; check what is given, or calibrate again",
        100.0 * faint
    );
    Check::new("faint", ("", name), (faint, FAINT), thin)
}

/// Means of heights over the boxes of a grid about all places, of those that have a fair part of them.
fn means(values: &[f64], places: &[&[f64]]) -> Vec<f64> {
    let dimensions = places.first().map_or(0, |place| place.len());
    let ends = |axis: usize| {
        let along = places.iter().map(|place| place[axis]);
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let ends: Vec<(f64, f64)> = (0..dimensions).map(ends).collect();
    let region = |place: &[f64]| {
        let along = place.iter().zip(&ends).map(|(x, (low, high))| REGIONS as f64 * (x - low) / (high - low));
        along.fold(0, |number, at| REGIONS * number + (at as usize).min(REGIONS - 1))
    };
    let mut sums = vec![(0usize, 0.0); REGIONS.pow(dimensions as u32)];
    for (value, place) in values.iter().zip(places) {
        let (count, sum) = &mut sums[region(place)];
        (*count, *sum) = (*count + 1, *sum + value);
    }
    let fair = values.len() / (3 * sums.len());
    sums.into_iter().filter(|(count, _)| *count > fair).map(|(count, sum)| sum / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How wide a source is on a grid of the unit square, and how much of it is faint.
    fn found(source: impl Fn(f64, f64) -> f64) -> [f64; 2] {
        let places: Vec<[f64; 2]> =
            (0..900).map(|at| [at % 30, at / 30].map(|x| (f64::from(x) + 0.5) / 30.0)).collect();
        let values: Vec<f64> = places.iter().map(|[x, y]| source(*x, *y)).collect();
        let places: Vec<&[f64]> = places.iter().map(|place| &place[..]).collect();
        [patches("f", &values, 2.0), faint("f", (&values, &places), 2.0)].map(|check| check.value)
    }

    #[test]
    fn a_tool_presses_nowhere_a_little_and_a_wrong_pressure_everywhere() {
        for radius in [0.1, 0.3, 0.38] {
            let tool = |x: f64, y: f64| if (x - 0.5).hypot(y - 0.5) < radius { 3.0 } else { 0.0 };
            let [wide, faint] = found(tool);
            assert!((wide - std::f64::consts::PI * radius * radius).abs() < 0.01 && faint == 0.0, "{wide} {faint}");
            let [_, faint] = found(|x, y| 0.1 + tool(x, y));
            assert!(faint > FAINT && faint <= 0.05, "{faint}");
        }
        // What noise leaves everywhere.
        assert!(found(|_, _| 0.004)[1] < FAINT);
    }
}
