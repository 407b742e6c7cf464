//! Values of model expressions by jet arithmetic: no symbolic differentiation, no sharing, no simplification.

use nisp_compiler::model::{Expr, Function, Node};

use super::jet::Jet;

/// What an expression reads.
#[derive(Clone, Debug)]
pub(crate) struct World {
    /// Taylor jets of the fields at the point and at its partner.
    pub(crate) fields: [Vec<Jet>; 2],
    /// Coordinates of the point, then of its partner.
    pub(crate) point: Vec<f64>,
    pub(crate) parameters: Vec<f64>,
    pub(crate) columns: Vec<f64>,
    pub(crate) degree: u32,
}

impl World {
    fn constant(&self, value: f64) -> Jet {
        Jet::affine(&vec![0.0; self.point.len() / 2], value, self.degree)
    }

    /// The value of an expression.
    pub(crate) fn value(&self, expression: &Expr) -> f64 {
        self.jet(expression, 0).value()
    }

    pub(crate) fn jet(&self, expression: &Expr, site: usize) -> Jet {
        let dimensions = self.point.len() / 2;
        match &**expression {
            Node::Number(r) => self.constant(*r.numer() as f64 / *r.denom() as f64),
            Node::Real(x) | Node::Quantity(x, _) => self.constant(*x),
            Node::Coordinate(i) => {
                let mut direction = vec![0.0; dimensions];
                direction[*i] = 1.0;
                Jet::affine(&direction, self.point[i + site * dimensions], self.degree)
            }
            Node::Field(i) => self.fields[site][*i].clone(),
            Node::Parameter(i) => self.constant(self.parameters[*i]),
            Node::Column(i) => self.constant(self.columns[*i]),
            Node::Add(parts) => parts.iter().fold(self.constant(0.0), |sum, e| sum.plus(&self.jet(e, site))),
            Node::Mul(parts) => parts.iter().fold(self.constant(1.0), |p, e| p.times(&self.jet(e, site))),
            Node::Div(a, b) => self.jet(a, site).times(&power(&self.jet(b, site), -1.0)),
            Node::Pow(a, e) => power(&self.jet(a, site), *e.numer() as f64 / *e.denom() as f64),
            Node::Call(f, a) => call(*f, &self.jet(a, site)),
            Node::Derivative(a, i) => derivative(&self.jet(a, site), *i),
            Node::Partner(a) => self.jet(a, 1 - site),
            Node::Power(..) | Node::Min(..) | Node::Max(..) => panic!("the oracle does not know {expression:?}"),
        }
    }
}

pub(crate) fn power(x: &Jet, exponent: f64) -> Jet {
    let mut factor = 1.0;
    let derivatives: Vec<f64> = (0..=x.degree)
        .map(|n| {
            let value = factor * x.value().powf(exponent - f64::from(n));
            factor *= exponent - f64::from(n);
            if factor == 0.0 && value.is_nan() { 0.0 } else { value }
        })
        .collect();
    x.compose(&derivatives)
}

pub(crate) fn call(f: Function, x: &Jet) -> Jet {
    let (v, one) = (x.value(), Jet::affine(&vec![0.0; x.coordinates], 1.0, x.degree));
    let cycle = |values: [f64; 4]| (0..=x.degree as usize).map(|n| values[n % 4]).collect::<Vec<f64>>();
    match f {
        Function::Sin => x.compose(&cycle([v.sin(), v.cos(), -v.sin(), -v.cos()])),
        Function::Cos => x.compose(&cycle([v.cos(), -v.sin(), -v.cos(), v.sin()])),
        Function::Exp => x.compose(&cycle([v.exp(); 4])),
        Function::Sqrt => power(x, 0.5),
        Function::Ln => {
            let mut derivatives = vec![v.ln()];
            let mut factor = 1.0;
            for n in 1..=x.degree {
                derivatives.push(factor / v.powi(n as i32));
                factor *= -f64::from(n);
            }
            x.compose(&derivatives)
        }
        Function::Softplus => call(Function::Ln, &one.plus(&call(Function::Exp, x))),
        // The exponential of a large number overflows.
        Function::Sigmoid if v < 0.0 => {
            let growing = call(Function::Exp, x);
            growing.times(&power(&one.plus(&growing), -1.0))
        }
        Function::Sigmoid => power(&one.plus(&call(Function::Exp, &x.scale(-1.0))), -1.0),
        Function::Tanh => call(Function::Sigmoid, &x.scale(2.0)).scale(2.0).plus(&one.scale(-1.0)),
        other => panic!("the oracle does not know {other:?}"),
    }
}

fn derivative(x: &Jet, i: usize) -> Jet {
    let mut result = x.clone();
    result.coefficients.clear();
    for (index, c) in &x.coefficients {
        if index[i] > 0 {
            let mut lower = index.clone();
            lower[i] -= 1;
            result.coefficients.insert(lower, c * f64::from(index[i]));
        }
    }
    result.coefficients.entry(vec![0; x.coordinates]).or_insert(0.0);
    result
}
