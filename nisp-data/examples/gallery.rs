//! Draws one picture of each kind from the repository's data, to be looked at:
//! `cargo run -p nisp-data --example gallery -- FOLDER`.

use std::path::Path;

use nisp_data::picture::{Curve, LinePanel, LinePlot, Quantity, line_plot};
use nisp_data::{DataError, OutDir, Table};

fn main() -> Result<(), DataError> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "nisp-out/gallery".into());
    let out = OutDir::create(folder)?;
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    pendulum(&data)?.write_svg(out.file("pendulum.svg"))
}

/// The truth plays the estimate, a little off and with a made-up band.
fn pendulum(data: &Path) -> Result<nisp_data::picture::Picture, DataError> {
    let observed = Table::read(data.join("pendulum/run_01_obs.csv"))?;
    let truth = Table::read(data.join("pendulum/run_01_truth.csv"))?;
    let (t, t_truth) = (observed.column("t")?, truth.column("t")?);
    let mut panels = Vec::new();
    for (name, unit) in [("f", "N"), ("q", "m"), ("psi", "rad"), ("phi", "rad")] {
        let values = truth.column(name)?;
        let off: Vec<f64> = t_truth.iter().zip(values).map(|(t, y)| 0.9 * y + 1e-3 * (9.0 * t).sin()).collect();
        let mut panel = LinePanel::new(Quantity::new(name, unit));
        panel.estimate = Some(Curve::new(t_truth, &off));
        panel.deviation = Some(t_truth.iter().map(|t| 1e-3 + 8e-3 * (-5.0 * t).exp()).collect());
        panel.truth = Some(Curve::new(t_truth, values));
        if name != "f" {
            panel.measured = Some(Curve::new(t, observed.column(&format!("{name}_{unit}_sigma0.01"))?));
        }
        panels.push(panel);
    }
    line_plot(&LinePlot { title: "Force on the cart, run 01".into(), x: Quantity::new("t", "s"), panels })
}
