//! Places of a source that no cloud saw. What is known of it there is its prior, and that it is zero "or well above" does not
//! say which: its deviations there are those of a pressure of the prior's level that is spread as patches are.

use kiddo::{ImmutableKdTree, SquaredEuclidean};

use super::heads::Heads;
use super::lattice::Lattice;
use super::normal::Normal;
use super::surface::Surface;

/// Share of a source's functions up to which clouds are taken to show all: a rim is hardly ever seen, and nothing presses there.
const FEW: f64 = 0.1;
/// Size of a patch, as a share of the body's. What is nearer to a point that was seen than half of it is seen.
const PATCH: f64 = 0.1;
/// Pressure of a patch, in levels, of which the least is one.
const PRESSURE: f64 = 2.0;
/// Of a thin cloud, functions are seen within so many times the distance that a quarter of them has from the next point.
const THIN: f64 = 4.0;
/// Stiffness of differences over that of a node of a field whose deviation is one, in the plane: over the patch's size in nodes the
/// logarithm of its sum over waves hardly changes.
const SPREAD: f64 = 0.6;

/// A source's functions that no cloud saw.
pub(super) struct Unseen {
    /// By number among those kept.
    pub(super) functions: Vec<bool>,
    /// Nodes along a patch.
    nodes: f64,
}

impl Unseen {
    /// What clouds did not see of a source on a lattice; nothing where there are no clouds, or where they saw about
    /// all.
    pub(super) fn of(surfaces: &[Surface], lattice: &Lattice) -> Option<Self> {
        let feet: Vec<[f64; 3]> = surfaces.iter().flat_map(Surface::found_places).collect();
        let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&feet).ok().filter(|_| !feet.is_empty())?;
        let distance = |at| tree.query(&lattice.middle(at)).nearest_one::<SquaredEuclidean<f64>>().execute().distance;
        let distances: Vec<f64> = (0..lattice.len()).map(|at| distance(at).sqrt()).collect();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let longest = (0..lattice.dimensions()).max_by_key(|axis| lattice.cells[*axis])?;
        let nodes = PATCH * lattice.cells[longest] as f64;
        let patch = (nodes * lattice.spacing(longest)).max(THIN * sorted[sorted.len() / 4]);
        let functions = distances.iter().map(|distance| *distance > 0.5 * patch).collect();
        Some(Self { functions, nodes }).filter(|unseen| unseen.share() > FEW)
    }

    /// Share of the source's functions.
    pub(super) fn share(&self) -> f64 {
        self.functions.iter().filter(|unseen| **unseen).count() as f64 / self.functions.len() as f64
    }

    /// Adds what is known of a source there: no more than that it is of the order of `level`, in units of its coefficients.
    pub(super) fn add(&self, normal: &mut Normal, heads: &Heads, head: usize, level: f64) {
        let (first, lattice) = (heads.first[head], &heads.lattices[head]);
        let stiffness = SPREAD / (PRESSURE * level).powi(2);
        for axis in 0..lattice.dimensions() {
            for (a, b) in lattice.neighbours(axis) {
                if self.functions[a as usize] || self.functions[b as usize] {
                    normal.add_difference([first + a as usize, first + b as usize], stiffness, 0.0);
                }
            }
        }
        for at in (0..lattice.len()).filter(|at| self.functions[*at]) {
            normal.add_stiffness(first + at, stiffness / (self.nodes * self.nodes));
        }
    }
}
