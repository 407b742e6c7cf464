//! The report: one table an item.

use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

use nisp::simd::Isa;

use crate::{Extent, Item, Row};

/// What is not this command's to measure.
const ELSEWHERE: &str = "## Elsewhere

A thousand random small equations a run, from their text: rows and channels through a small network agree with dense jets within
1e-10 and 1e-12, and their adjoints with tangents (u.(Jv) = (J'u).v) within 1e-13, beside what an equation amplifies:
`cargo test --release -p nisp-compiler --test middle_equations`. Error against time, by scene, method, width and precision:
`equations/RESULTS.md`.";

/// Runs items and describes what they found, in Markdown; says on standard error how far it is.
pub fn report(items: &[Item], extent: Extent) -> String {
    let mut text = String::from("# Numerical stability\n\n");
    // Writing into a string cannot fail.
    let mut line = |content: String| {
        let _ = writeln!(text, "{content}");
    };
    line("Made by `cargo run --release -p nisp-stability`; one item alone by adding its name, the fast part by".into());
    line(
        "`cargo test --release -p nisp-stability`. Errors are relative unless a row says otherwise; what is counted is"
            .into(),
    );
    line(
        "what went wrong. Tests hold us to every target, and where it is MISSED to the bound that the row names.\n"
            .into(),
    );
    line(format!(
        "{}; {}; instruction sets {}; commit {}\n",
        output("date", &["-u", "+%F"]),
        machine(),
        isas(),
        commit()
    ));
    for item in items {
        eprintln!("{} ...", item.name);
        let start = Instant::now();
        let rows = (item.run)(extent);
        line(format!("## {} (`{}`, {:.0} s)\n", item.title, item.name, start.elapsed().as_secs_f64()));
        line("| what | samples | worst | target | |".into());
        line("|---|---|---|---|---|".into());
        rows.iter().for_each(|row| line(table_row(row)));
        line(String::new());
    }
    line(ELSEWHERE.into());
    let end = text.trim_end().len();
    text.truncate(end);
    text.push('\n');
    text
}

fn table_row(row: &Row) -> String {
    let verdict = match (row.passes(), row.holds()) {
        (true, _) => "pass".into(),
        (false, true) if row.held.is_infinite() => format!("MISSED: {}", row.why),
        (false, true) => format!("MISSED (tests: {}): {}", number(row.held), row.why),
        (false, false) => "MISSED, and worse than tests allow".to_string(),
    };
    format!("| {} | {} | {} | {} | {verdict} |", row.what, row.samples, number(row.worst), number(row.target))
}

/// Counts and moderate numbers plainly.
fn number(x: f64) -> String {
    if x == 0.0 || (x.fract() == 0.0 && x.abs() < 1e6) {
        format!("{x}")
    } else if (0.1..1e3).contains(&x.abs()) {
        format!("{x:.2}")
    } else {
        format!("{x:.1e}")
    }
}

fn isas() -> String {
    Isa::available().map(Isa::name).collect::<Vec<_>>().join(", ")
}

fn machine() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find_map(|line| line.strip_prefix("model name")?.split(": ").nth(1));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {threads} threads", model.unwrap_or(std::env::consts::ARCH))
}

fn commit() -> String {
    output("git", &["-C", env!("CARGO_MANIFEST_DIR"), "describe", "--always", "--dirty", "--exclude=*"])
}

/// What a command says, if it is there.
fn output(command: &str, arguments: &[&str]) -> String {
    let said = Command::new(command).args(arguments).output().ok().filter(|output| output.status.success());
    said.map_or_else(|| "unknown".into(), |output| String::from_utf8_lossy(&output.stdout).trim().into())
}
