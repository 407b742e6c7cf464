//! Recover unknown sources from noisy measurements and a governing equation that is checked when the program compiles.
//!
//! Write the equation in [`pde!`] (its [language]); bind points and data to one of its scenes; solve; read the source back.

#[doc = include_str!("language.md")]
pub mod language {}

pub use nisp_macros::pde;
pub use nisp_runtime::carrier::Estimate;
pub use nisp_runtime::engine::Resampling;
pub use nisp_runtime::kernel::{Precision, Scene, SceneRef, scene, scene_in_both_precisions};
pub use nisp_runtime::problem::{BindError, Points, Problem};
pub use nisp_runtime::recover::{
    Carrier, Checkpoint, CheckpointError, LearnedValue, Optimizer, RecoverError, Report, Settings, Solution,
    TermReport, Width, recover, resume,
};
pub use nisp_runtime::saved::{OpenAnswer, SavedAnswer, SavedError, SavedParameter};
pub use nisp_runtime::verdict::{Check, Verdict};
pub use nisp_runtime::{engine, local, network, peak, real, schema, simd, solve};

/// What emitted code refers to; not for direct use.
#[doc(hidden)]
pub mod __private {
    pub use nisp_runtime::compiled::{CompiledLayers, CompiledPrograms};
    pub use nisp_runtime::functions;
    pub use nisp_runtime::kernel::GroupKernel;
    pub use nisp_runtime::problem::component;
    pub use nisp_runtime::real::Real;
    pub use nisp_runtime::residual::{Lane, Residuals, Sink};
    pub use nisp_runtime::rules::Rules;
    pub use nisp_runtime::schema;
    pub use nisp_runtime::simd::Simd;
    pub use nisp_runtime::values::{Precompiled, Values};
}
