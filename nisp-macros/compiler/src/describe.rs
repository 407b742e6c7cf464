//! What is said of a plan in names and counts, for whatever puts it into a schema: emitted tokens, or an interpreter.

use crate::channels::{ChannelSet, Operator};
use crate::model::{Group, Model, Scene, TermKind};
use crate::plan::{GroupPlan, Jet, ScenePlan, SetPlan, TermPlan};
use crate::rational::Rational;
use crate::symbolic::site::Site;

/// Channels as people write them: `1`, `x`, `xx`, `xxx + xyy`.
pub fn channel_names(set: &ChannelSet, model: &Model) -> Vec<String> {
    set.basis.iter().map(|operator| operator_name(operator, model, "")).collect()
}

/// An operator by its coordinates, each part behind `prefix`: `w_xxx + 2 w_xyy`.
fn operator_name(operator: &Operator, model: &Model, prefix: &str) -> String {
    let mut name = String::new();
    for (at, (index, &coefficient)) in operator.terms().enumerate() {
        let letters: String = index
            .iter()
            .zip(&model.coordinates)
            .flat_map(|(&n, coordinate)| std::iter::repeat_n(coordinate.name.text.as_str(), n as usize))
            .collect();
        let letters = if letters.is_empty() { String::from("1") } else { letters };
        if at > 0 {
            name.push_str(" + ");
        }
        if coefficient != Rational::from_integer(1) {
            name.push_str(&format!("{coefficient} "));
        }
        name.push_str(prefix);
        name.push_str(&letters);
    }
    name
}

/// A site at which coordinates are held: 0 for the point or 1 for its partner, and the coordinates.
pub fn held(site: Site, model: &Model) -> (usize, Vec<usize>) {
    (usize::from(site.partner), (0..model.coordinates.len()).filter(|&at| site.holds(at)).collect())
}

/// What a group reads of a head, as people write it: `w`, `w_xx`.
pub fn jet_name(jet: &Jet, scene: &ScenePlan, model: &Model) -> String {
    let field = &model.fields[scene.heads[jet.head]].name.text;
    match jet.operator.degree() {
        0 => field.clone(),
        _ => operator_name(&jet.operator, model, &format!("{field}_")),
    }
}

/// Degree of an operator per coordinate. All terms of a collapsed operator have the same degree within a scale group,
/// so that any of them stands for all.
pub fn degree(operator: &Operator, coordinates: usize) -> Vec<u8> {
    operator.terms().next().map_or_else(|| vec![0; coordinates], |(index, _)| index.iter().map(|&n| n as u8).collect())
}

/// Channels of a dense jet of the order of a set.
pub fn dense(set: &ChannelSet) -> usize {
    let (order, coordinates) = (set.order() as usize, set.coordinates);
    (1..=order).fold(1, |product, i| product * (coordinates + i) / i)
}

/// Floating-point operations of a set's rules, forward and back: of a composition, an affine map, a product.
pub fn rule_flops(rules: &SetPlan) -> [[usize; 2]; 3] {
    // The way back computes a layer anew; an affine map's channels are kept.
    let again = |forward: usize, adjoint: usize| [forward, forward + adjoint];
    [
        again(rules.compose.flops(), rules.compose_adjoint.flops()),
        [rules.affine.flops(), rules.affine_adjoint.flops()],
        again(rules.product.flops(), rules.product_adjoint.flops()),
    ]
}

/// Of an observation, the column that each row compares with, by its place among the columns that the group reads.
pub fn observed(group: &GroupPlan, source: &Group, term: &TermPlan) -> Vec<usize> {
    match &source.terms[term.term].kind {
        TermKind::Observation { columns, .. } => {
            columns.iter().filter_map(|at| group.columns.iter().position(|own| own == at)).collect()
        }
        _ => Vec::new(),
    }
}

/// True for inequalities and complementarities.
pub fn is_bound(source: &Group, term: &TermPlan) -> bool {
    matches!(source.terms[term.term].kind, TermKind::Inequality(_) | TermKind::Complementarity { .. })
}

/// Of a cloud, what the coordinates of its points are called; nothing where they are not written one by one.
pub fn components<'a>(source: &'a Group, term: &TermPlan) -> &'a [String] {
    match &source.terms[term.term].kind {
        TermKind::Chamfer { names, .. } => names,
        _ => &[],
    }
}

/// The declared value of a parameter in a scene, in SI units.
pub fn default(model: &Model, scene: &Scene, parameter: usize) -> Option<f64> {
    scene.fixed_parameters[parameter].or(model.parameters[parameter].default)
}

/// Lines of documentation as one text.
pub fn text(docs: &[String]) -> String {
    docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n")
}
