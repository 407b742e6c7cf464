//! What interpreted layers are made of: the rules of channel sets as tapes.

use nisp_compiler::plan::SetPlan;
use nisp_runtime::layer::Shape;

use crate::slopes::Slopes;
use crate::tape::Tape;

/// The rules of a channel set as tapes.
#[derive(Debug)]
pub(crate) struct Rules {
    pub(crate) compose: Tape,
    pub(crate) compose_adjoint: Tape,
    pub(crate) affine: Tape,
    pub(crate) affine_adjoint: Tape,
    pub(crate) product: Tape,
    pub(crate) product_adjoint: Tape,
    /// Channels that the rules deliver.
    pub(crate) read: Vec<bool>,
}

impl Rules {
    fn new(plan: &SetPlan) -> Self {
        Self {
            compose: Tape::new(&plan.compose),
            compose_adjoint: Tape::new(&plan.compose_adjoint),
            affine: Tape::new(&plan.affine),
            affine_adjoint: Tape::new(&plan.affine_adjoint),
            product: Tape::new(&plan.product),
            product_adjoint: Tape::new(&plan.product_adjoint),
            read: plan.read.clone(),
        }
    }
}

/// Layers with hidden rules, of which the last has rules of its own.
#[derive(Debug)]
pub(crate) struct InterpretedLayers {
    pub(crate) hidden: Rules,
    pub(crate) last: Rules,
    /// The activation and its derivatives, as many as the rules read.
    pub(crate) slopes: Slopes,
    pub(crate) channels: usize,
    pub(crate) coordinates: usize,
}

impl InterpretedLayers {
    pub(crate) fn new(hidden: &SetPlan, last: &SetPlan) -> Self {
        let set = &hidden.set;
        Self {
            hidden: Rules::new(hidden),
            last: Rules::new(last),
            slopes: Slopes::of_order(set.order() as usize),
            channels: set.len(),
            coordinates: set.coordinates,
        }
    }

    /// Those of the last layer or of the others.
    pub(crate) fn rules(&self, last: bool) -> &Rules {
        if last { &self.last } else { &self.hidden }
    }
}

/// Checks that a buffer holds rows for so many channels.
pub(crate) fn holds<E>(shape: Shape, rows: &[E], channels: usize) {
    assert!(shape.width <= shape.ld && rows.len() >= shape.points * channels * shape.ld, "tile buffer too small");
}
