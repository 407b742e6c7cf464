//! Models built by hand, so that the middle stages are tested without the front end.

use std::rc::Rc;

use nisp_compiler::model::{
    Column, Coordinate, Expr, Field, Function, Group, Model, Name, Node, Parameter, Role, Scene, Term, TermKind,
};
use nisp_compiler::rational::ratio;
use nisp_compiler::unit::frame::Scale;
use nisp_compiler::unit::{Dimension, Unit};
use proc_macro2::Span;

pub(crate) const NONE: [i128; 3] = [0, 0, 0];
pub(crate) const LENGTH: [i128; 3] = [1, 0, 0];
pub(crate) const TIME: [i128; 3] = [0, 0, 1];
pub(crate) const PRESSURE: [i128; 3] = [-1, 1, -2];
pub(crate) const FORCE: [i128; 3] = [1, 1, -2];

pub(crate) fn name(text: &str) -> Name {
    Name { text: text.to_owned(), span: Span::call_site() }
}

/// Exponents of metre, kilogram, second.
pub(crate) fn dimension(exponents: [i128; 3]) -> Dimension {
    let mut dimension = Dimension::default();
    for (slot, exponent) in dimension.0.iter_mut().zip(exponents) {
        *slot = ratio(exponent, 1);
    }
    dimension
}

pub(crate) fn unit(exponents: [i128; 3]) -> Unit {
    Unit { dimension: dimension(exponents), factor: Scale::new(1.0), text: String::new() }
}

pub(crate) fn n(value: i128) -> Expr {
    Rc::new(Node::Number(ratio(value, 1)))
}
pub(crate) fn q(value: f64, exponents: [i128; 3]) -> Expr {
    Rc::new(Node::Quantity(value, dimension(exponents)))
}
pub(crate) fn coordinate(i: usize) -> Expr {
    Rc::new(Node::Coordinate(i))
}
pub(crate) fn field(i: usize) -> Expr {
    Rc::new(Node::Field(i))
}
pub(crate) fn parameter(i: usize) -> Expr {
    Rc::new(Node::Parameter(i))
}
pub(crate) fn column(i: usize) -> Expr {
    Rc::new(Node::Column(i))
}
pub(crate) fn add(parts: &[&Expr]) -> Expr {
    Rc::new(Node::Add(parts.iter().map(|&e| e.clone()).collect()))
}
pub(crate) fn mul(parts: &[&Expr]) -> Expr {
    Rc::new(Node::Mul(parts.iter().map(|&e| e.clone()).collect()))
}
pub(crate) fn neg(a: &Expr) -> Expr {
    mul(&[&n(-1), a])
}
pub(crate) fn sub(a: &Expr, b: &Expr) -> Expr {
    add(&[a, &neg(b)])
}
pub(crate) fn div(a: &Expr, b: &Expr) -> Expr {
    Rc::new(Node::Div(a.clone(), b.clone()))
}
pub(crate) fn pow(a: &Expr, exponent: i128) -> Expr {
    Rc::new(Node::Pow(a.clone(), ratio(exponent, 1)))
}
pub(crate) fn call(f: Function, a: &Expr) -> Expr {
    Rc::new(Node::Call(f, a.clone()))
}
/// Derivatives by several coordinates, one after the other.
pub(crate) fn d(a: &Expr, by: &[usize]) -> Expr {
    by.iter().fold(a.clone(), |e, &i| Rc::new(Node::Derivative(e, i)))
}

/// An empty model with these coordinates.
pub(crate) fn model(coordinates: &[(&str, [i128; 3])]) -> Model {
    let coordinate =
        |&(text, exponents): &(&str, _)| Coordinate { name: name(text), unit: unit(exponents), docs: Vec::new() };
    Model {
        name: name("m"),
        visibility: Default::default(),
        docs: Vec::new(),
        coordinates: coordinates.iter().map(coordinate).collect(),
        fields: Vec::new(),
        parameters: Vec::new(),
        constants: Vec::new(),
        definitions: Vec::new(),
        groups: Vec::new(),
        questions: Vec::new(),
        scenes: Vec::new(),
        units_checked: true,
        warnings: Vec::new(),
    }
}

pub(crate) trait Build {
    fn field(&mut self, text: &str, exponents: [i128; 3]) -> Expr;
    fn bounded(&mut self, text: &str, exponents: [i128; 3], lower: Option<f64>, upper: Option<f64>) -> Expr;
    fn parameter(&mut self, text: &str, exponents: [i128; 3]) -> Expr;
    fn group(&mut self, text: &str, columns: usize, terms: Vec<(&str, TermKind)>);
    fn scene(&mut self) -> &mut Scene;
}

impl Build for Model {
    fn field(&mut self, text: &str, exponents: [i128; 3]) -> Expr {
        self.bounded(text, exponents, None, None)
    }

    fn bounded(&mut self, text: &str, exponents: [i128; 3], lower: Option<f64>, upper: Option<f64>) -> Expr {
        let unit = unit(exponents);
        let role = Role::Field;
        self.fields.push(Field {
            name: name(text),
            role,
            unit,
            held: 0,
            lower,
            upper,
            hard: None,
            part: None,
            docs: Vec::new(),
        });
        field(self.fields.len() - 1)
    }

    fn parameter(&mut self, text: &str, exponents: [i128; 3]) -> Expr {
        let unit = unit(exponents);
        let (default, lower, upper) = (None, None, None);
        self.parameters.push(Parameter {
            name: name(text),
            unit,
            default,
            lower,
            upper,
            part: None,
            spread: None,
            docs: Vec::new(),
        });
        parameter(self.parameters.len() - 1)
    }

    fn group(&mut self, text: &str, columns: usize, terms: Vec<(&str, TermKind)>) {
        let column = |i| Column { name: name(&format!("c{i}")), unit: unit(NONE), part: None, docs: Vec::new() };
        let term = |(text, kind)| Term {
            name: name(text),
            kind,
            loss: None,
            weight: 1.0,
            within: None,
            unit: unit(NONE),
            equation: String::new(),
            latex: String::new(),
            docs: Vec::new(),
        };
        self.groups.push(Group {
            name: name(text),
            columns: (0..columns).map(column).collect(),
            terms: terms.into_iter().map(term).collect(),
            place: None,
            paired: false,
            definitions: Vec::new(),
            docs: Vec::new(),
        });
    }

    /// A scene that uses everything; call it when all else is declared.
    fn scene(&mut self) -> &mut Scene {
        self.scenes.push(Scene {
            name: name("all"),
            uses: self.groups.iter().map(|group| vec![true; group.terms.len()]).collect(),
            fixed_fields: vec![None; self.fields.len()],
            fixed_parameters: vec![None; self.parameters.len()],
            learned: vec![false; self.parameters.len()],
            spreads: vec![None; self.parameters.len()],
            warnings: Vec::new(),
            weights: self.groups.iter().map(|group| vec![1.0; group.terms.len()]).collect(),
            docs: Vec::new(),
        });
        self.scenes.last_mut().unwrap()
    }
}

/// The double pendulum on a cart: fields q, psi, phi, source f; one group of residuals and one of observations.
pub(crate) fn pendulum() -> Model {
    let mut m = model(&[("t", TIME)]);
    let (q, psi, phi) = (m.field("q", LENGTH), m.field("psi", NONE), m.field("phi", NONE));
    let f = m.field("f", FORCE);
    let h: Vec<Expr> = (1..=8).map(|i| m.parameter(&format!("h{i}"), NONE)).collect();
    let h = |i: usize| &h[i - 1];
    let (tt, sin, cos) =
        (|e: &Expr| d(e, &[0, 0]), |e: &Expr| call(Function::Sin, e), |e: &Expr| call(Function::Cos, e));
    let dot2 = |e: &Expr| pow(&d(e, &[0]), 2);
    let apart = sub(&psi, &phi);
    let swing = |e: &Expr| sub(&mul(&[&tt(e), &cos(e)]), &mul(&[&dot2(e), &sin(e)]));
    let cart = add(&[&mul(&[h(1), &tt(&q)]), &mul(&[h(2), &swing(&psi)]), &mul(&[h(3), &swing(&phi)]), &neg(&f)]);
    let first = add(&[
        &mul(&[h(2), &tt(&q), &cos(&psi)]),
        &mul(&[h(4), &tt(&psi)]),
        &mul(&[h(5), &add(&[&mul(&[&tt(&phi), &cos(&apart)]), &mul(&[&dot2(&phi), &sin(&apart)])])]),
        &neg(&mul(&[h(7), &sin(&psi)])),
    ]);
    let second = add(&[
        &mul(&[h(3), &tt(&q), &cos(&phi)]),
        &mul(&[h(5), &sub(&mul(&[&tt(&psi), &cos(&apart)]), &mul(&[&dot2(&psi), &sin(&apart)]))]),
        &mul(&[h(6), &tt(&phi)]),
        &neg(&mul(&[h(8), &sin(&phi)])),
    ]);
    let residuals = [("cart", cart), ("first", first), ("second", second)];
    m.group("motion", 0, residuals.map(|(text, e)| (text, TermKind::Residual(vec![e]))).into());
    let observed = [("q", q), ("psi", psi), ("phi", phi)];
    let observe = |(i, (text, e)): (usize, (&'static str, Expr))| {
        (text, TermKind::Observation { rows: vec![sub(&e, &column(i))], columns: vec![i] })
    };
    m.group("samples", 3, observed.into_iter().enumerate().map(observe).collect());
    m.scene();
    m
}

/// The von Karman membrane: fields u, v, w, source f >= 0; scenes with and without the source.
pub(crate) fn membrane() -> Model {
    let mut m = model(&[("alpha", LENGTH), ("beta", LENGTH)]);
    let (u, v, w) = (m.field("u", LENGTH), m.field("v", LENGTH), m.field("w", LENGTH));
    let f = m.bounded("f", PRESSURE, Some(0.0), None);
    let (e, nu, t, p) =
        (m.parameter("E", PRESSURE), m.parameter("nu", NONE), m.parameter("t", LENGTH), m.parameter("p", PRESSURE));
    let rest = sub(&n(1), &pow(&nu, 2));
    let bending = div(&mul(&[&e, &pow(&t, 3)]), &mul(&[&n(12), &rest]));
    let stretching = div(&mul(&[&e, &t]), &rest);
    let half = |x: &Expr| div(x, &n(2));
    let e_aa = add(&[&d(&u, &[0]), &half(&pow(&d(&w, &[0]), 2))]);
    let e_bb = add(&[&d(&v, &[1]), &half(&pow(&d(&w, &[1]), 2))]);
    let e_ab = half(&add(&[&d(&u, &[1]), &d(&v, &[0]), &mul(&[&d(&w, &[0]), &d(&w, &[1])])]));
    let n_a = mul(&[&stretching, &add(&[&e_aa, &mul(&[&nu, &e_bb])])]);
    let n_b = mul(&[&stretching, &add(&[&e_bb, &mul(&[&nu, &e_aa])])]);
    let n_ab = mul(&[&stretching, &sub(&n(1), &nu), &e_ab]);
    let biharmonic = add(&[&d(&w, &[0, 0, 0, 0]), &mul(&[&n(2), &d(&w, &[0, 0, 1, 1])]), &d(&w, &[1, 1, 1, 1])]);
    let pull =
        add(&[&mul(&[&n_a, &d(&w, &[0, 0])]), &mul(&[&n(2), &n_ab, &d(&w, &[0, 1])]), &mul(&[&n_b, &d(&w, &[1, 1])])]);
    let balance = add(&[&mul(&[&bending, &biharmonic]), &neg(&pull), &neg(&p), &f]);
    let inplane = |x: &Expr, y: &Expr| TermKind::Residual(vec![add(&[&d(x, &[0]), &d(y, &[1])])]);
    let point = vec![add(&[&coordinate(0), &u]), add(&[&coordinate(1), &v]), w.clone()];
    m.group(
        "interior",
        0,
        vec![
            ("balance", TermKind::Residual(vec![balance])),
            ("inplane_a", inplane(&n_a, &n_ab)),
            ("inplane_b", inplane(&n_ab, &n_b)),
            ("cloud", TermKind::Chamfer { point, names: Vec::new(), symmetric: false, plane: false }),
        ],
    );
    m.group("rim", 0, vec![("clamp", TermKind::Residual(vec![u, v, w])), ("no_contact", TermKind::Residual(vec![f]))]);
    m.scene();
    let identify = m.scene();
    identify.fixed_fields[3] = Some(q(0.0, PRESSURE));
    identify.learned[0] = true;
    identify.uses[1][1] = false;
    m
}

/// The RLC circuit, with its source's derivative on the right: `v'' + 7 v' + 10 v = f' + 6 f`.
pub(crate) fn rlc() -> Model {
    let mut m = model(&[("t", TIME)]);
    let (v, f) = (m.field("v", NONE), m.field("f", NONE));
    let rate = |value: f64| q(value, [0, 0, -1]);
    let left = add(&[&d(&v, &[0, 0]), &mul(&[&rate(7.0), &d(&v, &[0])]), &mul(&[&q(10.0, [0, 0, -2]), &v])]);
    let right = mul(&[&rate(1.0), &add(&[&d(&f, &[0]), &mul(&[&rate(6.0), &f])])]);
    m.group("circuit", 0, vec![("balance", TermKind::Residual(vec![sub(&left, &right)]))]);
    m.group("samples", 1, vec![("v", TermKind::Observation { rows: vec![sub(&v, &column(0))], columns: vec![0] })]);
    m.scene();
    m
}

/// Linear elasticity in three dimensions with Lame parameters; equilibrium inside, traction on a face with normals
/// from columns, the net force as an integral.
pub(crate) fn elasticity() -> Model {
    let mut m = model(&[("x", LENGTH), ("y", LENGTH), ("z", LENGTH)]);
    let u: Vec<Expr> = ["u", "v", "w"].map(|text| m.field(text, LENGTH)).into();
    let f = m.bounded("f", PRESSURE, Some(0.0), None);
    let (lambda, mu) = (m.parameter("lambda", PRESSURE), m.parameter("mu", PRESSURE));
    let strain = |i: usize, j: usize| div(&add(&[&d(&u[i], &[j]), &d(&u[j], &[i])]), &n(2));
    let trace = add(&[&strain(0, 0), &strain(1, 1), &strain(2, 2)]);
    let stress = |i: usize, j: usize| {
        let shear = mul(&[&n(2), &mu, &strain(i, j)]);
        if i == j { add(&[&mul(&[&lambda, &trace]), &shear]) } else { shear }
    };
    let sum = |term: &dyn Fn(usize) -> Expr| add(&[&term(0), &term(1), &term(2)]);
    let equilibrium = (0..3).map(|i| sum(&|j| d(&stress(i, j), &[j]))).collect();
    let traction: Vec<Expr> =
        (0..3).map(|i| add(&[&sum(&|j| mul(&[&stress(i, j), &column(j)])), &mul(&[&f, &column(i)])])).collect();
    let target = (0..3).map(|i| q(f64::from(i), FORCE)).collect();
    m.group("inside", 0, vec![("equilibrium", TermKind::Residual(equilibrium))]);
    m.group(
        "face",
        3,
        vec![
            ("traction", TermKind::Residual(traction.clone())),
            ("force", TermKind::Integral { integrand: traction, target, measure: None }),
        ],
    );
    m.scene().learned = vec![true, true];
    m
}
