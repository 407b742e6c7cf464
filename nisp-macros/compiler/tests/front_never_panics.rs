//! Whatever the tokens are, the front end answers: no panic, no overflow of the stack, no waiting.

use nisp_compiler::error::Errors;
use nisp_compiler::model::check;
use nisp_compiler::syntax::parse;
use proc_macro2::TokenStream;
use proptest::prelude::*;

/// True if the program is sound; the point is that there is an answer.
fn is_sound(text: &str) -> bool {
    let Ok(tokens) = text.parse::<TokenStream>() else { return false };
    let mut errors = Errors::new();
    let model = parse(tokens, &mut errors).and_then(|module| check(&module, &[], &mut errors));
    assert_eq!(model.is_none(), !errors.is_empty(), "{text}");
    let _ = errors.into_compile_errors().to_string();
    model.is_some()
}

/// Words of the language, names that are declared and some that are not, operators and stray brackets.
const WORDS: [&str; 93] = [
    "coordinates",
    "fields",
    "sources",
    "parameters",
    "constants",
    "columns",
    "units",
    "off",
    "let",
    "on",
    "scene",
    "hard",
    "by",
    "observe",
    "learn",
    "without",
    "only",
    "weight",
    "with",
    "huber(3)",
    "welsch(2)",
    "tukey(4)",
    "chamfer",
    "symmetric",
    "pairs",
    "vector",
    "time",
    "in",
    "x",
    "y",
    "t",
    "u",
    "v",
    "w",
    "f",
    "k",
    "a",
    "n",
    "I",
    "pi",
    "u_x",
    "w_xx",
    "zz",
    "inside",
    "edge",
    "balance",
    "d(w, x)",
    "d(u, x, 2)",
    "d(d(w, y), x, 9)",
    "grad(w)",
    "div(u)",
    "sym(grad(u))",
    "curl(u)",
    "biharmonic(w)",
    "hessian(w)",
    "inverse(grad(u))",
    "det(grad(u))",
    "dot(u, n)",
    "partner(w)",
    "integral(w)",
    "min(w, 1)",
    "sin(w)",
    "sqrt(w)",
    "[1, 2]",
    "[x, y]",
    "[m]",
    "[N/m^2]",
    "[kg m^-3]",
    "[s^(1/2)]",
    "[qq]",
    "0",
    "1",
    "2.5",
    "1e30",
    "1e-400",
    "170141183460469231731687303715884105727",
    "+",
    "-",
    "*",
    "/",
    "^",
    "==",
    ">=",
    "<=",
    "=",
    "_|_",
    "~",
    ";",
    ",",
    ":",
    "..",
    "(",
    "{",
];

fn soup(length: usize) -> impl Strategy<Value = String> {
    prop::collection::vec(prop::sample::select(WORDS.to_vec()), 0..length).prop_map(|words| {
        let mut text = words.join(" ");
        // Brackets must match to be tokens at all.
        let mut open: Vec<char> = Vec::new();
        for word in &words {
            open.extend(match *word {
                "(" => Some(')'),
                "{" => Some('}'),
                _ => None,
            });
        }
        text.extend(open.into_iter().rev());
        text
    })
}

const HEAD: &str = "coordinates: x [m], y [m], t [s]; fields: u: vector [m], v [1], w [m]; sources: f [Pa] >= 0; \
                    parameters: k [1/s] = 2; let a = w_xx * w;";

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn soup_as_a_module(text in soup(60)) {
        is_sound(&format!("mod m {{ {text} }}"));
    }

    #[test]
    fn soup_as_statements(text in soup(30)) {
        is_sound(&format!("mod m {{ {HEAD} {text}; on inside {{ balance: w == 0 }} }}"));
    }

    #[test]
    fn soup_as_a_group(text in soup(30)) {
        is_sound(&format!("mod m {{ {HEAD} on inside pairs {{ columns: n: vector; t: {text}; }} scene s {{ {text} }} }}"));
    }

    #[test]
    fn soup_as_an_expression(text in soup(9)) {
        is_sound(&format!("mod m {{ {HEAD} let b = {text}; on inside {{ balance: b == {text}; observe w; }} }}"));
    }

    #[test]
    fn soup_without_a_module(text in soup(20)) {
        is_sound(&text);
    }
}

/// A program around one expression.
fn around(expression: &str) -> String {
    format!("mod m {{ coordinates: x; fields: u; on inside {{ balance: u == {expression}; }} }}")
}

#[test]
fn deep_nesting_is_refused() {
    for (open, close) in [("(", ")"), ("[", "]"), ("sin(", ")"), ("-", ""), ("x^", ""), ("d(x*(", "), x)"), ("u[", "]")]
    {
        for depth in [10, 90, 110, 1_000, 20_000] {
            let text = around(&format!("{}x{}", open.repeat(depth), close.repeat(depth)));
            if depth > 100 {
                assert!(!is_sound(&text), "{open} {depth}");
            } else {
                is_sound(&text);
            }
        }
    }
}

#[test]
fn long_programs_are_read_in_no_time() {
    for operator in ["+", "-", "*", "/", "+ 2 * x -"] {
        assert!(is_sound(&around(&vec!["x"; 5_000].join(operator))), "{operator}");
    }
    let lets: String = (1..2_000).map(|i| format!("let a{i} = a{} + x;", i - 1)).collect();
    is_sound(&format!("mod m {{ coordinates: x; fields: u; let a0 = u; {lets} on inside {{ b: a1999 == 0; }} }}"));
    let fields: String = (0..2_000).map(|i| format!("u{i}, ")).collect();
    is_sound(&format!("mod m {{ coordinates: x; fields: {fields} v; on inside {{ b: u0 == 0; }} }}"));
}

#[test]
fn numbers_never_overflow() {
    let huge = "999999999999999999";
    for text in [
        format!("{huge} * {huge} * {huge} * x"),
        format!("({huge}^9)^9 + x"),
        format!("x^({huge}/7) + x^(1/{huge})"),
        format!("1/{huge} + 1/999999999999999989 + 1/999999999999999967 + x"),
        "(x^1000)^1000 + (((x^999)^999)^999)^999".to_string(),
        "x^(2^0.5) + 2^-1000 * x + 0^0 * x".to_string(),
        "-170141183460469231731687303715884105728 * x".to_string(),
    ] {
        is_sound(&around(&text));
    }
    let text = format!(
        "mod m {{ coordinates: x [m]; fields: u [m]; on i {{ b: u^{huge} == x^{huge} * 1 [m^({huge}/3)]; }} }}"
    );
    assert!(!is_sound(&text));
}
