//! Whatever the text is, the compiler answers: `cargo +nightly fuzz run compile` in `nisp-macros/compiler`.
//!
//! Seed it with the programs of the tests: `cargo +nightly fuzz run compile fuzz/corpus tests/fixtures/good`. Stable Rust
//! does without the sanitizers: `fuzz/run 60`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use proc_macro2::TokenStream;

fuzz_target!(|text: &str| {
    if let Ok(tokens) = text.parse::<TokenStream>() {
        let first = nisp_compiler::compile(tokens.clone()).to_string();
        // The same input gives the same output.
        assert_eq!(first, nisp_compiler::compile(tokens).to_string());
    }
});
