//! The module of a scene: its type, its documentation, and how it is bound.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::{bind, docs, ident, residuals_type, rules_type, schema};
use crate::model::{self, Model};
use crate::plan::{GroupPlan, Plan, ScenePlan};

/// The module of one scene.
pub(super) fn emit(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let name = ident(&declared.name);
    let documentation = docs(&declared.docs);
    let equations = equations(model, scene);
    let schema = schema::emit(model, plan, scene, declared);
    let kernels = scene.groups.iter().map(|group| {
        let layers = layers(plan, group);
        let residuals = residuals_type(declared, &model.groups[group.group]);
        quote!(GroupKernel { layers: #layers, programs: CompiledPrograms::<kernels::#residuals>::erased() })
    });
    let latex = latex(model, scene);
    let bind = bind::emit(model, scene, declared);
    quote! {
        #(#documentation)*
        #(#equations)*
        pub mod #name {
            use super::kernels;
            use ::nisp::__private::{CompiledPrograms, GroupKernel, Real, schema};

            /// This scene, as the engine takes it.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            pub struct Scene;

            impl ::nisp::Scene for Scene {
                const SCHEMA: &'static schema::Scene = &#schema;
                fn kernels<E: Real>() -> Vec<GroupKernel<E>> {
                    vec![#(#kernels),*]
                }
            }

            #latex
            #bind
        }
    }
}

/// The layers of a group: its own, or those of values that the runtime has compiled.
fn layers(plan: &Plan, group: &GroupPlan) -> TokenStream {
    let set = &plan.sets[group.hidden].set;
    let (k, d, s) = (set.len(), set.order() as usize + 2, set.coordinates);
    if plan.sets[group.last].is_precompiled() {
        return quote!(<E as ::nisp::__private::Precompiled<#s>>::values());
    }
    let [hidden, last] = [group.hidden, group.last].map(|at| match plan.sets[at].is_precompiled() {
        true => quote!(::nisp::__private::Values),
        false => {
            let name = rules_type(at);
            quote!(kernels::#name)
        }
    });
    quote!(::nisp::__private::CompiledLayers::<#hidden, #last, #k, #d, #s>::erased())
}

/// Documentation lines: every equation with its group and unit.
fn equations(model: &Model, scene: &ScenePlan) -> Vec<TokenStream> {
    let mut lines = vec![String::new(), String::from(" # Equations"), String::new()];
    for group in public(scene) {
        let declared = &model.groups[group.group];
        for term in &group.terms {
            let term = &declared.terms[term.term];
            let unit = if term.unit.text.is_empty() { "1" } else { &term.unit.text };
            lines.push(format!(
                " - on `{}`, `{}`: `{}` \\[{unit}\\]",
                declared.name.text, term.name.text, term.equation
            ));
        }
    }
    docs(&lines)
}

/// One LaTeX constant per equation.
fn latex(model: &Model, scene: &ScenePlan) -> TokenStream {
    let constants = public(scene).iter().flat_map(|group| {
        let declared = &model.groups[group.group];
        group.terms.iter().map(move |term| {
            let term = &declared.terms[term.term];
            let name = format!("{}_{}", declared.name.text, term.name.text).to_uppercase();
            let name = format_ident!("{name}");
            let doc = format!(" `{}` on `{}`, `{}`, as LaTeX.", term.equation, declared.name.text, term.name.text);
            let latex = &term.latex;
            quote!(#[doc = #doc] pub const #name: &str = #latex;)
        })
    });
    quote! {
        /// The equations of this scene as LaTeX.
        pub mod latex { #(#constants)* }
    }
}

/// The groups that the user declared; the last group of a plan is the one that reads out the network.
pub(super) fn public(scene: &ScenePlan) -> &[crate::plan::GroupPlan] {
    scene.groups.split_last().map_or(&[], |(_, groups)| groups)
}
