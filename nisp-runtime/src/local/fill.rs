//! Where the Cholesky factors of a sparse symmetric matrix have entries.
//!
//! Unknowns that are eliminated one after the other and meet nearly the same others are a node: their rows of the factor are kept as
//! one dense strip (supernodes; Duff and Reid 1983). What a node leaves to the unknowns that it meets is added to the node that
//! comes next for them, its parent.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::entries::Entries;
use super::ordering::Ordering;
use super::spare::Spare;
use crate::solve::dense::rows::Strip;

/// Where factors have entries.
pub(super) struct Fill {
    /// By unknown, when it is eliminated.
    pub(super) places: Vec<usize>,
    /// Children before their parents, and all that is below a node right before it.
    pub(super) nodes: Vec<Node>,
    /// By entry of the matrix, its place in the factor.
    pub(super) targets: Vec<usize>,
    /// Memory for factors and what they need.
    pub(super) spare: Arc<Spare>,
    /// Nodes that are worked off beside each other: one with all that is below it.
    pub(super) subtrees: Vec<Range<usize>>,
}

/// Unknowns that are eliminated together.
pub(super) struct Node {
    /// When the first of them is.
    pub(super) first: usize,
    /// Its rows of the factor.
    pub(super) strip: Strip,
    /// Where these begin in the factor.
    pub(super) start: usize,
    /// When the others are eliminated that they meet.
    pub(super) others: Vec<usize>,
    pub(super) children: Vec<usize>,
    /// The others among the columns of the parent.
    pub(super) runs: Vec<Run>,
}

/// Unknowns that follow each other among those that a node meets, and among its parent's columns.
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) len: usize,
    /// Column of the first of them in the parent.
    pub(super) column: usize,
}

/// A node while it grows, in kinds of unknowns.
struct Growing {
    kinds: Vec<usize>,
    /// Kinds that it meets, in order.
    others: Vec<usize>,
    children: Vec<usize>,
    /// Unknowns, and those that it meets.
    width: usize,
    met: usize,
    /// Entries that are zero.
    zeros: usize,
}

/// One thread does a subtree by itself whose products are no more than all of them divided by this.
const PART: usize = 8;
/// Products so few that one thread does them all.
const FEW: usize = 1 << 20;

impl Fill {
    /// Of matrices whose lower triangle has these entries; nothing where they are no such triangle.
    pub(super) fn of(entries: &Entries, spare: Arc<Spare>) -> Option<Self> {
        let ordering = Ordering::of(entries)?;
        let growing = grown(&ordering);
        let order = postorder(&growing);
        let mut places = vec![0; entries.len()];
        // By kind, when its first unknown is eliminated.
        let mut begins = vec![0; ordering.members.len()];
        let mut next = 0;
        for &kind in order.iter().flat_map(|&at| &growing[at].kinds) {
            begins[kind] = next;
            for &member in &ordering.members[kind] {
                places[member] = next;
                next += 1;
            }
        }
        let mut number = vec![0; growing.len()];
        order.iter().enumerate().for_each(|(to, &from)| number[from] = to);
        let mut start = 0;
        let node = |&at: &usize| {
            let from = &growing[at];
            let met = from.others.iter().flat_map(|&kind| begins[kind]..begins[kind] + ordering.members[kind].len());
            let mut others: Vec<usize> = met.collect();
            others.sort_unstable();
            let strip = Strip::new(from.width, others.len());
            start += strip.len();
            Node {
                first: begins[from.kinds[0]],
                strip,
                start: start - strip.len(),
                others,
                children: from.children.iter().map(|&child| number[child]).collect(),
                runs: Vec::new(),
            }
        };
        let nodes = order.iter().map(node).collect();
        let mut fill = Self { places, nodes, targets: Vec::new(), spare, subtrees: Vec::new() };
        fill.find(entries);
        fill.share();
        Some(fill)
    }

    /// Finds where entries of the matrix belong, and where in its parent what a node takes from others does.
    fn find(&mut self, entries: &Entries) {
        let mut node_of = vec![0; entries.len()];
        for (at, node) in self.nodes.iter().enumerate() {
            node_of[node.first..][..node.strip.width].fill(at);
        }
        let (nodes, places) = (&self.nodes, &self.places);
        let target = |column: usize, row: usize| {
            let (a, b) = (places[column].min(places[row]), places[column].max(places[row]));
            let node = &nodes[node_of[a]];
            node.start + (a - node.first) * node.strip.stride + node.column(b)
        };
        let of_column = |column| entries.column(column).iter().map(move |&row| (column, row));
        self.targets = (0..entries.len())
            .into_par_iter()
            .flat_map_iter(of_column)
            .map(|(column, row)| target(column, row))
            .collect();
        for at in 0..self.nodes.len() {
            for child in self.nodes[at].children.clone() {
                let runs = runs(self.nodes[child].others.iter().map(|&place| self.nodes[at].column(place)));
                self.nodes[child].runs = runs;
            }
        }
    }

    /// Finds the subtrees that are worked off beside each other.
    fn share(&mut self) {
        let mut work = vec![0; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate() {
            let below: usize = node.children.iter().map(|&child| work[child]).sum();
            work[at] = below + node.strip.width * node.strip.stride * node.strip.stride;
        }
        let mut parent = vec![usize::MAX; self.nodes.len()];
        for (at, node) in self.nodes.iter().enumerate() {
            node.children.iter().for_each(|&child| parent[child] = at);
        }
        let all: usize = (0..work.len()).filter(|&at| parent[at] == usize::MAX).map(|at| work[at]).sum();
        let small = |at: usize| work[at] <= (all / PART).max(FEW);
        let mut first = 0;
        for (at, &parent) in parent.iter().enumerate() {
            if small(at) && parent != usize::MAX && small(parent) {
                continue;
            }
            if small(at) {
                self.subtrees.push(first..at + 1);
            }
            first = at + 1;
        }
    }
}

impl Node {
    /// Where its rows have the unknown that is eliminated then.
    fn column(&self, place: usize) -> usize {
        match place.checked_sub(self.first + self.strip.width) {
            None => place - self.first,
            Some(_) => self.strip.others() + self.others.partition_point(|&other| other < place),
        }
    }
}

/// Columns that rise, as runs of such that follow each other.
fn runs(columns: impl Iterator<Item = usize>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (at, column) in columns.enumerate() {
        match runs.last_mut() {
            Some(run) if run.column + run.len == column => run.len += 1,
            _ => runs.push(Run { first: at, len: 1, column }),
        }
    }
    runs
}

/// The nodes, in the order in which they were found.
fn grown(ordering: &Ordering) -> Vec<Growing> {
    let size = |kinds: &[usize]| kinds.iter().map(|&kind| ordering.members[kind].len()).sum::<usize>();
    let mut nodes: Vec<Growing> = Vec::new();
    // By kind, the nodes whose parent it belongs to; by kind, the last that met it.
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); ordering.members.len()];
    let mut seen = vec![usize::MAX; ordering.members.len()];
    for kind in 0..ordering.members.len() {
        let mut below = std::mem::take(&mut children[kind]);
        let met = below.iter().flat_map(|&child| &nodes[child].others).chain(&ordering.later[kind]);
        let mut others: Vec<usize> =
            met.copied().filter(|&other| other != kind && std::mem::replace(&mut seen[other], kind) != kind).collect();
        others.sort_unstable();
        let mut node = Growing {
            width: ordering.members[kind].len(),
            met: size(&others),
            kinds: vec![kind],
            others,
            children: Vec::new(),
            zeros: 0,
        };
        below.sort_by_key(|&child| std::cmp::Reverse(nodes[child].met));
        for child in below {
            node.take_in(child, &mut nodes);
        }
        if let Some(&next) = node.others.first() {
            children[next].push(nodes.len());
        }
        nodes.push(node);
    }
    nodes
}

impl Growing {
    /// Makes a child a part of this node, where few entries become zeros by it, and leaves nothing of the child then.
    fn take_in(&mut self, child: usize, nodes: &mut [Growing]) {
        let below = &nodes[child];
        let width = below.width + self.width;
        let zeros = self.zeros + below.zeros + below.width * (self.width + self.met - below.met);
        let all = width * (width + 1) / 2 + width * self.met;
        // Narrow strips cost more than their products.
        let most = match width {
            ..=8 => 0.8,
            9..=32 => 0.3,
            33..=96 => 0.1,
            _ => 0.05,
        };
        if zeros as f64 > most * all as f64 {
            self.children.push(child);
            return;
        }
        let below = &mut nodes[child];
        (self.width, self.zeros) = (width, zeros);
        self.children.append(&mut below.children);
        below.others = Vec::new();
        let mut kinds = std::mem::take(&mut below.kinds);
        kinds.append(&mut self.kinds);
        self.kinds = kinds;
    }
}

/// Nodes, all that is below each right before it.
fn postorder(nodes: &[Growing]) -> Vec<usize> {
    let kept = (0..nodes.len()).filter(|&at| !nodes[at].kinds.is_empty());
    let mut open: Vec<usize> = kept.filter(|&at| nodes[at].others.is_empty()).collect();
    // Parents before their children, turned round.
    let mut order = Vec::new();
    while let Some(at) = open.pop() {
        order.push(at);
        open.extend(&nodes[at].children);
    }
    order.reverse();
    order
}
