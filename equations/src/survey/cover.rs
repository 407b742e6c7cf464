//! How much of a domain the places of measurements cover, and the largest hole between them.

use nisp::nearest::Nearest;
use nisp::schema::Portion;

use super::{Survey, short};

/// Places of the domain that are looked at.
const PLACES: usize = 2000;
/// Places along a coordinate that are closer than this share of the domain count as one.
const APART: f64 = 1e-2;
/// Chance leaves a ball of this many measurements' share of the domain empty once in a million.
const EMPTY: f64 = 14.0;
/// Shares of the domain from which on all of it is covered.
const ALL: f64 = 0.98;

/// What is not covered, in words; nothing over one coordinate, whose gaps are seen in its rows, or where all is covered.
pub(super) fn notes(survey: &Survey<'_>) -> Vec<String> {
    match survey.coordinates.len() {
        2 => over::<2>(survey, std::f64::consts::PI),
        3 => over::<3>(survey, 4.0 / 3.0 * std::f64::consts::PI),
        4 => over::<4>(survey, std::f64::consts::PI.powi(2) / 2.0),
        _ => Vec::new(),
    }
}

/// `ball` is the volume of a ball of radius one.
fn over<const D: usize>(survey: &Survey<'_>, ball: f64) -> Vec<String> {
    let Some(body) = &survey.domain else { return Vec::new() };
    let (low, high) = body.bounds();
    let cells = cells(survey, &low, &high);
    // In steps between neighbours.
    let scaled = |point: &[f64]| -> [f64; D] {
        std::array::from_fn(|at| (point[at] - low[at]) / (high[at] - low[at]) * cells[at])
    };
    let measured: Vec<[f64; D]> = survey.points.chunks_exact(D).map(scaled).collect();
    let Some(tree) = Nearest::of(&measured) else { return Vec::new() };
    let reach = (EMPTY / ball).powf(1.0 / D as f64);
    let places = body.sample(Portion::Inside, PLACES).points.coordinates;
    let away = |place: &[f64]| tree.one(&scaled(place)).distance;
    let found: Vec<(f64, &[f64])> = places.chunks_exact(D).map(|place| (away(place), place)).collect();
    let share = found.iter().filter(|(away, _)| *away <= reach).count() as f64 / found.len().max(1) as f64;
    let farthest = found.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((away, place)) = farthest.filter(|_| share < ALL) else {
        return vec!["the rows cover the domain".into()];
    };
    let width = |at: usize| {
        let unit = survey.coordinates[at].unit.text;
        format!("{} {unit}", short(away * (high[at] - low[at]) / cells[at])).trim_end().to_string()
    };
    let widths: Vec<String> = (0..D).map(width).collect();
    vec![format!(
        "the rows cover {:.0} % of the domain; the largest hole lies around {}, with no row within {}",
        100.0 * share,
        survey.place(place),
        widths.join(" or ")
    )]
}

/// How many steps between neighbours a domain has along each coordinate: as many as there are places along it, where rows stand in
/// lines, and alike along all others.
fn cells(survey: &Survey<'_>, low: &[f64], high: &[f64]) -> Vec<f64> {
    let axes = survey.coordinates.len();
    let mut counts: Vec<(usize, usize)> =
        (0..axes).map(|at| (distinct(survey.axis(at).collect(), APART * (high[at] - low[at])), at)).collect();
    counts.sort_unstable();
    let mut left = (survey.points.len() / axes) as f64;
    let mut cells = vec![1.0; axes];
    for (number, (count, at)) in counts.into_iter().enumerate() {
        cells[at] = (count as f64).min(left.powf(1.0 / (axes - number) as f64)).max(1.0);
        left /= cells[at];
    }
    cells
}

/// How many of some numbers are farther apart than `apart`.
fn distinct(mut values: Vec<f64>, apart: f64) -> usize {
    values.sort_by(f64::total_cmp);
    let mut last = f64::NEG_INFINITY;
    let is_new = |x: &&f64| {
        let is_new = **x - last > apart;
        last = if is_new { **x } else { last };
        is_new
    };
    values.iter().filter(is_new).count()
}
