//! Straight-line programs as Rust statements.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use crate::model::Function;
use crate::program::{Op, Program, Slot, Value};

/// Longest run of statements in one emitted function; rustc slows down, and overflows its stack in debug builds, far
/// beyond it.
const LONGEST: usize = 400;

/// Which type the statements compute with.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Dialect {
    /// Vectors `V: Simd`.
    Vector,
    /// Plain `f64`.
    Scalar,
}

/// How an emitted function reads its inputs, and the parameters that it passes to its parts.
pub(super) struct Frame<'a> {
    /// An expression for an input.
    pub(super) read: &'a dyn Fn(Slot, usize) -> TokenStream,
    /// Parameters in declarations (`phi: &[V; D], a: &[V; K]`), for the parts of long programs.
    pub(super) parameters: TokenStream,
    /// The same as arguments.
    pub(super) arguments: TokenStream,
    /// What the statements compute with.
    pub(super) dialect: Dialect,
}

/// Statements of a program, and an expression for each output.
pub(super) fn lower(program: &Program, frame: &Frame<'_>) -> (TokenStream, Vec<TokenStream>) {
    if program.ops.len() <= LONGEST { short(program, frame) } else { long(program, frame) }
}

/// One `let` per operation.
fn short(program: &Program, frame: &Frame<'_>) -> (TokenStream, Vec<TokenStream>) {
    let lets = program.ops.iter().enumerate().map(|(at, op)| {
        let name = local(at);
        let value = operation(op, frame, &local);
        quote!(let #name = #value;)
    });
    let outputs = program.outputs.iter().map(|output| output.map_or_else(|| zero(frame), local));
    (quote!(#(#lets)*), outputs.collect())
}

/// Parts of bounded length that share an array of values.
fn long(program: &Program, frame: &Frame<'_>) -> (TokenStream, Vec<TokenStream>) {
    let operand = |value: Value| quote!(t[#value]);
    let (parameters, arguments) = (&frame.parameters, &frame.arguments);
    let (len, zero) = (program.ops.len(), zero(frame));
    let parts = program.ops.chunks(LONGEST).enumerate().map(|(part, ops)| {
        let name = format_ident!("part{part}");
        let statements = ops.iter().enumerate().map(|(at, op)| {
            let at = part * LONGEST + at;
            let value = operation(op, frame, &operand);
            quote!(t[#at] = #value;)
        });
        quote! {
            #[inline(always)]
            fn #name<V: Simd>(t: &mut [V; #len], #parameters) { #(#statements)* }
            #name::<V>(&mut t, #arguments);
        }
    });
    let outputs = program.outputs.iter().map(|output| output.map_or_else(|| zero.clone(), |value| quote!(t[#value])));
    let outputs = outputs.collect();
    (quote!(let mut t = [#zero; #len]; #(#parts)*), outputs)
}

fn local(value: Value) -> TokenStream {
    let name = Ident::new(&format!("t{value}"), Span::mixed_site());
    quote!(#name)
}

fn zero(frame: &Frame<'_>) -> TokenStream {
    match frame.dialect {
        Dialect::Vector => quote!(V::lit(0.0)),
        Dialect::Scalar => quote!(0.0_f64),
    }
}

/// The right-hand side of one operation.
fn operation(op: &Op, frame: &Frame<'_>, operand: &dyn Fn(Value) -> TokenStream) -> TokenStream {
    let vector = frame.dialect == Dialect::Vector;
    let o = operand;
    match *op {
        Op::Input(slot, index) => (frame.read)(slot, index),
        Op::Constant(x) if vector => quote!(V::lit(#x)),
        Op::Constant(x) => quote!(#x),
        Op::Add(a, b) => binary(quote!(add), quote!(+), vector, o(a), o(b)),
        Op::Sub(a, b) => binary(quote!(sub), quote!(-), vector, o(a), o(b)),
        Op::Mul(a, b) => binary(quote!(mul), quote!(*), vector, o(a), o(b)),
        Op::Div(a, b) => binary(quote!(div), quote!(/), vector, o(a), o(b)),
        Op::Neg(a) => {
            let a = o(a);
            if vector { quote!(#a.neg()) } else { quote!(-#a) }
        }
        Op::MulAdd(a, b, c) => ternary(quote!(mul_add), |a, b, c| quote!(#a * #b + #c), vector, [o(a), o(b), o(c)]),
        Op::MulSub(a, b, c) => ternary(quote!(mul_sub), |a, b, c| quote!(#a * #b - #c), vector, [o(a), o(b), o(c)]),
        Op::NegMulAdd(a, b, c) => {
            ternary(quote!(neg_mul_add), |a, b, c| quote!(#c - #a * #b), vector, [o(a), o(b), o(c)])
        }
        Op::Min(a, b) => method(quote!(min), o(a), o(b)),
        Op::Max(a, b) => method(quote!(max), o(a), o(b)),
        Op::Call(function, a) => call(function, vector, &o(a)),
    }
}

fn binary(name: TokenStream, symbol: TokenStream, vector: bool, a: TokenStream, b: TokenStream) -> TokenStream {
    if vector { quote!(#a.#name(#b)) } else { quote!(#a #symbol #b) }
}

fn method(name: TokenStream, a: TokenStream, b: TokenStream) -> TokenStream {
    quote!(#a.#name(#b))
}

fn ternary(
    name: TokenStream,
    plain: impl Fn(&TokenStream, &TokenStream, &TokenStream) -> TokenStream,
    vector: bool,
    [a, b, c]: [TokenStream; 3],
) -> TokenStream {
    if vector { quote!(#a.#name(#b, #c)) } else { plain(&a, &b, &c) }
}

/// Elementary functions: roots and magnitudes are instructions, the others go lane by lane.
fn call(function: Function, vector: bool, a: &TokenStream) -> TokenStream {
    let path = match function {
        Function::Sqrt if vector => return quote!(#a.sqrt()),
        Function::Abs if vector => return quote!(#a.abs()),
        Function::Sin => quote!(f64::sin),
        Function::Cos => quote!(f64::cos),
        Function::Tan => quote!(f64::tan),
        Function::Asin => quote!(f64::asin),
        Function::Acos => quote!(f64::acos),
        Function::Atan => quote!(f64::atan),
        Function::Sinh => quote!(f64::sinh),
        Function::Cosh => quote!(f64::cosh),
        Function::Tanh => quote!(f64::tanh),
        Function::Exp => quote!(f64::exp),
        Function::Ln => quote!(f64::ln),
        Function::Sqrt => quote!(f64::sqrt),
        Function::Abs => quote!(f64::abs),
        Function::Sign => quote!(functions::sign),
        Function::Step => quote!(functions::step),
        Function::Softplus => quote!(functions::softplus),
        Function::Sigmoid => quote!(functions::sigmoid),
    };
    if vector { quote!(#a.map(#path)) } else { quote!(#path(#a)) }
}
