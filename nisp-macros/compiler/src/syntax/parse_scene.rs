//! `scene NAME { ... }`

use super::recover::{self, end_statement};
use super::stream::{Context, Stream};
use super::tree::{Path, Scene, SceneItem};
use super::{parse_expression, parse_term};
use crate::error::{Checked, catalogue};

/// Reads a scene after its doc comment.
pub(super) fn parse(stream: &mut Stream<'_>, context: &mut Context<'_>, docs: Vec<String>) -> Checked<Scene> {
    stream.skip();
    let name = recover::name(stream, context, "a scene")?;
    let mut inside = recover::block(stream, context, &name.text)?;
    let mut items = Vec::new();
    recover::statements(&mut inside, context, |stream, context| statement(stream, context, &mut items));
    Ok(Scene { name, items, docs })
}

fn statement(stream: &mut Stream<'_>, context: &mut Context<'_>, items: &mut Vec<SceneItem>) -> Checked<()> {
    let word = stream.peek_word().unwrap_or_default();
    if !stream.second_is('=') {
        match word.as_str() {
            "learn" => {
                stream.skip();
                listed(stream, context, |stream, context| {
                    let name = recover::name(stream, context, "a parameter to learn")?;
                    let spread = stream.take_word("within").then(|| parse_expression::parse(stream, context));
                    Ok(SceneItem::Learn(name, spread.transpose()?))
                })
                .map(|found| items.extend(found))?;
                return end_statement(stream, context);
            }
            "without" | "only" => {
                stream.skip();
                let wrap = if word == "without" { SceneItem::Without } else { SceneItem::Only };
                items.extend(listed(stream, context, |stream, context| Ok(wrap(path(stream, context)?)))?);
                return end_statement(stream, context);
            }
            "weight" => {
                stream.skip();
                let path = path(stream, context)?;
                recover::operator(stream, context, "=", "the term")?;
                items.push(SceneItem::Weight(path, parse_term::positive(stream, context, parse_term::WEIGHT)?));
                return end_statement(stream, context);
            }
            _ => return Err(context.errors.report(stream.place(), catalogue::expected_scene_item(&stream.found()))),
        }
    }
    let name = recover::name(stream, context, "a source or parameter to fix")?;
    if let Some(place) = stream.take("==") {
        return Err(context.errors.report(place, catalogue::fix_with_one_equals(&name.text)));
    }
    recover::operator(stream, context, "=", &name.text)?;
    items.push(SceneItem::Fix(name, parse_expression::parse(stream, context)?));
    end_statement(stream, context)
}

fn listed<T>(
    stream: &mut Stream<'_>,
    context: &mut Context<'_>,
    parse: impl Fn(&mut Stream<'_>, &mut Context<'_>) -> Checked<T>,
) -> Checked<Vec<T>> {
    let mut found = vec![parse(stream, context)?];
    while stream.take(",").is_some() {
        found.push(parse(stream, context)?);
    }
    Ok(found)
}

/// `group` or `group.term`
fn path(stream: &mut Stream<'_>, context: &mut Context<'_>) -> Checked<Path> {
    let group = recover::name(stream, context, "a group")?;
    let term = stream.take(".").map(|_| recover::name(stream, context, "a term")).transpose()?;
    Ok(Path { group, term })
}
