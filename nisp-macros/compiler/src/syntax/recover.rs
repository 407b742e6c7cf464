//! Going on after a mistake: where statements begin and end.

use proc_macro2::{Delimiter, TokenTree};

use super::stream::{Context, Stream};
use super::tree::Name;
use crate::error::{Checked, Place, Reported, catalogue};

/// Words that begin a statement of a module.
pub(super) const STATEMENTS: [&str; 11] =
    ["coordinates", "fields", "sources", "parameters", "constants", "domains", "units", "let", "on", "scene", "hard"];

/// True where a new statement evidently begins, so that a `;` must have been forgotten before it.
pub(super) fn at_statement(stream: &Stream<'_>) -> bool {
    if stream.at("#") {
        return true;
    }
    let Some(word) = stream.peek_word() else { return false };
    let introduced = ["let", "on", "scene", "hard", "observe", "learn", "without", "only"];
    stream.second_is(':') || (introduced.contains(&word.as_str()) && stream.second_is_word())
}

/// Takes the `;` that ends a statement. A missing one in front of another statement is reported and forgiven.
pub(super) fn end_statement(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<()> {
    if stream.take(";").is_some() {
        return Ok(());
    }
    if stream.at_end() || at_statement(stream) {
        context.errors.push(stream.previous(), catalogue::missing_semicolon());
        return Ok(());
    }
    Err(context.errors.report(stream.place(), catalogue::expected_end(&stream.found())))
}

/// Skips to the end of a broken statement: past its `;` or its block, or up to where the next one begins.
pub(super) fn skip_statement(stream: &mut Stream<'_>) {
    while !stream.at_end() && stream.take(";").is_none() {
        if stream.at_word("let") || stream.at("#") {
            return;
        }
        if matches!(stream.skip(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace) {
            return;
        }
    }
}

/// As `skip_statement`, and remembers every word in it: whatever it was to declare is no unknown name.
pub(super) fn skip_declaration(stream: &mut Stream<'_>, context: &mut Context<'_>) {
    while !stream.at_end() && stream.take(";").is_none() {
        match stream.skip() {
            Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => return,
            Some(TokenTree::Ident(word)) => {
                context.broken.insert(word.to_string());
            }
            _ => {}
        }
    }
}

/// Reads statements to the end of a block. `parse` must take at least one token or report; what it leaves of a
/// statement that it could not read is skipped here.
pub(super) fn statements(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    mut parse: impl FnMut(&mut Stream<'_>, &mut Context<'_>) -> Checked<()>,
) {
    while !stream.at_end() {
        if stream.take(";").is_some() {
            continue;
        }
        if parse(stream, context).is_err() {
            // A parser that failed on its first token has not moved: step over it, so that this loop ends.
            if stream.at_word("let") || stream.at("#") {
                stream.skip();
            }
            skip_statement(stream);
        }
    }
}

/// Words of Rust that mean nothing here, so that equations may have them as names: the yield of a reactor, a loop of a circuit.
const PLAIN: [&str; 33] = [
    "abstract", "async", "await", "become", "box", "break", "const", "continue", "do", "dyn", "enum", "extern",
    "final", "fn", "gen", "impl", "loop", "macro", "match", "move", "override", "priv", "ref", "return", "static",
    "struct", "trait", "try", "type", "typeof", "unsized", "virtual", "yield",
];

/// True of what can be the name of a module: no word of Rust.
pub fn is_name(text: &str) -> bool {
    text != "_" && syn::parse_str::<syn::Ident>(text).is_ok()
}

/// Takes a name, or says what it would have named.
pub(super) fn name(stream: &mut Stream<'_>, context: &mut Context<'_>, what: &str) -> Checked<Name> {
    let place = stream.place();
    let found = stream.found();
    let Some(name) = stream.take_name() else {
        return Err(context.errors.report(place, catalogue::expected_name(what, &found)));
    };
    if let Some(plain) = name.text.strip_prefix("r#") {
        // Other statements may well mean it by its plain name.
        context.broken.extend([plain.to_string(), name.text.clone()]);
        return Err(context.errors.report(place, catalogue::raw_name(plain)));
    }
    if is_name(&name.text) || PLAIN.contains(&name.text.as_str()) { Ok(name) } else { Err(keyword(&name, context)) }
}

/// Takes the name of a module, which no word of Rust is: files and crates are called after it.
pub(super) fn module_name(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Name> {
    let name = name(stream, context, "a module")?;
    if is_name(&name.text) { Ok(name) } else { Err(keyword(&name, context)) }
}

fn keyword(name: &Name, context: &mut Context<'_>) -> Reported {
    context.broken.insert(name.text.clone());
    context.errors.report(name.span, catalogue::keyword_as_name(&name.text))
}

/// Takes an operator, or says what it was for.
pub(super) fn operator(stream: &mut Stream<'_>, context: &mut Context<'_>, text: &str, after: &str) -> Checked<Place> {
    let found = stream.found();
    match stream.take(text) {
        Some(place) => Ok(place),
        None => Err(context.errors.report(stream.place(), catalogue::expected_operator(text, after, &found))),
    }
}

/// Takes a `{ ... }` block.
pub(super) fn block<'a>(stream: &mut Stream<'a>, context: &mut Context<'_>, after: &str) -> Checked<Stream<'a>> {
    match stream.take_group(Delimiter::Brace) {
        Some((inside, _)) => Ok(inside),
        None => {
            let message = catalogue::expected_operator("{ ... }", after, &stream.found());
            Err(context.errors.report(stream.place(), message))
        }
    }
}

/// Takes doc comments; any other attribute is reported and left out.
pub(super) fn docs(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Vec<String> {
    let mut lines = Vec::new();
    while let Some(hash) = stream.take("#") {
        let Some((mut inside, place)) = stream.take_group(Delimiter::Bracket) else {
            context.errors.push(hash, catalogue::not_a_doc_comment());
            continue;
        };
        let literal = (inside.take_word("doc") && inside.take("=").is_some()).then(|| inside.take_literal()).flatten();
        match literal.map(syn::Lit::new) {
            Some(syn::Lit::Str(text)) => lines.push(text.value().trim().to_string()),
            _ => context.errors.push(hash.to(place), catalogue::not_a_doc_comment()),
        }
    }
    lines
}
