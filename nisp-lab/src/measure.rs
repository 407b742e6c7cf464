//! What tables say of an answer against the truth.

use nisp::Solution;
use nisp_equations::Prepared;

use nisp_cli::score::Found;

/// What is measured of an answer.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Measure {
    /// Mean absolute error of a head, in a unit.
    Error(&'static str, &'static str),
    Overlap,
    Distance,
    Force,
    /// Relative error of a learned parameter whose true value is given.
    Learned(&'static str, f64),
}

impl Measure {
    /// What it is and its unit, if it has one.
    pub(crate) fn quantity(self) -> (String, &'static str) {
        match self {
            Self::Error(name, unit) => (format!("mean error of {name}"), unit),
            Self::Overlap => ("IoU".into(), ""),
            Self::Distance => ("patch Chamfer".into(), "mm^2"),
            Self::Force => ("error of the force".into(), "N"),
            Self::Learned(name, truth) => (format!("error of {name} (true {truth})"), "%"),
        }
    }

    /// Head of its column.
    pub(crate) fn title(self) -> String {
        let (what, unit) = self.quantity();
        if unit.is_empty() { what } else { format!("{what} [{unit}]") }
    }

    /// A value in a cell, or a dash where there is none.
    pub(crate) fn shown(self, value: Option<f64>) -> String {
        let Some(value) = value else { return "-".into() };
        match self {
            Self::Error(..) => format!("{value:.2e}"),
            Self::Overlap | Self::Force => format!("{value:.3}"),
            Self::Distance | Self::Learned(..) => format!("{value:.2}"),
        }
    }

    /// Its value in an answer, if it has one.
    fn of(self, found: &Found) -> Option<f64> {
        let against = || found.contact.as_ref()?.against.as_ref();
        match self {
            Self::Error(name, _) => found.scores.iter().find(|score| score.name == name).map(|score| score.mean_abs),
            Self::Overlap => against().map(|against| against.iou),
            Self::Distance => against()?.patch_chamfer_mm2,
            Self::Force => against().map(|against| against.force_error),
            Self::Learned(name, truth) => {
                let learned = found.learned.iter().find(|learned| learned.name == name);
                learned.map(|learned| 100.0 * (learned.value / truth - 1.0).abs())
            }
        }
    }
}

/// Measures and wall times of answers on several samples.
pub(crate) struct Means<'a> {
    measures: &'a [Measure],
    found: Vec<Vec<f64>>,
    seconds: Vec<f64>,
}

impl<'a> Means<'a> {
    pub(crate) fn new(measures: &'a [Measure]) -> Self {
        Self { measures, found: vec![Vec::new(); measures.len()], seconds: Vec::new() }
    }

    pub(crate) fn add(&mut self, solution: &mut Solution, prepared: &Prepared) {
        let answer = Found::of(solution, prepared, &[]);
        for (values, measure) in self.found.iter_mut().zip(self.measures) {
            values.extend(measure.of(&answer));
        }
        self.seconds.push(solution.wall_s);
    }

    /// The mean of each measure over those samples that have it.
    pub(crate) fn values(&self) -> Vec<Option<f64>> {
        self.found.iter().map(|values| mean(values)).collect()
    }

    /// Mean wall time.
    pub(crate) fn seconds(&self) -> f64 {
        mean(&self.seconds).unwrap_or(0.0)
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
