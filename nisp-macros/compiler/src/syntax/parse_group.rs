//! `on NAME { ... }`, `on NAME in DOMAIN { ... }`

use super::recover;
use super::stream::{Context, Stream};
use super::tree::{Group, GroupItem, Kind, Let};
use super::{parse_declarations, parse_domain, parse_expression, parse_term};
use crate::error::{Checked, catalogue};

/// Reads a group after its doc comment.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>, docs: Vec<String>) -> Checked<Group> {
    stream.skip();
    let name = recover::name(stream, context, "a group of points")?;
    let location = parse_domain::location(stream, context)?;
    let paired = stream.take_word("pairs");
    let mut inside = recover::block(stream, context, &name.text)?;
    let mut items = Vec::new();
    recover::statements(&mut inside, context, |stream, context| statement(stream, context, &mut items));
    Ok(Group { name, location, paired, items, docs })
}

fn statement(stream: &mut Stream<'_>, context: &mut Context<'_>, items: &mut Vec<GroupItem>) -> Checked<()> {
    let docs = recover::docs(stream, context);
    let word = stream.peek_word().unwrap_or_default();
    if word == "columns" && stream.second_is(':') {
        let columns = parse_declarations::parse(stream, context, Kind::Column, &docs);
        items.extend(columns.into_iter().map(|column| GroupItem::Column(Box::new(column))));
    } else if word == "let" {
        items.push(GroupItem::Let(definition(stream, context)?));
    } else if word == "observe" && !stream.second_is(':') {
        items.extend(parse_term::observe(stream, context, docs)?);
    } else if stream.second_is(':') {
        items.push(parse_term::named(stream, context, docs)?);
    } else {
        return Err(context.errors.report(stream.place(), catalogue::expected_term(&stream.found())));
    }
    Ok(())
}

/// `let NAME = EXPR;` A definition that cannot be read keeps its name.
pub(super) fn definition(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Let> {
    stream.skip();
    let name = recover::name(stream, context, "a definition")?;
    let value = value(stream, context, &name.text);
    if value.is_err() {
        recover::skip_statement(stream);
    }
    Ok(Let { name, value: value.ok() })
}

fn value(stream: &mut Stream<'_>, context: &mut Context<'_>, name: &str) -> Checked<super::tree::Expr> {
    recover::operator(stream, context, "=", name)?;
    let value = parse_expression::parse(stream, context)?;
    recover::end_statement(stream, context)?;
    Ok(value)
}
