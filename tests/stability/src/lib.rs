//! Numerical stability, put to the test: what the most trusted numerical codes would ask of themselves.
//!
//! Every item compares the engine with something else: arithmetic of twice the precision, closed forms, complex steps, plain
//! dense Taylor series, or another way to the same number. The fast part runs as tests (`tests/fast.rs`), the full part as
//! one command, which writes `tests/STABILITY.md`: `cargo run --release -p nisp-stability`.

mod adjoints;
mod channels;
mod degenerate;
mod determinism;
mod digits;
mod faults;
mod invariance;
mod limits;
mod line;
mod precision;
mod promotion;
mod report;
mod row;
mod saturation;
mod scaling;
mod single;
mod soak;
mod stopping;
mod tanh;
mod wide;

#[path = "../../../nisp-runtime/tests/double_double/mod.rs"]
mod double_double;
#[path = "../../../nisp-runtime/tests/tanh_errors/mod.rs"]
mod tanh_errors;

pub use report::report;
pub use row::{Extent, Row};

/// A part of the suite.
#[derive(Clone, Copy)]
pub struct Item {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// Runs it.
    pub run: fn(Extent) -> Vec<Row>,
}

/// All parts, in the report's order.
pub const ITEMS: [Item; 12] = [
    Item { name: "tanh", title: "tanh and its first six derivatives", run: tanh::rows },
    Item { name: "channels", title: "Channels through whole networks", run: channels::rows },
    Item { name: "adjoints", title: "Adjoints and gradients", run: adjoints::rows },
    Item { name: "invariance", title: "Isotropic operators and harmonic functions", run: invariance::rows },
    Item { name: "saturation", title: "Saturated networks", run: saturation::rows },
    Item { name: "scaling", title: "Units from 1e-12 to 1e12", run: scaling::rows },
    Item { name: "precision", title: "f32 against f64", run: precision::rows },
    Item { name: "degenerate", title: "Stiff weights, degenerate points, singularities", run: degenerate::rows },
    Item { name: "limits", title: "Incompressible, thin, long", run: limits::rows },
    Item { name: "faults", title: "Faults during a run", run: faults::rows },
    Item { name: "determinism", title: "Determinism", run: determinism::rows },
    Item { name: "soak", title: "Long soak", run: soak::rows },
];
