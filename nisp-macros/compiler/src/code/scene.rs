//! The module of a scene: its type, its documentation, and how it is bound.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::{Names, bind, docs, document, ident, public, residuals_type, rules_type, schema};
use crate::model::{self, Model};
use crate::plan::{GroupPlan, Plan, ScenePlan};

/// The module of one scene.
pub(super) fn emit(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let name = ident(&declared.name);
    let documentation = docs(&declared.docs);
    let equations = docs(&document::equations(model, scene));
    let schema = schema::emit(model, plan, scene, declared);
    let kernels = scene.groups.iter().map(|group| {
        let layers = layers(plan, group);
        let residuals = residuals_type(model, declared, group);
        quote!(GroupKernel { layers: #layers, programs: CompiledPrograms::<kernels::#residuals>::erased() })
    });
    let latex = latex(model, scene);
    let bind = bind::emit(model, scene, declared);
    quote! {
        #(#documentation)*
        #(#equations)*
        pub mod #name {
            use super::kernels;
            use ::nisp::__private::{CompiledPrograms, GroupKernel, schema, units};

            /// This scene, as the engine takes it.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            pub struct Scene;

            impl ::nisp::Scene for Scene {
                const SCHEMA: &'static schema::Scene = &#schema;
                const TEXT: &'static str = super::TEXT;
                fn kernels<E: ::nisp::Precision>() -> Vec<GroupKernel<E>> {
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
        return quote!(<E as ::nisp::__private::Precompiled>::values(#s));
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

/// LaTeX constants, one for each equation and definition.
fn latex(model: &Model, scene: &ScenePlan) -> TokenStream {
    let mut names = Names::default();
    let mut constants = Vec::new();
    let mut add = |group: &str, name: &str, doc: String, latex: &str| {
        let name = names.free(format!("{group}_{name}").to_uppercase());
        let name = format_ident!("{name}");
        constants.push(quote!(#[doc = #doc] pub const #name: &str = #latex;));
    };
    for group in public(model, scene) {
        let declared = &model.groups[group.group];
        for term in group.terms.iter().map(|term| &declared.terms[term.term]) {
            let (place, name) = (&declared.name.text, &term.name.text);
            add(place, name, format!(" `{}` on `{place}`, `{name}`, as LaTeX.", term.equation), &term.latex);
        }
    }
    let groups = public(model, scene).iter().flat_map(|group| &model.groups[group.group].definitions);
    for definition in model.constants.iter().chain(&model.definitions).chain(groups) {
        let name = &definition.name.text;
        add("let", name, format!(" `{name} = {}`, as LaTeX.", definition.text), &definition.latex);
    }
    quote! {
        /// The equations and definitions of this scene as LaTeX.
        pub mod latex { #(#constants)* }
    }
}
