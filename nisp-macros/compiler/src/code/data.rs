//! What belongs to the points of a group, as a struct whose fields are named: numbers cannot be swapped unseen.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

use super::document::comment;
use super::{Names, ident, raw, unit_text};
use crate::model::{Column, Group, Model, Name, Part, Term, TermKind};
use crate::plan::GroupPlan;

/// The struct of a group, and how a binding takes it apart.
pub(super) struct Data {
    /// Its name.
    pub(super) name: Ident,
    /// Its definition.
    pub(super) definition: TokenStream,
    /// The columns that the group's programs read, as vectors made of `data`, in order.
    pub(super) columns: Vec<TokenStream>,
    /// Clouds by the names of their terms, made of `data`.
    pub(super) clouds: Vec<(String, TokenStream)>,
    /// The partners' coordinates, made of `data`, where points have partners.
    pub(super) partners: Option<TokenStream>,
}

/// The data of a group; None if it has points only.
pub(super) fn of(model: &Model, group: &GroupPlan) -> Option<Data> {
    let declared = &model.groups[group.group];
    let mut fields = Fields::default();
    let columns = group.columns.iter().map(|&at| column(&mut fields, &declared.columns[at])).collect();
    let terms = group.terms.iter().map(|term| &declared.terms[term.term]);
    let clouds = terms.filter(|term| matches!(term.kind, TermKind::Chamfer { .. }));
    let clouds = clouds.map(|term| (term.name.text.clone(), cloud(&mut fields, term))).collect();
    let partners = declared.paired.then(|| partners(&mut fields, model));
    if fields.definitions.is_empty() {
        return None;
    }
    let name = format_ident!("{}", declared.data_name());
    let definition = define(&name, declared, &fields.definitions);
    Some(Data { name, definition, columns, clouds, partners })
}

fn define(name: &Ident, group: &Group, fields: &[TokenStream]) -> TokenStream {
    let doc = format!(" What belongs to the points of group `{}`.", group.name.text);
    quote! {
        #[doc = #doc]
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct #name { #(#fields),* }
    }
}

/// Fields so far.
#[derive(Default)]
struct Fields {
    names: Names,
    definitions: Vec<TokenStream>,
}

impl Fields {
    /// Adds a field, under another name where the name is taken.
    fn add(&mut self, name: &Name, doc: &str) -> Ident {
        let free = raw(&self.names.free(name.text.clone()), name.span);
        self.definitions.push(quote!(#[doc = #doc] pub #free: Vec<f64>));
        free
    }
}

/// A column's values; those of a vector are taken from its one field.
fn column(fields: &mut Fields, column: &Column) -> TokenStream {
    let unit = unit_text(&column.unit);
    let docs = comment(&column.docs);
    let Some(Part { of, index, count }) = &column.part else {
        let name = fields.add(&column.name, &format!(" \\[{unit}\\]{docs}; one number for each point."));
        return quote!(data.#name);
    };
    let name = ident(of);
    if !fields.names.0.contains(&of.text) {
        let doc = format!(" \\[{unit}\\]{docs}; {count} numbers for each point, point by point.");
        fields.add(of, &doc);
    }
    quote!(::nisp::__private::component(&data.#name, #index, #count))
}

fn cloud(fields: &mut Fields, term: &Term) -> TokenStream {
    let unit = unit_text(&term.unit);
    let doc = format!(" \\[{unit}\\] The cloud that `{}` passes through, point by point.", term.equation);
    let name = fields.add(&term.name, &doc);
    quote!(data.#name)
}

fn partners(fields: &mut Fields, model: &Model) -> TokenStream {
    let coordinates: Vec<&str> = model.coordinates.iter().map(|c| c.name.text.as_str()).collect();
    let doc = format!(" Each point's partner: {}, point by point, in their declared units.", coordinates.join(", "));
    let name = fields.add(&Name { text: "partners".into(), span: Span::mixed_site() }, &doc);
    quote!(data.#name)
}
