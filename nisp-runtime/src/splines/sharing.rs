//! Which observations may have noise that neighbouring rows share.
//!
//! Only where equations and observations together are no more than fields and sources: there some source follows whatever the data show. Where
//! they are more (two sensors, a stop that pushes only where it is met), or where a source may not be negative, what is left may come of a wrong
//! equation, and is judged as that. Where nothing is sought but scalars, neighbours may be alike over few rows and no longer: what a wrong
//! equation leaves is as slow as the fields.

use super::cells::MANY;
use crate::problem::Bound;
use crate::schema::{self, TermKind};

/// By group and term, whether neighbouring rows may share noise.
fn may_share(bound: &Bound) -> Vec<Vec<bool>> {
    let schema = bound.problem.scene().schema;
    let lasting = schema.groups.iter().zip(&bound.coordinates).filter(|(_, places)| places.len() >= MANY);
    // Conditions of a few rows say where a record begins, and no more.
    let asked = |(group, _): (&'static schema::Group, _)| group.terms.iter().map(|term| term.rows).sum::<usize>();
    let is_bounded = |head: &schema::Head| head.source && (head.lower.is_some() || head.upper.is_some());
    let is_followed = lasting.map(asked).sum::<usize>() <= schema.heads.len() && !schema.heads.iter().any(is_bounded);
    let has_sources = schema.heads.iter().any(|head| head.source);
    let may = |(group, at): (usize, usize), term: &schema::Term| {
        let is_alike = bound.noisiness[group][term.first..][..term.rows].iter().all(Vec::is_empty);
        (is_followed || !has_sources)
            && is_data(term)
            && term.within.is_none()
            && is_alike
            && !bound.losses[group][at].is_robust()
    };
    let of = |(group, own): (usize, &schema::Group)| {
        own.terms.iter().enumerate().map(|(at, term)| may((group, at), term)).collect()
    };
    schema.groups.iter().enumerate().map(of).collect()
}

fn is_data(term: &schema::Term) -> bool {
    term.kind == TermKind::Observation
}

/// By group and term, the numbers of the classes of lengths, from `first` on.
pub(super) fn numbered(bound: &Bound, first: usize) -> Vec<Vec<Option<usize>>> {
    let mut next = first..;
    let may = may_share(bound).into_iter();
    may.map(|terms| terms.into_iter().map(|may| if may { next.next() } else { None }).collect()).collect()
}
