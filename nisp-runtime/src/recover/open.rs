//! Directions in which an answer is open.
//!
//! A head is open where nearly all of its variance lies along one direction and it is not small beside the head itself, or
//! most of the variance and it is larger than the head. Learned scalars are where the leading direction of their parameters
//! is as wide as the parameters' own scale; a source that only scales along, as a load does with a stiffness, is part of it.

use super::spread::Spread;
use crate::solve::posterior::{Direction, leading};
use crate::solve::vector;

/// Share of a head's variance that an open direction has at least, and standard deviation along it at least, beside the head
/// itself: one that stands alone, or one that drowns the head.
const OPEN: [(f64, f64); 2] = [(0.99, 0.05), (0.9, 1.0)];

/// The same of the parameters of learned scalars, which are of the order of one: a factor of e, most of a range.
const OPEN_LEARNED: (f64, f64) = (0.9, 1.0);

/// Share of a head's variance that goes along with a direction for the head to be part of it.
const TOGETHER: f64 = 0.9;

/// An open direction.
pub(super) struct Open {
    pub(super) what: What,
    pub(super) direction: Direction,
}

/// What is open.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum What {
    /// A head, with a pattern over the points.
    Head(usize),
    /// Learned scalars, with a pattern over their parameters.
    Learned,
}

impl Open {
    /// All that are open: learned scalars, and heads on their own.
    pub(super) fn all(spread: &Spread) -> Vec<Self> {
        let learned = Self::of_learned(spread);
        // A head that only follows open scalars is told of with them.
        let follows = |rows: &[f64]| learned.as_ref().is_some_and(|open| open.moved(rows).is_some());
        let alone = spread.heads.iter().enumerate().filter(|(_, (_, rows))| !follows(rows));
        let heads: Vec<Self> = alone.filter_map(|(head, (values, rows))| Self::of_head(head, values, rows)).collect();
        learned.into_iter().chain(heads).collect()
    }

    fn of_head(head: usize, values: &[f64], rows: &[f64]) -> Option<Self> {
        let direction = leading(rows, values.len())?;
        let size = vector::norm(values);
        let open = OPEN.iter().any(|(share, large)| direction.share > *share && direction.deviation > large * size);
        open.then_some(Self { what: What::Head(head), direction })
    }

    fn of_learned(spread: &Spread) -> Option<Self> {
        let direction = leading(&spread.learned, spread.scalars)?;
        let (share, large) = OPEN_LEARNED;
        (direction.share > share && direction.deviation > large).then_some(Self { what: What::Learned, direction })
    }

    /// How a head with these rows moves at every point, per standard deviation along the direction, if it goes along.
    pub(super) fn moved(&self, rows: &[f64]) -> Option<Vec<f64>> {
        let columns = &self.direction.columns;
        let moved: Vec<f64> = rows.chunks_exact(columns.len()).map(|row| vector::dot(row, columns)).collect();
        (vector::dot(&moved, &moved) > TOGETHER * vector::dot(rows, rows)).then_some(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stiffness `k`, a load `f` and an offset: data know `f / k` and the offset, to a hundredth.
    fn spread(closed: f64) -> Spread {
        let f = [2.0, 1.0, -2.0];
        // Columns: the logarithm of what both are multiplied by, and what the data leave of the ratio and the offset.
        let load = f.iter().flat_map(|f| [f * closed, 0.01, 0.0]).collect();
        let offset = vec![0.0, 0.0, 0.01, 0.0, 0.0, 0.01, 0.0, 0.0, 0.01];
        Spread {
            points: vec![0.0, 1.0, 2.0],
            heads: vec![(f.to_vec(), load), (vec![1.0; 3], offset)],
            learned: vec![closed, 0.0, 0.0],
            scalars: 1,
        }
    }

    #[test]
    fn a_source_that_follows_an_open_scalar_is_told_of_with_it() {
        let wide = spread(3.0);
        let [open] = &Open::all(&wide)[..] else { panic!("one direction") };
        assert!(open.what == What::Learned && open.direction.deviation == 3.0);
        assert_eq!(open.moved(&wide.heads[0].1).unwrap(), [6.0, 3.0, -6.0]);
        assert_eq!(open.moved(&wide.heads[1].1), None);
    }

    #[test]
    fn what_is_known_well_enough_is_not_open() {
        assert!(Open::all(&spread(0.03)).is_empty());
        // The scalar is known to a third, and nothing else moves the load by as much.
        let found = Open::all(&spread(0.3));
        assert!(matches!(&found[..], [Open { what: What::Head(0), .. }]));
    }

    #[test]
    fn heads_that_are_open_together_are_each_told_of() {
        let f = vec![2.0, 1.0, -2.0];
        let load = f.iter().flat_map(|f| [3.0 * f, 0.01]).collect();
        let shape = f.iter().flat_map(|f| [-6.0 * f, 0.01]).collect();
        let heads = vec![(f.clone(), load), (f, shape)];
        let both = Spread { points: vec![0.0, 1.0, 2.0], heads, learned: Vec::new(), scalars: 0 };
        let found: Vec<What> = Open::all(&both).into_iter().map(|open| open.what).collect();
        assert!(found == [What::Head(0), What::Head(1)]);
    }

    #[test]
    fn answers_without_a_posterior_say_nothing() {
        let empty = Spread { heads: vec![(vec![1.0; 3], Vec::new())], learned: Vec::new(), ..spread(3.0) };
        assert!(Open::all(&empty).is_empty());
    }
}
