//! `nisp explain`: what the compiler made of a scene.

use std::process::ExitCode;

/// Prints a scene's equations, units, channels and savings.
pub(crate) fn explain(equation: &str, scene: Option<&str>) -> Result<ExitCode, String> {
    let entry = crate::entry(equation)?;
    let schema = entry.scene(scene).map_err(|error| error.to_string())?.schema;
    println!("{} / {}: {}", schema.module, schema.name, schema.docs.lines().next().unwrap_or_default());
    for head in schema.heads {
        println!(
            "  {} {} [{}]  {}",
            if head.source { "source" } else { "field " },
            head.name,
            head.unit.text,
            head.docs
        );
    }
    for group in schema.groups {
        println!("group {}", group.name);
        for term in group.terms {
            println!("  {} [{}]: {}", term.name, term.unit.text, term.equation);
        }
        let jets: Vec<_> = group.jets.iter().map(|jet| jet.name).collect();
        println!("  channels {} of a dense jet's {}: {}", group.channels.len(), group.dense, group.channels.join(", "));
        println!("  reads {}", jets.join(", "));
        println!("  residuals {} FLOPs a point, adjoint {}", group.flops[0], group.flops[1]);
    }
    for line in schema.skipped {
        println!("skipped: {line}");
    }
    Ok(ExitCode::SUCCESS)
}
