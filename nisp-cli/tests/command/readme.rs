//! The README shows what the command prints.

use std::fs;
use std::path::Path;

use crate::common::Place;

/// A line without what differs between runs: numbers, and how the run ended.
fn shape(line: &str) -> String {
    let numbered =
        |word: &str| if word.contains(|c: char| c.is_ascii_digit()) { "#".to_string() } else { word.to_string() };
    let words: Vec<String> = line.split_whitespace().map(numbered).collect();
    let line = words.join(" ");
    match line.split_once(" after # s: ") {
        Some((_, rest)) => format!("STATUS {rest}"),
        None => line,
    }
}

fn shapes(text: &str) -> Vec<String> {
    text.lines().filter(|line| !line.starts_with("warning:")).map(shape).collect()
}

#[test]
fn the_printed_output_has_the_rows_of_the_readme() {
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")).unwrap();
    let (_, after) = readme.split_once("cargo run --release -- solve pendulum\n```").unwrap();
    let (_, block) = after.split_once("```text\n").unwrap();
    let (block, _) = block.split_once("```").unwrap();
    let place = Place::new();
    let ran = place.run("solve pendulum --budget 1");
    assert_eq!(shapes(&ran.stdout), shapes(block), "{}", ran.stdout);
}
