//! Rows of shipped scenes at given states, without a network.

use nisp::schema::{Group, Jet, Origin};
use nisp::simd::Isa;
use nisp::units::Number;
use nisp::{Precision, SceneRef};
use nisp_runtime::residual::Points;

/// One point of a group, in SI units.
pub(crate) struct Point<'a> {
    pub(crate) coordinates: &'a [f64],
    pub(crate) columns: &'a [f64],
    /// A derivative of a head: its name, and the order by each coordinate.
    pub(crate) state: &'a dyn Fn(&str, &[usize]) -> f64,
}

/// Lanes that every vector length divides.
const LANES: usize = 16;

/// Rows of a group in SI units, in the order of its terms; `given` are parameters in SI units.
pub(crate) fn rows(scene: SceneRef, group: &str, given: &[(&str, f64)], point: &Point<'_>) -> Vec<f64> {
    let schema = scene.schema;
    let at = schema.groups.iter().position(|g| g.name == group).expect("a group");
    let group = &schema.groups[at];
    let scalars: Vec<f64> = schema
        .scalars
        .iter()
        .map(|scalar| match scalar.origin {
            Origin::Given(value) | Origin::Learned { start: value, .. } => {
                let given = given.iter().find(|(name, _)| *name == scalar.name).map(|(_, value)| *value);
                given.or(value.map(Number::as_si)).unwrap_or_else(|| panic!("no value for {}", scalar.name))
            }
            Origin::Literal(value) => value.as_si(),
            Origin::HeadScale(_) | Origin::SideScale { .. } => 1.0,
        })
        .collect();
    let names: Vec<&str> = schema.coordinates.iter().map(|c| c.name).collect();
    let spread = |values: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
        values.flat_map(|value| std::iter::repeat_n(value, LANES)).collect()
    };
    let jets = spread(&mut group.jets.iter().map(|jet| value(jet, schema.heads, &names, point.state)));
    let coordinates = spread(&mut point.coordinates.iter().copied());
    let columns = spread(&mut point.columns.iter().copied());
    let points = Points {
        count: 1,
        stride: LANES,
        jets: &jets,
        coordinates: &coordinates,
        columns: &columns,
        scalars: &scalars,
        seeds: &[],
    };
    let mut rows = vec![0.0; group.rows * LANES];
    let kernels = f64::kernels(&scene).expect("double precision");
    kernels[at].programs.residual(Isa::detect(), points, &mut rows);
    rows.into_iter().step_by(LANES).collect()
}

/// The value of a jet, read off its name: `w_xx + 2 w_xy`.
fn value(jet: &Jet, heads: &[nisp::schema::Head], names: &[&str], state: &dyn Fn(&str, &[usize]) -> f64) -> f64 {
    let head = &heads[jet.head];
    let parts = jet.name.split(" + ").map(|part| {
        let (factor, name) = match part.split_once(' ') {
            Some((factor, name)) => (factor.parse().expect("a number"), name),
            None => (1.0, part),
        };
        let letters = name.strip_prefix(head.name).expect("a jet is named after its head");
        let mut rest = letters.strip_prefix('_').unwrap_or(letters);
        let mut orders = vec![0; names.len()];
        while !rest.is_empty() {
            let by = names.iter().position(|name| rest.starts_with(name)).expect("a coordinate");
            orders[by] += 1;
            rest = &rest[names[by].len()..];
        }
        factor * state(head.name, &orders)
    });
    parts.sum()
}

/// What the network must deliver for a source that is kept positive by `softplus`.
pub(crate) fn before_softplus(value: f64) -> f64 {
    if value > 30.0 { value } else { value.exp_m1().max(f64::MIN_POSITIVE).ln() }
}

/// The rows of a term within those of its group.
pub(crate) fn of_term<'r>(group: &Group, term: &str, rows: &'r [f64]) -> &'r [f64] {
    let term = group.terms.iter().find(|t| t.name == term).unwrap_or_else(|| panic!("no term {term}"));
    &rows[term.first..term.first + term.rows]
}
