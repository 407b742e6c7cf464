//! `cargo run --release -p nisp-stability [ITEM...]`: the full suite; without items it writes `tests/STABILITY.md`.

use std::path::Path;
use std::process::ExitCode;

use nisp_stability::{Extent, ITEMS, Item, report};

fn main() -> ExitCode {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    if let Some(unknown) = asked.iter().find(|name| ITEMS.iter().all(|item| item.name != **name)) {
        let names = ITEMS.map(|item| item.name).join(", ");
        eprintln!("there is no item `{unknown}`; there are: {names}");
        return ExitCode::from(2);
    }
    let chosen = ITEMS.into_iter().filter(|item| asked.is_empty() || asked.iter().any(|name| name == item.name));
    let text = report(&chosen.collect::<Vec<Item>>(), Extent::Full);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../STABILITY.md");
    let written = if asked.is_empty() { std::fs::write(&path, &text) } else { Ok(()) };
    println!("{text}");
    if let Err(error) = written {
        eprintln!("{}: {error}", path.display());
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
