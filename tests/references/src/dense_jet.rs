//! Truncated Taylor series in several variables, over all monomials up to an order: derivatives the plain way.

use std::ops::{Add, Mul, Neg, Sub};

use crate::number::Number;

/// The monomials of a series, and which products of two stay within the order.
#[derive(Debug)]
pub struct Space {
    order: usize,
    exponents: Vec<Vec<usize>>,
    /// `(left, right, product)`
    products: Vec<(usize, usize, usize)>,
}

impl Space {
    /// All monomials of `dimension` variables up to `order`.
    pub fn new(dimension: usize, order: usize) -> Self {
        let mut exponents = vec![Vec::new()];
        for _ in 0..dimension {
            let extended = exponents.into_iter().flat_map(|e: Vec<usize>| {
                let left = order - e.iter().sum::<usize>();
                (0..=left).map(move |n| e.iter().copied().chain([n]).collect())
            });
            exponents = extended.collect();
        }
        exponents.sort_by_key(|e| e.iter().sum::<usize>());
        let find = |e: &[usize]| exponents.iter().position(|other| other == e);
        let mut products = Vec::new();
        for (a, left) in exponents.iter().enumerate() {
            for (b, right) in exponents.iter().enumerate() {
                let sum: Vec<usize> = left.iter().zip(right).map(|(m, n)| m + n).collect();
                products.extend(find(&sum).map(|c| (a, b, c)));
            }
        }
        Self { order, exponents, products }
    }
}

/// A series, about some point.
#[derive(Clone, Debug)]
pub struct Jet<'s, T> {
    space: &'s Space,
    coefficients: Vec<T>,
}

impl<'s, T: Number> Jet<'s, T> {
    /// A constant.
    pub fn constant(space: &'s Space, value: T) -> Self {
        let mut coefficients = vec![T::of(0.0); space.exponents.len()];
        coefficients[0] = value;
        Self { space, coefficients }
    }

    /// `value + slope * (variable - its value)`
    pub fn variable(space: &'s Space, variable: usize, value: f64, slope: f64) -> Self {
        let mut jet = Self::constant(space, T::of(value));
        let at = space.exponents.iter().position(|e| e.iter().sum::<usize>() == 1 && e[variable] == 1);
        if let Some(at) = at {
            jet.coefficients[at] = T::of(slope);
        }
        jet
    }

    /// Times a number.
    pub fn scale(mut self, factor: T) -> Self {
        self.coefficients.iter_mut().for_each(|c| *c = *c * factor);
        self
    }

    /// Plus a number.
    pub fn shift(mut self, by: T) -> Self {
        self.coefficients[0] = self.coefficients[0] + by;
        self
    }

    /// `f(self)`, given `f` and its derivatives at the value.
    fn compose(&self, derivatives: &[T]) -> Self {
        let mut rest = self.clone();
        rest.coefficients[0] = T::of(0.0);
        let mut factorial = 1.0;
        let series: Vec<T> = derivatives
            .iter()
            .enumerate()
            .map(|(n, &f)| {
                factorial *= n.max(1) as f64;
                f * T::of(1.0 / factorial)
            })
            .collect();
        let zero = Self::constant(self.space, T::of(0.0));
        series.iter().rev().fold(zero, |sum, &f| (sum * rest.clone()).shift(f))
    }

    /// Hyperbolic tangent: with `t' = 1 - t^2`, every derivative is a polynomial in `t`.
    pub fn tanh(&self) -> Self {
        let t = self.coefficients[0].tanh();
        let mut polynomial = vec![0.0, 1.0];
        let derivatives: Vec<T> = (0..=self.space.order)
            .map(|_| {
                let value = polynomial.iter().rev().fold(T::of(0.0), |sum, &c| sum * t + T::of(c));
                let mut next = vec![0.0; polynomial.len() + 1];
                for (power, c) in polynomial.iter().enumerate().skip(1) {
                    next[power - 1] += power as f64 * c;
                    next[power + 1] -= power as f64 * c;
                }
                polynomial = next;
                value
            })
            .collect();
        self.compose(&derivatives)
    }

    /// Sine and cosine.
    pub fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = (self.coefficients[0].sin(), self.coefficients[0].cos());
        let turn = [sin, cos, -sin, -cos];
        let series = |quarter: usize| (0..=self.space.order).map(|n| turn[(n + quarter) % 4]).collect::<Vec<T>>();
        (self.compose(&series(0)), self.compose(&series(1)))
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        let a = self.coefficients[0];
        let value = a.chain(a.value().ln(), 1.0 / a.value());
        // Derivative n is (-1)^(n - 1) (n - 1)! / a^n.
        let rest = std::iter::successors(Some((1.0, T::of(1.0) / a)), |&(n, f)| Some((n + 1.0, T::of(-n) * f / a)));
        let derivatives: Vec<T> =
            std::iter::once(value).chain(rest.map(|(_, f)| f)).take(self.space.order + 1).collect();
        self.compose(&derivatives)
    }

    /// The value.
    pub fn value(&self) -> T {
        self.coefficients[0]
    }

    /// The partial derivative of these orders.
    pub fn derivative(&self, orders: &[usize]) -> T {
        let at = self.space.exponents.iter().position(|e| e == orders).expect("an order within the space");
        let factorials: f64 = orders.iter().flat_map(|&n| 1..=n).map(|n| n as f64).product();
        self.coefficients[at] * T::of(factorials)
    }

    /// The series of the partial derivative by a variable, good to one order less.
    pub fn by(&self, variable: usize) -> Self {
        let mut result = Self::constant(self.space, T::of(0.0));
        for (at, exponents) in self.space.exponents.iter().enumerate().filter(|(_, e)| e[variable] > 0) {
            let mut lower = exponents.clone();
            lower[variable] -= 1;
            let to = self.space.exponents.iter().position(|e| *e == lower).expect("a lower monomial");
            result.coefficients[to] = self.coefficients[at] * T::of(exponents[variable] as f64);
        }
        result
    }

    /// Sum of the second derivatives by the first `variables` variables.
    pub fn laplacian(&self, variables: usize) -> Self {
        let parts = (0..variables).map(|i| self.by(i).by(i));
        parts.reduce(|a, b| a + b).expect("at least one variable")
    }
}

impl<T: Number> Add for Jet<'_, T> {
    type Output = Self;
    fn add(mut self, b: Self) -> Self {
        self.coefficients.iter_mut().zip(b.coefficients).for_each(|(a, b)| *a = *a + b);
        self
    }
}

impl<T: Number> Neg for Jet<'_, T> {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(T::of(-1.0))
    }
}

impl<T: Number> Sub for Jet<'_, T> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl<T: Number> Mul for Jet<'_, T> {
    type Output = Self;
    fn mul(self, right: Self) -> Self {
        let mut product = Self::constant(self.space, T::of(0.0));
        for &(a, b, c) in &self.space.products {
            product.coefficients[c] = product.coefficients[c] + self.coefficients[a] * right.coefficients[b];
        }
        product
    }
}
