//! How a scene is bound to points and data: a chain of types, one per binding, so that a missing one does not compile.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::document::{comment, in_unit};
use super::{data, ident, public, raw, unit_text};
use crate::model::{self, Model};
use crate::plan::{GroupPlan, Scalar, ScenePlan};

/// `Parameters`, the data types of groups, and the chain of builders that ends in a `Problem`.
pub(super) fn emit(model: &Model, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let parameters = parameters(model, scene, declared);
    let groups = public(model, scene);
    let steps = (0..groups.len()).map(|at| step(model, at, &groups[at], groups.get(at + 1)));
    let list: Vec<String> = groups.iter().map(|group| format!("`{}`", model.groups[group.group].name.text)).collect();
    let doc = format!(" Begins to bind the scene: give its parameters, then its groups in order: {}.", list.join(", "));
    let first = state(model, groups.first());
    let last = state(model, None);
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
    let read: Vec<(&usize, &model::Parameter)> = scene
        .scalars
        .iter()
        .filter_map(|scalar| match scalar {
            Scalar::Parameter(at) => Some((at, &model.parameters[*at])),
            _ => None,
        })
        .filter(|(at, _)| declared.fixed_parameters[**at].is_none())
        .collect();
    let fields = read.iter().map(|(at, parameter)| {
        let name = ident(&parameter.name);
        let unit = unit_text(&parameter.unit);
        let doc = format!(" \\[{unit}\\]{}{}", comment(&parameter.docs), learned(parameter, **at, declared));
        quote!(#[doc = #doc] pub #name: f64)
    });
    let values = read.iter().map(|(_, parameter)| {
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

/// What a parameter's documentation adds where the scene learns it.
fn learned(parameter: &model::Parameter, at: usize, scene: &model::Scene) -> String {
    let unit = &parameter.unit;
    match (scene.learned[at], scene.spreads[at]) {
        (false, _) => String::new(),
        (true, None) => "; learned, from this value".into(),
        (true, Some(spread)) => {
            format!("; learned, believed to be this give or take {} {}", in_unit(spread, unit), unit.text)
        }
    }
}

/// The builder that waits for a group, by its name: the compiler's message says what is missing. `Bound` if nothing is.
fn state(model: &Model, group: Option<&GroupPlan>) -> Ident {
    match group {
        Some(group) => format_ident!("Needs{}", model.groups[group.group].camel_name()),
        None => format_ident!("Bound"),
    }
}

/// The builder that waits for group `at`, before that of the next.
fn step(model: &Model, at: usize, group: &GroupPlan, next: Option<&GroupPlan>) -> TokenStream {
    let declared = &model.groups[group.group];
    let text = &declared.name.text;
    let method = raw(text, declared.name.span);
    let (this, next) = (state(model, Some(group)), state(model, next));
    let waits = format!(" Waits for the points of group `{text}`.");
    let data = data::of(model, group);
    let coordinates: Vec<&str> = model.coordinates.iter().map(|c| c.name.text.as_str()).collect();
    let doc = format!(
        " Points of group `{text}`: {}, point by point, in their declared units.{}",
        coordinates.join(", "),
        if data.is_some() { " `data` is what belongs to them." } else { "" },
    );
    let (definition, argument, bound) = match data {
        None => (quote!(), quote!(), quote!(self.0.with_group(#at, points.into(), Vec::new()))),
        Some(data) => {
            let (name, columns) = (&data.name, &data.columns);
            let points = match &data.partners {
                Some(partners) => quote!(::nisp::Points { partners: #partners, ..points.into() }),
                None => quote!(points.into()),
            };
            let clouds = data.clouds.iter().map(|(term, cloud)| quote!(.with_cloud(#at, #term, #cloud)));
            let bound = quote!(self.0.with_group(#at, #points, vec![#(#columns),*]) #(#clouds)*);
            (data.definition, quote!(data: #name), bound)
        }
    };
    quote! {
        #definition
        #[doc = #waits]
        #[derive(Clone, Debug)]
        #[must_use = "a scene is not bound before all of its groups are"]
        pub struct #this(::nisp::Problem);
        impl #this {
            #[doc = #doc]
            pub fn #method(self, points: impl Into<::nisp::Points>, #argument) -> #next {
                #next(#bound)
            }
        }
    }
}
