//! Terms: what must hold at the points of a group.

use proc_macro2::Delimiter;

use super::recover::{self, end_statement};
use super::stream::{Context, Stream};
use super::tree::{Comparison, Condition, Expr, ExprKind, GroupItem, Name, Relation, Term, TermBody, Within};
use super::{parse_expression, parse_number, parse_unit};
use crate::error::{Checked, Place, catalogue};
use crate::loss::{self, Robust};

/// `NAME: BODY SUFFIXES;`
pub(super) fn named(stream: &mut Stream<'_>, context: &mut Context<'_>, docs: Vec<String>) -> Checked<GroupItem> {
    let name = recover::name(stream, context, "a term")?;
    recover::operator(stream, context, ":", &name.text)?;
    let start = stream.place();
    let finished = body(stream, context).and_then(|body| finish(stream, context, name.clone(), body, start, docs));
    Ok(finished.unwrap_or_else(|_| {
        recover::skip_statement(stream);
        GroupItem::Broken(name)
    }))
}

/// `observe NAME, NAME SUFFIXES, NAME SUFFIXES;` or `observe NAME: EXPR ~ COLUMN [unit] SUFFIXES;`
pub(super) fn observe(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    docs: Vec<String>,
) -> Checked<Vec<GroupItem>> {
    stream.skip();
    let name = recover::name(stream, context, "what is observed")?;
    if stream.take(":").is_some() {
        let start = stream.place();
        let finished =
            long_observation(stream, context).and_then(|body| finish(stream, context, name.clone(), body, start, docs));
        return Ok(vec![finished.unwrap_or_else(|_| {
            recover::skip_statement(stream);
            GroupItem::Broken(name)
        })]);
    }
    // Names that wait for their suffixes, which stand behind the last of them.
    let mut waiting = vec![name];
    let mut terms = Vec::new();
    loop {
        if stream.take(",").is_some() {
            waiting.push(recover::name(stream, context, "what is observed")?);
            continue;
        }
        let suffixes = suffixes(stream, context)?;
        terms.extend(waiting.drain(..).map(|name| observed(name, &suffixes, &docs)));
        if stream.take(",").is_none() {
            break;
        }
        waiting.push(recover::name(stream, context, "what is observed")?);
    }
    if ["~", "==", "-", "+", "*", "/", "^"].into_iter().any(|operator| stream.at(operator)) {
        return Err(context.errors.report(stream.place(), catalogue::unnamed_observation()));
    }
    end_statement(stream, context)?;
    Ok(terms)
}

/// The observation of a field in a column named like it.
fn observed(name: Name, (loss, weight, within): &Suffixes, docs: &[String]) -> GroupItem {
    let place = name.span.into();
    let value = Expr { kind: ExprKind::Name(name.text.clone()), place };
    let body = TermBody::Observe { value, column: None, unit: None };
    let (within, docs) = (within.clone(), docs.to_vec());
    GroupItem::Term(Box::new(Term { name, body, loss: *loss, weight: *weight, within, docs, place }))
}

fn long_observation(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<TermBody> {
    let value = parse_expression::parse(stream, context)?;
    if stream.take("~").is_none() {
        return Err(context.errors.report(stream.place(), catalogue::expected_tilde(&stream.found())));
    }
    let column = recover::name(stream, context, "a column")?;
    let unit = parse_unit::parse_optional(stream, context).transpose()?.map(Box::new);
    Ok(TermBody::Observe { value, column: Some(column), unit })
}

fn finish(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    name: Name,
    body: TermBody,
    start: Place,
    docs: Vec<String>,
) -> Checked<GroupItem> {
    let place = start.to(stream.previous());
    let (loss, weight, within) = suffixes(stream, context)?;
    end_statement(stream, context)?;
    Ok(GroupItem::Term(Box::new(Term { name, body, loss, weight, within, docs, place })))
}

/// What a number after `weight` is called where it is none.
pub(super) const WEIGHT: &str = "a weight (terms are left out by `without`)";

/// What stands after `with`, after `weight` and after `within`.
type Suffixes = (Option<Robust>, Option<f64>, Option<Within>);

/// `with huber(3)`, `weight 2`, `within 5 [mm]`.
fn suffixes(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Suffixes> {
    let (mut robust, mut weight, mut within) = (None, None, None);
    loop {
        if stream.take_word("weight") {
            weight = Some(positive(stream, context, WEIGHT)?);
        } else if stream.take_word("within") {
            let place = stream.place();
            let value = positive(stream, context, "what rows may be off by")?;
            let unit = parse_unit::parse_optional(stream, context).transpose()?.map(Box::new);
            within = Some(Within { value, unit, place });
        } else if stream.take_word("with") {
            let name = recover::name(stream, context, "a loss")?;
            let Some(variant) = loss::variant(&name.text) else {
                return Err(context.errors.report(name.span, catalogue::unknown_loss(&name.text)));
            };
            let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) else {
                let message = catalogue::expected_operator("(threshold)", &name.text, &stream.found());
                return Err(context.errors.report(stream.place(), message));
            };
            let threshold = positive(&mut inside, context, "the threshold")?;
            if !inside.at_end() {
                return Err(context.errors.report(place, catalogue::expected_positive("the threshold")));
            }
            robust = Some(Robust { variant, threshold });
        } else {
            return Ok((robust, weight, within));
        }
    }
}

/// A positive number.
pub(super) fn positive(stream: &mut Stream<'_>, context: &mut Context<'_>, what: &str) -> Checked<f64> {
    let place = stream.place();
    let Some(literal) = stream.take_literal() else {
        return Err(context.errors.report(place, catalogue::expected_positive(what)));
    };
    let place = place.to(stream.previous());
    match parse_number::parse(&literal, context)?.value {
        value if value > 0.0 => Ok(value),
        _ => Err(context.errors.report(place, catalogue::expected_positive(what))),
    }
}

fn body(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<TermBody> {
    let mut chamfer = *stream;
    let (symmetric, plane) = (chamfer.take_word("symmetric"), chamfer.take_word("plane"));
    if chamfer.at_word("chamfer") && starts_expression(&chamfer.after_next()) {
        *stream = chamfer.after_next();
        let point = parse_expression::parse(stream, context)?;
        return Ok(TermBody::Chamfer { point, symmetric, plane });
    }
    let mut conditions = vec![condition(stream, context)?];
    while stream.take(",").is_some() {
        conditions.push(condition(stream, context)?);
    }
    Ok(TermBody::Conditions(conditions))
}

fn starts_expression(stream: &Stream<'_>) -> bool {
    stream.at_group(Delimiter::Bracket) || stream.at_group(Delimiter::Parenthesis) || stream.peek_word().is_some()
}

/// `a == b`, `a >= b`, or `0 <= a _|_ b >= 0`.
fn condition(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Condition> {
    let first = comparison(stream, context)?;
    if stream.take_word("complements") || take_perpendicular(stream) {
        let second = comparison(stream, context)?;
        return Ok(Condition::Complementarity(Box::new([first, second])));
    }
    if let Some((_, place)) = take_relation(stream) {
        return Err(context.errors.report(place, catalogue::chained_relation()));
    }
    Ok(Condition::Relation(Box::new(first)))
}

/// `_|_` arrives as a word, an operator and a word.
fn take_perpendicular(stream: &mut Stream<'_>) -> bool {
    let mut ahead = *stream;
    let found = ahead.take_word("_") && ahead.take("|").is_some() && ahead.take_word("_");
    if found {
        *stream = ahead;
    }
    found
}

fn comparison(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Comparison> {
    let left = parse_expression::parse(stream, context)?;
    let Some((relation, relation_place)) = take_relation(stream) else {
        return Err(context.errors.report(stream.place(), catalogue::expected_relation(&stream.found())));
    };
    let right = parse_expression::parse(stream, context)?;
    Ok(Comparison { left, relation, relation_place, right })
}

fn take_relation(stream: &mut Stream<'_>) -> Option<(Relation, Place)> {
    [("==", Relation::Equal), (">=", Relation::AtLeast), ("<=", Relation::AtMost)]
        .into_iter()
        .find_map(|(text, relation)| Some((relation, stream.take(text)?)))
}
