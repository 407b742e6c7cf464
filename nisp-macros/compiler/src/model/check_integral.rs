//! Integral terms: `integral(f * n) == wrench`.

use super::check_term::{Body, TermInput, equation, integral_side};
use super::value::{Dim, Extent, Reads, Value};
use super::{Coordinate, Expr, TermKind, build};
use crate::error::{Checked, catalogue};
use crate::rational::ratio;
use crate::syntax::{self, Comparison, Relation, print_text};
use crate::unit::Dimension;

/// Past this many coordinates only areas and volumes are tried as measures.
const MOST_COORDINATES: usize = 8;

impl TermInput<'_, '_> {
    pub(super) fn integrals(&mut self, relations: &[&Comparison]) -> Checked<Body> {
        let (mut integrand, mut target, mut dims) = (Vec::new(), Vec::new(), Vec::new());
        for relation in relations {
            let (inside, outside, dim) = self.integral(relation)?;
            integrand.extend(inside);
            target.extend(outside);
            dims.push(dim);
        }
        let parts: Vec<(&syntax::Expr, &Dim)> = relations.iter().map(|relation| &relation.left).zip(&dims).collect();
        let dim = self.elaborator.agree(&parts, "integrals of one term");
        Ok(self.body(TermKind::Integral { integrand, target }, &dim, relations))
    }

    fn integral(&mut self, relation: &Comparison) -> Checked<(Vec<Expr>, Vec<Expr>, Dim)> {
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
        self.check_measure(inner, &inside, target, &outside)?;
        let count = inside.entries.len();
        let targets: Vec<Expr> = match (extent, outside.is_zero()) {
            (Extent::Scalar, _) | (_, false) => outside.entries.iter().map(|entry| entry.expr.clone()).collect(),
            _ => vec![build::zero().expr; count],
        };
        let dim = if outside.dim == Dim::Any { inside.dim.clone() } else { outside.dim.clone() };
        Ok((inside.entries.into_iter().map(|entry| entry.expr).collect(), targets, dim))
    }

    /// The target's unit must be the integrand's times a length, an area, a volume or an extent of coordinates.
    fn check_measure(
        &mut self,
        inner: &syntax::Expr,
        inside: &Value,
        target: &syntax::Expr,
        outside: &Value,
    ) -> Checked<()> {
        let (Some(a), Some(b)) = (inside.dim.known(), outside.dim.known()) else { return Ok(()) };
        let measure = b.over(a);
        if measure.is_some_and(|measure| is_measure(&measure, &self.elaborator.coordinates)) {
            return Ok(());
        }
        let message = catalogue::integral_units((&print_text(inner), a), (&print_text(target), b));
        Err(self.elaborator.errors.report(target.place, message))
    }
}

fn is_measure(measure: &Dimension, coordinates: &[Coordinate]) -> bool {
    if (1..=3).any(|power| Dimension::length().power(ratio(power, 1)).as_ref() == Some(measure)) {
        return true;
    }
    let known = &coordinates[..coordinates.len().min(MOST_COORDINATES)];
    (1_usize..1 << known.len()).any(|subset| {
        let chosen = known.iter().enumerate().filter(|(index, _)| subset >> index & 1 == 1);
        let product =
            chosen.map(|(_, c)| &c.unit.dimension).try_fold(Dimension::none(), |product, side| product.times(side));
        product.as_ref() == Some(measure)
    })
}
