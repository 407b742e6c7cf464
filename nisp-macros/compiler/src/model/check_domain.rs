//! Domains: their regions in numbers, and which part of one a group lies in.

use super::elaborate::Elaborator;
use super::{Coordinate, Place, Region, constant};
use crate::error::{Checked, catalogue};
use crate::syntax::{self, Expr, ExprKind, FileKind, Item, Module, Portion, RegionKind};
use crate::unit::Unit;

/// The domains of a module by their names; one that is broken has no regions.
pub(super) struct Domains {
    all: Vec<(syntax::Name, Option<Vec<Region>>, bool)>,
}

/// Evaluates the domains of a module.
pub(super) fn check(module: &Module, coordinates: &[Coordinate], elaborator: &mut Elaborator<'_>) -> Domains {
    let mut domains = Domains { all: Vec::new() };
    for item in &module.items {
        let Item::Domain(domain) = item else { continue };
        if domains.all.iter().any(|(name, ..)| name.text == domain.name.text) {
            elaborator.errors.push(domain.name.span, catalogue::domain_declared_twice(&domain.name.text));
        }
        let regions = regions(domain, coordinates, elaborator).ok();
        domains.all.push((domain.name.clone(), regions, false));
    }
    domains
}

impl Domains {
    /// Where a group lies, if it says so.
    pub(super) fn locate(
        &mut self,
        location: Option<&syntax::Location>,
        elaborator: &mut Elaborator<'_>,
    ) -> Option<Place> {
        let location = location?;
        let wanted = &location.domain;
        if elaborator.scope.broken.contains(&wanted.text) {
            return None;
        }
        let Some((_, regions, used)) = self.all.iter_mut().find(|(name, ..)| name.text == wanted.text) else {
            let nearest = catalogue::nearest(&wanted.text, self.all.iter().map(|(name, ..)| name.text.as_str()));
            elaborator.errors.push(wanted.span, catalogue::no_domain(&wanted.text, nearest));
            return None;
        };
        *used = true;
        let domain = regions.clone()?;
        let has_ends = matches!(domain.last(), Some(Region::Box(ranges)) if ranges.len() == 1);
        if matches!(location.portion, Portion::Start | Portion::End) && !has_ends {
            elaborator.errors.push(wanted.span, catalogue::no_ends(&wanted.text));
            return None;
        }
        Some(Place { portion: location.portion, domain, points: location.points })
    }

    /// Warns of domains in which no group lies.
    pub(super) fn warn(&self, elaborator: &mut Elaborator<'_>) {
        for (name, ..) in self.all.iter().filter(|(_, _, used)| !used) {
            elaborator.warnings.push((catalogue::unused("domain", &name.text), name.span));
        }
    }
}

fn regions(
    domain: &syntax::Domain,
    coordinates: &[Coordinate],
    elaborator: &mut Elaborator<'_>,
) -> Checked<Vec<Region>> {
    let mut left = coordinates;
    let mut regions = Vec::new();
    for region in &domain.regions {
        let Some(wanted) = dimension(region) else {
            return Err(elaborator.errors.report(region.place, catalogue::regions_of_two_dimensions()));
        };
        let Some((own, rest)) = left.split_at_checked(wanted) else { break };
        left = rest;
        let units: Vec<&Unit> = own.iter().map(|coordinate| &coordinate.unit).collect();
        regions.push(numbers(region, &units, elaborator)?);
    }
    if regions.len() < domain.regions.len() || !left.is_empty() {
        let names: Vec<&str> = coordinates.iter().map(|coordinate| coordinate.name.text.as_str()).collect();
        let message = catalogue::domain_of_other_dimension(&domain.name.text, &names.join(", "));
        return Err(elaborator.errors.report(domain.name.span, message));
    }
    Ok(regions)
}

/// A region in the declared units of its coordinates.
fn numbers(region: &syntax::Region, units: &[&Unit], elaborator: &mut Elaborator<'_>) -> Checked<Region> {
    let found = match &region.kind {
        RegionKind::Box(ranges) => {
            let ends = ranges
                .iter()
                .zip(units)
                .map(|((low, high), unit)| Ok([number(low, unit, elaborator)?, number(high, unit, elaborator)?]));
            let ends = ends.collect::<Checked<Vec<_>>>()?;
            ends.iter().all(|[low, high]| low < high).then_some(Region::Box(ends))
        }
        RegionKind::Disc(parts) => match parts.as_slice() {
            [x, y, radius] => round([x, y, radius, radius], units, elaborator)?,
            _ => None,
        },
        RegionKind::Ellipse(parts) => match parts.as_slice() {
            [x, y, a, b] => round([x, y, a, b], units, elaborator)?,
            _ => None,
        },
        RegionKind::Polygon(corners) => {
            let corners = corners.iter().map(|corner| match &corner.kind {
                ExprKind::List(pair) if pair.len() == 2 => {
                    Ok(Some([number(&pair[0], units[0], elaborator)?, number(&pair[1], units[1], elaborator)?]))
                }
                _ => Ok(None),
            });
            let corners = corners.collect::<Checked<Option<Vec<_>>>>()?;
            corners.filter(|corners| corners.len() >= 3).map(Region::Polygon)
        }
        RegionKind::Ball(parts) => {
            let unit = alike(region, units, elaborator)?;
            let values = parts.iter().map(|part| number(part, unit, elaborator)).collect::<Checked<Vec<_>>>()?;
            match values[..] {
                [x, y, z, radius] if radius > 0.0 => Some(Region::Ball { centre: [x, y, z], radius }),
                _ => None,
            }
        }
        RegionKind::Cylinder(parts, ends) => {
            let unit = alike(region, units, elaborator)?;
            let values = parts.iter().map(|part| number(part, unit, elaborator)).collect::<Checked<Vec<_>>>()?;
            let ends =
                ends.as_ref().map(|(low, high)| Ok([number(low, unit, elaborator)?, number(high, unit, elaborator)?]));
            match (&values[..], ends.transpose()?) {
                (&[x, y, radius], Some([low, high])) if radius > 0.0 && low < high => {
                    Some(Region::Cylinder { centre: [x, y], radius, ends: [low, high] })
                }
                _ => None,
            }
        }
        RegionKind::File(FileKind::Polygon, path, _) => {
            Some(Region::File { kind: FileKind::Polygon, path: path.clone(), scale: 1.0 })
        }
        RegionKind::File(FileKind::Solid, path, one) => {
            let unit = alike(region, units, elaborator)?;
            Some(Region::File { kind: FileKind::Solid, path: path.clone(), scale: number(one, unit, elaborator)? })
        }
        RegionKind::Plus(a, b) => {
            Some(Region::Plus(Box::new([numbers(a, units, elaborator)?, numbers(b, units, elaborator)?])))
        }
        RegionKind::Minus(a, b) => {
            Some(Region::Minus(Box::new([numbers(a, units, elaborator)?, numbers(b, units, elaborator)?])))
        }
    };
    found.ok_or_else(|| elaborator.errors.report(region.place, catalogue::no_such_region(name(&region.kind))))
}

/// What a region is called.
fn name(kind: &RegionKind) -> &'static str {
    match kind {
        RegionKind::Box(ranges) if ranges.len() == 1 => "interval",
        RegionKind::Box(_) => "box",
        RegionKind::Disc(_) => "disc",
        RegionKind::Ellipse(_) => "ellipse",
        RegionKind::Polygon(_) | RegionKind::File(FileKind::Polygon, ..) => "polygon",
        RegionKind::Ball(_) => "ball",
        RegionKind::Cylinder(..) => "cylinder",
        RegionKind::File(FileKind::Solid, ..) => "solid",
        RegionKind::Plus(..) | RegionKind::Minus(..) => "region",
    }
}

/// How many coordinates a region goes over; nothing where its parts do not agree.
fn dimension(region: &syntax::Region) -> Option<usize> {
    match &region.kind {
        RegionKind::Box(ranges) => Some(ranges.len()),
        RegionKind::Disc(_) | RegionKind::Ellipse(_) | RegionKind::Polygon(_) => Some(2),
        RegionKind::Ball(_) | RegionKind::Cylinder(..) => Some(3),
        RegionKind::File(kind, ..) => Some(if *kind == FileKind::Polygon { 2 } else { 3 }),
        RegionKind::Plus(a, b) | RegionKind::Minus(a, b) => dimension(a).filter(|own| dimension(b) == Some(*own)),
    }
}

/// The unit of coordinates that have one in common, as a shape wants that is no product of ranges.
fn alike<'a>(region: &syntax::Region, units: &[&'a Unit], elaborator: &mut Elaborator<'_>) -> Checked<&'a Unit> {
    match units {
        [first, others @ ..] if others.iter().all(|unit| unit.factor == first.factor) => Ok(first),
        _ => Err(elaborator.errors.report(region.place, catalogue::region_of_two_units())),
    }
}

fn round(parts: [&Expr; 4], units: &[&Unit], elaborator: &mut Elaborator<'_>) -> Checked<Option<Region>> {
    let mut values = [0.0; 4];
    for (at, part) in parts.into_iter().enumerate() {
        values[at] = number(part, units[at % 2], elaborator)?;
    }
    let [x, y, a, b] = values;
    Ok((a > 0.0 && b > 0.0).then_some(Region::Ellipse { centre: [x, y], semi_axes: [a, b] }))
}

/// A constant in a unit; numbers without one are in it.
fn number(expr: &Expr, unit: &Unit, elaborator: &mut Elaborator<'_>) -> Checked<f64> {
    match constant::in_unit(expr, unit, elaborator)?.as_slice() {
        [one] => Ok(unit.factor.back(one.value).as_declared()),
        _ => Err(elaborator.errors.report(expr.place, catalogue::no_region())),
    }
}
