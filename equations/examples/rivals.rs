//! Mean absolute error of the source by every rival, over the repository's runs:
//! `cargo run --release -p nisp-equations --example rivals`.

use std::error::Error;
use std::path::{Path, PathBuf};

use nisp_data::Table;
use nisp_equations::rivals::{Measurements, Pendulum, Rlc, System, contest, mean_abs_error, zero_error};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let runs: Vec<PathBuf> = (1..24).step_by(2).map(|run| folder.join(format!("pendulum/run_{run:02}"))).collect();
    for (text, sigma) in [("0", 0.0), ("0.01", 0.01), ("0.03", 0.03)] {
        let mut total = Vec::new();
        for run in &runs {
            let file = |end: &str| Table::read(format!("{}_{end}.csv", run.display()));
            let headers = ["q_m", "psi_rad", "phi_rad"].map(|name| format!("{name}_sigma{text}"));
            add(&mut total, &Pendulum::default(), &file("obs")?, &headers, &file("truth")?, sigma)?;
        }
        print(&format!("pendulum, {} runs, noise {text} (m, rad), mean |error of f| in N", runs.len()), &total);
    }
    let circuit = Table::read(folder.join("rlc/rlc_exponential.csv"))?;
    for (header, sigma) in [("v_V", 0.0), ("v_obs_sigma0.01_V", 0.01)] {
        let system = Rlc::default();
        let mut total = Vec::new();
        add(&mut total, &system, &circuit, &[header.to_string()], &circuit, sigma)?;
        print(&format!("rlc, noise {sigma} V, mean |error of f| in V"), &total);
    }
    Ok(())
}

/// Errors and seconds, one a run, of a method.
type Row = (&'static str, Vec<f64>, Vec<f64>);

fn add(
    total: &mut Vec<Row>,
    system: &dyn System,
    observed: &Table,
    headers: &[String],
    truth: &Table,
    noise: f64,
) -> Result<(), Box<dyn Error>> {
    let states = headers.iter().map(|header| observed.column(header)).collect::<Result<Vec<_>, _>>()?;
    let noise = vec![noise; states.len()];
    let data = Measurements { times: observed.column("t")?, states: &states, noise: &noise };
    let (at, f) = (truth.column("t")?, truth.column("f")?);
    let mut results = vec![("f = 0", zero_error(f), 0.0)];
    for answer in contest(system, &data, at, f)? {
        results.push((answer.name, mean_abs_error(&answer.source, f), answer.wall_s));
    }
    for (index, (name, error, seconds)) in results.into_iter().enumerate() {
        if total.len() <= index {
            total.push((name, Vec::new(), Vec::new()));
        }
        total[index].1.push(error);
        total[index].2.push(seconds);
    }
    Ok(())
}

fn print(title: &str, total: &[Row]) {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    println!("{title}");
    for (name, errors, seconds) in total {
        println!("  {name:24} {:.2e}  ({:.2} s a run)", mean(errors), mean(seconds));
    }
}
