//! `domains: plate = disc(0, 0, 0.1), slab = box(0 .. 1, 0 .. 2) times 0 .. 5;` and where in them a group lies.

use proc_macro2::Delimiter;

use super::parse_expression;
use super::recover;
use super::stream::{Context, Stream};
use super::tree::{Domain, Expr, Location, Portion, Region, RegionKind};
use crate::error::{Checked, catalogue};

/// Reads a whole declaration of domains, word and all.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Vec<Domain>> {
    stream.skip();
    recover::operator(stream, context, ":", "domains")?;
    let mut domains = Vec::new();
    loop {
        let name = recover::name(stream, context, "a domain")?;
        context.broken.insert(name.text.clone());
        recover::operator(stream, context, "=", &name.text)?;
        let mut regions = vec![region(stream, context)?];
        while stream.take_word("times") {
            regions.push(region(stream, context)?);
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
    let domain = recover::name(stream, context, "a domain")?;
    Ok(Some(Location { portion, domain }))
}

fn region(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Region> {
    let start = stream.place();
    let word = stream.peek_word().unwrap_or_default();
    let kind = match word.as_str() {
        "box" => RegionKind::Box(listed(stream, context, range)?),
        "disc" => RegionKind::Disc(listed(stream, context, parse_expression::parse)?),
        "ellipse" => RegionKind::Ellipse(listed(stream, context, parse_expression::parse)?),
        "polygon" => RegionKind::Polygon(listed(stream, context, parse_expression::parse)?),
        _ => RegionKind::Box(vec![range(stream, context)?]),
    };
    Ok(Region { kind, place: start.to(stream.previous()) })
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

/// `A .. B`
fn range(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<(Expr, Expr)> {
    let low = parse_expression::parse(stream, context)?;
    recover::operator(stream, context, "..", "the lower end")?;
    Ok((low, parse_expression::parse(stream, context)?))
}
