//! The study as a table for people and as JSON for programs.

use std::fmt::Write;

use serde_json::{Value, json};

use super::study::Row;

/// One JSON object, on one line.
pub(super) fn json(rows: &[Row]) -> String {
    let of = |row: &Row| {
        let unknowns = row.unknowns.iter().map(|(name, off)| {
            json!({
                "name": name,
                "error": off.error,
                "beyond_two_deviations": off.beyond.map(|beyond| beyond[0]),
                "beyond_four_deviations": off.beyond.map(|beyond| beyond[1]),
            })
        });
        json!({
            "equation": row.equation,
            "corruption": row.corruption,
            "can_be_told": row.can_be_told,
            "status": row.said,
            "exit_code": row.exit,
            "failed": row.failed,
            "refusal": row.refusal,
            "unknowns": unknowns.collect::<Vec<Value>>(),
            "unmet": row.unmet,
            "lie": row.judgement.lie,
            "false_alarm": row.judgement.false_alarm,
            "seconds": row.seconds,
        })
    };
    let object = json!({
        "cases": rows.len(),
        "lies": lies(rows),
        "lies_that_data_can_tell": lies_that_data_can_tell(rows),
        "false_alarms": false_alarms(rows),
        "rows": rows.iter().map(of).collect::<Vec<Value>>(),
    });
    format!("{object}\n")
}

fn lies(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.judgement.lie.is_some()).count()
}

fn lies_that_data_can_tell(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.judgement.lie.is_some() && row.can_be_told).count()
}

fn false_alarms(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.judgement.false_alarm).count()
}

/// A Markdown table with a row for each case, and the counts.
pub(super) fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| equation | case | said | error | beyond 2, 4 deviations | | why |\n|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let errors: Vec<String> = row.unknowns.iter().map(|(name, off)| format!("{name} {:.2e}", off.error)).collect();
        let beyond: Vec<String> = row.unknowns.iter().filter_map(|(_, off)| off.beyond.map(shares)).collect();
        let judged = match (&row.judgement.lie, row.judgement.false_alarm) {
            (Some(_), _) if !row.can_be_told => "**lie** (hidden)",
            (Some(_), _) => "**lie**",
            (None, true) => "**false alarm**",
            (None, false) => "",
        };
        let why: Vec<&str> =
            row.judgement.lie.iter().chain(&row.refusal).chain(&row.failed).map(String::as_str).collect();
        // Writing into a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {judged} | {} |",
            row.equation,
            row.corruption,
            row.said,
            errors.join("; "),
            beyond.join("; "),
            why.join("; ").replace('|', "\\|"),
        );
    }
    let _ = writeln!(
        text,
        "\n{} cases, {} lies, {} of which data can tell; {} false alarms. A hidden lie is one where another source explains the \
         same data exactly.",
        rows.len(),
        lies(rows),
        lies_that_data_can_tell(rows),
        false_alarms(rows)
    );
    text
}

fn shares([two, four]: [f64; 2]) -> String {
    format!("{:.0} %, {:.0} %", 100.0 * two, 100.0 * four)
}
