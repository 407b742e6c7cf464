//! Weighted sums beside their targets.

use super::{Judged, PART, TOLERANCE};
use crate::schema::Term;
use crate::units::Number;
use crate::verdict::Check;

impl Judged<'_> {
    /// Weighted sums beside their targets.
    pub(super) fn sums(&self, group: usize, term: &'static Term) -> Vec<Check> {
        let mut targets = vec![0.0; self.schema.rows];
        self.programs.target(self.scalars, &mut targets);
        let weights = self.bound.weights(group, term.measure.as_ref());
        let outward = |x| self.bound.system.outward(&term.unit).of(Number::engine(x));
        let whole = self.facts.plain_rows(self.programs, self.schema, self.scalars);
        let instead = match self.bound.problem.scene().schema.coordinates {
            [axis] => format!(
                ", or state it as a field that adds up: its derivative by `{}` is what is summed, and it is zero at the start and this at the end",
                axis.name
            ),
            _ => String::new(),
        };
        let mut checks = Vec::new();
        for row in term.first..term.first + term.rows {
            let parts = whole[row].iter().enumerate().map(|(p, x)| x * weights.get(p).copied().unwrap_or(1.0));
            let (sum, size) = parts.fold((0.0, 0.0f64), |(sum, size), x| (sum + x, size + x.abs()));
            let off = (sum - targets[row]).abs();
            let (scale, limit) = match term.within {
                Some(within) => (self.bound.system.size(&term.unit).back(within).as_engine(), TOLERANCE),
                None => (size.max(targets[row].abs()), PART),
            };
            let said = format!(
                "`{}.{}` sums to {:.3e}{} where {:.3e} is wanted: the answer does not meet it; check what is given against the \
                 other data{instead}",
                self.schema.name,
                term.name,
                outward(sum),
                term.unit.behind(),
                outward(targets[row])
            );
            let value = if off == 0.0 { 0.0 } else { off / scale };
            checks.push(Check::new("sum", (self.schema.name, term.name), (value, limit), said));
        }
        checks
    }
}
