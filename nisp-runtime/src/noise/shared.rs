//! Noise that rows of a record share with those before them: it dies away over a length along the coordinate (Ornstein and Uhlenbeck 1930).

/// Rows nearer than this share of their mean distance count as so far apart.
const NEAREST: f64 = 0.1;

/// The mean distance of places; nothing where they have none.
pub(crate) fn spacing(places: &[f64]) -> Option<f64> {
    let ends = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
    Some((ends[1] - ends[0]) / (places.len() as f64 - 1.0)).filter(|mean| mean.is_finite() && *mean > 0.0)
}

/// How much of its noise a row has from one that is so far before it, where rows have a mean distance.
pub(crate) fn shared(distance: f64, length: f64, spacing: f64) -> f64 {
    (-distance.max(NEAREST * spacing) / length).exp()
}

/// Values beside what those before them let expect, where their noise dies away over a length: noise of the same size that is each
/// value's own. In the order in which the values are given.
pub(crate) fn beside_those_before(places: &[f64], values: &[f64], length: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| places[a].total_cmp(&places[b]));
    let spacing = spacing(places).unwrap_or(length);
    let mut found = values.to_vec();
    for pair in order.windows(2) {
        let shared = shared(places[pair[1]] - places[pair[0]], length, spacing);
        found[pair[1]] = (values[pair[1]] - shared * values[pair[0]]) / (1.0 - shared * shared).sqrt();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};

    /// A process with correlation `exp(-distance / length)` at uneven places, out of order: its covariance is that of the definition, and
    /// what is left beside those before is white with the same variance.
    #[test]
    fn what_is_left_is_each_values_own() {
        let mut random = StdRng::seed_from_u64(1);
        let (count, length) = (20_000, 3.0);
        let (mut at, mut own) = (0.0, normal(&mut random));
        let mut record = vec![(at, own)];
        while record.len() < count {
            let distance = 0.2 + 1.6 * random.random::<f64>();
            let shared = f64::exp(-distance / length);
            own = shared * own + (1.0 - shared * shared).sqrt() * normal(&mut random);
            at += distance;
            record.push((at, own));
        }
        record.reverse();
        let (places, values): (Vec<f64>, Vec<f64>) = record.into_iter().unzip();
        let found = beside_those_before(&places, &values, length);
        let mean = |of: &dyn Fn(usize) -> f64| (1..count).map(of).sum::<f64>() / (count - 1) as f64;
        assert!(mean(&|i| values[i] * values[i - 1]) > 0.6);
        assert!((mean(&|i| found[i] * found[i]) - 1.0).abs() < 0.04);
        assert!(mean(&|i| found[i] * found[i - 1]).abs() < 0.03);
    }

    #[test]
    fn equal_places_divide_by_nothing() {
        let found = beside_those_before(&[0.0, 0.0, 1.0], &[1.0, 2.0, 3.0], 5.0);
        assert!(found.iter().all(|x| x.is_finite()));
    }
}
