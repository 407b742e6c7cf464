//! Where the misfits lie that are much larger than the others.

use super::smooth::scaled;

/// Share of far misfits beside another one from which on they lie together.
const TOGETHER: f64 = 0.5;
/// So many of the farthest are looked at.
const MOST: usize = 64;

/// Where far misfits lie.
#[derive(Debug, PartialEq)]
pub(super) enum Lie {
    /// Each alone among others that are met: so do outliers.
    Apart,
    /// Beside each other, about this point (its number).
    Together(usize),
    /// At one place along these coordinates and anywhere along the others: so do those of a station. The point is one of them.
    Station(usize, Vec<usize>),
}

/// Where misfits beyond `far` lie; `places` has `axes` coordinates for each misfit.
pub(super) fn lie(places: &[f64], axes: usize, misfits: &[f64], far: f64) -> Lie {
    let mut found: Vec<usize> = (0..misfits.len()).filter(|&at| misfits[at].abs() > far).collect();
    found.sort_by(|&a, &b| misfits[b].abs().total_cmp(&misfits[a].abs()));
    found.truncate(MOST);
    let (Some(&worst), true) = (found.first(), found.len() > 1) else { return Lie::Apart };
    let is_there = |at: usize, axis: usize| places[at * axes + axis] == places[worst * axes + axis];
    // What is the same for all data is no station.
    let same =
        |&axis: &usize| found.iter().all(|&at| is_there(at, axis)) && !(0..misfits.len()).all(|at| is_there(at, axis));
    let station: Vec<usize> = (0..axes).filter(same).collect();
    let there = (0..misfits.len()).filter(|&at| station.iter().all(|&axis| is_there(at, axis)));
    let (far_there, all_there) =
        there.fold((0, 0), |(is_far, all), at| (is_far + usize::from(misfits[at].abs() > far), all + 1));
    if !station.is_empty() && station.len() < axes && far_there as f64 > TOGETHER * f64::from(all_there) {
        return Lie::Station(worst, station);
    }
    let scaled = scaled(places, axes);
    let distance = |a: usize, b: usize| scaled.iter().map(|axis| (axis[a] - axis[b]).powi(2)).sum::<f64>();
    let nearest = |at: usize| {
        let others = (0..misfits.len()).filter(|&other| other != at);
        others.min_by(|&a, &b| distance(at, a).total_cmp(&distance(at, b)))
    };
    let is_beside = |&&at: &&usize| nearest(at).is_some_and(|other| misfits[other].abs() > far);
    let together = found.iter().filter(is_beside).count();
    if together as f64 > TOGETHER * found.len() as f64 { Lie::Together(worst) } else { Lie::Apart }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten stations along x, twenty times at each; misfits of one but where `far` says otherwise.
    fn stations(far: impl Fn(usize, usize) -> bool) -> (Vec<f64>, Vec<f64>) {
        let rows = (0..10).flat_map(|x| (0..20).map(move |t| (x, t)));
        let places = rows.clone().flat_map(|(x, t)| [x as f64, t as f64]).collect();
        (places, rows.map(|(x, t)| if far(x, t) { 10.0 } else { 1.0 }).collect())
    }

    #[test]
    fn outliers_lie_apart() {
        let (places, misfits) = stations(|x, t| (x * 20 + t) % 37 == 3);
        assert_eq!(lie(&places, 2, &misfits, 5.0), Lie::Apart);
        assert_eq!(lie(&places, 2, &misfits, 50.0), Lie::Apart);
    }

    #[test]
    fn one_station_alone_is_none() {
        let places: Vec<f64> = (0..60).flat_map(|t| [0.5, f64::from(t)]).collect();
        let misfits: Vec<f64> = (0..60).map(|t| if t == 7 || t == 41 { 10.0 } else { 1.0 }).collect();
        assert_eq!(lie(&places, 2, &misfits, 5.0), Lie::Apart);
        let (places, misfits) = stations(|x, t| x == 4 && (t == 2 || t == 11));
        assert_eq!(lie(&places, 2, &misfits, 5.0), Lie::Apart);
    }

    #[test]
    fn a_bad_station_is_found() {
        let (places, misfits) = stations(|x, _| x == 4);
        assert_eq!(lie(&places, 2, &misfits, 5.0), Lie::Station(80, vec![0]));
    }

    #[test]
    fn misfits_at_a_wall_lie_together() {
        let (places, misfits) = stations(|x, t| x > 7 && t < 9);
        assert_eq!(lie(&places, 2, &misfits, 5.0), Lie::Together(160));
    }
}
