//! A scene's schema from its plan, as static data: what emitted code holds as constants.
//!
//! An equation that was read lives as long as the program, as a compiled one does, so that its schema is leaked once.

use nisp_compiler::describe;
use nisp_compiler::model::{self, Model, Role};
use nisp_compiler::plan::{self, GroupPlan, Plan, RowKind, ScenePlan, TermPlan};
use nisp_compiler::symbolic::exact::to_f64;
use nisp_compiler::unit;
use nisp_compiler::unit::frame::Number;
use nisp_runtime::schema::{
    Column, Coordinate, FileKind, Group, Head, Held, Jet, Loss, Origin, Place, Portion, Region, RuleFlops, Scalar,
    Scene, Term, TermKind, Unit,
};

/// The schema of a scene.
pub(crate) fn of(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene) -> &'static Scene {
    let coordinates = model.coordinates.iter().zip(&plan.scale_groups);
    let coordinates = coordinates.map(|(coordinate, &scale_group)| Coordinate {
        name: text(&coordinate.name.text),
        unit: self::unit(&coordinate.unit),
        scale_group,
    });
    let mut groups: Vec<Group> = scene.groups.iter().map(|g| group(model, plan, scene, declared, g)).collect();
    let outputs = groups.pop().expect("the compiler adds the group of outputs to every scene");
    Box::leak(Box::new(Scene {
        module: text(&model.name.text),
        name: text(&declared.name.text),
        docs: text(&describe::text(&declared.docs)),
        coordinates: list(coordinates),
        heads: list(scene.heads.iter().map(|&at| head(&model.fields[at]))),
        scalars: list(scene.scalars.iter().map(|s| scalar(model, scene, declared, s))),
        groups: list(groups),
        outputs,
        skipped: list(scene.skipped.iter().map(|line| text(line))),
        warnings: list(declared.warnings.iter().map(|line| text(line))),
    }))
}

fn text(text: &str) -> &'static str {
    String::leak(text.into())
}

fn list<T>(items: impl IntoIterator<Item = T>) -> &'static [T] {
    Vec::leak(items.into_iter().collect())
}

fn head(field: &model::Field) -> Head {
    Head {
        name: text(&field.name.text),
        unit: unit(&field.unit),
        source: field.role == Role::Source,
        lower: field.lower.map(Number::si),
        upper: field.upper.map(Number::si),
        transformed: field.lower.is_some() || field.upper.is_some(),
        hard: field.hard.is_some(),
        docs: text(&describe::text(&field.docs)),
    }
}

fn scalar(model: &Model, scene: &ScenePlan, declared: &model::Scene, scalar: &plan::Scalar) -> Scalar {
    let unnamed = |unit: unit::Unit, origin: Origin| Scalar {
        name: "",
        unit: self::unit(&unit),
        lower: None,
        upper: None,
        origin,
    };
    match scalar {
        plan::Scalar::Parameter(at) => {
            let parameter = &model.parameters[*at];
            let value = describe::default(model, declared, *at).map(Number::si);
            Scalar {
                name: text(&parameter.name.text),
                unit: unit(&parameter.unit),
                lower: parameter.lower.map(Number::si),
                upper: parameter.upper.map(Number::si),
                origin: if declared.learned[*at] { Origin::Learned { start: value } } else { Origin::Given(value) },
            }
        }
        plan::Scalar::Literal(value, dimension) => {
            unnamed(unit::Unit::si(dimension.clone()), Origin::Literal(Number::si(*value)))
        }
        plan::Scalar::FieldScale(field) => {
            let head = scene.heads.iter().position(|head| head == field).unwrap_or(0);
            unnamed(unit::Unit::si(model.fields[*field].unit.dimension.clone()), Origin::HeadScale(head))
        }
        plan::Scalar::SideScale(dimension, group, term, side) => {
            unnamed(unit::Unit::si(dimension.clone()), Origin::SideScale { group: *group, term: *term, side: *side })
        }
    }
}

fn group(model: &Model, plan: &Plan, scene: &ScenePlan, declared: &model::Scene, group: &GroupPlan) -> Group {
    let source = &model.groups[group.group];
    let set = &plan.sets[group.hidden].set;
    let [compose, affine, product] = describe::rule_flops(&plan.sets[group.hidden]);
    Group {
        name: text(&source.name.text),
        docs: text(&describe::text(&source.docs)),
        channels: list(describe::channel_names(set, model).iter().map(|name| text(name))),
        order: set.order() as usize,
        dense: describe::dense(set),
        jets: list(group.jets.iter().map(|j| jet(model, scene, j))),
        columns: list(
            group
                .columns
                .iter()
                .map(|&at| Column { name: text(&source.columns[at].name.text), unit: unit(&source.columns[at].unit) }),
        ),
        terms: list(group.terms.iter().map(|t| term(declared, group, source, t))),
        rows: group.terms.iter().map(|term| term.rows).sum(),
        place: source.place.as_ref().map(place),
        paired: source.paired,
        held: list(group.held.iter().map(|site| {
            let (of, coordinates) = describe::held(*site, model);
            Held { of, coordinates: list(coordinates) }
        })),
        flops: [group.residual.flops(), group.adjoint.flops()],
        rule_flops: RuleFlops { compose, affine, product },
    }
}

fn place(place: &model::Place) -> Place {
    let portion = match place.portion {
        model::Portion::Inside => Portion::Inside,
        model::Portion::Boundary => Portion::Boundary,
        model::Portion::Start => Portion::Start,
        model::Portion::End => Portion::End,
    };
    Place { portion, domain: list(place.domain.iter().map(region)), points: place.points }
}

fn region(of: &model::Region) -> Region {
    match of {
        model::Region::Box(ranges) => Region::Box(list(ranges.iter().copied())),
        model::Region::Ellipse { centre, semi_axes } => Region::Ellipse { centre: *centre, semi_axes: *semi_axes },
        model::Region::Polygon(corners) => Region::Polygon(list(corners.iter().copied())),
        model::Region::Ball { centre, radius } => Region::Ball { centre: *centre, radius: *radius },
        model::Region::Cylinder { centre, radius, ends } => {
            Region::Cylinder { centre: *centre, radius: *radius, ends: *ends }
        }
        model::Region::File { kind, path, scale } => {
            let kind = match kind {
                model::FileKind::Polygon => FileKind::Polygon,
                model::FileKind::Solid => FileKind::Solid,
            };
            Region::File { kind, path: text(path), scale: *scale }
        }
        model::Region::Plus(parts) => Region::Plus(Box::leak(Box::new(parts.each_ref().map(region)))),
        model::Region::Minus(parts) => Region::Minus(Box::leak(Box::new(parts.each_ref().map(region)))),
    }
}

fn jet(model: &Model, scene: &ScenePlan, jet: &plan::Jet) -> Jet {
    let operator = jet.operator.terms().map(|(index, &coefficient)| {
        let index: &'static [u8] = list(index.iter().map(|&n| n as u8));
        (index, to_f64(coefficient))
    });
    Jet {
        head: jet.head,
        name: text(&describe::jet_name(jet, scene, model)),
        degree: list(describe::degree(&jet.operator, model.coordinates.len())),
        combination: list(jet.combination.iter().map(|(channel, coefficient)| (*channel, to_f64(*coefficient)))),
        operator: list(operator),
        site: jet.site,
    }
}

fn term(declared: &model::Scene, group: &GroupPlan, source: &model::Group, plan: &TermPlan) -> Term {
    let term = &source.terms[plan.term];
    let measure = match &term.kind {
        model::TermKind::Integral { measure: Some(measure), .. } => Some(unit(measure)),
        _ => None,
    };
    Term {
        name: text(&term.name.text),
        equation: text(&term.equation),
        latex: text(&term.latex),
        unit: unit(&term.unit),
        kind: match plan.kind {
            RowKind::Residual => TermKind::Residual,
            RowKind::Observation => TermKind::Observation,
            RowKind::Integral(_) => TermKind::Integral,
            RowKind::Chamfer { symmetric, plane } => {
                let components = list(describe::components(source, plan).iter().map(|name| text(name)));
                TermKind::Chamfer { symmetric, plane, components }
            }
        },
        loss: plan.loss.map_or(Loss::Square, |loss| {
            Loss::named(loss.variant, loss.threshold).expect("the runtime has every loss that the compiler names")
        }),
        weight: declared.weights[group.group][plan.term],
        within: term.within.map(Number::si),
        measure,
        first: plan.first,
        rows: plan.rows,
        jets: list(plan.jets.iter().copied()),
        columns: list(describe::observed(group, source, plan)),
        known: plan.known,
        bound: describe::is_bound(source, plan),
    }
}

fn unit(unit: &unit::Unit) -> Unit {
    Unit { exponents: unit.dimension.0.map(to_f64), factor: unit.factor, text: text(&unit.text) }
}
