//! Common parts of lists: pairs of factors or of terms that occur more than once are computed once.

use std::collections::BTreeMap;

use num_traits::{One, Signed, Zero};

use super::flat::{Flat, Item};
use crate::rational::Rational;
use crate::symbolic::exact;

/// Pairs looked at in all rounds together; past this, what is left stays unshared.
const WORK_LIMIT: usize = 20_000_000;

/// A pair of terms up to a common factor: items, and the ratio of the second coefficient to the first.
type TermPair = (usize, usize, Rational);

/// Rewrites lists so that common parts become items of their own.
pub(super) fn share(flat: &mut Flat, roots: &[Option<usize>]) {
    let mut work = 0;
    share_terms(flat, roots, &mut work);
    group_coefficients(flat, roots);
    share_factors(flat, roots, &mut work);
}

/// Items that the roots need, in ascending order.
fn live(flat: &Flat, roots: &[Option<usize>]) -> Vec<usize> {
    let mut found = vec![false; flat.items.len()];
    let mut open: Vec<usize> = roots.iter().flatten().copied().collect();
    while let Some(item) = open.pop() {
        if !std::mem::replace(&mut found[item], true) {
            open.extend(flat.items[item].operands());
        }
    }
    (0..found.len()).filter(|&item| found[item]).collect()
}

/// Items whose value is needed as such: not only as an addend that a fused multiply-add absorbs.
pub(super) fn valued(flat: &Flat, roots: &[Option<usize>]) -> Vec<bool> {
    let mut valued = vec![false; flat.items.len()];
    for item in live(flat, roots) {
        match &flat.items[item] {
            Item::Sum(_, terms) => {
                for (term, _) in terms.iter().filter(|(_, coefficient)| !coefficient.abs().is_one()) {
                    valued[*term] = true;
                }
            }
            other => other.operands().into_iter().for_each(|operand| valued[operand] = true),
        }
    }
    roots.iter().flatten().for_each(|&root| valued[root] = true);
    valued
}

/// The entries that occur most often, if that is at least twice, in ascending order.
fn most_frequent<T: Ord + Clone>(mut entries: Vec<T>) -> Vec<T> {
    entries.sort_unstable();
    let most = entries.chunk_by(|a, b| a == b).map(<[T]>::len).max().unwrap_or(0);
    if most < 2 {
        return Vec::new();
    }
    entries.chunk_by(|a, b| a == b).filter(|run| run.len() == most).map(|run| run[0].clone()).collect()
}

fn share_factors(flat: &mut Flat, roots: &[Option<usize>], work: &mut usize) {
    let mut valued = valued(flat, roots);
    let live = live(flat, roots);
    let mut products: Vec<usize> =
        live.into_iter().filter(|&item| matches!(flat.items[item], Item::Product(_))).collect();
    loop {
        let mut pairs = Vec::new();
        for &product in &products {
            if let Item::Product(factors) = &flat.items[product]
                && (factors.len() > 2 || valued[product])
            {
                factor_pairs(factors, &mut pairs);
            }
        }
        *work += pairs.len();
        let best = most_frequent(pairs);
        if best.is_empty() || *work > WORK_LIMIT {
            return;
        }
        for (a, b) in best {
            // An earlier pair of this round may have taken these factors.
            let fits = |&p: &usize| (flat.items[p].operands().len() > 2 || valued[p]) && fits(&flat.items[p], a, b);
            let members: Vec<usize> = products.iter().copied().filter(fits).collect();
            let pair = flat.intern(Item::Product(vec![a, b]));
            valued.resize(flat.items.len(), false);
            valued[pair] = true;
            for member in members.into_iter().filter(|&member| member != pair) {
                if let Item::Product(factors) = &mut flat.items[member] {
                    replace_factors(factors, a, b, pair);
                }
            }
            if !products.contains(&pair) {
                products.push(pair);
            }
        }
    }
}

fn fits(item: &Item, a: usize, b: usize) -> bool {
    let Item::Product(factors) = item else { return false };
    let count = |x| factors.iter().filter(|&&factor| factor == x).count();
    if a == b { count(a) > 1 } else { count(a) > 0 && count(b) > 0 }
}

/// Pairs of factors in a sorted list, each as often as it fits in without overlap.
fn factor_pairs(factors: &[usize], pairs: &mut Vec<(usize, usize)>) {
    let powers: Vec<(usize, usize)> = factors.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect();
    for (i, &(a, m)) in powers.iter().enumerate() {
        pairs.extend((0..m / 2).map(|_| (a, a)));
        for &(b, n) in &powers[i + 1..] {
            pairs.extend((0..m.min(n)).map(|_| (a, b)));
        }
    }
}

fn replace_factors(factors: &mut Vec<usize>, a: usize, b: usize, pair: usize) {
    while factors.len() > 1 {
        let Some(first) = factors.iter().position(|&f| f == a) else { break };
        let Some(second) = (0..factors.len()).find(|&i| i != first && factors[i] == b) else { break };
        factors.remove(first.max(second));
        factors.remove(first.min(second));
        factors.push(pair);
    }
    factors.sort_unstable();
}

fn share_terms(flat: &mut Flat, roots: &[Option<usize>], work: &mut usize) {
    let live = live(flat, roots);
    let mut sums: Vec<usize> = live.into_iter().filter(|&item| matches!(flat.items[item], Item::Sum(..))).collect();
    loop {
        let mut pairs: Vec<TermPair> = Vec::new();
        for &sum in &sums {
            if let Item::Sum(_, terms) = &flat.items[sum] {
                // A long sum alone may have more pairs than there is memory for.
                if terms.len() * terms.len() / 2 + pairs.len() > WORK_LIMIT / 4 {
                    return;
                }
                term_pairs(terms, &mut pairs);
            }
        }
        *work += 4 * pairs.len();
        let best = most_frequent(pairs);
        if best.is_empty() || *work > WORK_LIMIT {
            return;
        }
        for (a, b, factor) in best {
            // An earlier pair of this round may have taken these terms.
            let has = |&sum: &usize| has_terms(&flat.items[sum], a, b, factor);
            let members: Vec<usize> = sums.iter().copied().filter(has).collect();
            if members.len() < 2 {
                continue;
            }
            let pair = flat.intern(Item::Sum(Rational::zero(), vec![(a, Rational::one()), (b, factor)]));
            for member in members.into_iter().filter(|&member| member != pair) {
                if let Item::Sum(_, terms) = &mut flat.items[member] {
                    replace_terms(terms, a, b, pair);
                }
            }
            if !sums.contains(&pair) {
                sums.push(pair);
            }
        }
    }
}

fn term_pairs(terms: &[(usize, Rational)], pairs: &mut Vec<TermPair>) {
    for (i, &(a, first)) in terms.iter().enumerate() {
        for &(b, second) in &terms[i + 1..] {
            if let Ok(factor) = exact::invert(first).and_then(|inverse| exact::mul(second, inverse)) {
                pairs.push((a, b, factor));
            }
        }
    }
}

fn coefficient(terms: &[(usize, Rational)], item: usize) -> Option<Rational> {
    terms.binary_search_by_key(&item, |&(other, _)| other).ok().map(|at| terms[at].1)
}

fn has_terms(item: &Item, a: usize, b: usize, factor: Rational) -> bool {
    let Item::Sum(_, terms) = item else { return false };
    match (coefficient(terms, a), coefficient(terms, b)) {
        (Some(first), Some(second)) => exact::mul(first, factor) == Ok(second),
        _ => false,
    }
}

fn replace_terms(terms: &mut Vec<(usize, Rational)>, a: usize, b: usize, pair: usize) {
    let Some(size) = coefficient(terms, a) else { return };
    terms.retain(|&(item, _)| item != a && item != b);
    terms.push((pair, size));
    terms.sort_unstable();
}

/// Terms of one sum with the same coefficient, other than one, are added before they are multiplied.
fn group_coefficients(flat: &mut Flat, roots: &[Option<usize>]) {
    for sum in live(flat, roots) {
        let Item::Sum(constant, terms) = flat.items[sum].clone() else { continue };
        let mut classes: BTreeMap<Rational, Vec<(usize, Rational)>> = BTreeMap::new();
        for &(item, coefficient) in &terms {
            classes.entry(coefficient.abs()).or_default().push((item, coefficient.signum()));
        }
        let negative = terms.iter().all(|(_, coefficient)| coefficient.is_negative());
        let scaled = classes.keys().all(|size| !size.is_one());
        if classes.len() == 1 && constant.is_zero() && (negative || scaled) && terms.len() > 1 {
            let size = terms[0].1;
            let inner = terms.iter().map(|&(item, c)| (item, c / size)).collect();
            let inner = flat.intern(Item::Sum(Rational::zero(), inner));
            flat.items[sum] = Item::Sum(constant, vec![(inner, size)]);
            continue;
        }
        let mut grouped = Vec::new();
        for (size, class) in classes {
            if size.is_one() || class.len() == 1 {
                grouped.extend(class.into_iter().map(|(item, sign)| (item, sign * size)));
            } else {
                let sign = class[0].1;
                let inner = class.into_iter().map(|(item, s)| (item, s * sign)).collect();
                grouped.push((flat.intern(Item::Sum(Rational::zero(), inner)), sign * size));
            }
        }
        grouped.sort_unstable();
        flat.items[sum] = Item::Sum(constant, grouped);
    }
}
