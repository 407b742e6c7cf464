//! A dense Taylor jet, written plainly: the oracle for channel rules. Coefficients are `partial / index!`.

use std::collections::BTreeMap;

use nisp_compiler::channels::Operator;

/// Taylor coefficients of all orders up to `degree`.
#[derive(Clone, Debug)]
pub(crate) struct Jet {
    pub(crate) coordinates: usize,
    pub(crate) degree: u32,
    pub(crate) coefficients: BTreeMap<Vec<u32>, f64>,
}

impl Jet {
    /// Random coefficients.
    pub(crate) fn random(coordinates: usize, degree: u32, numbers: &mut super::Numbers) -> Self {
        let coefficients = super::dense(coordinates, degree).into_iter().map(|index| (index, numbers.next())).collect();
        Self { coordinates, degree, coefficients }
    }

    /// `w . x + b` at the origin.
    pub(crate) fn affine(weights: &[f64], bias: f64, degree: u32) -> Self {
        let mut coefficients = BTreeMap::from([(vec![0; weights.len()], bias)]);
        for (i, &weight) in weights.iter().enumerate() {
            let mut index = vec![0; weights.len()];
            index[i] = 1;
            coefficients.insert(index, weight);
        }
        Self { coordinates: weights.len(), degree, coefficients }
    }

    pub(crate) fn value(&self) -> f64 {
        self.coefficients[&vec![0; self.coordinates]]
    }

    pub(crate) fn scale(&self, factor: f64) -> Self {
        let mut result = self.clone();
        result.coefficients.values_mut().for_each(|c| *c *= factor);
        result
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let mut result = self.clone();
        for (index, c) in &other.coefficients {
            *result.coefficients.entry(index.clone()).or_insert(0.0) += c;
        }
        result
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut coefficients = BTreeMap::new();
        for (p, a) in &self.coefficients {
            for (q, b) in &other.coefficients {
                let sum: Vec<u32> = p.iter().zip(q).map(|(x, y)| x + y).collect();
                if sum.iter().sum::<u32>() <= self.degree {
                    *coefficients.entry(sum).or_insert(0.0) += a * b;
                }
            }
        }
        Self { coordinates: self.coordinates, degree: self.degree, coefficients }
    }

    /// `phi(self)` from `phi[n]`, the derivatives of phi at the value, by the plain Taylor series.
    pub(crate) fn compose(&self, phi: &[f64]) -> Self {
        let origin = vec![0; self.coordinates];
        let mut rest = self.clone();
        rest.coefficients.insert(origin.clone(), 0.0);
        let constant = |c: f64| Self { coefficients: BTreeMap::from([(origin.clone(), c)]), ..self.clone() };
        let (mut total, mut power, mut factorial) = (constant(phi[0]), constant(1.0), 1.0);
        for (n, value) in phi.iter().enumerate().skip(1).take(self.degree as usize) {
            power = power.times(&rest);
            factorial *= n as f64;
            total = total.plus(&power.scale(value / factorial));
        }
        total
    }

    /// The operator applied, at the origin.
    pub(crate) fn apply(&self, operator: &Operator) -> f64 {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        let term = |(index, c): (&Vec<u32>, &nisp_compiler::rational::Rational)| {
            let coefficient = *c.numer() as f64 / *c.denom() as f64;
            let scale: f64 = index.iter().map(|&n| factorial(n)).product();
            coefficient * scale * self.coefficients.get(index).copied().unwrap_or(0.0)
        };
        operator.terms().map(term).sum()
    }
}
