//! A thousand random small equations, from their text to rows and channels, against dense jets, and their adjoints against
//! tangents.

mod middle_support;

use middle_support::check::{check_dot_products, check_rows};
use middle_support::jet::Jet;
use middle_support::oracle::call;
use middle_support::{Numbers, network};
use nisp_compiler::error::Errors;
use nisp_compiler::model::{Function, Model, check};
use nisp_compiler::plan;
use nisp_compiler::syntax::parse;
use proptest::prelude::*;

/// Sets larger than this take long in dense jets, and are left to `middle_random`.
const LARGE: usize = 30;

/// Writes random equations.
struct Author {
    numbers: Numbers,
    coordinates: &'static [&'static str],
    fields: &'static [&'static str],
}

impl Author {
    fn new(seed: u64) -> Self {
        let mut author = Self { numbers: Numbers(seed), coordinates: &[], fields: &[] };
        author.coordinates = author.pick(&[&["x"], &["x", "y"], &["x", "y", "z"]]);
        author.fields = author.pick(&[&["u"], &["u", "v"]]);
        author
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        // The generator's first number after a small seed is small too.
        self.numbers.next();
        of[((self.numbers.next() + 1.0) / 2.0 * of.len() as f64) as usize % of.len()]
    }

    /// A derivative of a field of at most this order.
    fn derivative(&mut self, order: usize) -> String {
        let field = self.pick(self.fields);
        let axes: Vec<&str> = (0..1 + self.pick(&[0, 1, 2]) % order).map(|_| self.pick(self.coordinates)).collect();
        format!("d({field}, {})", axes.join(", "))
    }

    fn leaf(&mut self, order: usize) -> String {
        match self.pick(&[0, 1, 2, 3, 4, 5]) {
            0 => self.pick(&["0.5", "2", "3/4", "a", "b"]).into(),
            1 => self.pick(self.coordinates).into(),
            2 => self.pick(self.fields).into(),
            3 if order >= 2 => format!("laplacian({})", self.pick(self.fields)),
            4 if order >= 4 => format!("biharmonic({})", self.pick(self.fields)),
            _ if order >= 1 => self.derivative(order),
            _ => self.pick(self.fields).into(),
        }
    }

    /// An expression whose derivatives are of at most this order.
    fn expression(&mut self, depth: usize, order: usize) -> String {
        if depth == 0 {
            return self.leaf(order);
        }
        let part = |author: &mut Self| author.expression(depth - 1, order);
        match self.pick(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]) {
            0 => format!("({} + {})", part(self), part(self)),
            1 => format!("({} - {})", part(self), part(self)),
            2 => format!("{} * {}", part(self), part(self)),
            3 => format!("{}({})", self.pick(&["sin", "cos", "tanh"]), part(self)),
            4 => format!("exp(sin({}) / 2)", part(self)),
            5 => format!("({})^2", part(self)),
            6 => format!("{} / (2 + cos({}))", part(self), part(self)),
            7 => format!("sqrt(3 + sin({}))", part(self)),
            8 if order >= 1 => {
                let inner = self.expression(depth - 1, order - 1);
                format!("d({inner}, {})", self.pick(self.coordinates))
            }
            _ => part(self),
        }
    }

    fn module(&mut self) -> String {
        let order = self.pick(&[1, 2, 3, 4, 4]);
        let rows = 1 + self.pick(&[0, 1, 2]);
        // A derivative of each field, so that each is part of the problem.
        let terms: String = (0..rows)
            .map(|row| {
                // The fifth power cancels nothing: an equation in which everything cancels is refused.
                let kept = self.fields[0];
                format!(
                    "r{row}: {} + {} + {kept}^5 == {};",
                    self.derivative(1),
                    self.expression(3, order),
                    self.leaf(1)
                )
            })
            .collect();
        let fields: String = self.fields.iter().map(|field| format!("m_{field}: {field} == 1;")).collect();
        format!(
            "mod random {{ units: off; coordinates: {}; fields: {}; parameters: a = 1.5, b = 0.7; \
             on inside {{ {terms} }} on rim {{ {fields} }} scene solve {{ }} }}",
            self.coordinates.join(", "),
            self.fields.join(", "),
        )
    }
}

fn model_of(text: &str) -> Result<Model, String> {
    let mut errors = Errors::new();
    let tokens = text.parse().map_err(|error| format!("{error}"))?;
    let module = parse(tokens, &mut errors);
    let model = module.and_then(|module| check(&module, &[], &mut errors));
    let messages: Vec<String> = errors.faults().iter().map(|fault| fault.message.clone()).collect();
    model.filter(|_| messages.is_empty()).ok_or_else(|| messages.join("\n"))
}

proptest! {
    // Others in every run.
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_equations_are_those_of_dense_jets(seed: u64) {
        let text = Author::new(seed).module();
        let model = model_of(&text);
        prop_assert!(model.is_ok(), "{text}\n{:?}", model.err());
        let model = model.unwrap();
        let plan = plan::build(&model);
        prop_assert!(plan.is_ok(), "{text}");
        let plan = plan.unwrap();
        let checked = check_rows(&model, &plan, seed);
        prop_assert!(checked.is_ok(), "{text}\n{:?}", checked);
        let checked = check_dot_products(&model, &plan, seed);
        prop_assert!(checked.is_ok(), "{text}\n{:?}", checked);
        for group in plan.scenes.iter().flat_map(|scene| &scene.groups) {
            let set = &plan.sets[group.hidden].set;
            if set.len() <= LARGE {
                network::check(set, seed)?;
                network::check_adjoints(set, seed)?;
            }
        }
    }
}

#[test]
fn dense_jets_of_saturated_functions_are_finite() {
    for at in [-1e3, 1e3] {
        let jet = call(Function::Tanh, &Jet::affine(&[1.0], at, 2));
        assert_eq!(jet.coefficients.values().copied().collect::<Vec<f64>>(), [at.signum(), 0.0, 0.0]);
    }
}
