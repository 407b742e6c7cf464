//! Compiler stage 6: tokens.
//!
//! - Input: the [`Model`] (names, units, documentation) and the [`Plan`] (programs).
//! - Output: the module that replaces the `pde!` invocation.
//!
//! What is emitted, for a module `heat` with a scene `recover` and a group `interior`:
//!
//! ```text
//! pub mod heat {
//!     mod kernels { Channels0: Rules, RecoverInterior: Residuals }
//!     pub mod recover { Scene (its schema and kernels), Parameters, bind() -> a builder that needs every group }
//! }
//! ```

mod bind;
mod lower;
mod residuals;
mod rules;
mod scene;
mod schema;

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use crate::model::{Model, Name, Role};
use crate::plan::Plan;
use crate::unit::Unit;

/// Emits the module of a model.
pub fn emit(model: &Model, plan: &Plan) -> TokenStream {
    let name = ident(&model.name);
    let visibility = &model.visibility;
    let documentation = docs(&model.docs);
    let quantities = docs(&quantities(model));
    let sets = plan.sets.iter().enumerate().filter(|(_, set)| !set.is_precompiled());
    let sets = sets.map(|(at, set)| rules::emit(at, set, model));
    let groups = plan
        .scenes
        .iter()
        .zip(&model.scenes)
        .flat_map(|(plan, scene)| plan.groups.iter().map(move |group| residuals::emit(model, scene, group)));
    let scenes =
        plan.scenes.iter().zip(&model.scenes).map(|(scene, declared)| scene::emit(model, plan, scene, declared));
    let warnings = model.warnings.iter().enumerate().map(|(at, (message, span))| warning(at, message, *span));
    quote! {
        #(#documentation)*
        #(#quantities)*
        #[allow(non_snake_case, reason = "users name moduli and temperatures by capitals")]
        #visibility mod #name {
            #(#warnings)*
            #[doc(hidden)]
            #[allow(non_camel_case_types, unused_variables, unused_imports, clippy::all, clippy::pedantic)]
            mod kernels {
                use ::nisp::__private::{Lane, Residuals, Rules, Simd, Sink, functions};
                #(#sets)*
                #(#groups)*
            }
            #(#scenes)*
        }
    }
}

/// Documentation lines: every quantity with its unit and what the user says of it.
fn quantities(model: &Model) -> Vec<String> {
    let line = |name: &Name, unit: &Unit, docs: &[String]| {
        let unit = if unit.text.is_empty() { "1" } else { &unit.text };
        let docs: Vec<&str> = docs.iter().map(|line| line.trim()).collect();
        format!(" - `{}` \\[{unit}\\] {}", name.text, docs.join(" "))
    };
    let role = |role: Role| {
        let fields = model.fields.iter().filter(move |field| field.role == role);
        fields.map(|field| line(&field.name, &field.unit, &field.docs)).collect()
    };
    let sections: [(&str, Vec<String>); 4] = [
        ("Coordinates", model.coordinates.iter().map(|c| line(&c.name, &c.unit, &c.docs)).collect()),
        ("Fields", role(Role::Field)),
        ("Sources", role(Role::Source)),
        ("Parameters", model.parameters.iter().map(|p| line(&p.name, &p.unit, &p.docs)).collect()),
    ];
    let mut lines = Vec::new();
    for (title, mut entries) in sections.into_iter().filter(|(_, entries)| !entries.is_empty()) {
        lines.extend([String::new(), format!(" # {title}"), String::new()]);
        lines.append(&mut entries);
    }
    lines
}

/// The least that keeps names defined when a module has errors, so that one mistake gives one error.
pub fn skeleton(model: &Model) -> TokenStream {
    let name = ident(&model.name);
    let visibility = &model.visibility;
    let scenes = model.scenes.iter().map(|scene| {
        let name = ident(&scene.name);
        quote!(pub mod #name {})
    });
    quote!(#visibility mod #name { #(#scenes)* })
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

fn docs(lines: &[String]) -> Vec<TokenStream> {
    lines.iter().map(|line| quote!(#[doc = #line])).collect()
}

/// `soft_bubble` and `contact` as `SoftBubbleContact`.
fn camel(parts: &[&str]) -> String {
    parts
        .iter()
        .flat_map(|part| part.split(|c: char| !c.is_alphanumeric()))
        .map(|word| {
            let mut letters = word.chars();
            letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
        })
        .collect()
}

/// The type that holds the residual programs of a group in a scene.
fn residuals_type(scene: &crate::model::Scene, group: &crate::model::Group) -> Ident {
    format_ident!("{}", camel(&[&scene.name.text, &group.name.text]))
}

/// The type that holds the rules of a channel set.
fn rules_type(set: usize) -> Ident {
    format_ident!("Channels{set}")
}
