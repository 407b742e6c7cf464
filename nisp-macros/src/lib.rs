//! The `pde!` macro: a thin face of `nisp-compiler`, which can be tested, fuzzed and read as a plain library.

use proc_macro::TokenStream;

/// Declares the equations of an inverse source problem; the module `nisp::language` describes the language.
#[proc_macro]
pub fn pde(tokens: TokenStream) -> TokenStream {
    nisp_compiler::compile(tokens.into()).into()
}
