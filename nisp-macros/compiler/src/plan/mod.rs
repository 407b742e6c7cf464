//! Compiler stage 5: what every scene and group needs, as straight-line programs.
//!
//! - Input: a [`Model`].
//! - Output: a [`Plan`].

mod collapse;
mod group;
mod rows;
mod scene;
mod schedule;
mod sets;
mod skipped;

pub use self::sets::rule_programs;

use crate::channels::{ChannelSet, Operator};
use crate::loss::Robust;
use crate::model::Model;
use crate::program::Program;
use crate::rational::Rational;
pub use crate::symbolic::lower::Scalar;
use crate::symbolic::site::Site;

/// The highest order of a derivative that a plan supports.
pub const MAX_ORDER: u32 = 6;

/// Why a model has no plan.
#[derive(Clone, Debug)]
pub struct PlanError {
    /// The user's token, where one is to blame.
    pub span: Option<proc_macro2::Span>,
    /// What is wrong.
    pub message: String,
}

/// Plans every scene of a model.
///
/// # Errors
/// One error per scene and group that cannot be planned: a derivative of too high an order, an expression that
/// grows past bounds, a coefficient that outgrows exact arithmetic.
pub fn build(model: &Model) -> Result<Plan, Vec<PlanError>> {
    let mut sets = sets::Sets::default();
    let mut errors = Vec::new();
    let mut scenes = Vec::new();
    for scene in &model.scenes {
        match scene::build(model, scene, &mut sets) {
            Ok(scene) => scenes.push(scene),
            Err(mut more) => errors.append(&mut more),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let sets = sets.finish();
    let operators = sets.iter().flat_map(|set| &set.set.basis);
    let scale_groups = collapse::scale_groups(operators, &collapse::dimension_classes(model));
    Ok(Plan { sets, scenes, scale_groups })
}

/// Everything code generation needs, for all scenes.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Distinct channel sets with their rules, shared by groups.
    pub sets: Vec<SetPlan>,
    /// One per scene, in the model's order.
    pub scenes: Vec<ScenePlan>,
    /// Coordinates that must share one length scale, as a group number per coordinate: those that a collapsed
    /// operator ties together.
    pub scale_groups: Vec<usize>,
}

/// A channel set and its propagation rules.
#[derive(Clone, Debug)]
pub struct SetPlan {
    /// The channels.
    pub set: ChannelSet,
    /// Which channels the result has to deliver: all of them in hidden layers, those that heads read in the last.
    pub read: Vec<bool>,
    /// `phi(a)`: slots Phi (0..=order) and Argument (channel 0 unused). Outputs: one per channel, None where not read.
    pub compose: Program,
    /// Its adjoint: slots Phi (0..=order+1), Argument, Seed. Outputs: adjoint of each argument channel (all K of them).
    pub compose_adjoint: Program,
    /// `phi(w.x + b)`: slots Phi (0..=order), Weight (one per coordinate). Outputs as `compose`.
    pub affine: Program,
    /// Its adjoint: slots Phi, Weight, Seed. Outputs: adjoint of the value channel, then of each weight *by way of the
    /// derivative channels* (the value channel's share, adjoint of the value times x, is added by the runtime).
    pub affine_adjoint: Program,
    /// Product of two jets: slots Left, Right. Outputs: one per channel, None where not read.
    pub product: Program,
    /// Its adjoint: slots Left, Right, Seed. Outputs: K adjoints of Left, then K of Right.
    pub product_adjoint: Program,
}

/// What one scene needs.
#[derive(Clone, Debug)]
pub struct ScenePlan {
    /// Fields that have a head here, by index in the model: a fixed field or one that no used term reads has none.
    pub heads: Vec<usize>,
    /// The scalars that programs read, in slot order: parameters, literals with units, scales.
    pub scalars: Vec<Scalar>,
    /// One per model group of which any term is used.
    pub groups: Vec<GroupPlan>,
    /// What was left out and why, one line each, for people.
    pub skipped: Vec<String>,
}

/// A network output or one of its derivatives, as group programs read it.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet {
    /// Index in [`ScenePlan::heads`].
    pub head: usize,
    /// Which operator of it.
    pub operator: Operator,
    /// The operator in the channels of the group's set: (channel, coefficient).
    pub combination: Vec<(usize, Rational)>,
    /// Where it is taken: 0 for the point itself, then its partner if the group is paired, then [`GroupPlan::held`].
    pub site: usize,
}

/// What one group needs in one scene.
#[derive(Clone, Debug)]
pub struct GroupPlan {
    /// Index of the group in the model.
    pub group: usize,
    /// Index in [`Plan::sets`] of the hidden layers' rules.
    pub hidden: usize,
    /// Index in [`Plan::sets`] of the last layer's rules (the same set, fewer channels read).
    pub last: usize,
    /// What the programs read of the heads, in slot order.
    pub jets: Vec<Jet>,
    /// Further sites: the point or its partner with some coordinates held, for fields that do not depend on those.
    pub held: Vec<Site>,
    /// Used terms with their rows.
    pub terms: Vec<TermPlan>,
    /// Rows of all terms: slots Jet, Coordinate, Column, Parameter.
    pub residual: Program,
    /// Adjoint: slots as `residual` and Seed (one per row). Outputs: one per jet, then one per learned parameter
    /// (in the order of [`ScenePlan::learned`]).
    pub adjoint: Program,
    /// Sum over a row's terms of their absolute values, for natural sizes: same slots as `residual`, where Jet may have values or
    /// sizes. One output per row.
    pub magnitude: Program,
    /// Model columns read, in slot order.
    pub columns: Vec<usize>,
}

/// Rows of one term.
#[derive(Clone, Debug)]
pub struct TermPlan {
    /// Index of the term in the model's group.
    pub term: usize,
    /// How its rows are meant.
    pub kind: RowKind,
    /// Loss of each row.
    pub loss: Option<Robust>,
    /// First row.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// Jets of the group that its rows read.
    pub jets: Vec<usize>,
    /// Whether its rows read columns.
    pub known: bool,
    /// Of an integral: the derivatives of its targets by the learned parameters, over slot Parameter only. Outputs row
    /// by row, each in the order of [`ScenePlan::learned`]. Empty for other kinds.
    pub target_slopes: Program,
}

/// How rows are meant.
#[derive(Clone, Debug, PartialEq)]
pub enum RowKind {
    /// Wanted zero at every point (inequalities and complementarities are already folded into this form).
    Residual,
    /// Wanted zero, up to measurement noise.
    Observation,
    /// Rows are integrands; their weighted sum over the group is compared with a target: a program over slot Parameter
    /// only, with one output per row.
    Integral(Program),
    /// Rows are coordinates of a surface point, compared with a cloud.
    Chamfer {
        /// Both directions.
        symmetric: bool,
        /// Only across the surface.
        plane: bool,
    },
}

impl SetPlan {
    /// Whether the runtime has the rules: those of values alone.
    pub fn is_precompiled(&self) -> bool {
        self.set.len() == 1 && self.read[0] && self.set.coordinates <= MOST_PRECOMPILED
    }
}

/// Coordinates up to which the runtime has rules of values.
const MOST_PRECOMPILED: usize = 4;

impl ScenePlan {
    /// Parameters that are learned, by index in the model.
    pub fn learned<'a>(&'a self, scene: &'a crate::model::Scene) -> impl Iterator<Item = usize> + 'a {
        scene.learned.iter().enumerate().filter_map(|(index, &learned)| learned.then_some(index))
    }
}
