//! Faulty programs through the whole macro and rustc: the errors stand at the user's own tokens, one for each mistake.

#[test]
fn rustc_shows_what_the_macro_says() {
    trybuild::TestCases::new().compile_fail("tests/ui/*.rs");
}
