//! Expressions, by binding power: sums, products, signs, powers, indices. `syn::Expr` would not do: Rust's `^` binds
//! looser than `+`.

use proc_macro2::Delimiter;

use super::stream::{Context, Stream};
use super::tree::{Expr, ExprKind, Name};
use super::{parse_number, parse_unit};
use crate::error::{Checked, catalogue};

/// Reads an expression, as far as it goes.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Expr> {
    context
        .nested(stream, |stream, context| chain(stream, context, product, [("+", false), ("-", true)], ExprKind::Sum))
}

fn product(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Expr> {
    chain(stream, context, sign, [("*", false), ("/", true)], ExprKind::Product)
}

/// A chain of operators of one binding power; the flag is true for the inverse one.
fn chain(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    tighter: impl Fn(&mut Stream<'_>, &mut Context<'_>) -> Checked<Expr>,
    operators: [(&str, bool); 2],
    build: impl FnOnce(Vec<(bool, Expr)>) -> ExprKind,
) -> Checked<Expr> {
    let first = tighter(stream, context)?;
    let start = first.place;
    let mut operands = vec![(false, first)];
    while let Some(&(_, inverse)) = operators.iter().find(|(text, _)| stream.take(text).is_some()) {
        operands.push((inverse, tighter(stream, context)?));
    }
    if operands.len() == 1
        && let Some((_, only)) = operands.pop()
    {
        return Ok(only);
    }
    Ok(Expr { kind: build(operands), place: start.to(stream.previous()) })
}

/// `-a`, which binds looser than `^` and tighter than `*`.
fn sign(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Expr> {
    if let Some(minus) = stream.take("-") {
        let inner = context.nested(stream, sign)?;
        let place = minus.to(inner.place);
        return Ok(Expr { kind: ExprKind::Negate(Box::new(inner)), place });
    }
    if stream.take("+").is_some() {
        return context.nested(stream, sign);
    }
    let base = postfix(stream, context)?;
    if stream.take("^").is_none() {
        return Ok(base);
    }
    // The exponent is read as a signed power itself, so that `2^-x` works and `a^b^c` is `a^(b^c)`.
    let exponent = context.nested(stream, sign)?;
    let place = base.place.to(exponent.place);
    Ok(Expr { kind: ExprKind::Power(Box::new(base), Box::new(exponent)), place })
}

/// `a[i, j]` or `a[i][j]`
fn postfix(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Expr> {
    let mut base = primary(stream, context)?;
    // A matrix has two indices: a bound on nesting, too.
    for _ in 0..2 {
        let Some((mut inside, end)) = stream.take_group(Delimiter::Bracket) else { break };
        let indices = list(&mut inside, context)?;
        let place = base.place.to(end);
        base = Expr { kind: ExprKind::Index(Box::new(base), indices), place };
    }
    Ok(base)
}

fn primary(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Expr> {
    let start = stream.place();
    let found = stream.found();
    if let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) {
        let inner = parse(&mut inside, context)?;
        expect_end(&inside, context)?;
        return Ok(Expr { kind: inner.kind, place });
    }
    if let Some((mut inside, place)) = stream.take_group(Delimiter::Bracket) {
        return Ok(Expr { kind: ExprKind::List(list(&mut inside, context)?), place });
    }
    if let Some(literal) = stream.take_literal() {
        let number = parse_number::parse(&literal, context);
        let unit = parse_unit::parse_optional(stream, context).transpose();
        let kind = ExprKind::Number(number?, unit?.map(Box::new));
        return Ok(Expr { kind, place: start.to(stream.previous()) });
    }
    match stream.take_name() {
        Some(name) if name.text != "_" && name.text != "let" => named(stream, context, name),
        _ => Err(context.errors.report(start, catalogue::expected_expression(&found))),
    }
}

/// A name, or a call if parentheses follow.
fn named(stream: &mut Stream<'_>, context: &mut Context<'_>, name: Name) -> Checked<Expr> {
    let start = name.span.into();
    let Some((mut inside, place)) = stream.take_group(Delimiter::Parenthesis) else {
        return Ok(Expr { kind: ExprKind::Name(name.text), place: start });
    };
    let arguments = list(&mut inside, context)?;
    Ok(Expr { kind: ExprKind::Call(name, arguments), place: start.to(place) })
}

/// Expressions separated by commas, to the end of their group.
pub(super) fn list(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Vec<Expr>> {
    let mut entries = Vec::new();
    while !stream.at_end() {
        entries.push(parse(stream, context)?);
        if stream.take(",").is_none() {
            expect_end(stream, context)?;
        }
    }
    Ok(entries)
}

fn expect_end(stream: &Stream<'_>, context: &mut Context<'_>) -> Checked<()> {
    if stream.at_end() {
        return Ok(());
    }
    Err(context.errors.report(stream.place(), catalogue::expected_close(&stream.found())))
}
