//! Propagation rules of a channel set.

use proc_macro2::TokenStream;
use quote::quote;

use super::lower::{Dialect, Frame, lower};
use super::rules_type;
use crate::describe;
use crate::model::Model;
use crate::plan::SetPlan;
use crate::program::{Program, Slot};

/// The type `Channels{at}` and its implementation of `Rules`.
pub(super) fn emit(at: usize, plan: &SetPlan, model: &Model) -> TokenStream {
    let name = rules_type(at);
    let (k, s) = (plan.set.len(), plan.set.coordinates);
    let d = plan.set.order() as usize + 2;
    let channels = describe::channel_names(&plan.set, model);
    let doc = format!(" Channels: {}.", channels.join(", "));
    let read = &plan.read;
    let compose = function(&plan.compose, quote!(phi: &[V; #d], a: &[V; #k]), quote!(phi, a));
    let compose_adjoint =
        function(&plan.compose_adjoint, quote!(phi: &[V; #d], a: &[V; #k], seed: &[V; #k]), quote!(phi, a, seed));
    let affine = function(&plan.affine, quote!(phi: &[V; #d], w: &[V; #s]), quote!(phi, w));
    let affine_adjoint =
        value_and_array(&plan.affine_adjoint, quote!(phi: &[V; #d], w: &[V; #s], seed: &[V; #k]), quote!(phi, w, seed));
    let product = function(&plan.product, quote!(f: &[V; #k], g: &[V; #k]), quote!(f, g));
    let product_adjoint =
        arrays(&plan.product_adjoint, quote!(f: &[V; #k], g: &[V; #k], seed: &[V; #k]), quote!(f, g, seed), k);
    quote! {
        #[doc = #doc]
        pub struct #name;
        impl Rules<#k, #d, #s> for #name {
            const READ: [bool; #k] = [#(#read),*];
            #[inline(always)]
            fn compose<V: Simd>(phi: &[V; #d], a: &[V; #k]) -> [V; #k] { #compose }
            #[inline(always)]
            fn compose_adjoint<V: Simd>(phi: &[V; #d], a: &[V; #k], seed: &[V; #k]) -> [V; #k] { #compose_adjoint }
            #[inline(always)]
            fn affine<V: Simd>(phi: &[V; #d], w: &[V; #s]) -> [V; #k] { #affine }
            #[inline(always)]
            fn affine_adjoint<V: Simd>(phi: &[V; #d], w: &[V; #s], seed: &[V; #k]) -> (V, [V; #s]) { #affine_adjoint }
            #[inline(always)]
            fn product<V: Simd>(f: &[V; #k], g: &[V; #k]) -> [V; #k] { #product }
            #[inline(always)]
            fn product_adjoint<V: Simd>(f: &[V; #k], g: &[V; #k], seed: &[V; #k]) -> ([V; #k], [V; #k]) {
                #product_adjoint
            }
        }
    }
}

/// How rules name their inputs.
fn read(slot: Slot, index: usize) -> TokenStream {
    match slot {
        Slot::Phi => quote!(phi[#index]),
        Slot::Argument => quote!(a[#index]),
        Slot::Left => quote!(f[#index]),
        Slot::Right => quote!(g[#index]),
        Slot::Weight => quote!(w[#index]),
        _ => quote!(seed[#index]),
    }
}

fn body(program: &Program, parameters: TokenStream, arguments: TokenStream) -> (TokenStream, Vec<TokenStream>) {
    lower(program, &Frame { read: &read, parameters, arguments, dialect: Dialect::Vector })
}

/// A body that gives one array.
fn function(program: &Program, parameters: TokenStream, arguments: TokenStream) -> TokenStream {
    let (statements, outputs) = body(program, parameters, arguments);
    quote!(#statements [#(#outputs),*])
}

/// A body that gives two arrays, the first of `at` entries.
fn arrays(program: &Program, parameters: TokenStream, arguments: TokenStream, at: usize) -> TokenStream {
    let (statements, outputs) = body(program, parameters, arguments);
    let (first, second) = outputs.split_at(at);
    quote!(#statements ([#(#first),*], [#(#second),*]))
}

/// A body that gives a value and an array.
fn value_and_array(program: &Program, parameters: TokenStream, arguments: TokenStream) -> TokenStream {
    let (statements, outputs) = body(program, parameters, arguments);
    let (value, array) = (&outputs[0], &outputs[1..]);
    quote!(#statements (#value, [#(#array),*]))
}
