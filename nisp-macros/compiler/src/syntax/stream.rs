//! A position in the tokens, and what all parsers share.

use std::collections::BTreeSet;

use proc_macro2::{Delimiter, Literal, Spacing, TokenTree};
use syn::buffer::Cursor;

use super::tree::Name;
use crate::error::{Checked, Errors, Place, catalogue};

/// Nesting of expressions past which we give up: far more than anybody writes, far less than the stack holds.
const DEEPEST_EXPRESSION: usize = 100;

/// What parsers share: where errors go, names of broken statements, and how deep they are.
pub(super) struct Context<'e> {
    pub(super) errors: &'e mut Errors,
    pub(super) broken: BTreeSet<String>,
    depth: usize,
}

impl<'e> Context<'e> {
    pub(super) fn new(errors: &'e mut Errors) -> Self {
        Self { errors, broken: BTreeSet::new(), depth: 0 }
    }

    /// Runs a parser one level deeper.
    pub(super) fn nested<T>(
        &mut self,
        stream: &mut Stream<'_>,
        parse: impl FnOnce(&mut Stream<'_>, &mut Self) -> Checked<T>,
    ) -> Checked<T> {
        if self.depth == DEEPEST_EXPRESSION {
            return Err(self.errors.report(stream.place(), catalogue::nested_too_deeply(DEEPEST_EXPRESSION)));
        }
        self.depth += 1;
        let result = parse(stream, self);
        self.depth -= 1;
        result
    }
}

/// A position in the tokens.
#[derive(Clone, Copy)]
pub(super) struct Stream<'a> {
    cursor: Cursor<'a>,
    previous: Option<Place>,
}

impl<'a> Stream<'a> {
    pub(super) fn new(cursor: Cursor<'a>) -> Self {
        Self { cursor, previous: None }
    }

    /// Where the next token is; at the end of a group, its closing delimiter.
    pub(super) fn place(&self) -> Place {
        self.cursor.span().into()
    }

    /// Where the last token was.
    pub(super) fn previous(&self) -> Place {
        self.previous.unwrap_or_else(|| self.place())
    }

    pub(super) fn at_end(&self) -> bool {
        self.cursor.eof()
    }

    /// Takes any token, delimited groups whole.
    pub(super) fn skip(&mut self) -> Option<TokenTree> {
        let (token, rest) = self.cursor.token_tree()?;
        self.advance(token.span().into(), rest);
        Some(token)
    }

    fn advance(&mut self, place: Place, rest: Cursor<'a>) {
        self.previous = Some(place);
        self.cursor = rest;
    }

    /// The next token if it is a word.
    pub(super) fn peek_word(&self) -> Option<String> {
        self.cursor.ident().map(|(word, _)| word.to_string())
    }

    /// True if the next token is this word.
    pub(super) fn at_word(&self, text: &str) -> bool {
        self.cursor.ident().is_some_and(|(word, _)| word == text)
    }

    /// Takes the next token if it is this word.
    pub(super) fn take_word(&mut self, text: &str) -> bool {
        let found = self.at_word(text);
        if found {
            self.skip();
        }
        found
    }

    /// Takes a word.
    pub(super) fn take_name(&mut self) -> Option<Name> {
        let (word, rest) = self.cursor.ident()?;
        self.advance(word.span().into(), rest);
        Some(Name { text: word.to_string(), span: word.span() })
    }

    /// Takes a literal; a number may have no digits before its point.
    pub(super) fn take_literal(&mut self) -> Option<Literal> {
        let mut ahead = *self;
        let is_below_one = ahead.take(".").is_some();
        let (mut literal, rest) = ahead.cursor.literal()?;
        let span = literal.span();
        if is_below_one {
            literal = format!("0.{literal}").parse().ok()?;
            literal.set_span(span);
        }
        self.advance(span.into(), rest);
        Some(literal)
    }

    /// True if the next tokens spell this operator and no longer one of which it is a part.
    pub(super) fn at(&self, operator: &str) -> bool {
        self.after(operator).is_some()
    }

    /// True if the next token is a delimited group of this kind.
    pub(super) fn at_group(&self, delimiter: Delimiter) -> bool {
        self.cursor.group(delimiter).is_some()
    }

    /// True if the token after the next is an operator that starts with this character.
    pub(super) fn second_is(&self, character: char) -> bool {
        let second = self.cursor.token_tree().and_then(|(_, rest)| rest.punct());
        second.is_some_and(|(punct, _)| punct.as_char() == character)
    }

    /// True if the token after the next is a word.
    pub(super) fn second_is_word(&self) -> bool {
        self.cursor.token_tree().is_some_and(|(_, rest)| rest.ident().is_some())
    }

    /// The stream after the next token.
    pub(super) fn after_next(&self) -> Self {
        let mut next = *self;
        next.skip();
        next
    }

    /// Takes an operator and says where it stood.
    pub(super) fn take(&mut self, operator: &str) -> Option<Place> {
        let start = self.place();
        let (last, rest) = self.after(operator)?;
        self.advance(last, rest);
        Some(start.to(last))
    }

    fn after(&self, operator: &str) -> Option<(Place, Cursor<'a>)> {
        let mut cursor = self.cursor;
        let mut last = None;
        for (index, character) in operator.chars().enumerate() {
            let (punct, rest) = cursor.punct().filter(|(punct, _)| punct.as_char() == character)?;
            let joined = punct.spacing() == Spacing::Joint;
            if index + 1 < operator.chars().count() && !joined {
                return None;
            }
            // `=` is no part of `==`, nor `.` of `..`.
            let longer = joined && rest.punct().is_some_and(|(next, _)| "=.".contains(next.as_char()));
            if index + 1 == operator.chars().count() && longer {
                return None;
            }
            last = Some((Place::from(punct.span()), rest));
            cursor = rest;
        }
        last
    }

    /// Takes a delimited group: the stream inside, and where the whole of it stands.
    pub(super) fn take_group(&mut self, delimiter: Delimiter) -> Option<(Stream<'a>, Place)> {
        let (inside, span, rest) = self.cursor.group(delimiter)?;
        let place = Place { start: span.open(), end: span.close() };
        self.advance(place, rest);
        Some((Stream { cursor: inside, previous: Some(span.open().into()) }, place))
    }

    /// The next token as a message shows it: `found ...`.
    pub(super) fn found(&self) -> String {
        match self.cursor.token_tree() {
            None => "the end".into(),
            Some((TokenTree::Group(group), _)) => match group.delimiter() {
                Delimiter::Parenthesis => "`(`".into(),
                Delimiter::Bracket => "`[`".into(),
                Delimiter::Brace => "`{`".into(),
                Delimiter::None => "an expression of another macro".into(),
            },
            Some((TokenTree::Punct(_), _)) => format!("`{}`", self.operator_text()),
            Some((token, _)) => format!("`{}`", catalogue::shorten(&token.to_string())),
        }
    }

    /// The operator that starts here, with all the characters that are joined to it.
    fn operator_text(&self) -> String {
        let (mut text, mut cursor) = (String::new(), self.cursor);
        while let Some((punct, rest)) = cursor.punct() {
            text.push(punct.as_char());
            if punct.spacing() == Spacing::Alone || text.len() == 3 {
                break;
            }
            cursor = rest;
        }
        text
    }
}
