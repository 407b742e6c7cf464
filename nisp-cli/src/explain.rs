//! `nisp explain`: what the compiler made of a scene.

use std::fmt::Write;
use std::process::ExitCode;

use nisp::beyond_splines;
use nisp::network::Architecture;
use nisp::schema::{Origin, Scene, Unit};
use nisp_equations::Entry;

/// Prints a scene's equations, units, channels and savings, and what a point costs in a network of this shape.
pub(crate) fn explain(entry: &Entry, scene: Option<&str>, architecture: Architecture) -> Result<ExitCode, String> {
    let schema = entry.scene(scene).map_err(|error| error.to_string())?.schema;
    let mut text = String::new();
    // Writing into a string cannot fail.
    let mut line = |content: String| {
        let _ = writeln!(text, "{}", content.trim_end());
    };
    unknowns(schema).into_iter().for_each(&mut line);
    for size in entry.sizes {
        line(format!("  {:10} {:5} {:9} {}  {}", "size", size.name, "[m]", size.usual, size.about));
    }
    let Architecture { layers, width, .. } = architecture;
    line(match beyond_splines(schema) {
        None => format!("carried by splines; in a network of {layers} layers of {width} units, with gates:"),
        Some(_) => format!("in a network of {layers} layers of {width} units, with gates:"),
    });
    for group in schema.groups {
        line(format!("group {}", group.name));
        for term in group.terms {
            line(format!("  {} {}: {}", term.name, unit(&term.unit), term.equation));
        }
        let jets: Vec<_> = group.jets.iter().map(|jet| jet.name).collect();
        let channels = group.channels.join(", ");
        line(format!("  channels {} of a dense jet's {}: {channels}", group.channels.len(), group.dense));
        line(format!("  reads {}", jets.join(", ")));
        let [forward, back] = architecture.cost(group);
        line(format!("  FLOPs a point     {:>10} {:>10}", "forward", "adjoint"));
        for (what, ways) in [
            ("matrix products", [forward.products, back.products]),
            ("layers' rules", [forward.rules, back.rules]),
            ("heads", [forward.heads, back.heads]),
            ("residuals", group.flops),
        ] {
            line(format!("    {what:15} {:>10} {:>10}", ways[0], ways[1]));
        }
    }
    for skipped in schema.skipped {
        line(format!("skipped: {skipped}"));
    }
    crate::terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// A scene in a few lines: what it is, its coordinates, what is unknown, what is given.
pub(crate) fn unknowns(schema: &Scene) -> Vec<String> {
    let about = schema.docs.lines().next().unwrap_or_default();
    let mut lines =
        vec![format!("{}, scene {}: {about}", schema.module, schema.name).trim_end_matches(": ").to_string()];
    let mut line = |content: String| lines.push(content);
    for coordinate in schema.coordinates {
        line(format!("  coordinate {:5} {}", coordinate.name, unit(&coordinate.unit)));
    }
    for (at, head) in schema.heads.iter().enumerate() {
        let kind = if head.source { "source" } else { "field" };
        let axes: Vec<&str> = schema.axes(at).into_iter().map(|axis| schema.coordinates[axis].name).collect();
        let of_some = axes.len() < schema.coordinates.len();
        let name = if of_some { format!("{}({})", head.name, axes.join(", ")) } else { head.name.into() };
        line(format!("  {kind:10} {name:5} {:9} {}", unit(&head.unit), head.docs));
    }
    for scalar in schema.scalars {
        let (kind, value) = match scalar.origin {
            Origin::Given(value) => ("parameter", value),
            Origin::Learned { start, .. } => ("learned", start),
            Origin::Literal(_) | Origin::HeadScale(_) | Origin::SideScale { .. } => continue,
        };
        let value = value.map(|value| rounded(scalar.unit.factor.back(value).as_declared()));
        let value = value.map_or_else(|| "must be --set".into(), |value| value.to_string());
        line(format!("  {kind:10} {:5} {:9} {value}", scalar.name, unit(&scalar.unit)));
    }
    lines
}

pub(crate) fn unit(unit: &Unit) -> String {
    format!("[{}]", unit.text)
}

/// Without the digits that a conversion of units may have left behind.
fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}
