//! `pub mod NAME { ... }`

use proc_macro2::{Delimiter, TokenStream};

use super::recover::{self, STATEMENTS};
use super::stream::{Context, Stream};
use super::tree::{Hard, Item, Kind, Module};
use super::{parse_declarations, parse_domain, parse_expression, parse_group, parse_scene};
use crate::error::{Checked, catalogue};

/// Reads the one module of an invocation.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Module> {
    let docs = recover::docs(stream, context);
    let visibility = visibility(stream);
    if !stream.take_word("mod") {
        return Err(context.errors.report(stream.place(), catalogue::expected_module(&stream.found())));
    }
    let name = recover::module_name(stream, context)?;
    let mut inside = recover::block(stream, context, &name.text)?;
    if !stream.at_end() {
        context.errors.push(stream.place(), catalogue::one_module(&stream.found()));
    }
    let mut module = Module {
        docs,
        visibility,
        name,
        units_off: false,
        declarations: Vec::new(),
        items: Vec::new(),
        broken: Default::default(),
    };
    recover::statements(&mut inside, context, |stream, context| statement(stream, context, &mut module));
    module.broken.append(&mut context.broken);
    Ok(module)
}

fn visibility(stream: &mut Stream<'_>) -> TokenStream {
    let mut tokens = TokenStream::new();
    if stream.at_word("pub") {
        tokens.extend(stream.skip());
        if stream.at_group(Delimiter::Parenthesis) {
            tokens.extend(stream.skip());
        }
    }
    tokens
}

fn statement(stream: &mut Stream<'_>, context: &mut Context<'_>, module: &mut Module) -> Checked<()> {
    let docs = recover::docs(stream, context);
    let word = stream.peek_word().unwrap_or_default();
    if let Some(kind) = parse_declarations::kind_of(&word).filter(|kind| *kind != Kind::Column) {
        module.declarations.extend(parse_declarations::parse(stream, context, kind, &docs));
        return Ok(());
    }
    match word.as_str() {
        "units" => {
            units(stream, context)?;
            module.units_off = true;
        }
        "let" => module.items.push(Item::Let(parse_group::definition(stream, context)?)),
        "on" => module.items.push(Item::Group(parse_group::parse(stream, context, docs)?)),
        "scene" => module.items.push(Item::Scene(parse_scene::parse(stream, context, docs)?)),
        "domains" => module.items.extend(parse_domain::parse(stream, context)?.into_iter().map(Item::Domain)),
        "hard" => module.items.push(Item::Hard(hard(stream, context)?)),
        _ => {
            let message = catalogue::expected_statement(&stream.found(), &word, &STATEMENTS);
            context.errors.push(stream.place(), message);
            recover::skip_declaration(stream, context);
        }
    }
    Ok(())
}

/// `units: off;`
fn units(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<()> {
    stream.skip();
    recover::operator(stream, context, ":", "units")?;
    if !stream.take_word("off") {
        let message = catalogue::expected_operator("off", "units:", &stream.found());
        return Err(context.errors.report(stream.place(), message));
    }
    recover::end_statement(stream, context)
}

/// `hard FIELD = VALUE by DISTANCE;`
fn hard(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Hard> {
    stream.skip();
    let field = recover::name(stream, context, "a field")?;
    recover::operator(stream, context, "=", &field.text)?;
    let value = parse_expression::parse(stream, context)?;
    if !stream.take_word("by") {
        return Err(context.errors.report(stream.place(), catalogue::expected_by(&stream.found())));
    }
    let distance = parse_expression::parse(stream, context)?;
    recover::end_statement(stream, context)?;
    Ok(Hard { field, value, distance })
}
