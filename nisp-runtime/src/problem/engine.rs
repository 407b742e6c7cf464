//! The engine of a problem: a network with the problem's groups.

use super::bound::Bound;
use super::error::BindError;
use crate::engine::{BoundGroup, Chamfer, Engine};
use crate::kernel::Precision;
use crate::network::{Architecture, Layout};
use crate::schema;
use crate::simd::Isa;

/// Solvers keep some vectors of this length, of a gigabyte each.
const MOST_PARAMETERS: usize = 100_000_000;

impl Bound {
    /// The engine of this problem in precision `E`, for a network of the given shape.
    pub(crate) fn engine<E: Precision>(&self, architecture: Architecture) -> Result<Engine<E>, BindError> {
        self.engine_on(Isa::detect(), architecture)
    }

    /// The same with vectors of `isa`.
    pub(crate) fn engine_on<E: Precision>(&self, isa: Isa, architecture: Architecture) -> Result<Engine<E>, BindError> {
        if architecture.width == 0 || architecture.layers == 0 {
            return Err(BindError::Architecture { layers: architecture.layers, width: architecture.width });
        }
        let scene = self.problem.scene;
        let inputs = scene.schema.coordinates.len();
        let lanes = isa.lanes::<E>();
        let layout = Layout::new(architecture, inputs, scene.schema.heads.len(), self.learned.len(), lanes);
        if layout.len > MOST_PARAMETERS {
            return Err(BindError::Architecture { layers: architecture.layers, width: architecture.width });
        }
        let mut groups = Vec::new();
        let kernels = E::kernels(&scene).ok_or(BindError::NotCompiled { scene: scene.schema.name })?;
        for (at, kernel) in kernels.into_iter().enumerate().take(scene.schema.groups.len()) {
            let schema = &scene.schema.groups[at];
            let mut group = BoundGroup::new(
                kernel,
                schema,
                &self.scaling,
                &self.coordinates[at],
                &self.partners[at],
                &self.filled_columns(at),
            );
            let bound = self.sizes[at].iter().zip(&self.losses[at]).zip(&self.powers[at]).zip(&self.clouds[at]);
            for (term, (((size, loss), powers), cloud)) in group.terms.iter_mut().zip(bound) {
                (term.size, term.loss) = (*size, *loss);
                term.within = term.schema.within.map(|_| size / term.schema.weight.sqrt());
                term.powers = powers.clone();
                if term.schema.kind == schema::TermKind::Integral && !self.raw_weights(at).is_empty() {
                    let weights = self.weights(at, term.schema.measure.as_ref());
                    term.point_weights = Some(weights.into_iter().map(E::from_f64).collect());
                }
                if let Some(measured) = self.lacking(at, term.schema) {
                    let weights = measured.into_iter().map(|is_there| if is_there { E::ONE } else { E::ZERO });
                    term.point_weights = Some(weights.collect());
                }
                term.chamfer = Chamfer::new(cloud, (term.schema, term.loss), group.points);
            }
            groups.push(group);
        }
        let scalars = self.scalars.iter().map(|&x| E::from_f64(x)).collect();
        Ok(Engine::new(isa, layout, groups, scalars, self.learned.clone()))
    }
}
