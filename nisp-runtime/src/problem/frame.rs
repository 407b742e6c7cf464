//! What is left of a bound problem without its points and data: enough to read an answer.

use super::UnitSystem;
use crate::engine::{BoundGroup, Engine, Learned, Scaling};
use crate::kernel::SceneRef;
use crate::network::{Architecture, Layout};
use crate::schema;
use crate::simd::Isa;
use crate::solve::objective::LeastSquares;
use crate::solve::vector;
use crate::units::Number;

/// The frozen scaling of a bound problem: a scene with its units, scales and scalars. It is saved with an answer, and new points are
/// brought into it.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) scene: SceneRef,
    pub(crate) system: UnitSystem,
    pub(crate) scaling: Scaling,
    /// Scalars in the engine's units; of learned ones, where learning started.
    pub(crate) scalars: Vec<f64>,
    pub(crate) learned: Vec<Learned>,
}

impl Frame {
    /// The outputs group at points given in the engine's units, as an engine with no terms that count.
    pub(crate) fn readout(&self, architecture: Architecture, points: &[f64]) -> Engine<f64> {
        let schema = self.scene.schema;
        let isa = Isa::detect();
        let (lanes, heads) = (isa.lanes::<f64>(), schema.heads.len());
        let layout = Layout::new(architecture, schema.coordinates.len(), heads, self.learned.len(), lanes);
        let kernel = self.scene.double().pop();
        let groups = kernel.map(|kernel| BoundGroup::new(kernel, &schema.outputs, &self.scaling, points, &[], &[]));
        Engine::new(isa, layout, groups.into_iter().collect(), self.scalars.clone(), self.learned.clone())
    }

    /// Values of all outputs at points in the engine's units, output by output, and their derivatives by the parameters, row
    /// by row; none where they are not finite.
    pub(crate) fn sensitivities(
        &self,
        architecture: Architecture,
        theta: &[f64],
        points: &[f64],
    ) -> Option<(Vec<f64>, Vec<f64>)> {
        let mut readout = self.readout(architecture, points);
        let rows = readout.row_count();
        let (mut values, mut derivatives) = (vec![0.0; rows], vec![0.0; rows * theta.len()]);
        readout.jacobian(theta, &mut values, &mut derivatives).ok()?;
        vector::all_finite(&derivatives).then_some((values, derivatives))
    }

    /// Points given in declared units, in the engine's.
    pub(crate) fn inward(&self, points: &[f64]) -> Vec<f64> {
        inward_points(self.scene.schema, &self.system, points)
    }
}

/// Points given in declared units, in those of a system.
pub(super) fn inward_points(schema: &schema::Scene, system: &UnitSystem, points: &[f64]) -> Vec<f64> {
    let inward: Vec<_> = schema.coordinates.iter().map(|c| system.inward(&c.unit)).collect();
    points.iter().enumerate().map(|(at, &x)| inward[at % inward.len()].of(Number::declared(x)).as_engine()).collect()
}
