//! What is told of an answer once the steps have ended: error bars, warnings, and what the verdict is made from.

use super::between::measurements;
use super::changes::Changes;
use super::run::{Clock, Run, is_still};
use super::solver::Solver;
use super::state::State;
use super::{SAME, leaning, places, singular, told};
use crate::local::{KeptLattices, LocalError, LocalSolution};
use crate::noise::Noise;
use crate::problem::Bound;
use crate::solve::driver::{Status, Warning, WarningKind};
use crate::verdict::settled::HELD_BACK;

/// Error bars, and what the verdict is made from, of an answer that finer lattices have changed so much.
pub(super) fn finish(
    bound: &Bound,
    mut solver: Solver<'_>,
    run: Run,
    noise: &Noise,
    (clock, changes): (&Clock, &Changes),
) -> Result<LocalSolution, LocalError> {
    let Run { state, loss, ahead, moved, factor, status, longest, bars, checkpoint, .. } = run;
    let mut warnings = Vec::new();
    let is_noisy = noise.is_there(bound.problem.scene().schema);
    let schema = bound.problem.scene().schema;
    let sources = || (0..schema.heads.len()).filter(|&head| schema.heads[head].source);
    // Only a minimum has error bars. Of a source exact measurements leave as much open as noisy ones where there are few.
    let is_open = is_noisy || solver.is_measured() && sources().next().is_some();
    let wants_bars = status == Status::Converged && is_open;
    let is_beside_sources = solver.is_beside_sources();
    let is_minimum = status == Status::Converged;
    let rougher = if is_minimum { solver.rougher(&state, clock, longest) } else { None };
    let (draws, beyond) = if wants_bars && clock.has_time(bars) {
        solver.doubted(&state).unwrap_or_default()
    } else {
        if is_open && matches!(status, Status::Converged | Status::Budget) {
            warnings.push(Warning::no_bars());
        }
        Default::default()
    };
    if is_noisy && !changes.learned().is_empty() && !is_still(&factor, changes.learned()) {
        let message = "what is learned still changes with the cells, by more than noise leaves open: deviations count that, and a larger \
                       budget makes them shorter";
        warnings.push(Warning { kind: WarningKind::OutOfTime, message: message.into() });
    }
    if solver.lacks {
        let message = format!(
            "{} of {} rows were used, picked at random, for want of time: with a larger budget error bars get shorter",
            measurements(&solver.bound),
            measurements(bound)
        );
        warnings.push(Warning { kind: WarningKind::OutOfTime, message });
    }
    let heads = schema.heads.iter().enumerate();
    warnings.extend(heads.filter_map(|(head, own)| Some(solver.unseen(head)?.warning(own.name))));
    warnings.extend(solver.clashes.warning(schema));
    warnings.extend(singular::warning(bound, solver.singular()));
    let scores = if is_minimum { solver.scores(&state, clock, longest) } else { Vec::new() };
    if !solver.is_measured() {
        // What finer cells hardly change is as good as resolved.
        let is_resolved = solver.strain(&state, noise) < 1.0 || changes.off() < HELD_BACK;
        let is_resolved = status != Status::NotConverged && is_resolved;
        warnings.extend(solver.undetermined(&state, is_resolved));
    }
    // What a finer lattice has hardly changed, another one will not. Where nothing is measured such a change tells all.
    let is_early = status == Status::Budget && changes.least() > SAME;
    // Equations that had to be loose hold only if they do so by themselves.
    let is_loose = state.strictest > solver.tolerance;
    let strain = (solver.is_measured() && (is_early || is_loose)).then(|| solver.strain(&state, noise));
    let (strain, loose) = if is_early { (strain, None) } else { (None, strain) };
    let is_coarse = solver.left_of_equations(&state, noise) > 1.0;
    solver.judge_at(bound);
    let (mut answer, misfits) = (solver.answer(&state), solver.misfits(&state));
    answer.is_coarse = is_coarse;
    (answer.strain, answer.loose) = (strain, loose);
    answer.used = measurements(&solver.bound) as f64 / measurements(bound).max(1) as f64;
    // Noise may fall differently on other cells; without it they are all that changes an answer.
    answer.refined = if solver.is_measured() { changes.taken().filter(|_| !is_noisy) } else { Some(changes.off()) };
    if status != Status::Converged {
        (answer.ahead, answer.moved) = (Some(ahead), Some(moved));
    }
    if status == Status::NotConverged {
        let message = "the data and the equations leave some of the unknowns open: give more conditions or data".into();
        warnings.push(Warning { kind: WarningKind::Undetermined, message });
    }
    let State { theta, learned, step: iterations, .. } = state;
    let mut kept = KeptLattices { heads: solver.heads, theta, learned, draws };
    sources().for_each(|head| kept.widen(head, places::widened(bound, head)));
    // What the cells cannot hold tells no source from none.
    let is_untold =
        is_noisy && kept.draws.coefficients.is_empty() && matches!(status, Status::Converged | Status::Budget);
    answer.told = told::told(bound, &kept, is_untold);
    answer.scores = scores;
    kept.draws.widen(&beyond, changes.learned());
    if is_beside_sources {
        answer.leaning = leaning::facts(&kept, rougher.as_deref());
    }
    let factor = Some(factor).filter(|_| wants_bars);
    let together = Vec::new();
    let off = changes.learned().to_vec();
    Ok(LocalSolution { kept, status, iterations, loss, warnings, factor, together, off, checkpoint, answer, misfits })
}
