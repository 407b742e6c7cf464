//! `parameters: m [kg], l [m] = 0.5, g: vector [m/s^2];`

use proc_macro2::Delimiter;

use super::parse_number;
use super::recover::{self, at_statement};
use super::stream::{Context, Stream};
use super::tree::{Declaration, Expr, ExprKind, Kind, Name, Shape};
use super::{parse_expression, parse_unit};
use crate::error::{Checked, Place, catalogue};
use crate::unit::Unit;

/// What a word at the start of a statement declares.
pub(super) fn kind_of(word: &str) -> Option<Kind> {
    Some(match word {
        "coordinates" => Kind::Coordinate,
        "fields" => Kind::Field,
        "sources" => Kind::Source,
        "parameters" => Kind::Parameter,
        "constants" => Kind::Constant,
        "columns" => Kind::Column,
        _ => return None,
    })
}

/// Reads a whole declaration statement, word and all. Broken entries are reported and left out.
pub(super) fn parse(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    kind: Kind,
    docs: &[String],
) -> Vec<Declaration> {
    let word = stream.peek_word().unwrap_or_default();
    stream.skip();
    let mut declarations = Vec::new();
    if stream.take(":").is_none() {
        context.errors.push(stream.place(), catalogue::expected_operator(":", &word, &stream.found()));
        if stream.peek_word().is_none() {
            recover::skip_declaration(stream, context);
            return declarations;
        }
    }
    while !stream.at_end() && stream.take(";").is_none() {
        match entry(stream, context, kind, docs) {
            Ok(declaration) => {
                let is_learn = declaration.name.text == "learn";
                declarations.push(declaration);
                if !separator(stream, context, is_learn) {
                    break;
                }
            }
            Err(_) => skip_entry(stream, context),
        }
    }
    declarations
}

/// Takes a comma, or looks at a semicolon; a missing one is reported, after `learn` as what it is. False if the statement is over without one.
fn separator(stream: &mut Stream<'_>, context: &mut Context<'_>, is_learn: bool) -> bool {
    if stream.take(",").is_some() || stream.at(";") {
        return true;
    }
    if stream.at_end() || at_statement(stream) {
        context.errors.push(stream.previous(), catalogue::missing_semicolon());
        return false;
    }
    let message = if is_learn { catalogue::learned_by_a_scene } else { catalogue::expected_separator };
    context.errors.push(stream.place(), message(&stream.found()));
    if stream.peek_word().is_none() {
        skip_entry(stream, context);
    }
    true
}

/// Skips to the next entry, and remembers the words on the way, which are not unknown names later.
fn skip_entry(stream: &mut Stream<'_>, context: &mut Context<'_>) {
    while !stream.at_end() && !stream.at(";") && stream.take(",").is_none() {
        if let Some(word) = stream.peek_word() {
            context.broken.insert(word);
        }
        stream.skip();
    }
}

fn entry(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    kind: Kind,
    outer_docs: &[String],
) -> Checked<Declaration> {
    let mut docs = recover::docs(stream, context);
    if docs.is_empty() {
        docs = outer_docs.to_vec();
    }
    let name = recover::name(stream, context, noun(kind))?;
    // From here on the name is known: whatever is wrong behind it, using it is no further mistake.
    context.broken.insert(name.text.clone());
    let depends = depends(stream, context, kind)?;
    let shape = if stream.take(":").is_some() { shape(stream, context, kind)? } else { Shape::Scalar };
    let written = parse_unit::parse_optional(stream, context);
    let is_written = written.is_some();
    let unit = written.map_or(Some(Unit::one()), Checked::ok);
    let broken_name = name.text.clone();
    let mut declaration = Declaration {
        kind,
        name,
        depends,
        shape,
        unit,
        lower: None,
        upper: None,
        above: false,
        below: false,
        value: None,
        spread: None,
        docs,
    };
    attributes(stream, context, &mut declaration)?;
    if let (false, Kind::Parameter | Kind::Constant, Some(value)) = (is_written, kind, &declaration.value) {
        declaration.unit = unit_of(value).or(declaration.unit);
    }
    context.broken.remove(&broken_name);
    Ok(declaration)
}

/// The unit of a plain number: `J = 2e-4 [kg m^2]` is `J [kg m^2] = 2e-4`.
fn unit_of(value: &Expr) -> Option<Unit> {
    match &value.kind {
        ExprKind::Number(_, unit) => unit.as_deref().cloned(),
        ExprKind::Negate(inner) => unit_of(inner),
        _ => None,
    }
}

/// `(x, y)` behind the name of a field or a source: the coordinates that it depends on.
fn depends(stream: &mut Stream<'_>, context: &mut Context<'_>, kind: Kind) -> Checked<Option<Vec<Name>>> {
    let start = stream.place();
    let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) else { return Ok(None) };
    if !matches!(kind, Kind::Field | Kind::Source) {
        return Err(context.errors.report(start.to(place), catalogue::depends_on_nothing(noun(kind))));
    }
    let mut names = Vec::new();
    while !inside.at_end() {
        names.push(recover::name(&mut inside, context, "a coordinate")?);
        if inside.take(",").is_none() && !inside.at_end() {
            return Err(context.errors.report(inside.place(), catalogue::expected_separator(&inside.found())));
        }
    }
    Ok(Some(names))
}

fn noun(kind: Kind) -> &'static str {
    match kind {
        Kind::Coordinate => "a coordinate",
        Kind::Field => "a field",
        Kind::Source => "a source",
        Kind::Parameter => "a parameter",
        Kind::Constant => "a constant",
        Kind::Column => "a column",
    }
}

fn shape(stream: &mut Stream<'_>, context: &mut Context<'_>, kind: Kind) -> Checked<Shape> {
    let (place, found) = (stream.place(), stream.found());
    if stream.take_word("time") && kind == Kind::Coordinate {
        return Ok(Shape::Time);
    }
    if kind == Kind::Coordinate || kind == Kind::Constant || !stream.take_word("vector") {
        return Err(context.errors.report(place, catalogue::expected_shape(kind == Kind::Coordinate, &found)));
    }
    let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) else { return Ok(Shape::Vector) };
    let literal = inside.take_literal().filter(|_| inside.at_end());
    let number = literal.map(|literal| parse_number::parse(&literal, context)).transpose()?;
    let count = number.and_then(|number| number.exact).filter(|value| value.is_integer()).map(|value| *value.numer());
    match count.and_then(|count| usize::try_from(count).ok()).filter(|count| (1..=9).contains(count)) {
        Some(count) => Ok(Shape::Numbered(count)),
        None => Err(context.errors.report(place, catalogue::bad_vector_length())),
    }
}

/// `>= a`, `> a`, `<= b`, `< b`, `in a .. b`, `= c`, `within d`, in any order.
fn attributes(stream: &mut Stream<'_>, context: &mut Context<'_>, declaration: &mut Declaration) -> Checked<()> {
    loop {
        let start = stream.place();
        if stream.take("=").is_some() {
            declaration.value = Some(parse_expression::parse(stream, context)?);
            allow(context, declaration, start.to(stream.previous()), "=")?;
        } else if stream.take(">=").is_some() {
            declaration.lower = Some(parse_expression::parse(stream, context)?);
            allow(context, declaration, start.to(stream.previous()), ">=")?;
        } else if stream.take("<=").is_some() {
            declaration.upper = Some(parse_expression::parse(stream, context)?);
            allow(context, declaration, start.to(stream.previous()), "<=")?;
        } else if stream.take(">").is_some() {
            declaration.lower = Some(parse_expression::parse(stream, context)?);
            declaration.above = true;
            allow(context, declaration, start.to(stream.previous()), ">")?;
        } else if stream.take("<").is_some() {
            declaration.upper = Some(parse_expression::parse(stream, context)?);
            declaration.below = true;
            allow(context, declaration, start.to(stream.previous()), "<")?;
        } else if stream.take_word("in") {
            declaration.lower = Some(parse_expression::parse(stream, context)?);
            if stream.take("..=").or_else(|| stream.take("..")).is_none() {
                return Err(context.errors.report(stream.place(), catalogue::expected_range(&stream.found())));
            }
            declaration.upper = Some(parse_expression::parse(stream, context)?);
            allow(context, declaration, start.to(stream.previous()), "in")?;
        } else if stream.take_word("within") {
            declaration.spread = Some(parse_expression::parse(stream, context)?);
            allow(context, declaration, start.to(stream.previous()), "within")?;
        } else {
            return Ok(());
        }
    }
}

/// Only parameters and constants have values, and only parameters are believed to be somewhere; coordinates, constants
/// and columns have no bounds.
fn allow(context: &mut Context<'_>, declaration: &Declaration, place: Place, sign: &str) -> Checked<()> {
    let valued = matches!(declaration.kind, Kind::Parameter | Kind::Constant);
    let bounded = matches!(declaration.kind, Kind::Field | Kind::Source | Kind::Parameter);
    let allowed = match sign {
        "=" => valued,
        "within" => declaration.kind == Kind::Parameter,
        _ => bounded,
    };
    if allowed {
        return Ok(());
    }
    let message = match sign {
        "=" => catalogue::takes_no_value(noun(declaration.kind)),
        "within" => catalogue::takes_no_spread(noun(declaration.kind)),
        _ => catalogue::takes_no_bounds(noun(declaration.kind)),
    };
    Err(context.errors.report(place, message))
}
