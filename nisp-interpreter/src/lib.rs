//! Equations from text files: what stands between the braces of `pde!`, read by the same compiler and solved by the same engine.
//!
//! The compiler's plan is not turned into code but into tapes, which are run on blocks of units or points with the vectors of
//! the machine. Messages are those of `pde!`, with line and column.
//!
//! ```
//! let text = "
//!     /// A driven oscillator.
//!     coordinates: t [s];
//!     fields: y [m];
//!     sources: f [m/s^2];
//!     parameters: w [1/s] = 2;
//!     on motion { balance: d(y, t, 2) + w^2 * y == f; }
//!     on samples { observe y; }
//! ";
//! let equation = nisp_interpreter::read(text, "oscillator").unwrap();
//! assert_eq!(equation.docs.trim(), "A driven oscillator.");
//! assert_eq!(equation.scenes[0].schema.heads[1].name, "f");
//!
//! let mistakes = nisp_interpreter::read(&text.replace("w^2", "w"), "oscillator").unwrap_err();
//! assert_eq!(mistakes.0[0].line, 7);
//! ```

mod affine;
mod answer;
mod block;
mod declared;
mod hidden;
mod layers;
mod programs;
mod rules;
mod schema;
mod scratch;
mod slopes;
mod tape;
mod text;

use nisp_compiler::model::{self, Model};
use nisp_compiler::plan::{GroupPlan, Plan, ScenePlan};
use nisp_compiler::{Failure, analyse};
use nisp_runtime::kernel::{GroupKernel, Kernels, Precision};
use thiserror::Error;

pub use answer::{OpenError, ask, open};
pub use declared::scene;
pub use nisp_runtime::kernel::SceneRef;
use programs::InterpretedPrograms;
use rules::InterpretedLayers;
pub use text::{Mistake, is_same_equation};

/// An equation that was read.
#[derive(Clone, Debug)]
pub struct Equation {
    /// Name of its module.
    pub name: String,
    /// Its documentation.
    pub docs: String,
    /// Its scenes in the order of the text; a text without scenes has one named `all`.
    pub scenes: Vec<SceneRef>,
    /// What does not stop it from being solved, and where it stands.
    pub warnings: Vec<Mistake>,
}

/// Everything that is wrong with a text.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct Mistakes(pub Vec<Mistake>);

/// Reads an equation; `name` is its module's name where the text gives none.
///
/// What is read stays in memory until the program ends, as compiled equations do.
///
/// # Errors
/// Everything that is wrong with the text, by line and column.
pub fn read(text: &str, name: &str) -> Result<Equation, Mistakes> {
    let tokens = text::tokens(text, name).map_err(|mistake| Mistakes(vec![mistake]))?;
    let (model, plan) = analyse(tokens).map_err(|Failure { errors, .. }| {
        Mistakes(errors.faults().iter().map(|fault| Mistake::new(fault, text)).collect())
    })?;
    let kept: &'static str = String::leak(text.into());
    let scenes = plan
        .scenes
        .iter()
        .zip(&model.scenes)
        .map(|(scene, declared)| interpret((&model, kept), &plan, scene, declared));
    let warnings = model.warnings.iter().map(|(message, span)| {
        let fault = nisp_compiler::error::Fault { place: (*span).into(), message: message.clone() };
        Mistake::new(&fault, text)
    });
    Ok(Equation {
        name: model.name.text.clone(),
        docs: nisp_compiler::describe::text(&model.docs),
        scenes: scenes.collect(),
        warnings: warnings.collect(),
    })
}

/// A scene with interpreted kernels.
fn interpret(
    (model, text): (&Model, &'static str),
    plan: &Plan,
    scene: &ScenePlan,
    declared: &model::Scene,
) -> SceneRef {
    let groups: &'static [Interpreted] =
        Vec::leak(scene.groups.iter().map(|group| Interpreted::new(plan, group)).collect());
    let kernels: &'static Interpretation = Box::leak(Box::new(Interpretation(groups)));
    SceneRef::new(schema::of(model, plan, scene, declared), text, kernels)
}

/// The kernels of a scene.
struct Interpretation(&'static [Interpreted]);

/// The kernels of a group. Layers of values alone over few coordinates are compiled into the runtime.
struct Interpreted {
    layers: Result<InterpretedLayers, usize>,
    programs: InterpretedPrograms,
}

impl Interpreted {
    fn new(plan: &Plan, group: &GroupPlan) -> Self {
        let [hidden, last] = [group.hidden, group.last].map(|at| &plan.sets[at]);
        let precompiled = last.is_precompiled();
        Self {
            layers: if precompiled { Err(last.set.coordinates) } else { Ok(InterpretedLayers::new(hidden, last)) },
            programs: InterpretedPrograms::new(group),
        }
    }

    fn kernel<E: Precision>(&'static self) -> GroupKernel<E> {
        let layers = match &self.layers {
            Ok(layers) => layers,
            Err(coordinates) => E::values(*coordinates),
        };
        GroupKernel { layers, programs: &self.programs }
    }
}

impl Interpretation {
    fn kernels<E: Precision>(&self) -> Vec<GroupKernel<E>> {
        self.0.iter().map(Interpreted::kernel).collect()
    }
}

impl Kernels for Interpretation {
    fn double(&self) -> Vec<GroupKernel<f64>> {
        self.kernels()
    }

    fn single(&self) -> Option<Vec<GroupKernel<f32>>> {
        Some(self.kernels())
    }
}
