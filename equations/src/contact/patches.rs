//! The patches of a contact: connected touched parts of a face.

use super::face::{Face, weighted_sum};

/// A connected part of a body's surface that is touched. Lengths are in metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Its middle at rest: the mean place over its area at rest.
    pub centre_at_rest: [f64; 3],
    /// Its middle on the deformed surface: the mean place over its deformed area.
    pub centre: [f64; 3],
    /// Its area at rest.
    pub area_at_rest: f64,
    /// Its area on the deformed surface.
    pub area: f64,
    /// The force on the body that acts within it, in newtons.
    pub force: [f64; 3],
}

/// The patches of the points that `touched` marks, the largest first. `moved` are the points' deformed places, `pressures`
/// what acts on them, and `forces` the force of one pascal at each.
pub(super) fn patches(
    face: &Face,
    touched: &[bool],
    moved: &[[f64; 3]],
    pressures: &[f64],
    forces: &[[f64; 3]],
) -> Vec<Patch> {
    let at_rest = face.at_rest();
    let (areas_at_rest, areas) = (face.areas(&at_rest), face.areas(moved));
    let of = |members: Vec<usize>| {
        let pick = |all: &[f64]| -> Vec<f64> { members.iter().map(|&at| all[at]).collect() };
        let places = |all: &[[f64; 3]]| -> Vec<[f64; 3]> { members.iter().map(|&at| all[at]).collect() };
        let middle = |weights: &[f64], all: &[[f64; 3]]| {
            let total = weights.iter().sum::<f64>();
            weighted_sum(weights, &places(all)).map(|x| x / total)
        };
        let (rest, now) = (pick(&areas_at_rest), pick(&areas));
        Patch {
            centre_at_rest: middle(&rest, &at_rest),
            centre: middle(&now, moved),
            area_at_rest: rest.iter().sum(),
            area: now.iter().sum(),
            force: weighted_sum(&pick(pressures), &places(forces)),
        }
    };
    let mut patches: Vec<Patch> = connected(face, touched).into_iter().map(of).collect();
    patches.sort_by(|a, b| b.area_at_rest.total_cmp(&a.area_at_rest));
    patches
}

/// Marked points in groups: two of them belong together where an edge of a triangle joins them.
fn connected(face: &Face, marked: &[bool]) -> Vec<Vec<usize>> {
    let mut neighbours = vec![Vec::new(); marked.len()];
    for &[a, b, c] in &face.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            if marked[from] && marked[to] {
                neighbours[from].push(to);
                neighbours[to].push(from);
            }
        }
    }
    let mut left = marked.to_vec();
    let mut groups = Vec::new();
    for first in 0..marked.len() {
        if !std::mem::take(&mut left[first]) {
            continue;
        }
        let mut group = vec![first];
        let mut at = 0;
        while let Some(&member) = group.get(at) {
            at += 1;
            group.extend(neighbours[member].iter().filter(|&&other| std::mem::take(&mut left[other])));
        }
        groups.push(group);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::face::Load;
    use std::f64::consts::PI;

    /// Two discs on a square that is lifted and stretched twofold along x: areas double, middles move along.
    #[test]
    fn two_discs_are_two_patches_with_their_own_areas_and_forces() {
        let points: Vec<f64> = (0..201 * 201).flat_map(|i| [i % 201, i / 201].map(|k| 0.005 * f64::from(k))).collect();
        let face = Face::new(2, points).unwrap();
        let within = |p: &[f64], [x, y, radius]: [f64; 3]| (p[0] - x).hypot(p[1] - y) < radius;
        let (large, small) = ([0.3, 0.4, 0.15], [0.75, 0.7, 0.1]);
        let touched: Vec<bool> = face.points.chunks_exact(2).map(|p| within(p, large) || within(p, small)).collect();
        let moved: Vec<[f64; 3]> = face.points.chunks_exact(2).map(|p| [2.0 * p[0], p[1], 0.5]).collect();
        let pressures: Vec<f64> = touched.iter().map(|touched| if *touched { 3.0 } else { 0.0 }).collect();
        let forces = face.forces(Load::Follower, &moved);
        let found = patches(&face, &touched, &moved, &pressures, &forces);
        assert_eq!(found.len(), 2);
        for (patch, [x, y, radius]) in found.iter().zip([large, small]) {
            let area = PI * radius * radius;
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
            assert!(close(patch.area_at_rest, area) && close(patch.area, 2.0 * area), "{patch:?}");
            assert!(close(patch.force[2], -6.0 * area), "{patch:?}");
            assert!(close(patch.centre_at_rest[0], x) && close(patch.centre[0], 2.0 * x), "{patch:?}");
            assert!(close(patch.centre[1], y) && close(patch.centre[2], 0.5), "{patch:?}");
        }
    }
}
