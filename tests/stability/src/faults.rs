//! Faults that are put into a run: every step that meets one is refused, and what was before is there to the bit.

use std::ops::Range;

use nisp::engine::Engine;
use nisp::network::{Architecture, initialise};
use nisp::solve::adam::{Adam, AdamSettings};
use nisp::solve::broyden::{Broyden, Update};
use nisp::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use nisp::solve::fault::Fault;
use nisp::solve::gauss_newton::GaussNewton;
use nisp::solve::lbfgs::Lbfgs;
use nisp::solve::marquardt::Marquardt;
use nisp::solve::method::{Method, Verdict};
use nisp::solve::objective::{Block, LeastSquares, Objective};
use nisp::solve::prior::WeightPrior;
use nisp::solve::state::State;
use nisp::{Checkpoint, Settings, recover};
use nisp_equations::{Prepared, Request, catalogue};

use crate::row::{Extent, Row};
use nisp_references::reference::engine;

/// An engine some of whose evaluations end with a fault, and with what they should have written full of NaN.
struct Poisoned {
    engine: Engine<f64>,
    evaluations: usize,
    faulty: Range<usize>,
}

impl Poisoned {
    fn fault(&mut self, outputs: &mut [&mut [f64]], kind: fn(&str, Option<usize>) -> Fault) -> Result<(), Fault> {
        self.evaluations += 1;
        if !self.faulty.contains(&self.evaluations) {
            return Ok(());
        }
        outputs.iter_mut().for_each(|output| output.fill(f64::NAN));
        Err(kind("motion.cart", Some(17)))
    }
}

fn residual(term: &str, point: Option<usize>) -> Fault {
    Fault::residual(term, point)
}

fn gradient(term: &str, point: Option<usize>) -> Fault {
    Fault::gradient(term, point)
}

impl Objective<f64> for Poisoned {
    fn len(&self) -> usize {
        self.engine.len()
    }
    fn value(&mut self, theta: &[f64]) -> Result<f64, Fault> {
        self.fault(&mut [], residual)?;
        self.engine.value(theta)
    }
    fn gradient(&mut self, theta: &[f64], out: &mut [f64]) -> Result<f64, Fault> {
        self.fault(&mut [out], gradient)?;
        self.engine.gradient(theta, out)
    }
}

impl LeastSquares for Poisoned {
    fn rows(&self) -> usize {
        self.engine.rows()
    }
    fn residuals(&mut self, theta: &[f64], r: &mut [f64]) -> Result<f64, Fault> {
        self.fault(&mut [r], residual)?;
        self.engine.residuals(theta, r)
    }
    fn jacobian(&mut self, theta: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<f64, Fault> {
        self.fault(&mut [r, j], gradient)?;
        self.engine.jacobian(theta, r, j)
    }
    fn blocks(&self) -> &[Block] {
        self.engine.blocks()
    }
    fn set_sigma(&mut self, block: usize, sigma: f64) {
        self.engine.set_sigma(block, sigma);
    }
    fn jacobian_vector(&mut self, theta: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.fault(&mut [out], gradient)?;
        self.engine.jacobian_vector(theta, v, out)
    }
    fn vector_jacobian(&mut self, theta: &[f64], u: &[f64], out: &mut [f64]) -> Result<(), Fault> {
        self.fault(&mut [out], gradient)?;
        self.engine.vector_jacobian(theta, u, out)
    }
}

type AnyMethod = Box<dyn Method<f64, Poisoned>>;

fn methods(engine: &Engine<f64>) -> Vec<AnyMethod> {
    let theta = || initialise(engine.layout(), 3);
    let prior = || WeightPrior::uniform(0.3, engine.layout().len);
    vec![
        Box::new(Adam::new(theta(), AdamSettings::default())),
        Box::new(Lbfgs::new(theta(), 20)),
        Box::new(Broyden::new(theta(), Update::SelfScaledBroyden)),
        Box::new(Marquardt::new(theta(), prior())),
        Box::new(GaussNewton::new(theta(), prior(), 20)),
        Box::new(EmpiricalBayes::new(theta(), prior(), EmpiricalBayesSettings::default())),
    ]
}

fn pendulum() -> Prepared {
    let entry = catalogue().into_iter().find(|entry| entry.name == "pendulum").expect("an entry");
    entry.prepare(&Request::default()).expect("the repository's example")
}

fn poisoned(prepared: &Prepared) -> Poisoned {
    let engine = engine::<f64>(&prepared.problem, Architecture::modified(6, 2));
    Poisoned { engine, evaluations: 0, faulty: 0..0 }
}

fn bits(theta: &[f64]) -> Vec<u64> {
    theta.iter().map(|x| x.to_bits()).collect()
}

fn damping(state: &State) -> Option<f64> {
    state.vectors.iter().find(|(name, _)| name == "damping").map(|(_, values)| values[0])
}

/// What went wrong around one faulty evaluation, so many evaluations ahead: a refused step that moved, damping that was not
/// raised, more than five steps until the iterate moved on.
fn passing(prepared: &Prepared, at: usize, ahead: usize) -> usize {
    let mut objective = poisoned(prepared);
    let mut method = methods(&objective.engine).swap_remove(at);
    for _ in 0..4 {
        if method.step(&mut objective).is_err() {
            return 1;
        }
    }
    let faulty = objective.evaluations + ahead;
    objective.faulty = faulty..faulty + 1;
    let mut wrong = 0;
    let mut since = 0;
    for _ in 0..60 {
        let (before, state) = (bits(method.theta()), method.save());
        let met = objective.evaluations >= faulty;
        let Ok(step) = method.step(&mut objective) else { return wrong + 1 };
        let moved = matches!(step.verdict, Verdict::Moved | Verdict::Changed);
        wrong += usize::from(!moved && bits(method.theta()) != before);
        if let (Verdict::Faulty(fault), Some(old)) = (&step.verdict, damping(&state)) {
            wrong += usize::from(damping(&method.save()).is_none_or(|new| new <= old));
            wrong += usize::from(fault.term != "motion.cart" || fault.point != Some(17));
        }
        since += usize::from(met || objective.evaluations >= faulty);
        if since > 0 && moved {
            return wrong + usize::from(since > 6);
        }
    }
    wrong + 1
}

/// True if a lasting fault ends the run within five steps, is named, and leaves the iterate alone.
fn ends_cleanly(prepared: &Prepared, at: usize) -> bool {
    let mut objective = poisoned(prepared);
    let mut method = methods(&objective.engine).swap_remove(at);
    if (0..4).any(|_| method.step(&mut objective).is_err()) {
        return false;
    }
    objective.faulty = objective.evaluations + 1..usize::MAX;
    let before = bits(method.theta());
    let end = (0..5).find_map(|_| method.step(&mut objective).err());
    end.is_some_and(|fault| fault.term == "motion.cart" && fault.point == Some(17)) && bits(method.theta()) == before
}

/// True if a state with a NaN is refused and the method is as it was.
fn refuses_spoilt_states(prepared: &Prepared, at: usize) -> bool {
    let mut objective = poisoned(prepared);
    let mut method = methods(&objective.engine).swap_remove(at);
    if (0..3).any(|_| method.step(&mut objective).is_err()) {
        return false;
    }
    let good = method.save();
    let of = |vector: usize| {
        let mut bad = good.clone();
        let spoilt = bad.vectors[vector].1.first_mut().map(|x| *x = f64::NAN);
        (spoilt.is_some(), bad)
    };
    (0..good.vectors.len())
        .map(of)
        .filter(|(spoilt, _)| *spoilt)
        .all(|(_, bad)| method.restore(&bad).is_err() && method.save() == good)
}

/// Rows of data with a NaN that are not refused with the name of their group and the number of their point.
fn accepted_data(prepared: &Prepared) -> (usize, usize) {
    let times: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
    let columns = || vec![times.iter().map(|t| 0.01 * t.sin()).collect::<Vec<f64>>(); 3];
    let mut wrong = 0;
    for column in 0..3 {
        for row in [0, 17, 29] {
            let mut problem = prepared.problem.clone();
            let mut spoilt = columns();
            spoilt[column][row] = [f64::INFINITY, f64::NEG_INFINITY][column % 2];
            let bound = problem.set_group("samples", times.clone().into(), spoilt);
            let refused = bound.map_err(|error| error.to_string()).and_then(|()| {
                let solved = recover(&problem, &Settings::default(), &mut |_| nisp::solve::driver::Flow::Stop);
                solved.map(|_| ()).map_err(|error| error.to_string())
            });
            let named = |text: &String| text.contains("samples") && text.contains(&format!("point {row}"));
            wrong += usize::from(!refused.as_ref().err().is_some_and(named));
        }
    }
    (9, wrong)
}

/// Weights that are NaN: the engine names a term and a point in values, gradients and Jacobians.
fn unnoticed_weights(prepared: &Prepared) -> (usize, usize) {
    let mut engine = engine::<f64>(&prepared.problem, Architecture::modified(6, 2));
    let theta = initialise(engine.layout(), 3);
    let (rows, len) = (engine.rows(), theta.len());
    let (mut r, mut j, mut g) = (vec![0.0; rows], vec![0.0; rows * len], vec![0.0; len]);
    let mut wrong = 0;
    let at: Vec<usize> = (0..len).step_by(7).collect();
    for &at in &at {
        let mut spoilt = theta.clone();
        spoilt[at] = f64::NAN;
        for fault in [
            engine.loss(&spoilt).err(),
            engine.loss_and_gradient(&spoilt, &mut g).err(),
            engine.residuals(&spoilt, &mut r).err(),
            engine.jacobian(&spoilt, &mut r, &mut j).err(),
        ] {
            wrong += usize::from(!fault.is_some_and(|fault| fault.term.contains('.') && fault.point.is_some()));
        }
    }
    (4 * at.len(), wrong)
}

/// Bytes of a checkpoint that may change without anyone noticing.
fn unnoticed_bytes(prepared: &Prepared, stride: usize) -> (usize, usize) {
    let settings = Settings { iterations: Some(3), budget: None, ..Settings::default() };
    let solved = recover(&prepared.problem, &settings, &mut |_| nisp::solve::driver::Flow::Continue);
    let Ok(solution) = solved else { return (0, 1) };
    let mut bytes = solution.checkpoint.to_bytes();
    let samples = bytes.len().div_ceil(stride);
    let accepted = (0..bytes.len()).step_by(stride).filter(|&at| {
        bytes[at] ^= 0x10;
        let accepted = Checkpoint::from_bytes(&bytes).is_ok();
        bytes[at] ^= 0x10;
        accepted
    });
    (samples, accepted.count())
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let prepared = pendulum();
    let names: Vec<&str> = methods(&poisoned(&prepared).engine).iter().map(|method| method.name()).collect();
    let most = extent.pick(3, 12);
    let mut rows = Vec::new();
    for (at, name) in names.iter().enumerate() {
        let wrong = (1..=most).map(|ahead| passing(&prepared, at, ahead)).sum();
        rows.push(Row::count(
            format!("{name}: one evaluation gives NaN; not restored bitwise, not more careful, or over 5 steps lost"),
            most,
            wrong,
        ));
    }
    let count = names.len();
    let left = |good: &dyn Fn(usize) -> bool| (0..count).filter(|&at| !good(at)).count();
    let lasting = left(&|at| ends_cleanly(&prepared, at));
    rows.push(Row::count("all evaluations give NaN: no clean end in 5 steps with term and point", count, lasting));
    let spoilt = left(&|at| refuses_spoilt_states(&prepared, at));
    rows.push(Row::count("NaN in a saved state: accepted, or the method changed by it", count, spoilt));
    let (samples, wrong) = unnoticed_bytes(&prepared, extent.pick(61, 1));
    rows.push(Row::count("a changed byte in a checkpoint: accepted", samples, wrong));
    let (samples, wrong) = accepted_data(&prepared);
    rows.push(Row::count("infinity in a row of data: not refused with group and point", samples, wrong));
    let (samples, wrong) = unnoticed_weights(&prepared);
    rows.push(Row::count("NaN in a weight: no fault with term and point", samples, wrong));
    rows
}
