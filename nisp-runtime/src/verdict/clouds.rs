//! What an answer's surface leaves of a cloud: no more than the cloud's own roughness, and without a pattern.

use super::patterns::BELOW;
use super::{Check, root_mean_square};
use crate::correlation;
use crate::facts::CloudFacts;
use crate::nearest::Nearest;
use crate::problem::Bound;
use crate::roughness::{directions, middle, roughness};
use crate::units::Number;

/// Misfit over roughness.
const MISFIT: f64 = 1.35;
/// Share of points that may have no place on the surface: strays, and what is seen beside the body.
const LOST: f64 = 0.1;
/// What is off by so many times the median is a stray.
const STRAY: f64 = 5.0;
/// Correlation of neighbouring misfits in its own standard deviations, and the share of the misfit's square below which it
/// does not matter.
const PATTERN: f64 = 5.0;
const SLIGHT: f64 = 0.02;

/// Checks of one cloud.
pub(super) fn checks(bound: &Bound, cloud: &CloudFacts) -> Vec<Check> {
    let schema = &bound.problem.scene().schema.groups[cloud.group];
    let Some(term) = schema.terms.iter().find(|term| term.name == cloud.term) else { return Vec::new() };
    let place = (schema.name, term.name);
    let outward = |x| bound.system.outward(&term.unit).of(Number::engine(x));
    let unit = term.unit.behind();
    let all = cloud.points.iter().zip(&cloud.places).zip(&cloud.misfits);
    let found: Vec<_> = all.filter_map(|((point, place), misfit)| Some((*point, *place, (*misfit)?))).collect();
    let lost = cloud.points.len() - found.len();
    let share = lost as f64 / cloud.points.len().max(1) as f64;
    let said = format!(
        "{lost} of the {} points of `{}` have no place on the surface: is it a cloud of this body, in its frame and unit?",
        cloud.points.len(),
        term.name
    );
    let mut checks = vec![Check::new("seen", place, (share, LOST), said)];
    let places: Vec<[f64; 3]> = found.iter().map(|(_, place, _)| *place).collect();
    let Some(tree) = Nearest::of(&places) else { return checks };
    // Strays count for nothing here: the share of the cloud that they may make up is checked above.
    let typical = middle(found.iter().map(|(.., misfit)| misfit.abs()).collect());
    let is_stray = |misfit: f64| misfit.abs() > STRAY * typical;
    let kept: Vec<f64> = found.iter().map(|(.., m)| if is_stray(*m) { 0.0 } else { *m }).collect();
    let rms = root_mean_square(kept.iter().copied());
    let tolerance = bound.tolerance(cloud.group, term).map(|tolerance| tolerance.size);
    let within = tolerance.or(term.within.map(|within| bound.system.size(&term.unit).back(within).as_engine()));
    let own = found.iter().filter(|(.., misfit)| !is_stray(*misfit)).map(|(point, place, _)| (*point, *place));
    let shown = || {
        let (points, places): (Vec<_>, Vec<_>) = own.unzip();
        let directions = directions(bound.problem.scene().schema.coordinates.len(), term.rows)?;
        roughness(&points, &places, directions)
    };
    // A cloud may be noisier than those that its tolerance was found from.
    let rough = match (within, tolerance) {
        (Some(within), None) => within,
        (_, tolerance) => shown().into_iter().chain(tolerance).fold(0.0, f64::max),
    };
    let rough = rough.max(cloud.resolution);
    let said = format!(
        "the surface misses `{}` by {:.2e}{unit} (rms), while the cloud's own roughness is {:.2e}{unit}: check the pressure, the pose, the \
         unit and the parameters; if they are right, the equations do not describe this body",
        term.name,
        outward(rms),
        outward(rough)
    );
    checks.push(Check::new("distance", place, (rms / rough, MISFIT), said));
    if !cloud.signed {
        return checks;
    }
    let (correlation, z) = correlation::of_neighbours(&places, &kept, &tree);
    let systematic = correlation.max(0.0).sqrt() * rms;
    // Far below the noise that is declared, it is what a fit that follows the cloud leaves.
    let least = tolerance.unwrap_or(cloud.resolution / 2.0);
    let matters = correlation > SLIGHT && systematic > least && within.is_none_or(|within| rms >= BELOW * within);
    let said = format!(
        "what is left of `{}` is no noise: neighbours correlate by {correlation:.2}, so the surface is off by some {:.2e}{unit} \
         over whole regions: wrong equations (large strains?), a wrong parameter or a wrong pose",
        term.name,
        outward(systematic)
    );
    checks.push(Check::new("pattern", place, (if matters { z } else { z.min(PATTERN) }, PATTERN), said));
    checks
}
