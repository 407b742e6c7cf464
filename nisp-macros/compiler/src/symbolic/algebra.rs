//! Sums and products: the rules that keep them canonical.

use std::collections::BTreeMap;

use num_traits::{One, Signed, ToPrimitive, Zero};

use super::exact::{self, Exact};
use super::graph::{Fault, Graph, Id, Node, ZERO};
use crate::model::Function;
use crate::rational::{Rational, ratio};

/// A sum under construction.
#[derive(Default)]
struct Terms {
    constant: Rational,
    real: f64,
    terms: BTreeMap<Id, Rational>,
}

/// A product under construction.
struct Factors {
    coefficient: Rational,
    real: f64,
    powers: BTreeMap<Id, Rational>,
}

impl Graph {
    /// `sum of coefficient * expression`: nested sums are flattened, equal terms collected, zeros dropped.
    pub fn linear(&mut self, parts: &[(Rational, Id)]) -> Id {
        let mut sum = Terms::default();
        for &(coefficient, id) in parts {
            if self.collect_term(&mut sum, coefficient, id).is_err() {
                return self.fail(Fault::Overflow);
            }
        }
        self.finish_sum(sum)
    }

    fn collect_term(&self, sum: &mut Terms, coefficient: Rational, id: Id) -> Exact<()> {
        match self.node(id) {
            Node::Number(value) => sum.constant = exact::add(sum.constant, exact::mul(coefficient, *value)?)?,
            Node::Real(bits) => sum.real += exact::to_f64(coefficient) * f64::from_bits(*bits),
            Node::Sum(constant, terms) => {
                sum.constant = exact::add(sum.constant, exact::mul(coefficient, *constant)?)?;
                for &(term, factor) in terms {
                    self.collect_term(sum, exact::mul(coefficient, factor)?, term)?;
                }
            }
            _ => {
                let entry = sum.terms.entry(id).or_insert_with(Rational::zero);
                *entry = exact::add(*entry, coefficient)?;
            }
        }
        Ok(())
    }

    fn finish_sum(&mut self, mut sum: Terms) -> Id {
        sum.terms.retain(|_, coefficient| !coefficient.is_zero());
        if sum.real != 0.0 {
            // One inexact constant makes the whole constant inexact.
            let real = self.real(sum.real + exact::to_f64(sum.constant));
            sum.constant = Rational::zero();
            if sum.terms.is_empty() {
                return real;
            }
            sum.terms.insert(real, Rational::one());
        }
        if sum.terms.is_empty() {
            return self.number(sum.constant);
        }
        let terms: Vec<_> = sum.terms.into_iter().collect();
        if let [(only, coefficient)] = terms[..]
            && coefficient.is_one()
            && sum.constant.is_zero()
        {
            return only;
        }
        self.intern(Node::Sum(sum.constant, terms))
    }

    /// `a + b + ...`
    pub fn add(&mut self, parts: &[Id]) -> Id {
        let parts: Vec<_> = parts.iter().map(|&id| (Rational::one(), id)).collect();
        self.linear(&parts)
    }

    /// `a - b`
    pub fn subtract(&mut self, a: Id, b: Id) -> Id {
        self.linear(&[(ratio(1, 1), a), (ratio(-1, 1), b)])
    }

    /// `-a`
    pub fn negate(&mut self, a: Id) -> Id {
        self.linear(&[(ratio(-1, 1), a)])
    }

    /// `factor * a`
    pub fn scale(&mut self, factor: Rational, a: Id) -> Id {
        self.linear(&[(factor, a)])
    }

    /// `a * b * ...`
    pub fn multiply(&mut self, factors: &[Id]) -> Id {
        let powers: Vec<_> = factors.iter().map(|&id| (id, Rational::one())).collect();
        self.product(&powers)
    }

    /// `a / b`
    pub fn divide(&mut self, a: Id, b: Id) -> Id {
        self.product(&[(a, ratio(1, 1)), (b, ratio(-1, 1))])
    }

    /// `a ^ exponent`
    pub fn power(&mut self, a: Id, exponent: Rational) -> Id {
        self.product(&[(a, exponent)])
    }

    /// Product of powers: nested products are flattened, equal bases collected, numbers pulled out.
    ///
    /// Bases with fractional exponents are taken to be non-negative: `sqrt(x)^2` is `x`.
    pub fn product(&mut self, powers: &[(Id, Rational)]) -> Id {
        if self.fault().is_some() {
            return ZERO;
        }
        let mut product = Factors { coefficient: Rational::one(), real: 1.0, powers: BTreeMap::new() };
        for &(base, exponent) in powers {
            match self.collect_factor(&mut product, base, exponent) {
                Ok(()) => {}
                Err(fault) => return self.fail(fault),
            }
        }
        let rooted = self.normalise_roots(&mut product);
        let result = rooted.and_then(|()| self.finish_product(product));
        result.unwrap_or_else(|fault| self.fail(fault))
    }

    fn collect_factor(&mut self, product: &mut Factors, base: Id, exponent: Rational) -> Result<(), Fault> {
        if exponent.is_zero() {
            return Ok(());
        }
        let whole = exponent.is_integer();
        match self.node(base).clone() {
            Node::Number(value) => return collect_number(product, value, exponent),
            Node::Real(bits) => product.real *= f64::from_bits(bits).powf(exact::to_f64(exponent)),
            Node::Product(factors) if whole => {
                for (factor, power) in factors {
                    self.collect_factor(product, factor, exact::mul(power, exponent)?)?;
                }
            }
            Node::Sum(constant, terms) if whole || (terms.len() == 1 && terms[0].1.is_positive()) => {
                if terms.len() == 1 && constant.is_zero() {
                    collect_number(product, terms[0].1, exponent)?;
                    return self.collect_factor(product, terms[0].0, exponent);
                }
                // Sums that differ by a number share one node: 2a + 2b is 2 (a + b).
                let numbers = terms.iter().map(|(_, c)| *c).chain((!constant.is_zero()).then_some(constant));
                let content = exact::content(numbers)?;
                let primitive = if whole { self.scale(exact::invert(content)?, base) } else { base };
                if whole {
                    collect_number(product, content, exponent)?;
                }
                add_power(product, primitive, exponent)?;
            }
            _ => add_power(product, base, exponent)?,
        }
        Ok(())
    }

    /// Half-integer powers become integer powers of a square root, and those at most the first power.
    fn normalise_roots(&mut self, product: &mut Factors) -> Result<(), Fault> {
        let half: Vec<_> = product.powers.iter().filter(|(_, e)| *e.denom() == 2).map(|(&b, &e)| (b, e)).collect();
        for (base, exponent) in half {
            product.powers.remove(&base);
            let root = self.call(Function::Sqrt, base);
            self.collect_factor(product, root, exact::mul(exponent, ratio(2, 1))?)?;
        }
        let roots: Vec<_> = product.powers.iter().map(|(&base, &exponent)| (base, exponent)).collect();
        for (base, exponent) in roots {
            if let Node::Call(Function::Sqrt, inside) = *self.node(base)
                && exponent.is_integer()
                && exponent.numer().unsigned_abs() > 1
            {
                product.powers.remove(&base);
                let rest = ratio(exponent.numer() % 2, 1);
                if !rest.is_zero() {
                    product.powers.insert(base, rest);
                }
                self.collect_factor(product, inside, ratio(exponent.numer() / 2, 1))?;
            }
        }
        Ok(())
    }

    fn finish_product(&mut self, mut product: Factors) -> Result<Id, Fault> {
        product.powers.retain(|_, exponent| !exponent.is_zero());
        if product.real != 1.0 {
            let real = self.real(product.real);
            if real == ZERO {
                return Ok(ZERO);
            }
            if product.powers.is_empty() {
                return Ok(self.scale(product.coefficient, real));
            }
            product.powers.insert(real, Rational::one());
        }
        let factors: Vec<_> = product.powers.into_iter().collect();
        let id = match factors[..] {
            [] => self.integer(1),
            [(only, exponent)] if exponent.is_one() => only,
            _ => self.intern(Node::Product(factors)),
        };
        Ok(self.scale(product.coefficient, id))
    }
}

fn add_power(product: &mut Factors, base: Id, exponent: Rational) -> Result<(), Fault> {
    let entry = product.powers.entry(base).or_insert_with(Rational::zero);
    *entry = exact::add(*entry, exponent)?;
    Ok(())
}

/// Multiplies with a power of a number: exactly, or rounded where it has no exact value or too many digits, as `pi^4` has.
fn collect_number(product: &mut Factors, value: Rational, exponent: Rational) -> Result<(), Fault> {
    if value.is_zero() && exponent.is_negative() {
        return Err(Fault::Undefined);
    }
    let whole = exponent.is_integer().then(|| exponent.to_integer().to_i128()).flatten();
    let power = whole.and_then(|whole| exact::power(value, whole).ok());
    match power.and_then(|power| exact::mul(product.coefficient, power).ok()) {
        Some(coefficient) => product.coefficient = coefficient,
        None => product.real *= exact::to_f64(value).powf(exact::to_f64(exponent)),
    }
    if product.real.is_infinite() { Err(Fault::Overflow) } else { Ok(()) }
}

impl From<exact::Overflow> for Fault {
    fn from(_: exact::Overflow) -> Self {
        Self::Overflow
    }
}
