//! The study as a table for people and as JSON for programs.

use nisp::Check;
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
            "checks": row.checks.iter().map(check).collect::<Vec<Value>>(),
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

fn check(check: &Check) -> Value {
    json!({
        "check": check.check,
        "group": check.group,
        "term": check.term,
        "value": check.value,
        "limit": check.limit,
        "passed": check.passed,
    })
}

/// A check that failed, in a cell.
fn failure(check: &Check) -> String {
    let place = [check.group, check.term].join(".");
    format!("{} {} {:.3} > {:.3}", check.check, place.trim_matches('.'), check.value, check.limit)
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

/// The head of a Markdown table with a row for each case.
pub(super) const HEAD: &str = "| equation | case | said | error | beyond 2, 4 deviations | | why |
|---|---|---|---|---|---|---|
";

/// A case as a row of the table.
pub(super) fn line(row: &Row) -> String {
    let errors: Vec<String> = row.unknowns.iter().map(|(name, off)| format!("{name} {:.2e}", off.error)).collect();
    let beyond: Vec<String> = row.unknowns.iter().filter_map(|(_, off)| off.beyond.map(shares)).collect();
    let judged = match (&row.judgement.lie, row.judgement.false_alarm) {
        (Some(_), _) if !row.can_be_told => "**lie** (hidden)",
        (Some(_), _) => "**lie**",
        (None, true) => "**false alarm**",
        (None, false) => "",
    };
    let failures = row.checks.iter().filter(|check| !check.passed).map(failure);
    let why: Vec<String> = row.judgement.lie.iter().chain(&row.refusal).cloned().chain(failures).collect();
    let (errors, beyond, why) = (errors.join("; "), beyond.join("; "), why.join("; ").replace('|', r"\|"));
    format!(
        "| {} | {} | {} | {errors} | {beyond} | {judged} | {why} |
",
        row.equation, row.corruption, row.said
    )
}

/// The counts, below the table.
pub(super) fn counts(rows: &[Row]) -> String {
    format!(
        "
{} cases, {} lies, {} of which data can tell; {} false alarms. A hidden lie is one where another source explains the \
         same data exactly.
",
        rows.len(),
        lies(rows),
        lies_that_data_can_tell(rows),
        false_alarms(rows)
    )
}

fn shares([two, four]: [f64; 2]) -> String {
    format!("{:.0} %, {:.0} %", 100.0 * two, 100.0 * four)
}
