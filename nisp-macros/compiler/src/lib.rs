//! The compiler behind `pde!`: from the tokens of an equation to fused derivative-propagation code.
//!
//! Stages, in the one direction in which data flows:
//!
//! 1. [`syntax`]   - Input: tokens. Output: the syntax tree, as written.
//! 2. [`model`]    - Input: the syntax tree. Output: resolved names, checked shapes and units, scalar expressions.
//! 3. [`symbolic`] - Input: scalar expressions. Output: hash-consed expressions in jets, derivatives carried out.
//! 4. [`channels`] - Input: the operators read. Output: the minimal channel set and its propagation rules.
//! 5. [`plan`]     - Input: all of the above. Output: straight-line programs for every scene and group.
//! 6. [`code`]     - Input: the plan. Output: tokens.
//!
//! Only `syntax` and `code` know of tokens' structure; the stages between them carry spans for error messages
//! and nothing else. The compiler does no input or output, never panics, and is deterministic.

pub mod channels;
pub mod code;
pub mod error;
pub mod model;
pub mod plan;
pub mod program;
pub mod rational;
pub mod symbolic;
pub mod syntax;
pub mod unit;
