//! Whoever stops and goes on gets the bits of whoever did not stop.

use nisp::network::Architecture;
use nisp::solve::driver::Flow;
use nisp::{Checkpoint, Optimizer, Problem, Report, Settings, Width, recover, resume};
use nisp_equations::{Request, catalogue};

use crate::row::{Extent, Row};

fn problem(name: &str) -> Problem {
    let entry = catalogue().into_iter().find(|entry| entry.name == name).expect("an entry");
    entry.prepare(&Request::default()).expect("the repository's example").problem
}

fn settings(optimizer: Optimizer, precision: Width, width: usize, iterations: u64) -> Settings {
    let architecture = Architecture { width, ..Settings::default().architecture };
    Settings { optimizer, precision, architecture, budget: None, iterations: Some(iterations), ..Settings::default() }
}

/// Runs that differ by a bit from one that did not stop, stopped halfway and gone on on another number of threads.
fn halfway(optimizer: Optimizer, steps: u64) -> usize {
    let problem = problem("pendulum");
    let settings = |iterations, threads| Settings { threads, ..settings(optimizer, Width::F64, 6, iterations) };
    let go_on = &mut |_: Report<'_>| Flow::Continue;
    let straight = recover(&problem, &settings(steps, 1), go_on);
    let first = recover(&problem, &settings(steps / 2, 2), go_on);
    let (Ok(straight), Ok(first)) = (straight, first) else { return 1 };
    let Ok(second) = resume(&problem, &settings(steps, 3), &first.checkpoint, go_on) else { return 1 };
    usize::from(second.checkpoint.to_bytes() != straight.checkpoint.to_bytes())
}

/// Steps between two looks at whether single precision still helps, early in a run.
const LOOKS: u64 = 128;

/// What a run leaves that is broken off after a step, before, at and after each look and the turn to double precision, all gone
/// on to the end of the run: how many there are, and how many end otherwise by a bit. Nothing of a run that does not turn, or
/// not where it should: at a look, or between two.
fn about_the_turn(width: usize, at_a_look: bool) -> Option<(usize, usize)> {
    let problem = problem("rlc");
    let settings = |threads| Settings { threads, ..settings(Optimizer::Lbfgs, Width::Auto, width, 450) };
    // Names in a checkpoint are text.
    let is_double = |bytes: &[u8]| bytes.windows(12).any(|text| text == b"single steps");
    let (mut kept, mut last): (Vec<Vec<u8>>, Vec<u8>) = (Vec::new(), Vec::new());
    let mut turn = None;
    let straight = recover(&problem, &settings(1), &mut |report: Report<'_>| {
        let bytes = (report.checkpoint)().to_bytes();
        let turns = is_double(&bytes) && !is_double(&last);
        if turns {
            turn = Some(report.iteration - 1);
            kept.push(last.clone());
        }
        if turns || (report.iteration + 1) % LOOKS < 3 {
            kept.push(bytes.clone());
        }
        last = bytes;
        Flow::Continue
    });
    turn.filter(|turn| turn.is_multiple_of(LOOKS) == at_a_look)?;
    let straight = straight.ok()?.checkpoint.to_bytes();
    let differs = |bytes: &&Vec<u8>| {
        let from = Checkpoint::from_bytes(bytes).expect("what was written");
        let resumed = resume(&problem, &settings(3), &from, &mut |_| Flow::Continue);
        resumed.map_or(true, |resumed| resumed.checkpoint.to_bytes() != straight)
    };
    Some((kept.len(), kept.iter().filter(differs).count()))
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let steps = extent.pick(8, 60);
    let wrong = Optimizer::ALL.into_iter().map(|optimizer| halfway(optimizer, steps)).sum();
    let mut rows = vec![Row::count(
        "stopped halfway and resumed: methods whose state differs by a bit",
        Optimizer::ALL.len(),
        wrong,
    )];
    // Where single precision finds no better point, a run turns between two looks. Which networks do depends on the rounding.
    for (turn, at_a_look) in [("between two looks", false), ("at a look", true)] {
        let (stops, wrong) = (4..=16).rev().find_map(|width| about_the_turn(width, at_a_look)).unwrap_or((0, 1));
        let what =
            format!("f32 that turns f64 {turn}, broken off about each look and the turn: later bits that differ");
        rows.push(Row::count(what, stops, wrong));
    }
    rows
}
