//! Compiler stage 6: tokens.
//!
//! - Input: the [`Model`] (names, units, documentation) and the [`Plan`] (programs).
//! - Output: the module that replaces the `pde!` invocation.
//!
//! What is emitted, for a module `heat` with a scene `recover` and a group `interior`:
//!
//! ```text
//! pub mod heat {
//!     mod kernels { Channels0: Rules, recover_interior_0: Residuals }
//!     pub mod recover { Scene (its schema and kernels), Parameters, InteriorData, bind() -> a builder that needs every group }
//! }
//! ```

mod bind;
mod data;
mod document;
mod lower;
mod residuals;
mod rules;
mod scene;
mod schema;

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use crate::model::{Model, Name, Scene};
use crate::plan::{GroupPlan, Plan, ScenePlan};
use crate::unit::Unit;

/// Emits the module of a model that was read from this text.
pub fn emit(model: &Model, plan: &Plan, text: &str) -> TokenStream {
    let name = ident(&model.name);
    let visibility = &model.visibility;
    let documentation = docs(&model.docs);
    let quantities = docs(&document::quantities(model));
    let sets = plan.sets.iter().enumerate().filter(|(_, set)| !set.is_precompiled());
    let sets = sets.map(|(at, set)| rules::emit(at, set, model));
    let groups = plan
        .scenes
        .iter()
        .zip(&model.scenes)
        .flat_map(|(plan, scene)| plan.groups.iter().map(move |group| residuals::emit(model, scene, group)));
    let scenes =
        plan.scenes.iter().zip(&model.scenes).map(|(scene, declared)| scene::emit(model, plan, scene, declared));
    let names = model.scenes.iter().map(|scene| ident(&scene.name));
    let warnings = model.warnings.iter().enumerate().map(|(at, (message, span))| warning(at, message, *span));
    quote! {
        #(#documentation)*
        #(#quantities)*
        #[allow(non_snake_case, reason = "users name moduli and temperatures by capitals")]
        #visibility mod #name {
            #(#warnings)*
            /// The text of the equation, as the compiler reads it.
            pub const TEXT: &str = #text;
            #[doc(hidden)]
            #[allow(non_camel_case_types, unused_variables, unused_imports, clippy::all, clippy::pedantic)]
            mod kernels {
                use ::nisp::__private::{Lane, Residuals, Rules, Simd, Sink, functions};
                #(#sets)*
                #(#groups)*
            }
            /// All scenes, in double precision, for what takes them without their types, like `nisp::main!`.
            // Compiled where it is called, and the kernels with it.
            #[inline]
            pub fn scenes() -> Vec<::nisp::SceneRef> {
                vec![#(::nisp::scene::<#names::Scene>()),*]
            }
            #(#scenes)*
        }
    }
}

/// The least that keeps names defined when a module has errors, so that one mistake gives one error.
pub fn skeleton(model: &Model) -> TokenStream {
    let name = ident(&model.name);
    let visibility = &model.visibility;
    let scenes = model.scenes.iter().map(|scene| {
        let name = ident(&scene.name);
        quote!(pub mod #name {})
    });
    quote! {
        #visibility mod #name {
            pub fn scenes() -> Vec<::nisp::SceneRef> { Vec::new() }
            #(#scenes)*
        }
    }
}

/// A warning on stable Rust: the use of a deprecated constant, at the user's token.
fn warning(at: usize, message: &str, span: Span) -> TokenStream {
    let name = format_ident!("lint_{at}");
    let used = Ident::new(&name.to_string(), Span::mixed_site().located_at(span));
    let declared = Ident::new(&name.to_string(), Span::mixed_site());
    quote! {
        #[deprecated(note = #message)]
        #[allow(non_upper_case_globals)]
        const #declared: () = ();
        const _: () = #used;
    }
}

/// The groups that the user declared: those that the compiler adds come after them.
fn public<'a>(model: &Model, scene: &'a ScenePlan) -> &'a [GroupPlan] {
    let count = scene.groups.iter().take_while(|group| !model.groups[group.group].is_internal()).count();
    &scene.groups[..count]
}

fn ident(name: &Name) -> Ident {
    raw(&name.text, name.span)
}

/// An identifier, raw if the text is a keyword.
fn raw(text: &str, span: Span) -> Ident {
    syn::parse_str::<Ident>(text).map_or_else(
        |_| Ident::new_raw(text, span),
        |mut ident| {
            ident.set_span(span);
            ident
        },
    )
}

/// Names taken so far.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    /// The name, with underscores behind it where it is taken.
    fn free(&mut self, mut name: String) -> String {
        while !self.0.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

/// A unit as it stands in brackets.
fn unit_text(unit: &Unit) -> &str {
    if unit.text.is_empty() { "1" } else { &unit.text }
}

fn docs(lines: &[String]) -> Vec<TokenStream> {
    lines.iter().map(|line| quote!(#[doc = #line])).collect()
}

/// The type that holds the residual programs of a group in a scene. Its number keeps a group of the user's apart from one
/// that the compiler adds.
fn residuals_type(model: &Model, scene: &Scene, group: &GroupPlan) -> Ident {
    let name = model.groups[group.group].name.text.trim_matches(['(', ')']);
    format_ident!("{}_{name}_{}", scene.name.text, group.group)
}

/// The type that holds the rules of a channel set.
fn rules_type(set: usize) -> Ident {
    format_ident!("Channels{set}")
}
