//! Recover unknown sources from noisy measurements and a governing equation that is checked when the program compiles.
//!
//! Write the equation in [`pde!`] (its [language]); bind points and data to one of its scenes; solve; read the source back.

#[doc = include_str!("language.md")]
pub mod language {}

pub use nisp_macros::pde;
pub use nisp_runtime::carrier::Estimate;
pub use nisp_runtime::engine::Resampling;

/// The `main` of a program that has the whole command line for equations of its own: `list`, `check`, `explain`, `solve`, `eval`.
///
/// ```text
/// nisp::pde! { mod heat { /* ... */ } }
/// nisp::main!(heat);
/// ```
///
/// It names the modules that [`pde!`] made, with commas between them. The command line is the crate `nisp-cli`, which stands in
/// the program's `Cargo.toml` beside `nisp`, so that libraries do not compile it: `nisp-cli = { version = "0.1",
/// default-features = false }`. `nisp new heat --rust` writes such a program.
#[macro_export]
macro_rules! main {
    ($($($equation:ident)::+),+ $(,)?) => {
        fn main() -> ::std::process::ExitCode {
            ::nisp_cli::Program::own(env!("CARGO_BIN_NAME"), [$($($equation)::+::scenes()),+]).run()
        }
    };
}

pub use nisp_runtime::kernel::{Precision, Scene, SceneRef, scene, scene_in_both_precisions};
pub use nisp_runtime::live::{FixedLagSmoother, LagSettings, LiveError, RowColumn, Smoothed};
pub use nisp_runtime::problem::{BindError, Doubt, Points, Problem, Rest, Tolerance};
pub use nisp_runtime::recover::{
    Carrier, Checkpoint, CheckpointError, LearnedValue, Misfits, Optimizer, RecoverError, Report, Session, Settings,
    Solution, TermReport, Width, beyond_splines, recover, resume,
};
pub use nisp_runtime::saved::{OpenAnswer, SavedAnswer, SavedError, SavedParameter};
pub use nisp_runtime::verdict::{Check, Verdict};
pub use nisp_runtime::{engine, local, nearest, network, noise, peak, real, schema, simd, solve, units};

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
    pub use nisp_runtime::units;
    pub use nisp_runtime::values::{Precompiled, Values};
}
