//! The pendulum and the circuit: the repository's truths, measured anew.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use nisp::Carrier;
use nisp_data::Table;
use nisp_equations::{Entry, Request};

use super::corruption::Corruption::{Early, Exact, Few, Gap, Moved, Nothing, Outliers, Parameter, Scaled, Swapped};
use super::experiment::{Case, Experiment, Ready, Stated, Subject, Told, Truth, cases};
use super::samples::{Column, Samples};

/// Both, the pendulum with little and with much noise.
pub(super) fn subjects(repository: &Path) -> Vec<Subject> {
    let pendulum = [
        Nothing,
        Exact,
        Few(40),
        Gap(0.4, 0.5),
        Outliers(0.05),
        Early(5),
        Swapped("psi", "phi"),
        Swapped("q", "psi"),
        Parameter("l1", 0.25),
        Parameter("l2", 1.0),
        Parameter("g", 1.62),
        Scaled("q", 1e3),
        Scaled("psi", 180.0 / std::f64::consts::PI),
        Moved("psi", 0.5),
    ];
    let noisy = [Nothing, Swapped("psi", "phi"), Parameter("l1", 0.25), Scaled("q", 1e3)];
    let circuit =
        [Nothing, Exact, Few(40), Gap(0.4, 0.6), Outliers(0.05), Early(5), Parameter("f0", 1e8), Scaled("v", 1e-6)];
    // Any voltage is the answer to some drive, whatever the circuit is taken for and whatever the drive starts from.
    let hidden = [Scaled("v", 1e3), Parameter("f0", -6.0), Parameter("b", 100.0), Parameter("a", 1.0)];
    let of = |name, entry, noise, cases| subject(repository, name, entry, noise, cases);
    vec![
        // The mass of the cart enters nothing but the force. Under another last mass the same force moves the links otherwise by
        // less than this noise: all three misfits agree to a hundredth with those under the right one.
        of("pendulum", "pendulum", 0.01, cases(&pendulum, &[Parameter("m0", 0.02), Parameter("m2", 0.02)])),
        of("pendulum, much noise", "pendulum", 0.03, cases(&noisy, &[])),
        of("rlc", "rlc", 0.01, cases(&circuit, &hidden)),
    ]
}

fn subject(repository: &Path, name: &'static str, entry: &'static str, noise: f64, cases: Vec<Case>) -> Subject {
    let repository: PathBuf = repository.into();
    let make = move |_| experiment(&repository, entry, noise);
    Subject { name, make: Box::new(make), cases, patience: 1.0 }
}

fn experiment(repository: &Path, entry: &str, noise: f64) -> Result<Experiment, String> {
    let entry = crate::entry(entry)?;
    let schema = entry.scene(None).map_err(|error| error.to_string())?.schema;
    let series = entry.series().ok_or("no measurements over time")?;
    // The example's truth where there are several.
    let path = series.truths.get(3).or(series.truths.first()).ok_or("no truth")?;
    let truth = Table::read(repository.join(path)).map_err(|error| {
        format!("{error}; the study needs the repository's data: name its folder with --repository")
    })?;
    let read = |name: &'static str, unit: &str, noise: Option<f64>| {
        let values = truth.quantity(name, unit).map_err(|error| error.to_string())?;
        let values = values.into_iter().step_by(series.every).collect();
        Ok::<_, String>(Column { name, values, measured: noise.is_some(), noise })
    };
    let mut columns = vec![read("t", "s", None)?];
    for column in schema.groups.iter().flat_map(|group| group.columns) {
        columns.push(read(column.name, column.unit.text, Some(noise))?);
    }
    let truth = Rc::new(truth);
    let bind = move |samples: &Samples, told: Told<'_>| bind(&entry, &truth, samples, told);
    Ok(Experiment { samples: Samples { columns }, noise: 0.0, bind: Box::new(bind) })
}

fn bind(entry: &Entry, truth: &Table, samples: &Samples, told: Told<'_>) -> Result<Ready, String> {
    let schema = entry.scene(None).map_err(|error| error.to_string())?.schema;
    let series = entry.series().ok_or("no measurements over time")?;
    let mut table = Table::empty();
    for column in &samples.columns {
        let own = schema.groups.iter().flat_map(|group| group.columns).find(|own| own.name == column.name);
        table
            .push(column.name, own.map_or("s", |own| own.unit.text), &column.values)
            .map_err(|error| error.to_string())?;
    }
    let parameters = told.iter().map(|(name, value)| ((*name).into(), *value)).collect();
    let request = Request { parameters, ..Request::default() };
    let prepared = series.bind(entry, &request, &table, Some(truth)).map_err(|error| error.to_string())?;
    let known = prepared.truth.ok_or("no truth")?;
    let heads = known.heads.iter().filter(|(name, _)| *name == "f").cloned().collect();
    let mut stated = Vec::new();
    if entry.name == "rlc" {
        let start = told.iter().find(|(name, _)| *name == "f0").map_or(6.0, |(_, value)| *value);
        stated.push(Stated { head: "f", at: vec![samples.columns[0].values[0]], value: start, size: 6.0 });
    }
    let truth = Truth { points: known.points, heads, ..Truth::default() };
    Ok(Ready { problem: prepared.problem, carrier: Carrier::Auto, stated, truth })
}
