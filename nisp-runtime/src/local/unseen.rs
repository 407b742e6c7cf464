//! What a source may be where no cloud saw the surface. Its prior says that it is zero or well above zero there, but not which of
//! both. So its deviations are those of a pressure that is as large as patches are, and changes over their size.

use super::heads::Heads;
use super::lattice::Lattice;
use super::normal::Normal;
use super::surface::Surface;
use crate::nearest::Nearest;
use crate::solve::driver::{Warning, WarningKind};

/// Share of the surface up to which clouds are taken to show all: a rim is hardly ever seen, and nothing presses there.
const FEW: f64 = 0.1;
/// Size of a patch, as a share of the body's. What is nearer to a point that was seen than half of it is seen.
const PATCH: f64 = 0.1;
/// Pressure of a patch, in levels, of which the least is one.
const PRESSURE: f64 = 2.0;
/// Of a thin cloud, places are seen within so many times the distance that a quarter of them has from the next point.
const THIN: f64 = 4.0;
/// Stiffness of the differences between next nodes at which a field in the plane has a deviation of about one, if it changes over
/// some twelve nodes. It grows with the logarithm of their number.
const SPREAD: f64 = 0.6;

/// A source's functions that no cloud saw.
pub(super) struct Unseen {
    /// By number among those kept.
    pub(super) functions: Vec<bool>,
    /// Share of the surface.
    share: f64,
    /// Nodes along a patch.
    nodes: f64,
}

impl Unseen {
    /// What clouds did not see of a source on a lattice; nothing where there are no clouds, or where they saw about all.
    pub(super) fn of(surfaces: &[Surface], lattice: &Lattice) -> Option<Self> {
        let feet: Vec<[f64; 3]> = surfaces.iter().flat_map(Surface::found_places).collect();
        let samples: Vec<[f64; 3]> = surfaces.iter().flat_map(Surface::samples).collect();
        let (of_feet, of_samples) = (Nearest::of(&feet)?, Nearest::of(&samples)?);
        let distances: Vec<f64> = samples.iter().map(|place| of_feet.one(place).distance).collect();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let longest = (0..lattice.dimensions()).max_by_key(|axis| lattice.cells[*axis])?;
        let nodes = PATCH * lattice.cells[longest] as f64;
        let patch = (nodes * lattice.spacing(longest)).max(THIN * sorted[sorted.len() / 4]);
        let is_unseen = |distance: f64| distance > 0.5 * patch;
        let share = distances.iter().filter(|distance| is_unseen(**distance)).count() as f64 / distances.len() as f64;
        // Functions whose middle is off the surface are seen as its edge is.
        let nearest = |at| of_samples.one(&lattice.middle(at)).index;
        let functions = (0..lattice.len()).map(|at| is_unseen(distances[nearest(at)])).collect();
        Some(Self { functions, share, nodes }).filter(|unseen| unseen.share > FEW)
    }

    /// Says that a source acts there too.
    pub(super) fn warning(&self, source: &str) -> Warning {
        let message = format!(
            "clouds do not show {:.0} % of where `{source}` acts; it is what the prior says there, as little as can be, and its \
             deviations say how much it may be",
            100.0 * self.share
        );
        Warning { kind: WarningKind::Settled, message }
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
