//! What local functions cannot do is refused before anything is computed.

use super::lattice::MOST_COORDINATES;
use super::{Local, LocalError};
use crate::bounds;
use crate::schema::{self, TermKind};

/// Splines of a higher degree than this are a slip.
pub(super) const HIGHEST_DEGREE: usize = 8;

/// What only networks do must not be left out quietly.
pub(super) fn refuse_what_networks_do(schema: &schema::Scene, settings: &Local) -> Result<(), LocalError> {
    let inputs = schema.coordinates.len();
    let terms = || schema.groups.iter().flat_map(|group| group.terms);
    let refused = [
        (inputs > MOST_COORDINATES, "more than four coordinates"),
        (schema.groups.iter().any(|group| group.paired), "paired points"),
        (
            schema.groups.iter().any(|group| !group.held.is_empty()),
            "fields and sources of some of the coordinates only",
        ),
        (terms().any(|t| t.kind == TermKind::Observation && t.within.is_none()), "measurements without `within`"),
        (terms().any(|t| t.kind == TermKind::Integral && t.loss.is_robust()), "robust losses of integrals"),
        (settings.cells <= settings.tests || settings.finer == 0, "lattices of fewer cells than a test is spread over"),
        (settings.degree > HIGHEST_DEGREE, "splines of such a degree"),
    ];
    let found = refused.into_iter().find(|(is_so, _)| *is_so).map(|(_, what)| what);
    let found = found.or_else(|| clouds(schema)).or_else(|| bounds::refused(schema));
    found.map_or(Ok(()), |what| Err(LocalError::Unsupported(what)))
}

/// Clouds whose points have no foot on a surface (see `surface`), or one where columns that the surface may read are not known.
pub(super) fn clouds(schema: &schema::Scene) -> Option<&'static str> {
    let clouds = || {
        let terms = schema.groups.iter().flat_map(|group| group.terms);
        terms.filter(|term| matches!(term.kind, TermKind::Chamfer { .. }))
    };
    let is_known =
        |group: &schema::Group, column: usize| group.terms.iter().all(|term| !term.columns.contains(&column));
    let has_known = |group: &schema::Group| (0..group.columns.len()).any(|column| is_known(group, column));
    let has_cloud =
        |group: &schema::Group| group.terms.iter().any(|term| matches!(term.kind, TermKind::Chamfer { .. }));
    // A curve in a plane, or a surface in space.
    let is_met = |term: &schema::Term| matches!((schema.coordinates.len(), term.rows), (1, 2) | (2..=3, 3));
    let is_symmetric =
        |term: &schema::Term| matches!(term.kind, TermKind::Chamfer { symmetric: true, plane: false, .. });
    match () {
        () if schema.groups.iter().any(|group| has_cloud(group) && has_known(group)) => {
            Some("clouds in groups with columns")
        }
        () if clouds().any(is_symmetric) => Some("symmetric Chamfer distances"),
        () if !clouds().all(is_met) => Some("clouds that are neither of a surface in space nor of a curve in a plane"),
        () => None,
    }
}
