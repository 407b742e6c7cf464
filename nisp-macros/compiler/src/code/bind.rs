//! How a scene is bound to points and data: a chain of types, one per binding, so that a missing one does not compile.

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use super::scene::public;
use super::{ident, raw};
use crate::model::{self, Model, TermKind};
use crate::plan::{GroupPlan, Scalar, ScenePlan};

/// `Parameters`, the data types of groups, and the chain of builders that ends in a `Problem`.
pub(super) fn emit(model: &Model, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let parameters = parameters(model, scene, declared);
    let groups = public(scene);
    let count = groups.len();
    let steps = groups.iter().enumerate().map(|(at, group)| step(model, at, group));
    let list: Vec<String> = groups.iter().map(|group| format!("`{}`", model.groups[group.group].name.text)).collect();
    let doc = format!(" Begins to bind the scene: give its parameters, then its groups in order: {}.", list.join(", "));
    let first = format_ident!("Needs0");
    let last = format_ident!("Needs{count}");
    quote! {
        #parameters
        #[doc = #doc]
        pub fn bind(parameters: Parameters) -> #first {
            #first(::nisp::Problem::new(::nisp::scene::<Scene>()).with_parameters(&parameters.values()))
        }
        #(#steps)*
        /// Everything is bound.
        #[derive(Clone, Debug)]
        pub struct #last(::nisp::Problem);
        impl #last {
            /// The bound problem, ready to be solved.
            pub fn problem(self) -> ::nisp::Problem { self.0 }
            /// Compiles the scene in single precision too, for settings with `Width::F32`. It takes as long again.
            #[inline]
            #[must_use]
            pub fn in_single_precision(self) -> Self {
                Self(self.0.with_scene(::nisp::scene_in_both_precisions::<Scene>()))
            }
        }
    }
}

/// The parameters that the scene reads, as a struct in declared units.
fn parameters(model: &Model, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let read: Vec<&model::Parameter> = scene
        .scalars
        .iter()
        .filter_map(|scalar| match scalar {
            Scalar::Parameter(at) => Some((at, &model.parameters[*at])),
            _ => None,
        })
        .filter(|(at, _)| declared.fixed_parameters[**at].is_none())
        .map(|(_, parameter)| parameter)
        .collect();
    let fields = read.iter().map(|parameter| {
        let name = ident(&parameter.name);
        let unit = if parameter.unit.text.is_empty() { "1" } else { &parameter.unit.text };
        let doc = format!(" `{}` in {unit}.{}", parameter.name.text, parameter.docs.concat());
        quote!(#[doc = #doc] pub #name: f64)
    });
    let values = read.iter().map(|parameter| {
        let (name, text) = (ident(&parameter.name), &parameter.name.text);
        quote!((#text, self.#name))
    });
    let count = read.len();
    quote! {
        /// The scene's parameters, each in its declared unit; a learned one gives the value to start from.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Parameters { #(#fields),* }
        impl Parameters {
            fn values(&self) -> [(&'static str, f64); #count] { [#(#values),*] }
        }
    }
}

/// The builder that waits for group `at`.
fn step(model: &Model, at: usize, group: &GroupPlan) -> TokenStream {
    let declared = &model.groups[group.group];
    let text = &declared.name.text;
    let method = raw(text, declared.name.span);
    let (this, next) = (format_ident!("Needs{at}"), format_ident!("Needs{}", at + 1));
    let columns: Vec<_> = group.columns.iter().map(|&column| &declared.columns[column]).collect();
    let arguments = columns.iter().map(|column| {
        let name = ident(&column.name);
        quote!(#name: impl Into<Vec<f64>>)
    });
    let pushes = columns.iter().map(|column| {
        let name = ident(&column.name);
        quote!(#name.into())
    });
    let clouds = group
        .terms
        .iter()
        .map(|term| &declared.terms[term.term])
        .filter(|term| matches!(term.kind, TermKind::Chamfer { .. }));
    let clouds: Vec<_> = clouds.map(|term| (format_ident!("{}", term.name.text), &term.name.text)).collect();
    let cloud_arguments = clouds.iter().map(|(name, _)| quote!(#name: impl Into<Vec<f64>>));
    let cloud_calls = clouds.iter().map(|(name, text)| quote!(.with_cloud(#at, #text, #name.into())));
    let (partners, points) = match declared.paired {
        true => (
            quote!(partners: impl Into<Vec<f64>>,),
            quote!(::nisp::Points { partners: partners.into(), ..points.into() }),
        ),
        false => (quote!(), quote!(points.into())),
    };
    let units: Vec<String> = columns.iter().map(|c| format!("`{}` in {}", c.name.text, c.unit.text)).collect();
    let waits = format!(" Waits for the points of group `{text}`.");
    let doc = format!(
        " Points of group `{text}`: coordinates in their declared units, point by point ({}).{}",
        model.coordinates.iter().map(|c| c.name.text.as_str()).collect::<Vec<_>>().join(", "),
        if units.is_empty() { String::new() } else { format!(" Columns, one value per point: {}.", units.join(", ")) },
    );
    quote! {
        #[doc = #waits]
        #[derive(Clone, Debug)]
        #[must_use = "a scene is not bound before all of its groups are"]
        pub struct #this(::nisp::Problem);
        impl #this {
            #[doc = #doc]
            #[allow(clippy::too_many_arguments)]
            pub fn #method(
                self, points: impl Into<::nisp::Points>, #partners #(#arguments,)* #(#cloud_arguments,)*
            ) -> #next {
                #next(self.0.with_group(#at, #points, vec![#(#pushes),*]) #(#cloud_calls)*)
            }
        }
    }
}
