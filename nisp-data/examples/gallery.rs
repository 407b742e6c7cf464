//! Draws one picture of each kind from the repository's data, to be looked at:
//! `cargo run -p nisp-data --example gallery -- FOLDER`.

use std::path::Path;

use nisp_data::colour::ColourScale;
use nisp_data::domain::Domain;
use nisp_data::picture::{
    Curve, FieldMap, Grid, LinePanel, LinePlot, LogLog, MapPanel, Mark, Picture, Quantity, Series, field_map,
    line_plot, log_log,
};
use nisp_data::{DataError, OutDir, Table};

fn main() -> Result<(), DataError> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "nisp-out/gallery".into());
    let out = OutDir::create(folder)?;
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    pendulum(&data)?.write_svg(out.file("pendulum.svg"))?;
    membrane(&data)?.write_svg(out.file("membrane.svg"))?;
    frontier()?.write_svg(out.file("frontier.svg"))
}

/// The truth plays the estimate, a little off and with a made-up band.
fn pendulum(data: &Path) -> Result<Picture, DataError> {
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
    line_plot(&LinePlot {
        title: "Force on the cart, run 01".into(),
        subtitle: String::new(),
        x: Quantity::new("t", "s"),
        panels,
    })
}

/// Contact pressure of one sample, with a shifted copy as the estimate.
fn membrane(data: &Path) -> Result<Picture, DataError> {
    let truth = Table::read(data.join("membrane/flower_1_truth.csv"))?;
    let (x, y) = (truth.column("x")?, truth.column("y")?);
    let (f, contact) = (truth.column("f")?, truth.column("contact")?);
    let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(x, y)| [*x, *y]).collect();
    let moved: Vec<f64> = f.iter().cycle().skip(78).take(f.len()).map(|f| 0.8 * f).collect();
    let error: Vec<f64> = moved.iter().zip(f).map(|(a, b)| a - b).collect();
    let mask: Vec<bool> = contact.iter().map(|&c| c > 0.5).collect();
    let patch = ("true patch".to_string(), Grid::from_mask(&points, &mask)?, 0.5);
    let panel = |title: &str, values: &[f64], scale: ColourScale| {
        Ok::<_, DataError>(MapPanel {
            title: title.into(),
            value: Quantity::new("f", "Pa"),
            grid: Grid::from_points(&points, values)?,
            scale,
            contours: vec![patch.clone()],
        })
    };
    let scale = ColourScale::sequential(f);
    field_map(&FieldMap {
        title: "Contact pressure, flower 1".into(),
        subtitle: String::new(),
        x: Quantity::new("x", "m"),
        y: Quantity::new("y", "m"),
        outline: Domain::ellipse([0.0, 0.0], [0.06, 0.04])?.outline(200),
        marks: Vec::new(),
        panels: vec![
            panel("estimate", &moved, scale)?,
            panel("truth", f, scale)?,
            panel("error", &error, ColourScale::diverging(&error))?,
        ],
    })
}

/// Made-up numbers of about the size that solvers reach.
fn frontier() -> Result<Picture, DataError> {
    let series = |family, name: &str, points: &[[f64; 2]]| Series {
        name: name.into(),
        family,
        points: points.to_vec(),
        joined: true,
    };
    log_log(&LogLog {
        title: "Double pendulum, no noise".into(),
        subtitle: "made-up numbers".into(),
        x: Quantity::new("wall time", "s"),
        y: Quantity::new("mean |error of f|", "N"),
        series: vec![
            series(0, "self-scaled Broyden", &[[0.3, 9e-4], [1.0, 1e-4], [3.0, 7e-6], [10.0, 8e-7]]),
            series(1, "Levenberg-Marquardt", &[[0.3, 4e-4], [1.0, 2e-4], [3.0, 6e-5], [10.0, 3e-5]]),
            series(2, "Adam f32", &[[3.0, 1e-3], [30.0, 7e-4]]),
            series(2, "Adam", &[[3.0, 8e-4], [30.0, 5e-4], [110.0, 3e-4]]),
        ],
        marks: vec![
            Mark::Horizontal("f = 0".into(), 7.4e-4),
            Mark::Horizontal("paper".into(), 3.8e-4),
            Mark::Horizontal("interpolation".into(), 1.2e-4),
            Mark::Horizontal("best SG (oracle)".into(), 9.7e-6),
            Mark::Vertical("target".into(), 10.0),
            Mark::Vertical("interactive".into(), 3.0),
        ],
    })
}
