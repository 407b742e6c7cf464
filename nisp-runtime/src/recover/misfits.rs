//! What an answer leaves of every observation, measurement by measurement: where it is that data and equations disagree.

use super::Solution;
use crate::schema::{TermKind, Unit};
use crate::units::Number;

/// What is left of one measured quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Misfits {
    /// `group.term`, and the number of the component if it has several.
    pub name: String,
    /// Unit of the values.
    pub unit: Unit,
    /// The places of the measurements, point by point, in declared units.
    pub points: Vec<f64>,
    /// The answer less the measurement, one for each point.
    pub values: Vec<f64>,
}

impl Solution {
    /// What is left of every observation.
    pub fn misfits(&mut self) -> Vec<Misfits> {
        let answer = self.carried.answer(&self.bound);
        let bound = &self.bound;
        let scene = bound.problem.scene();
        let kernels = scene.double();
        let mut all = Vec::new();
        for (at, (group, facts)) in scene.schema.groups.iter().zip(&answer.facts).enumerate() {
            let Some((points, _)) = bound.problem.group(group.name).filter(|_| !group.is_beliefs()) else { continue };
            let rows = facts.plain_rows(kernels[at].programs, group, &answer.scalars);
            for term in group.terms.iter().filter(|term| term.kind == TermKind::Observation) {
                let outward = bound.system.outward(&term.unit);
                let outward = |x| outward.of(Number::engine(x)).as_declared();
                for (component, row) in rows[term.first..][..term.rows].iter().enumerate() {
                    let number = if term.rows > 1 { format!("[{component}]") } else { String::new() };
                    all.push(Misfits {
                        name: format!("{}.{}{number}", group.name, term.name),
                        unit: term.unit,
                        points: bound.measured(at, term, &points.coordinates),
                        values: bound.measured(at, term, row).into_iter().map(outward).collect(),
                    });
                }
            }
        }
        all
    }
}
