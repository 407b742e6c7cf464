//! `domains: plate = disc(0, 0, 0.1), slab = box(0 .. 1, 0 .. 2) times 0 .. 5;` and where in them a group lies.

use num_traits::One;
use proc_macro2::Delimiter;

use super::recover;
use super::stream::{Context, Stream};
use super::tree::{Domain, Expr, ExprKind, FileKind, Location, Number, Portion, Region, RegionKind};
use super::{parse_expression, parse_unit};
use crate::error::{Checked, catalogue};
use crate::rational::Rational;

/// Reads a whole declaration of domains, word and all.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Vec<Domain>> {
    stream.skip();
    recover::operator(stream, context, ":", "domains")?;
    let mut domains = Vec::new();
    loop {
        let name = recover::name(stream, context, "a domain")?;
        context.broken.insert(name.text.clone());
        recover::operator(stream, context, "=", &name.text)?;
        let mut regions = vec![combined(stream, context)?];
        while stream.take_word("times") {
            regions.push(combined(stream, context)?);
        }
        context.broken.remove(&name.text);
        domains.push(Domain { name, regions });
        if stream.take(",").is_none() || stream.at(";") {
            recover::end_statement(stream, context)?;
            return Ok(domains);
        }
    }
}

/// `in D`, `boundary of D`, `start of D` or `end of D`, behind a group's name.
pub(super) fn location(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Option<Location>> {
    let portions =
        [("in", Portion::Inside), ("boundary", Portion::Boundary), ("start", Portion::Start), ("end", Portion::End)];
    let Some((word, portion)) = portions.into_iter().find(|(word, _)| stream.take_word(word)) else { return Ok(None) };
    if portion != Portion::Inside && !stream.take_word("of") {
        return Err(context.errors.report(stream.place(), catalogue::expected_of(word, &stream.found())));
    }
    if stream.peek_word().is_none() {
        return Err(context.errors.report(stream.place(), catalogue::region_without_name()));
    }
    let domain = recover::name(stream, context, "a domain")?;
    let points = if stream.take_word("with") { Some(points(stream, context)?) } else { None };
    Ok(Some(Location { portion, domain, points }))
}

/// `2000 points`, behind `with`.
fn points(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<usize> {
    let place = stream.place();
    let found = stream.found();
    let number = stream.take_literal().and_then(|literal| literal.to_string().replace('_', "").parse::<usize>().ok());
    match number.filter(|number| (1..=MOST_POINTS).contains(number) && stream.take_word("points")) {
        Some(number) => Ok(number),
        None => Err(context.errors.report(place, catalogue::expected_points(&found, MOST_POINTS))),
    }
}

/// More points than this are a slip.
const MOST_POINTS: usize = 10_000_000;

/// A region, or several with `plus` and `minus` between them, from left to right.
fn combined(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Region> {
    let mut found = region(stream, context)?;
    loop {
        let kind = if stream.take_word("plus") {
            RegionKind::Plus
        } else if stream.take_word("minus") {
            RegionKind::Minus
        } else if let Some(operator) = ["+", "-"].into_iter().find(|operator| stream.at(operator)) {
            return Err(context.errors.report(stream.place(), catalogue::regions_joined_by(operator)));
        } else {
            return Ok(found);
        };
        let other = region(stream, context)?;
        let place = found.place.to(other.place);
        found = Region { kind: kind(Box::new(found), Box::new(other)), place };
    }
}

fn region(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Region> {
    let start = stream.place();
    let word = stream.peek_word().unwrap_or_default();
    let kind = match word.as_str() {
        "box" => RegionKind::Box(listed(stream, context, |stream, context| {
            range(stream, context, || catalogue::no_such_region("box"))
        })?),
        "disc" => RegionKind::Disc(listed(stream, context, parse_expression::parse)?),
        "ellipse" => RegionKind::Ellipse(listed(stream, context, parse_expression::parse)?),
        "solid" => file(stream, context)?,
        "polygon" if holds_text(stream) => file(stream, context)?,
        "polygon" => RegionKind::Polygon(listed(stream, context, parse_expression::parse)?),
        "ball" => RegionKind::Ball(listed(stream, context, parse_expression::parse)?),
        "cylinder" => cylinder(stream, context)?,
        _ if holds_range(stream) || names_shape(stream, &word) => {
            return Err(context.errors.report(start, catalogue::no_such_region(&word)));
        }
        _ => RegionKind::Box(vec![range(stream, context, catalogue::no_region)?]),
    };
    Ok(Region { kind, place: start.to(stream.previous()) })
}

/// True if a text in quotes stands first between the parentheses behind a word.
fn holds_text(stream: &Stream<'_>) -> bool {
    let inside = stream.after_next().take_group(Delimiter::Parenthesis);
    let literal = inside.and_then(|(mut inside, _)| inside.take_literal());
    literal.is_some_and(|literal| literal.to_string().starts_with('"'))
}

/// True if `..` stands between the parentheses behind a word, which then names a shape.
fn holds_range(stream: &Stream<'_>) -> bool {
    let Some((mut inside, _)) = stream.after_next().take_group(Delimiter::Parenthesis) else { return false };
    while !inside.at_end() && !inside.at("..") {
        inside.skip();
    }
    stream.peek_word().is_some() && !inside.at_end()
}

/// True for a word before parentheses that says what a shape is, but not as shapes are written.
fn names_shape(stream: &Stream<'_>, word: &str) -> bool {
    catalogue::names_region(word) && stream.after_next().at_group(Delimiter::Parenthesis)
}

/// `polygon("FILE")` or `solid("FILE" [unit])`.
fn file(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<RegionKind> {
    let kind = if stream.take_word("solid") { FileKind::Solid } else { FileKind::Polygon };
    if kind == FileKind::Polygon {
        stream.skip();
    }
    let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) else {
        return Err(context.errors.report(stream.place(), catalogue::no_region()));
    };
    let path = inside.take_literal().and_then(|literal| syn::parse_str::<syn::LitStr>(&literal.to_string()).ok());
    // The headers of a table have units of their own.
    let unit = match kind {
        FileKind::Solid => parse_unit::parse_optional(&mut inside, context).transpose()?,
        FileKind::Polygon => None,
    };
    match path.filter(|_| inside.at_end()) {
        Some(path) => {
            let one = Number { exact: Some(Rational::one()), value: 1.0, text: "1".into() };
            let one = Expr { kind: ExprKind::Number(one, unit.map(Box::new)), place };
            Ok(RegionKind::File(kind, path.value(), one))
        }
        None => {
            let called = if kind == FileKind::Solid { "solid" } else { "polygon" };
            Err(context.errors.report(place, catalogue::no_such_region(called)))
        }
    }
}

/// `cylinder(x, y, radius, a .. b)`
fn cylinder(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<RegionKind> {
    let parts = listed(stream, context, |stream, context| {
        let first = parse_expression::parse(stream, context)?;
        let last = if stream.take("..").is_some() { Some(parse_expression::parse(stream, context)?) } else { None };
        Ok((first, last))
    })?;
    let (plain, ranges): (Vec<_>, Vec<_>) = parts.into_iter().partition(|(_, last)| last.is_none());
    let ends = ranges.into_iter().next().and_then(|(low, high)| Some((low, high?)));
    Ok(RegionKind::Cylinder(plain.into_iter().map(|(first, _)| first).collect(), ends))
}

/// What stands between the parentheses behind a word, separated by commas.
fn listed<T>(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    parse: fn(&mut Stream<'_>, &mut Context<'_>) -> Checked<T>,
) -> Checked<Vec<T>> {
    let word = stream.peek_word().unwrap_or_default();
    stream.skip();
    let Some((mut inside, _)) = stream.take_group(Delimiter::Parenthesis) else {
        let message = catalogue::expected_operator("(", &word, &stream.found());
        return Err(context.errors.report(stream.place(), message));
    };
    let mut found = Vec::new();
    while !inside.at_end() {
        found.push(parse(&mut inside, context)?);
        if inside.take(",").is_none() && !inside.at_end() {
            let message = catalogue::expected_separator(&inside.found());
            return Err(context.errors.report(inside.place(), message));
        }
    }
    Ok(found)
}

/// `A .. B`, or else what to write.
fn range(stream: &mut Stream<'_>, context: &mut Context<'_>, otherwise: fn() -> String) -> Checked<(Expr, Expr)> {
    let start = stream.place();
    let low = parse_expression::parse(stream, context)?;
    if stream.take("..").is_none() {
        return Err(context.errors.report(start.to(stream.previous()), otherwise()));
    }
    Ok((low, parse_expression::parse(stream, context)?))
}
