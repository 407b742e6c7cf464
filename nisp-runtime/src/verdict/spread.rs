//! Sources in patches that are not: contacts that cover a body, or press a little all over it.

use super::Check;

/// A tool that covers more than this share of a body has no edge to find.
const LARGEST: f64 = 0.5;
/// Regions along each coordinate.
const REGIONS: usize = 3;
/// What is less than half of the least that acts, in the mean over half of the regions, over that least. Of pressed bubbles, simulated and real,
/// right answers have up to 0.016, and those to a pressure five per cent too high 0.026 and more.
const FAINT: f64 = 0.02;
/// Share of the regions that a tool leaves bare.
const BARE: f64 = 0.25;
/// Mean over such a region beside that over the region with most. Right answers have up to 0.04, and those that make spots of what
/// acts everywhere, as a cloud does that is three per cent too small, 0.1 and more.
const EVEN: f64 = 0.08;
/// Mean over a region, over the least that a source is where it acts, that is next to nothing.
const NOTHING: f64 = 0.05;

/// Whether a source that is known to be zero nearly everywhere is that: values over the domain at places, and the least that it is where
/// it acts. Meant for sources that may act anywhere in the domain.
pub(crate) fn patches(name: &'static str, (values, places): (&[f64], &[&[f64]]), level: f64) -> [Check; 3] {
    let heights: Vec<f64> = values.iter().map(|value| value.abs() / level).collect();
    let acting = heights.iter().filter(|height| **height >= 0.5).count();
    let share = acting as f64 / values.len().max(1) as f64;
    let wide = format!(
        "`{name}` acts on {:.0} % of the surface, where contacts are patches: check the sign and the pose of the data, and the \
         parameters that balance it",
        100.0 * share
    );
    let low: Vec<f64> = heights.iter().map(|&height| if height < 0.5 { height } else { 0.0 }).collect();
    let faint = quantile(&means(&low, places), 0.5);
    let all = means(&heights, places);
    let even = quantile(&all, BARE) / quantile(&all, 1.0).max(NOTHING);
    let no_tool = "no tool does that, but a wrong pressure, stiffness, size or pose does; check what is given, or calibrate again";
    let thin = format!(
        "in most regions of the surface `{name}` is {:.1} % of the least that a contact presses with: {no_tool}",
        100.0 * faint
    );
    let spots =
        format!("`{name}` acts in all regions of the surface, and not much more in any than in others: {no_tool}");
    [
        Check::new("patch", ("", name), (share, LARGEST), wide),
        Check::new("faint", ("", name), (faint, FAINT), thin),
        Check::new("spread", ("", name), (even, EVEN), spots),
    ]
}

/// The value below which a share of all lie; zero of none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let at = (share * sorted.len() as f64) as usize;
    sorted.get(at.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
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

    /// How wide a source is on a grid of the unit square, how much of it is faint, and how even it is.
    fn found(source: impl Fn(f64, f64) -> f64) -> [f64; 3] {
        let places: Vec<[f64; 2]> =
            (0..900).map(|at| [at % 30, at / 30].map(|x| (f64::from(x) + 0.5) / 30.0)).collect();
        let values: Vec<f64> = places.iter().map(|[x, y]| source(*x, *y)).collect();
        let places: Vec<&[f64]> = places.iter().map(|place| &place[..]).collect();
        patches("f", (&values, &places), 2.0).map(|check| check.value)
    }

    #[test]
    fn a_tool_leaves_regions_bare_and_a_wrong_pressure_none() {
        let tool = |x: f64, y: f64| if (x - 0.4).hypot(y - 0.5) < 0.3 { 3.0 } else { 0.0 };
        let [wide, faint, even] = found(tool);
        assert!((wide - 0.283).abs() < 0.01 && faint == 0.0 && even == 0.0, "{wide} {faint} {even}");
        let [_, faint, _] = found(|x, y| 0.1 + tool(x, y));
        assert!(faint > FAINT && faint < 0.05, "{faint}");
        // Spots of the size that a prior makes of what acts everywhere.
        let spots = |x: f64, y: f64| if (x * 6.0).fract().hypot((y * 6.0).fract()) < 0.4 { 2.0 } else { 0.0 };
        let [wide, faint, even] = found(spots);
        assert!(wide < LARGEST && faint == 0.0 && even > 0.9, "{wide} {faint} {even}");
        // What noise leaves everywhere.
        let [_, faint, even] = found(|_, _| 0.004);
        assert!(faint < FAINT && even < EVEN, "{faint} {even}");
    }
}
