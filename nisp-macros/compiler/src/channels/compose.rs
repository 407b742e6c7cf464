//! The chain rule: `phi(a)_k = sum over n of phi[n] e_n,k`, with the divided powers `e_n = a^n / n!` of the
//! argument without its value; `e_1 = a` and `e_n = e_(n-1) e_1 / n` by the product rule.

use super::{ChannelSet, Rule, Share};
use crate::program::Slot;
use crate::rational::{Rational, ratio};
use crate::symbolic::exact::{self, Exact};
use crate::symbolic::graph::{Graph, Id, ZERO};
use crate::symbolic::horner;
use crate::symbolic::polynomial::Polynomial;

/// Divided powers with more monomials than this are not expanded but built by the recursion.
const EXPANSION_LIMIT: usize = 300;

/// One channel of a divided power.
#[derive(Clone, Debug)]
struct Power {
    id: Id,
    /// As a polynomial in the argument's channels, if that is small.
    expanded: Option<Polynomial>,
}

/// The activation of a jet.
pub fn compose(set: &ChannelSet) -> Exact<Rule> {
    let mut graph = Graph::default();
    let size = set.len();
    let order = set.order() as usize;
    let argument: Vec<Id> = (0..size).map(|k| graph.input(Slot::Argument, k)).collect();
    let shares: Vec<Vec<Share>> = (0..size).map(|k| reduced(set, k)).collect::<Exact<_>>()?;
    let first = |k: usize| Power {
        id: if k == 0 { ZERO } else { argument[k] },
        expanded: Some(if k == 0 { Polynomial::zero() } else { Polynomial::variable(k, size) }),
    };
    let mut powers: Vec<Vec<Power>> = vec![(0..size).map(first).collect()];
    for n in 2..=order {
        let last = &powers[n - 2];
        let next = shares.iter().map(|shares| next_power(&mut graph, shares, last, &powers[0], n, &argument));
        let next = next.collect::<Exact<_>>()?;
        powers.push(next);
    }
    let mut results = vec![graph.input(Slot::Phi, 0)];
    for channel in 1..size {
        let mut terms = Vec::new();
        for (n, power) in powers.iter().enumerate() {
            let phi = graph.input(Slot::Phi, n + 1);
            terms.push(graph.multiply(&[phi, power[channel].id]));
        }
        results.push(graph.add(&terms));
    }
    let arguments = (1..size).map(|k| Some((Slot::Argument, k)));
    Ok(Rule { graph, results, phis: order + 1, inputs: [None].into_iter().chain(arguments).collect() })
}

/// The coproduct without the parts in which a factor is only a value.
fn reduced(set: &ChannelSet, channel: usize) -> Exact<Vec<Share>> {
    Ok(set.coproduct(channel)?.into_iter().filter(|&(i, j, _)| i > 0 && j > 0).collect())
}

fn next_power(
    graph: &mut Graph,
    shares: &[Share],
    last: &[Power],
    first: &[Power],
    n: usize,
    argument: &[Id],
) -> Exact<Power> {
    let divisor = ratio(1, n as i128);
    if let Some(expanded) = expand(shares, last, first, divisor)? {
        return Ok(Power { id: horner::polynomial(graph, &expanded, argument), expanded: Some(expanded) });
    }
    let mut terms = Vec::new();
    for &(i, j, coefficient) in shares {
        let product = graph.multiply(&[last[i].id, first[j].id]);
        terms.push((exact::mul(coefficient, divisor)?, product));
    }
    Ok(Power { id: graph.linear(&terms), expanded: None })
}

/// The power as a polynomial, unless it is large.
fn expand(shares: &[Share], last: &[Power], first: &[Power], divisor: Rational) -> Exact<Option<Polynomial>> {
    let mut total = Polynomial::zero();
    for &(i, j, coefficient) in shares {
        let (Some(left), Some(right)) = (&last[i].expanded, &first[j].expanded) else { return Ok(None) };
        total.add_scaled(exact::mul(coefficient, divisor)?, &left.times(right)?)?;
        // Recursions add few monomials that cancel later, so a large partial sum means a large result.
        if total.len() > EXPANSION_LIMIT {
            return Ok(None);
        }
    }
    Ok(Some(total))
}
