//! Compiler stage 3: scalar expressions as a hash-consed graph.
//!
//! - Input: scalar expressions of the model.
//! - Output: expressions in jets of the network's outputs, derivatives carried out, common parts shared.

pub mod algebra;
pub mod differentiate;
mod elementary;
pub mod exact;
pub mod factor;
pub mod function;
pub mod graph;
pub mod horner;
pub mod lower;
pub mod magnitude;
pub mod polynomial;
pub mod rewrite;
pub mod site;
