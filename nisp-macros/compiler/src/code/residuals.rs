//! Residual programs of a group in a scene.

use proc_macro2::TokenStream;
use quote::quote;

use super::lower::{Dialect, Frame, lower};
use super::residuals_type;
use crate::model::{Model, Scene};
use crate::plan::{GroupPlan, RowKind, TermPlan};
use crate::program::{Program, Slot};

/// The type that holds the programs, and its implementation of `Residuals`.
pub(super) fn emit(model: &Model, scene: &Scene, group: &GroupPlan) -> TokenStream {
    let declared = &model.groups[group.group];
    let name = residuals_type(model, scene, group);
    let equations = group.terms.iter().map(|term| {
        let term = &declared.terms[term.term];
        let line = format!(" - `{}`: `{}`", term.name.text, term.equation);
        quote!(#[doc = #line])
    });
    let title = format!(" Group `{}` of scene `{}`:", declared.name.text, scene.name.text);
    let residual = points(&group.residual);
    let adjoint = points(&group.adjoint);
    let magnitude = points(&group.magnitude);
    let target = scalars(group, |term| match &term.kind {
        RowKind::Integral(program) => Some(program),
        _ => None,
    });
    let target_slopes = scalars(group, |term| Some(&term.target_slopes));
    quote! {
        #[doc = #title]
        #(#equations)*
        pub struct #name;
        impl Residuals for #name {
            #[inline(always)]
            fn residual<V: Simd>(at: &Lane<'_, V>, out: &mut Sink<'_, V::Elem>) { #residual }
            #[inline(always)]
            fn adjoint<V: Simd>(at: &Lane<'_, V>, out: &mut Sink<'_, V::Elem>) { #adjoint }
            #[inline(always)]
            fn magnitude<V: Simd>(at: &Lane<'_, V>, out: &mut Sink<'_, V::Elem>) { #magnitude }
            fn target(scalars: &[f64], rows: &mut [f64]) { #target }
            fn target_slopes(scalars: &[f64], rows: &mut [f64]) { #target_slopes }
        }
    }
}

/// A program over the points of a lane.
fn points(program: &Program) -> TokenStream {
    let read = |slot: Slot, index: usize| match slot {
        Slot::Jet => quote!(at.jet(#index)),
        Slot::Coordinate => quote!(at.coordinate(#index)),
        Slot::Parameter => quote!(at.scalar(#index)),
        Slot::Column => quote!(at.column(#index)),
        _ => quote!(at.seed(#index)),
    };
    let frame =
        Frame { read: &read, parameters: quote!(at: &Lane<'_, V>), arguments: quote!(at), dialect: Dialect::Vector };
    let (statements, outputs) = lower(program, &frame);
    let indices = 0..outputs.len();
    quote!(#statements #(out.put::<V>(#indices, #outputs);)*)
}

/// Programs over scalars alone, one per term; as many outputs for each row of the term are written where its rows are.
fn scalars(group: &GroupPlan, program: impl Fn(&TermPlan) -> Option<&Program>) -> TokenStream {
    let read = |_: Slot, index: usize| quote!(scalars[#index]);
    let programs = group.terms.iter().filter_map(|term| Some((term, program(term).filter(|p| !p.outputs.is_empty())?)));
    let blocks = programs.map(|(term, program)| {
        let frame = Frame { read: &read, parameters: quote!(), arguments: quote!(), dialect: Dialect::Scalar };
        let (statements, outputs) = lower(program, &frame);
        let first = term.first * outputs.len() / term.rows;
        let indices = first..first + outputs.len();
        quote!({ #statements #(rows[#indices] = #outputs;)* })
    });
    quote!(#(#blocks)*)
}
