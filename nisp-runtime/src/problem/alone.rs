//! Points of a cloud that stand alone: strays of a camera between bodies, or in the air. Where the rest of the cloud shows the surface,
//! a robust loss leaves them out. Where it shows nothing, such a point would be all that is known.

use std::num::NonZero;

use super::bound::Bound;
use crate::nearest::Nearest;
use crate::roughness::directions;
use crate::schema;
use crate::solve::driver::Warning;

/// The neighbour by whose distance a cloud's density is told.
const NEIGHBOUR: usize = 4;
/// Points of a cloud that is judged, at least.
const FEWEST: usize = 8 * NEIGHBOUR;
/// Share of the cloud whose points have a neighbour within a distance that is usual.
const USUAL: f64 = 0.75;
/// What stands alone has so few points around it, as a share of what is usual.
const SPARSE: f64 = 1.0 / 9.0;

/// A cloud, flat, without the points that stand alone.
pub(super) fn without_alone(cloud: Vec<f64>, scene: &schema::Scene, term: &schema::Term) -> Vec<f64> {
    let Some(directions) = directions(scene.coordinates.len(), term.rows) else { return cloud };
    let flat = |point: &[f64]| std::array::from_fn(|axis| point.get(axis).copied().unwrap_or(0.0));
    let points: Vec<[f64; 3]> = cloud.chunks_exact(term.rows).map(flat).collect();
    let Some(distances) = distances(&points) else { return cloud };
    let mut sorted = distances.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted[(USUAL * sorted.len() as f64) as usize];
    let far = usual * SPARSE.recip().powf(1.0 / directions as f64);
    let kept = cloud.chunks_exact(term.rows).zip(distances).filter(|(_, distance)| *distance <= far);
    kept.flat_map(|(point, _)| point.to_vec()).collect()
}

/// How far every point is from one of its neighbours; nothing where points are few or not finite.
fn distances(points: &[[f64; 3]]) -> Option<Vec<f64>> {
    // The nearest to a point is itself.
    let count = NonZero::new(1 + NEIGHBOUR)?;
    let tree = Nearest::of(points).filter(|_| points.len() >= FEWEST)?;
    points.iter().map(|point| Some(tree.some(point, count).last()?.distance)).collect()
}

impl Bound {
    /// Says how many points of clouds are left out, since they stand alone.
    pub(crate) fn alone(&self) -> Vec<Warning> {
        let groups = self.problem.scene.schema.groups.iter().zip(&self.clouds).zip(&self.problem.groups);
        let terms = groups.flat_map(|((group, clouds), binding)| {
            group.terms.iter().zip(clouds).map(move |(term, cloud)| (term, cloud, binding))
        });
        let said = |(term, cloud, binding): (&schema::Term, &Vec<f64>, &Option<super::Binding>)| {
            let all = binding.as_ref()?.cloud(term.name)?.len();
            let alone = all.saturating_sub(cloud.len()) / term.rows.max(1);
            (alone > 0).then(|| Warning::alone(term.name, alone))
        };
        terms.filter_map(said).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice of points a unit apart, and two that are four units above it.
    #[test]
    fn points_in_the_air_have_no_neighbours() {
        let mut points: Vec<[f64; 3]> = (0..400).map(|at| [f64::from(at % 20), f64::from(at / 20), 0.0]).collect();
        points.extend([[5.0, 5.0, 14.0], [8.0, 30.0, 0.0]]);
        let found = distances(&points).unwrap();
        // Four neighbours are a unit away, in a corner three are within the root of two.
        assert!(found[..400].iter().all(|distance| *distance <= 2.0));
        assert!(found[400..].iter().all(|distance| *distance > 10.0));
        assert_eq!(distances(&points[..31]), None);
    }
}
