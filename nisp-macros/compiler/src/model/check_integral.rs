//! Integral terms: `integral(f * n) == wrench`.

use super::check_term::{Body, TermInput, equation, integral_side};
use super::value::{Dim, Extent, Reads, Value};
use super::{Coordinate, Expr, TermKind, build};
use crate::error::{Checked, catalogue};
use crate::rational::ratio;
use crate::syntax::{self, Comparison, Relation, print_text};
use crate::unit::frame::Scale;
use crate::unit::{Dimension, Unit};

/// Past this many coordinates only areas and volumes are tried as measures.
const MOST_COORDINATES: usize = 8;

/// One integral of a term.
struct Integral {
    integrand: Vec<Expr>,
    target: Vec<Expr>,
    dim: Dim,
    /// Unit of the points' weights, where units tell.
    measure: Option<Unit>,
}

impl TermInput<'_, '_> {
    pub(super) fn integrals(&mut self, relations: &[&Comparison]) -> Checked<Body> {
        let (mut integrand, mut target, mut dims) = (Vec::new(), Vec::new(), Vec::new());
        let mut measure = None;
        for relation in relations {
            let found = self.integral(relation)?;
            measure = measure.or(found.measure);
            integrand.extend(found.integrand);
            target.extend(found.target);
            dims.push(found.dim);
        }
        let parts: Vec<(&syntax::Expr, &Dim)> = relations.iter().map(|relation| &relation.left).zip(&dims).collect();
        let dim = self.elaborator.agree(&parts, "integrals of one term");
        Ok(self.body(TermKind::Integral { integrand, target, measure }, &dim, relations))
    }

    fn integral(&mut self, relation: &Comparison) -> Checked<Integral> {
        let place = relation.left.place.to(relation.right.place);
        let Some(([inner], target)) = integral_side(relation) else {
            let message = catalogue::wrong_arguments("integral", &catalogue::count(1), 0);
            return Err(self.elaborator.errors.report(place, message));
        };
        if relation.relation != Relation::Equal {
            return Err(self.elaborator.errors.report(relation.relation_place, catalogue::integral_inequality()));
        }
        let (inside, outside) = (self.elaborator.value(inner), self.elaborator.value(target));
        let (inside, outside) = (inside?, outside?);
        if !inside.reads().any(Reads::FIELD.and(Reads::PARAMETER)) {
            return Err(self.elaborator.errors.report(place, catalogue::nothing_to_solve(&equation(relation))));
        }
        if outside.reads().any(Reads::FIELD.and(Reads::COORDINATE).and(Reads::COLUMN)) {
            return Err(self.elaborator.errors.report(target.place, catalogue::target_varies(&print_text(target))));
        }
        let extent = self.elaborator.common_extent(&[(inner, &inside), (target, &outside)])?;
        let measure = self.check_measure(inner, &inside, target, &outside)?;
        let count = inside.entries.len();
        let targets: Vec<Expr> = match (extent, outside.is_zero()) {
            (Extent::Scalar, _) | (_, false) => outside.entries.iter().map(|entry| entry.expr.clone()).collect(),
            _ => vec![build::zero().expr; count],
        };
        let dim = if outside.dim == Dim::Any { inside.dim.clone() } else { outside.dim.clone() };
        let integrand = inside.entries.into_iter().map(|entry| entry.expr).collect();
        Ok(Integral { integrand, target: targets, dim, measure })
    }

    /// The target's unit must be the integrand's times a length, an area, a volume or an extent of coordinates.
    fn check_measure(
        &mut self,
        inner: &syntax::Expr,
        inside: &Value,
        target: &syntax::Expr,
        outside: &Value,
    ) -> Checked<Option<Unit>> {
        let (Some(a), Some(b)) = (inside.dim.known(), outside.dim.known()) else { return Ok(None) };
        let measure = b.over(a).and_then(|measure| as_declared(&measure, &self.elaborator.coordinates));
        if measure.is_some() {
            return Ok(measure);
        }
        let message = catalogue::integral_units((&print_text(inner), a), (&print_text(target), b));
        Err(self.elaborator.errors.report(target.place, message))
    }
}

/// A measure in the coordinates' declared units, if it is one.
fn as_declared(measure: &Dimension, coordinates: &[Coordinate]) -> Option<Unit> {
    let unit = |factor: f64| Some(Unit { factor: Scale::new(factor), ..Unit::si(measure.clone()) });
    let length =
        coordinates.iter().find(|c| c.unit.dimension == Dimension::length()).map_or(1.0, |c| c.unit.factor.factor());
    let power = (1..=3).find(|&n| Dimension::length().power(ratio(n, 1)).as_ref() == Some(measure));
    if let Some(power) = power {
        return unit(length.powi(power as i32));
    }
    let known = &coordinates[..coordinates.len().min(MOST_COORDINATES)];
    let subset = (1_usize..1 << known.len()).find(|subset| {
        let chosen = known.iter().enumerate().filter(|(index, _)| subset >> index & 1 == 1);
        let product =
            chosen.map(|(_, c)| &c.unit.dimension).try_fold(Dimension::none(), |product, side| product.times(side));
        product.as_ref() == Some(measure)
    })?;
    let chosen = known.iter().enumerate().filter(|(index, _)| subset >> index & 1 == 1);
    unit(chosen.map(|(_, c)| c.unit.factor.factor()).product())
}
