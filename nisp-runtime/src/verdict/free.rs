//! Sources of which any course would do: there are more unknown functions of all coordinates than equations and measured quantities between them.
//!
//! Each of these settles one function at most. Where none is left for a source, any course of it is met by some course of the others
//! (Dulmage and Mendelsohn 1958), and what is believed of it beforehand decides alone.

use super::Check;
use crate::problem::Bound;
use crate::schema::{Place, Portion, Term, TermKind};

/// By equation and measured quantity, the heads of all coordinates that it reads.
type Reads = Vec<Vec<usize>>;

/// The sources that may have any course.
pub(super) fn sources(bound: &Bound) -> Vec<&'static str> {
    let heads = bound.problem.scene().schema.heads;
    let free = free(&reads(bound), heads.len());
    free.into_iter().map(|head| &heads[head]).filter(|head| head.source).map(|head| head.name).collect()
}

/// A check that fails for such sources.
pub(super) fn check(sources: &[&'static str]) -> Option<Check> {
    let (first, others) = sources.split_first()?;
    let others: Vec<String> = others.iter().map(|name| format!("`{name}`")).collect();
    let said = match &others[..] {
        [] => format!(
            "nothing settles `{first}`: all equations are needed to find the fields; measure it, or another field"
        ),
        others => format!(
            "nothing tells `{first}` from {}: there are fewer equations and measured quantities than unknown functions, so that any course of one is met \
             by some course of the others; measure one of them, or declare it as a column or a parameter",
            others.join(", ")
        ),
    };
    Some(Check::new("determined", ("", first), (sources.len() as f64, 0.0), said))
}

/// What equations and measurements of functions of all coordinates read.
fn reads(bound: &Bound) -> Reads {
    let schema = bound.problem.scene().schema;
    let inputs = schema.coordinates.len();
    let is_of_all: Vec<bool> = (0..schema.heads.len()).map(|head| schema.axes(head).len() == inputs).collect();
    let mut reads = Vec::new();
    for (at, group) in schema.groups.iter().enumerate() {
        // Conditions at an edge or at single points settle no function of all coordinates.
        let is_inside = matches!(group.place, None | Some(Place { portion: Portion::Inside, .. }));
        if group.is_beliefs() || !is_inside || bound.coordinates[at].len() <= inputs {
            continue;
        }
        let is_known = |term: &Term, row: usize| {
            let column = term.columns.get(row).filter(|_| term.kind == TermKind::Observation);
            column.is_none_or(|&column| bound.columns[at][column].iter().any(|x| x.is_finite()))
        };
        for term in group.terms.iter().filter(|term| term.kind != TermKind::Integral) {
            let mut own: Vec<usize> = term.jets.iter().map(|&jet| group.jets[jet].head).collect();
            own.retain(|&head| is_of_all[head]);
            reads.extend((0..term.rows).filter(|&row| is_known(term, row)).map(|_| own.clone()));
        }
    }
    reads
}

/// The heads that may have any course, of those that are read.
fn free(reads: &Reads, heads: usize) -> Vec<usize> {
    let by: Vec<Vec<usize>> =
        (0..heads).map(|head| (0..reads.len()).filter(|&row| reads[row].contains(&head)).collect()).collect();
    let mut settles: Vec<Option<usize>> = vec![None; reads.len()];
    let mut free = vec![false; heads];
    for head in (0..heads).filter(|&head| !by[head].is_empty()) {
        let mut seen = vec![false; reads.len()];
        if !find(head, &by, &mut settles, &mut seen) {
            // Every head that a row on the way settles could be the one that is left over.
            free[head] = true;
            let others = settles.iter().zip(&seen).filter(|(_, seen)| **seen);
            others.filter_map(|(head, _)| *head).for_each(|head| free[head] = true);
        }
    }
    (0..heads).filter(|&head| free[head]).collect()
}

/// Gives a head a row of its own, if need be by giving others another one (Kuhn 1955).
fn find(head: usize, by: &[Vec<usize>], settles: &mut [Option<usize>], seen: &mut [bool]) -> bool {
    for &row in &by[head] {
        if std::mem::replace(&mut seen[row], true) {
            continue;
        }
        if settles[row].is_none_or(|other| find(other, by, settles, seen)) {
            settles[row] = Some(head);
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_without_a_row_of_their_own_are_free_and_so_are_those_that_share_one() {
        // A field that is measured, and an equation with one source, and with two.
        assert_eq!(free(&vec![vec![0], vec![0, 1]], 2), []);
        assert_eq!(free(&vec![vec![0], vec![0, 1, 2]], 3), [1, 2]);
        // Two sensors of one field settle no more than one.
        assert_eq!(free(&vec![vec![0], vec![0], vec![0, 1, 2]], 3), [1, 2]);
        // A field behind another one that is measured.
        assert_eq!(free(&vec![vec![1], vec![0, 1], vec![0, 2]], 3), []);
        // Nothing measured, and a head that nothing reads.
        assert_eq!(free(&vec![vec![0, 1]], 3), [0, 1]);
    }
}
