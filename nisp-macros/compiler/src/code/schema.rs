//! The schema of a scene: static data that the engine and `explain` read.

use proc_macro2::{Ident, Span, TokenStream};
use quote::quote;

use crate::describe;
use crate::loss::Robust;
use crate::model::{self, Model, Region, Role};
use crate::plan::{GroupPlan, Jet, Plan, RowKind, Scalar, ScenePlan, TermPlan};
use crate::symbolic::exact::to_f64;
use crate::unit::{Dimension, Unit};

/// The expression of a scene's schema.
pub(super) fn emit(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene) -> TokenStream {
    let module = &model.name.text;
    let name = &declared.name.text;
    let docs = describe::text(&declared.docs);
    let coordinates = model.coordinates.iter().zip(&plan.scale_groups).map(|(coordinate, group)| {
        let (name, unit) = (&coordinate.name.text, unit(&coordinate.unit));
        quote!(schema::Coordinate { name: #name, unit: #unit, scale_group: #group })
    });
    let heads = scene.heads.iter().map(|&at| head(&model.fields[at]));
    let scalars = scene.scalars.iter().map(|s| scalar(model, scene, declared, s));
    let mut groups: Vec<TokenStream> = scene.groups.iter().map(|g| group(model, plan, scene, declared, g)).collect();
    let outputs = groups.pop();
    let (skipped, warnings) = (&scene.skipped, &declared.warnings);
    quote! {
        schema::Scene {
            module: #module,
            name: #name,
            docs: #docs,
            coordinates: &[#(#coordinates),*],
            heads: &[#(#heads),*],
            scalars: &[#(#scalars),*],
            groups: &[#(#groups),*],
            outputs: #outputs,
            skipped: &[#(#skipped),*],
            warnings: &[#(#warnings),*],
        }
    }
}

fn head(field: &model::Field) -> TokenStream {
    let (name, unit, docs) = (&field.name.text, unit(&field.unit), describe::text(&field.docs));
    let source = field.role == Role::Source;
    let (lower, upper) = (optional(field.lower), optional(field.upper));
    let transformed = field.lower.is_some() || field.upper.is_some();
    let hard = field.hard.is_some();
    quote! {
        schema::Head {
            name: #name, unit: #unit, source: #source, lower: #lower, upper: #upper,
            transformed: #transformed, hard: #hard, docs: #docs,
        }
    }
}

fn scalar(model: &Model, scene: &ScenePlan, declared: &model::Scene, scalar: &Scalar) -> TokenStream {
    match scalar {
        Scalar::Parameter(at) => {
            let parameter = &model.parameters[*at];
            let (name, unit) = (&parameter.name.text, unit(&parameter.unit));
            let default = optional(describe::default(model, declared, *at));
            let (lower, upper) = (optional(parameter.lower), optional(parameter.upper));
            let origin = if declared.learned[*at] {
                quote!(schema::Origin::Learned { start: #default })
            } else {
                quote!(schema::Origin::Given(#default))
            };
            quote!(schema::Scalar { name: #name, unit: #unit, lower: #lower, upper: #upper, origin: #origin })
        }
        Scalar::Literal(value, dimension) => {
            let unit = si(dimension);
            quote! {
                schema::Scalar {
                    name: "",
                    unit: #unit,
                    lower: None,
                    upper: None,
                    origin: schema::Origin::Literal(units::Number::si(#value)),
                }
            }
        }
        Scalar::FieldScale(field) => {
            let unit = si(&model.fields[*field].unit.dimension);
            let head = scene.heads.iter().position(|head| head == field).unwrap_or(0);
            quote!(schema::Scalar { name: "", unit: #unit, lower: None, upper: None, origin: schema::Origin::HeadScale(#head) })
        }
        Scalar::SideScale(dimension, group, term, side) => {
            let unit = si(dimension);
            quote! {
                schema::Scalar {
                    name: "",
                    unit: #unit,
                    lower: None,
                    upper: None,
                    origin: schema::Origin::SideScale { group: #group, term: #term, side: #side },
                }
            }
        }
    }
}

fn group(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene, group: &GroupPlan) -> TokenStream {
    let source = &model.groups[group.group];
    let (name, docs, paired) = (&source.name.text, describe::text(&source.docs), source.paired);
    let held = group.held.iter().map(|site| {
        let (of, coordinates) = describe::held(*site, model);
        quote!(schema::Held { of: #of, coordinates: &[#(#coordinates),*] })
    });
    let place = source.place.as_ref().map_or_else(|| quote!(None), place);
    let set = &plan.sets[group.hidden].set;
    let channels = describe::channel_names(set, model);
    let (order, dense) = (set.order() as usize, describe::dense(set));
    let jets = group.jets.iter().map(|j| jet(model, scene, j));
    let columns = group.columns.iter().map(|&at| {
        let (name, unit) = (&source.columns[at].name.text, unit(&source.columns[at].unit));
        quote!(schema::Column { name: #name, unit: #unit })
    });
    let terms = group.terms.iter().map(|t| term(declared, group, source, t));
    let rows: usize = group.terms.iter().map(|t| t.rows).sum();
    let flops = [group.residual.flops(), group.adjoint.flops()];
    let [compose, affine, product] =
        describe::rule_flops(&plan.sets[group.hidden]).map(|[forward, back]| quote!([#forward, #back]));
    let rule_flops = quote!(schema::RuleFlops { compose: #compose, affine: #affine, product: #product });
    quote! {
        schema::Group {
            name: #name, docs: #docs, channels: &[#(#channels),*], order: #order, dense: #dense,
            jets: &[#(#jets),*], columns: &[#(#columns),*], terms: &[#(#terms),*],
            rows: #rows, place: #place, paired: #paired, held: &[#(#held),*], flops: [#(#flops),*], rule_flops: #rule_flops,
        }
    }
}

fn place(place: &model::Place) -> TokenStream {
    let portion = Ident::new(&format!("{:?}", place.portion), Span::call_site());
    let regions = place.domain.iter().map(region);
    let points = match place.points {
        Some(count) => quote!(Some(#count)),
        None => quote!(None),
    };
    quote!(Some(schema::Place { portion: schema::Portion::#portion, domain: &[#(#regions),*], points: #points }))
}

fn region(of: &Region) -> TokenStream {
    let pairs = |pairs: &[[f64; 2]]| {
        let pairs = pairs.iter().map(|[a, b]| quote!([#a, #b]));
        quote!(&[#(#pairs),*])
    };
    match of {
        Region::Box(ranges) => {
            let ranges = pairs(ranges);
            quote!(schema::Region::Box(#ranges))
        }
        Region::Ellipse { centre: [x, y], semi_axes: [a, b] } => {
            quote!(schema::Region::Ellipse { centre: [#x, #y], semi_axes: [#a, #b] })
        }
        Region::Polygon(corners) => {
            let corners = pairs(corners);
            quote!(schema::Region::Polygon(#corners))
        }
        Region::Ball { centre: [x, y, z], radius } => {
            quote!(schema::Region::Ball { centre: [#x, #y, #z], radius: #radius })
        }
        Region::Cylinder { centre: [x, y], radius, ends: [low, high] } => {
            quote!(schema::Region::Cylinder { centre: [#x, #y], radius: #radius, ends: [#low, #high] })
        }
        Region::File { kind, path, scale } => {
            let kind = Ident::new(&format!("{kind:?}"), Span::call_site());
            quote!(schema::Region::File { kind: schema::FileKind::#kind, path: #path, scale: #scale })
        }
        Region::Plus(parts) => {
            let [a, b] = parts.each_ref().map(region);
            quote!(schema::Region::Plus(&[#a, #b]))
        }
        Region::Minus(parts) => {
            let [a, b] = parts.each_ref().map(region);
            quote!(schema::Region::Minus(&[#a, #b]))
        }
    }
}

fn jet(model: &Model, scene: &ScenePlan, jet: &Jet) -> TokenStream {
    let head = jet.head;
    let name = describe::jet_name(jet, scene, model);
    let degree = describe::degree(&jet.operator, model.coordinates.len());
    let site = jet.site;
    let combination = jet.combination.iter().map(|(channel, coefficient)| {
        let coefficient = to_f64(*coefficient);
        quote!((#channel, #coefficient))
    });
    let operator = jet.operator.terms().map(|(index, &coefficient)| {
        let (index, coefficient) = (index.iter().map(|&n| n as u8), to_f64(coefficient));
        quote!((&[#(#index),*], #coefficient))
    });
    quote! {
        schema::Jet {
            head: #head, name: #name, degree: &[#(#degree),*], combination: &[#(#combination),*],
            operator: &[#(#operator),*], site: #site,
        }
    }
}

fn term(declared: &model::Scene, group: &GroupPlan, source: &model::Group, plan: &TermPlan) -> TokenStream {
    let term = &source.terms[plan.term];
    let (name, equation, latex, unit) = (&term.name.text, &term.equation, &term.latex, unit(&term.unit));
    let kind = match plan.kind {
        RowKind::Residual => quote!(schema::TermKind::Residual),
        RowKind::Observation => quote!(schema::TermKind::Observation),
        RowKind::Integral(_) => quote!(schema::TermKind::Integral),
        RowKind::Chamfer { symmetric, plane } => {
            let components = describe::components(source, plan);
            quote!(schema::TermKind::Chamfer { symmetric: #symmetric, plane: #plane, components: &[#(#components),*] })
        }
    };
    let loss = match plan.loss {
        None => quote!(schema::Loss::Square),
        Some(Robust { variant, threshold }) => {
            let variant = Ident::new(variant, Span::call_site());
            quote!(schema::Loss::#variant(#threshold))
        }
    };
    let weight = declared.weights[group.group][plan.term];
    let within = optional(term.within);
    let measure = match &term.kind {
        model::TermKind::Integral { measure: Some(measure), .. } => {
            let measure = self::unit(measure);
            quote!(Some(#measure))
        }
        _ => quote!(None),
    };
    let columns = describe::observed(group, source, plan);
    let (first, rows, jets) = (plan.first, plan.rows, &plan.jets);
    let (known, bound) = (plan.known, describe::is_bound(source, plan));
    quote! {
        schema::Term {
            name: #name, equation: #equation, latex: #latex, unit: #unit, kind: #kind, loss: #loss,
            weight: #weight, within: #within, measure: #measure, first: #first, rows: #rows,
            jets: &[#(#jets),*], columns: &[#(#columns),*], known: #known, bound: #bound,
        }
    }
}

/// A unit as the schema holds it.
pub(super) fn unit(unit: &Unit) -> TokenStream {
    let exponents = unit.dimension.0.iter().map(|&e| to_f64(e));
    let (factor, text) = (unit.factor.factor(), &unit.text);
    quote!(schema::Unit { exponents: [#(#exponents),*], factor: units::Scale::new(#factor), text: #text })
}

fn si(dimension: &Dimension) -> TokenStream {
    unit(&Unit::si(dimension.clone()))
}

/// A number in SI units, where there is one.
fn optional(value: Option<f64>) -> TokenStream {
    value.map_or_else(|| quote!(None), |value| quote!(Some(units::Number::si(#value))))
}
