//! List forms to operations, with fused multiply-adds.

use std::collections::BTreeMap;

use num_traits::{One, Signed, Zero};

use super::flat::{Flat, Item};
use super::share;
use crate::program::{Op, Program, Value};
use crate::rational::Rational;
use crate::symbolic::exact;

struct Emitter<'a> {
    flat: &'a Flat,
    /// Items whose value is needed other than as an addend.
    valued: Vec<bool>,
    /// How often an item is an operand.
    uses: Vec<usize>,
    values: Vec<Option<Value>>,
    halves: Vec<Option<(Value, Value)>>,
    constants: BTreeMap<u64, Value>,
    ops: Vec<Op>,
}

/// A term of a sum, ready to be accumulated: `sign * value` or `sign * a * b`.
#[derive(Clone, Copy)]
enum Addend {
    Plain(Value),
    Product(Value, Value),
}

/// The program for the given roots.
pub(super) fn emit(flat: &Flat, roots: &[Option<usize>]) -> Program {
    let count = flat.items.len();
    let mut emitter = Emitter {
        flat,
        valued: share::valued(flat, roots),
        uses: uses(flat, roots),
        values: vec![None; count],
        halves: vec![None; count],
        constants: BTreeMap::new(),
        ops: Vec::new(),
    };
    let outputs = roots.iter().map(|root| root.map(|item| emitter.value(item))).collect();
    Program { ops: emitter.ops, outputs }
}

fn uses(flat: &Flat, roots: &[Option<usize>]) -> Vec<usize> {
    let mut uses = vec![0; flat.items.len()];
    let mut open: Vec<usize> = roots.iter().flatten().copied().collect();
    while let Some(item) = open.pop() {
        uses[item] += 1;
        if uses[item] == 1 {
            open.extend(flat.items[item].operands());
        }
    }
    uses
}

impl Emitter<'_> {
    fn push(&mut self, op: Op) -> Value {
        self.ops.push(op);
        self.ops.len() - 1
    }

    fn constant(&mut self, bits: u64) -> Value {
        if let Some(&value) = self.constants.get(&bits) {
            return value;
        }
        let value = self.push(Op::Constant(f64::from_bits(bits)));
        self.constants.insert(bits, value);
        value
    }

    fn number(&mut self, number: Rational) -> Value {
        self.constant(exact::to_f64(number).to_bits())
    }

    fn value(&mut self, item: usize) -> Value {
        if let Some(value) = self.values[item] {
            return value;
        }
        let flat = self.flat;
        let value = match &flat.items[item] {
            Item::Input(slot, index) => self.push(Op::Input(*slot, *index)),
            Item::Constant(bits) => self.constant(*bits),
            Item::Sum(constant, terms) => self.sum(*constant, terms),
            // What is left of a product that sharing found to equal another.
            Item::Product(factors) if factors.len() == 1 => self.value(factors[0]),
            Item::Product(factors) => match self.single_use_reciprocal(factors) {
                Some(at) => self.quotient(factors, at),
                None => {
                    let (a, b) = self.half(item);
                    self.push(Op::Mul(a, b))
                }
            },
            Item::Reciprocal(x) => {
                let x = self.value(*x);
                let one = self.number(Rational::one());
                self.push(Op::Div(one, x))
            }
            Item::Call(function, x) => {
                let x = self.value(*x);
                self.push(Op::Call(*function, x))
            }
            Item::Min(a, b) => {
                let (a, b) = (self.value(*a), self.value(*b));
                self.push(Op::Min(a, b))
            }
            Item::Max(a, b) => {
                let (a, b) = (self.value(*a), self.value(*b));
                self.push(Op::Max(a, b))
            }
        };
        self.values[item] = Some(value);
        value
    }

    /// A denominator that nothing else needs: divide instead of multiplying by its reciprocal.
    fn single_use_reciprocal(&self, factors: &[usize]) -> Option<usize> {
        factors.iter().position(|&f| matches!(self.flat.items[f], Item::Reciprocal(_)) && self.uses[f] == 1)
    }

    fn quotient(&mut self, factors: &[usize], at: usize) -> Value {
        let rest: Vec<usize> = factors.iter().enumerate().filter(|&(i, _)| i != at).map(|(_, &f)| f).collect();
        let above = self.fold(&rest);
        let flat = self.flat;
        let below = match &flat.items[factors[at]] {
            Item::Reciprocal(x) => self.value(*x),
            _ => self.value(factors[at]),
        };
        self.push(Op::Div(above, below))
    }

    fn fold(&mut self, factors: &[usize]) -> Value {
        let first = self.value(factors[0]);
        factors[1..].iter().fold(first, |product, &factor| {
            let factor = self.value(factor);
            self.push(Op::Mul(product, factor))
        })
    }

    /// The two values whose product is this item.
    fn half(&mut self, item: usize) -> (Value, Value) {
        if let Some(half) = self.halves[item] {
            return half;
        }
        let flat = self.flat;
        let Item::Product(factors) = &flat.items[item] else { return (self.value(item), 0) };
        let mut factors = factors.clone();
        // Scalars first, so that what does not depend on the point stays together.
        factors.sort_by_key(|&f| (!flat.uniform[f], f));
        let (last, rest) = factors.split_at(factors.len() - 1);
        let half = (self.fold(last), self.value(rest[0]));
        self.halves[item] = Some(half);
        half
    }

    fn addend(&mut self, item: usize) -> Addend {
        if let Item::Product(factors) = &self.flat.items[item]
            && factors.len() > 1
            && !self.valued[item]
            && self.single_use_reciprocal(factors).is_none()
        {
            let (a, b) = self.half(item);
            return Addend::Product(a, b);
        }
        Addend::Plain(self.value(item))
    }

    fn sum(&mut self, constant: Rational, terms: &[(usize, Rational)]) -> Value {
        if let [(item, coefficient)] = *terms
            && constant.is_zero()
            && !coefficient.abs().is_one()
        {
            let (factor, value) = (self.number(coefficient), self.value(item));
            return self.push(Op::Mul(factor, value));
        }
        let mut terms = terms.to_vec();
        terms.sort_by_key(|&(item, _)| (!self.flat.uniform[item], item));
        let mut addends: Vec<(bool, Addend)> = Vec::new();
        for (item, coefficient) in terms {
            let positive = coefficient.is_positive();
            if coefficient.abs().is_one() {
                addends.push((positive, self.addend(item)));
            } else {
                let value = self.value(item);
                let size = self.number(coefficient.abs());
                addends.push((positive, Addend::Product(size, value)));
            }
        }
        let mut total = self.start(constant, &mut addends);
        for (positive, addend) in addends {
            total = self.push(match (positive, addend) {
                (true, Addend::Plain(x)) => Op::Add(total, x),
                (false, Addend::Plain(x)) => Op::Sub(total, x),
                (true, Addend::Product(a, b)) => Op::MulAdd(a, b, total),
                (false, Addend::Product(a, b)) => Op::NegMulAdd(a, b, total),
            });
        }
        total
    }

    /// The first value of a sum: one that costs nothing, if there is one.
    fn start(&mut self, constant: Rational, addends: &mut Vec<(bool, Addend)>) -> Value {
        if !constant.is_zero() {
            return self.number(constant);
        }
        let find = |addends: &[(bool, Addend)], positive, plain| {
            addends.iter().position(|&(p, a)| p == positive && matches!(a, Addend::Plain(_)) == plain)
        };
        if let Some(at) = find(addends, true, true)
            && let (_, Addend::Plain(x)) = addends.remove(at)
        {
            return x;
        }
        if let (Some(product), Some(plain)) = (find(addends, true, false), find(addends, false, true))
            && let (Addend::Product(a, b), Addend::Plain(c)) = (addends[product].1, addends[plain].1)
        {
            addends.remove(product.max(plain));
            addends.remove(product.min(plain));
            return self.push(Op::MulSub(a, b, c));
        }
        let at = find(addends, true, false).unwrap_or(0);
        let (positive, first) = addends.remove(at);
        let value = match first {
            Addend::Plain(x) => x,
            Addend::Product(a, b) => self.push(Op::Mul(a, b)),
        };
        if positive { value } else { self.push(Op::Neg(value)) }
    }
}
