//! Clouds for the Chamfer terms of any scene.

use std::path::Path;

use nisp::schema::{Group, Scene, Term, TermKind};
use nisp::units::Number;
use nisp_data::DataError;
use nisp_data::cloud::View;

use super::{Found, Tables};
use crate::error::PrepareError;
use crate::frames::POINTS_OF_A_CELL;
use crate::request::Request;

/// Cells along a cloud that hardly any answer is finer than.
const CELLS: f64 = 40.0;

/// A file that holds the cloud of a group's term.
pub(crate) struct CloudFile<'a> {
    /// Group and term.
    pub(super) of: [&'static str; 2],
    pub(super) path: &'a Path,
}

/// The group and the term whose cloud a name in `--data NAME=FILE` asks for: `skin.seen` for a term of a group, `skin` for a
/// group that has nothing else to be measured, no name where the scene has nothing else.
pub(super) fn named(schema: &Scene, name: Option<&str>) -> Option<[&'static str; 2]> {
    let all = || schema.groups.iter().flat_map(|group| terms(group).map(move |term| (group, term)));
    let alone = |(group, _): &(&Group, &Term)| group.place.is_some() && !super::wants_data(group);
    let only = |mut found: Vec<(&'static Group, &'static Term)>| match found.len() {
        1 => found.pop(),
        _ => None,
    };
    let found = match name.map(|name| name.split_once('.').map_or((name, None), |(group, term)| (group, Some(term)))) {
        Some((group, Some(term))) => all().find(|(own, seen)| own.name == group && seen.name == term),
        Some((group, None)) => only(all().filter(|pair| pair.0.name == group && alone(pair)).collect()),
        None if schema.groups.iter().any(super::wants_data) => None,
        None => only(all().collect()),
    };
    found.map(|(group, term)| [group.name, term.name])
}

/// Gives every Chamfer term its cloud, in the term's unit.
///
/// # Errors
/// A cloud that is missing or cannot be read.
pub(super) fn bind(found: &mut Found, tables: &Tables<'_>, request: &Request) -> Result<(), PrepareError> {
    for group in found.problem.scene().schema.groups {
        for term in terms(group) {
            let file = tables.clouds.iter().rev().find(|cloud| cloud.of == [group.name, term.name]);
            let Some(file) = file else {
                return Err(PrepareError::Unseen { group: group.name, term: term.name });
            };
            let is_plain = term.unit.text.is_empty();
            // Clouds are in metres, or in the unit that the user names; numbers without unit are what they are.
            let unit = request.view.unit.filter(|_| !is_plain);
            let view = View { unit, components: components(term), ..request.view.clone() };
            let mut cloud = view.read(file.path)?;
            if is_plain && cloud.is_in_metres {
                let what = format!(
                    "`{}.{}` has no unit, and its cloud has one: give the equation units, or the cloud none",
                    group.name, term.name
                );
                return Err(DataError::File { path: file.path.into(), what }.into());
            }
            cloud.thin(cloud.length() / CELLS, POINTS_OF_A_CELL);
            found.warnings.extend(cloud.warnings);
            let inward = |metres: &f64| term.unit.factor.inverse().of(Number::si(*metres)).as_declared();
            let points = cloud.points.iter().flat_map(|point| point.iter().take(term.rows)).map(inward);
            found.problem.set_cloud(group.name, term.name, points.collect())?;
        }
    }
    Ok(())
}

/// What the numbers of a point are called: as the term's entries, or as coordinates in space where these are not written one by one.
fn components(term: &Term) -> Vec<String> {
    let names: &[&str] = match term.kind {
        TermKind::Chamfer { components, .. } if !components.is_empty() => components,
        _ => &["x", "y", "z"][..term.rows.min(3)],
    };
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn terms(group: &'static Group) -> impl Iterator<Item = &'static Term> {
    group.terms.iter().filter(|term| matches!(term.kind, TermKind::Chamfer { .. }))
}
