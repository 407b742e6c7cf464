//! What is added or compared must have one unit; the odd one out is blamed.

use super::elaborate::Elaborator;
use super::value::Dim;
use crate::error::catalogue;
use crate::syntax::{Expr, ExprKind, print_text};
use crate::unit::Dimension;

impl Elaborator<'_> {
    /// The common dimension of all parts. If they differ, the part that differs from the majority is reported, and
    /// the result compares with everything, so that one wrong unit is one error.
    pub(super) fn agree(&mut self, parts: &[(&Expr, &Dim)], what: &str) -> Dim {
        let known: Vec<(&Expr, &Dimension)> =
            parts.iter().filter_map(|(expr, dim)| Some((*expr, dim.known()?))).collect();
        let Some(&(_, first)) = known.first() else {
            let all_zero = parts.iter().all(|(_, dim)| **dim == Dim::Any);
            return if all_zero { Dim::Any } else { Dim::Unknown };
        };
        // A long sum has few different units.
        let mut votes: Vec<(&Dimension, usize)> = Vec::new();
        for (_, dimension) in &known {
            match votes.iter_mut().find(|(other, _)| other == dimension) {
                Some((_, count)) => *count += 1,
                None => votes.push((dimension, 1)),
            }
        }
        let most = votes.iter().map(|(_, count)| *count).max().unwrap_or(0);
        // Of equally frequent units the first is the reference: that is how one reads.
        let reference = votes.iter().find(|(_, count)| *count == most).map_or(first, |(dimension, _)| dimension);
        let (Some(&(odd, found)), Some(&(other, _))) = (
            known.iter().find(|(_, dimension)| *dimension != reference),
            known.iter().find(|(_, dimension)| *dimension == reference),
        ) else {
            // Unknown parts make the whole unknown only where nothing better is known.
            return Dim::Known(reference.clone());
        };
        let message = self.mismatch(odd, found, other, reference, what);
        self.errors.push(odd.place, message);
        Dim::Unknown
    }

    fn mismatch(&self, odd: &Expr, found: &Dimension, other: &Expr, reference: &Dimension, what: &str) -> String {
        let hint = if let (ExprKind::Number(number, None), true) = (&odd.kind, found.is_none()) {
            catalogue::give_a_unit(&number.text, reference)
        } else {
            catalogue::units_differ_by(found, reference, &self.units_within(odd))
        };
        catalogue::units_differ(what, (&print_text(odd), found), (&print_text(other), reference), &hint)
    }
}
