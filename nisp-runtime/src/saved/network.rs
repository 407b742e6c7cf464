//! A network that was trained: its weights, and a root of their covariance.

use crate::carrier::{Kept, Outputs};
use crate::network::{Activation, Architecture, Fourier, Inputs, Kind, Layout, Stretched};
use crate::problem::Frame;
use crate::solve::fault::Fault;
use crate::solve::root::Root;
use crate::solve::state::State;

/// Name of the carrier in files.
pub(crate) const CARRIER: &str = "network";

/// Derivatives of rows by parameters that are held at a time: 32 MiB.
const MOST_DERIVATIVES: usize = 1 << 22;

/// A network and what is known of its parameters.
#[derive(Clone, Debug)]
pub(crate) struct KeptNetwork {
    pub(crate) architecture: Architecture,
    pub(crate) theta: Vec<f64>,
    /// A root of the covariance of the parameters; nothing where there are no error bars.
    pub(crate) root: Option<Root>,
}

impl Kept for KeptNetwork {
    fn degrees(&self) -> Option<Vec<usize>> {
        None
    }

    fn outputs(&self, frame: &Frame, points: &[f64]) -> Outputs {
        let inputs = frame.scene.schema.coordinates.len();
        let rows = frame.scene.schema.outputs.rows;
        let share = (MOST_DERIVATIVES / (rows * self.theta.len()).max(1)).max(1);
        let parts: Vec<Outputs> = points.chunks(share * inputs).map(|points| self.part(frame, points)).collect();
        Outputs::joined(&parts, rows)
    }

    fn save(&self) -> State {
        let Architecture { kind, width, layers, factorised, inputs, activation } = self.architecture;
        let (features, settings) = match inputs {
            Inputs::Automatic => (0, [0.0; 2]),
            Inputs::Coordinates => (1, [0.0; 2]),
            Inputs::Stretched(stretched) => (2, [stretched.ratio, 0.0]),
            Inputs::Fourier(fourier) => (3, [fourier.frequencies as f64, fourier.deviation]),
        };
        let state = State::new(CARRIER)
            .with("theta", &self.theta)
            .with("features", &settings)
            .with_counter("features", features)
            .with_counter("gated", u64::from(kind == Kind::Modified))
            .with_counter("width", width as u64)
            .with_counter("layers", layers as u64)
            .with_counter("factorised", u64::from(factorised))
            .with_counter("sine", u64::from(activation == Activation::Sine));
        match &self.root {
            Some(root) => state.with("root_rows", root.numbers()),
            None => state,
        }
    }
}

impl KeptNetwork {
    /// From the numbers of [`Kept::save`].
    pub(super) fn restored(state: &State, frame: &Frame) -> Result<Self, Fault> {
        let (schema, learned) = (frame.scene.schema, frame.learned.len());
        let [first, second] = state.scalars("features")?;
        let inputs = match state.counter("features")? {
            0 => Inputs::Automatic,
            1 => Inputs::Coordinates,
            2 => Inputs::Stretched(Stretched { ratio: first }),
            3 => Inputs::Fourier(Fourier { frequencies: first as usize, deviation: second }),
            _ => return Err(Fault::state("features")),
        };
        let theta = state.vector("theta")?.to_vec();
        // A layer has more parameters than units, and no network more layers than parameters.
        let size = |name: &str| match usize::try_from(state.counter(name)?) {
            Ok(size) if (1..=theta.len()).contains(&size) => Ok(size),
            _ => Err(Fault::state(name)),
        };
        let architecture = Architecture {
            kind: if state.counter("gated")? == 1 { Kind::Modified } else { Kind::Plain },
            width: size("width")?,
            layers: size("layers")?,
            factorised: state.counter("factorised")? == 1,
            inputs,
            // Files from before there was a sine have no such counter.
            activation: if state.counter("sine") == Ok(1) { Activation::Sine } else { Activation::Tanh },
        };
        if architecture.width.saturating_mul(architecture.layers) > theta.len() {
            return Err(Fault::state("width"));
        }
        let layout = Layout::new(architecture, schema.coordinates.len(), schema.heads.len(), learned, 1);
        if layout.len != theta.len() {
            return Err(Fault::state("theta"));
        }
        let root = match state.has("root_rows") {
            false => None,
            true => {
                let numbers = state.vector("root_rows")?.to_vec();
                Some(Root::restored(theta.len(), numbers).ok_or_else(|| Fault::state("root"))?)
            }
        };
        Ok(Self { architecture, theta, root })
    }

    /// The rows at a part of the points.
    fn part(&self, frame: &Frame, points: &[f64]) -> Outputs {
        let known = self.root.as_ref().and_then(|root| {
            let (values, derivatives) = frame.sensitivities(self.architecture, &self.theta, points)?;
            let deviations = derivatives.chunks_exact(self.theta.len()).map(|slopes| root.deviation(slopes)).collect();
            Some(Outputs { values, deviations: Some(deviations) })
        });
        known.unwrap_or_else(|| {
            let values = frame.readout(self.architecture, points).raw_rows(0, &self.theta);
            let unknown = self.root.as_ref().map(|_| vec![f64::NAN; values.len()]);
            Outputs { values, deviations: unknown }
        })
    }
}
