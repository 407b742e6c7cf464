//! Where Cholesky factors have entries: columns that are filled alike make a front, and fronts are eliminated from the leaves of a tree
//! to its roots (Liu 1992).

use std::ops::Range;

use super::super::entries::Entries;
use super::super::ordering::order;

/// Columns of a front at most, and the share of its entries that may be zeros, for it to take in the front before it.
const RELAXED: [(usize, f64); 4] = [(4, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];
/// Share of all work in the subtrees that are eliminated side by side.
const TASK: f64 = 1.0 / 16.0;

/// Fronts in the order of their elimination: every one after those that it takes updates from.
pub(super) struct Tree {
    /// The unknown of every column.
    pub(super) order: Vec<usize>,
    pub(super) fronts: Vec<Front>,
    /// Where the entries of a matrix go among those of the factor.
    pub(super) places: Vec<usize>,
    /// Entries of the factor.
    pub(super) len: usize,
    /// Subtrees that are eliminated side by side; what lies between them comes after them.
    pub(super) tasks: Vec<Range<usize>>,
}

/// Columns that are eliminated together.
pub(super) struct Front {
    pub(super) first: usize,
    /// How many columns it eliminates.
    pub(super) width: usize,
    /// Where its entries of the factor begin: `width` rows of the factor's transpose, each of the front's whole size.
    pub(super) at: usize,
    /// Columns that its rows have entries in, beside its own.
    pub(super) below: Vec<usize>,
    /// Which front takes its update; none at a root.
    pub(super) parent: Option<usize>,
    /// By column below: its place in the parent.
    pub(super) within: Vec<u32>,
}

impl Front {
    /// Columns of its rows.
    pub(super) fn size(&self) -> usize {
        self.width + self.below.len()
    }
}

impl Tree {
    /// The tree of the factors of a matrix whose lower triangle has these entries; nothing where no order is found.
    pub(super) fn of(entries: &Entries) -> Option<Self> {
        let mut order = order(entries)?;
        let mut after = later(entries, &order);
        let parents = parents(&after);
        let turned = postorder(&parents);
        order = turned.iter().map(|&at| order[at]).collect();
        after = later(entries, &order);
        let mut fronts = relax(alike(&after));
        let mut len = 0;
        let mut of = vec![0; order.len()];
        for (number, front) in fronts.iter_mut().enumerate() {
            front.at = len;
            len += front.width * front.size();
            of[front.first..][..front.width].fill(number);
        }
        let mut place = vec![0; order.len()];
        for number in 0..fronts.len() {
            let Some(&first) = fronts[number].below.first() else { continue };
            let parent = &fronts[of[first]];
            (0..parent.width).for_each(|at| place[parent.first + at] = at);
            parent.below.iter().enumerate().for_each(|(at, &column)| place[column] = parent.width + at);
            fronts[number].within = fronts[number].below.iter().map(|&column| place[column] as u32).collect();
            fronts[number].parent = Some(of[first]);
        }
        let places = places(entries, &order, &fronts, &of);
        let tasks = tasks(&fronts);
        Some(Self { order, fronts, places, len, tasks })
    }
}

/// By column in an order: later columns that it has entries with.
fn later(entries: &Entries, order: &[usize]) -> Vec<Vec<u32>> {
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(at, &unknown)| place[unknown] = at);
    let mut later = vec![Vec::new(); order.len()];
    for column in 0..order.len() {
        for &row in entries.rows_of(column) {
            let (one, other) = (place[row], place[column]);
            if one != other {
                later[one.min(other)].push(one.max(other) as u32);
            }
        }
    }
    later
}

/// By column: the first later column that its elimination fills; none at a root.
fn parents(later: &[Vec<u32>]) -> Vec<Option<usize>> {
    let mut earlier: Vec<Vec<u32>> = vec![Vec::new(); later.len()];
    for (column, later) in later.iter().enumerate() {
        later.iter().for_each(|&row| earlier[row as usize].push(column as u32));
    }
    let (mut parents, mut ancestors) = (vec![None; later.len()], vec![None; later.len()]);
    for (column, earlier) in earlier.iter().enumerate() {
        for &first in earlier {
            let mut next = Some(first as usize);
            while let Some(at) = next.filter(|&at| at < column) {
                next = ancestors[at].replace(column);
                if next.is_none() {
                    parents[at] = Some(column);
                }
            }
        }
    }
    parents
}

/// The columns of a forest, every one after all that lead to it, and those of a subtree together.
fn postorder(parents: &[Option<usize>]) -> Vec<usize> {
    let count = parents.len();
    // By column, and for the roots at the end: its first child, and by child the next one.
    let (mut child, mut sibling) = (vec![None; count + 1], vec![None; count]);
    for (column, parent) in parents.iter().enumerate().rev() {
        sibling[column] = child[parent.unwrap_or(count)].replace(column);
    }
    let (mut order, mut path) = (Vec::with_capacity(count), vec![count]);
    while let Some(&column) = path.last() {
        if let Some(next) = child[column].take() {
            child[column] = sibling[next];
            path.push(next);
        } else {
            path.pop();
            order.extend((column < count).then_some(column));
        }
    }
    order
}

/// Fronts of neighbouring columns that are filled alike.
fn alike(later: &[Vec<u32>]) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::new();
    // By column: fronts whose first column below it is.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); later.len()];
    let mut seen = vec![usize::MAX; later.len()];
    for (column, own) in later.iter().enumerate() {
        seen[column] = column;
        let mut below = Vec::new();
        let mut see = |row: usize| {
            if seen[row] != column {
                seen[row] = column;
                below.push(row);
            }
        };
        own.iter().for_each(|&row| see(row as usize));
        for &child in &children[column] {
            fronts[child].below.iter().for_each(|&row| see(row));
        }
        let before = fronts.last_mut().filter(|front| {
            front.first + front.width == column && front.below.len() == below.len() + 1 && front.below.contains(&column)
        });
        let next = below.iter().copied().min();
        if let Some(front) = before {
            front.width += 1;
            front.below = below;
        } else {
            fronts.push(Front { first: column, width: 1, at: 0, below, parent: None, within: Vec::new() });
        }
        if let Some(next) = next {
            // A front that grew is the last child of its own column, and of no other.
            children[next].push(fronts.len() - 1);
        }
    }
    fronts.iter_mut().for_each(|front| front.below.sort_unstable());
    fronts
}

/// Takes fronts together whose columns follow each other, as long as this adds few zeros.
fn relax(fronts: Vec<Front>) -> Vec<Front> {
    let mut relaxed: Vec<(Front, usize)> = Vec::new();
    for front in fronts {
        let (mut last, mut zeros) = (front, 0);
        while let Some((before, others)) = relaxed.pop() {
            let width = before.width + last.width;
            let size = width + last.below.len();
            let leads = before.below.first().is_some_and(|&next| (last.first..last.first + last.width).contains(&next));
            let sum = zeros + others + before.width * (size - before.size()) * usize::from(leads);
            let entries = width * size - width * (width - 1) / 2;
            let most = RELAXED.iter().find(|(most, _)| width <= *most).map_or(0.0, |(_, share)| *share);
            if !leads || sum as f64 > most * entries as f64 {
                relaxed.push((before, others));
                break;
            }
            last = Front { first: before.first, width, ..last };
            zeros = sum;
        }
        relaxed.push((last, zeros));
    }
    relaxed.into_iter().map(|(front, _)| front).collect()
}

/// Where the entries of a matrix go among those of the factor.
fn places(entries: &Entries, order: &[usize], fronts: &[Front], of: &[usize]) -> Vec<usize> {
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(at, &unknown)| place[unknown] = at);
    let mut places = Vec::with_capacity(entries.rows().len());
    for column in 0..order.len() {
        for &row in entries.rows_of(column) {
            let (first, last) = (place[row].min(place[column]), place[row].max(place[column]));
            let front = &fronts[of[first]];
            let across = match last.checked_sub(front.first + front.width) {
                None => last - front.first,
                Some(_) => front.width + front.below.binary_search(&last).unwrap_or_default(),
            };
            places.push(front.at + (first - front.first) * front.size() + across);
        }
    }
    places
}

/// Subtrees of a moderate share of all work.
fn tasks(fronts: &[Front]) -> Vec<Range<usize>> {
    let mut work: Vec<f64> = fronts.iter().map(|front| front.width as f64 * (front.size() as f64).powi(2)).collect();
    let all: f64 = work.iter().sum();
    let mut starts: Vec<usize> = (0..fronts.len()).collect();
    for (number, front) in fronts.iter().enumerate() {
        if let Some(parent) = front.parent {
            work[parent] += work[number];
            starts[parent] = starts[parent].min(starts[number]);
        }
    }
    let is_small = |number: usize| work[number] <= TASK * all;
    let is_root = |&number: &usize| is_small(number) && fronts[number].parent.is_none_or(|parent| !is_small(parent));
    (0..fronts.len()).filter(is_root).map(|root| starts[root]..root + 1).collect()
}
