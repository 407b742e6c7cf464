//! Elimination of fronts: each hands what its columns leave of the rest to its parent.

use rayon::prelude::*;

use super::tree::{Front, Tree};
use crate::solve::dense::{factorise, subtract_gram};

/// What a front leaves to its parent: the upper triangle of the columns below it.
struct Update {
    front: usize,
    values: Vec<f64>,
}

/// The factor of a matrix; nothing where it is not positive definite, or memory too small.
pub(super) fn factor(tree: &Tree, matrix: &[f64]) -> Option<Vec<f64>> {
    let mut lower = zeros(tree.len)?;
    tree.places.iter().zip(matrix).for_each(|(&place, value)| lower[place] = *value);
    let end = |fronts: &std::ops::Range<usize>| fronts.end.checked_sub(1).map_or(0, |last| after(&tree.fronts[last]));
    let (mut parts, mut rest, mut from) = (Vec::new(), lower.as_mut_slice(), 0);
    for task in &tree.tasks {
        let start = tree.fronts[task.start].at;
        let (part, left) = std::mem::take(&mut rest)[start - from..].split_at_mut(end(task) - start);
        parts.push((task, part));
        (rest, from) = (left, end(task));
    }
    let eliminated = parts.into_par_iter().map(|(task, part)| {
        let mut updates = Vec::new();
        let start = tree.fronts[task.start].at;
        task.clone().try_for_each(|number| eliminate(tree, number, part, start, &mut updates)).map(|()| updates)
    });
    let eliminated: Vec<Option<Vec<Update>>> = eliminated.collect();
    let (mut updates, mut number) = (Vec::new(), 0);
    for (task, left) in tree.tasks.iter().zip(eliminated) {
        (number..task.start).try_for_each(|number| eliminate(tree, number, &mut lower, 0, &mut updates))?;
        updates.extend(left?);
        number = task.end;
    }
    (number..tree.fronts.len()).try_for_each(|number| eliminate(tree, number, &mut lower, 0, &mut updates))?;
    Some(lower)
}

/// Where the entries of a front end.
fn after(front: &Front) -> usize {
    front.at + front.width * front.size()
}

/// Eliminates a front whose children's updates are the last ones; `lower` begins at entry `start`.
fn eliminate(tree: &Tree, number: usize, lower: &mut [f64], start: usize, updates: &mut Vec<Update>) -> Option<()> {
    let front = &tree.fronts[number];
    let (width, size, below) = (front.width, front.size(), front.below.len());
    let rows = &mut lower[front.at - start..after(front) - start];
    let mut values = zeros(below * below)?;
    while let Some(update) = updates.pop_if(|update| tree.fronts[update.front].parent == Some(number)) {
        let within = &tree.fronts[update.front].within;
        for (i, row) in update.values.chunks_exact(within.len().max(1)).enumerate() {
            let at = within[i] as usize;
            let (into, first) = match at.checked_sub(width) {
                None => (&mut rows[at * size..][..size], 0),
                Some(at) => (&mut values[at * below..][..below], width),
            };
            within[i..].iter().zip(&row[i..]).for_each(|(&at, value)| into[at as usize - first] += value);
        }
    }
    if !factorise(rows, width, size) {
        return None;
    }
    if below > 0 {
        subtract_gram(&rows[width..], size, width, &mut values, below, below, below);
        updates.push(Update { front: number, values });
    }
    Some(())
}

/// So many zeros; nothing where memory is too small.
fn zeros(len: usize) -> Option<Vec<f64>> {
    let mut zeros = Vec::new();
    zeros.try_reserve_exact(len).ok()?;
    zeros.resize(len, 0.0);
    Some(zeros)
}
