//! An inflated membrane under a moving tool, by linear triangles: nothing of it is shared with what is measured.
//!
//! The energy is von Karman's (strains `E = sym grad(u) + grad(w) grad(w)^T / 2`), with the work of the gas and a penalty
//! where the surface is above the tool. It is minimised from the last position of the tool.

use nisp::solve::fault::Fault;
use nisp::solve::lbfgs::Lbfgs;
use nisp::solve::method::{Method, Verdict};
use nisp::solve::objective::Objective;
use nisp_data::DataError;
use nisp_data::domain::{Domain, Sampling};
use nisp_equations::contact::Face;

/// Semi-axes, thickness (metres), Young's modulus, gauge pressure (pascals) and Poisson's ratio.
pub(super) const AXES: [f64; 2] = [0.06, 0.04];
pub(super) const THICKNESS: f64 = 4.5e-4;
pub(super) const YOUNG: f64 = 341_260.0;
pub(super) const PRESSURE: f64 = 5670.0;
pub(super) const POISSON: f64 = 0.5;

/// Nodes within and on the rim.
const NODES: (usize, usize) = (6000, 240);
/// Pressure of the penalty by depth, in pascals over metres: a twentieth of a millimetre at 20 kPa.
const PENALTY: f64 = 4e8;
/// Steps for a position of the tool, at most, and the norm of the forces on all nodes, in newtons, at which it rests.
const STEPS: usize = 4000;
const REST: f64 = 1e-4;

/// The lowest height of a tool over a place, in metres.
pub(super) type Tool<'a> = dyn Fn(f64, f64) -> f64 + 'a;

/// The membrane and its present shape.
pub(super) struct Membrane {
    face: Face,
    /// Area of every node.
    areas: Vec<f64>,
    /// Twice the area of every triangle, and the derivatives of its corners' hats.
    hats: Vec<(f64, [[f64; 2]; 3])>,
    is_free: Vec<bool>,
    /// `u`, `v` and `w` of every node, in metres.
    shape: Vec<f64>,
}

impl Membrane {
    pub(super) fn new() -> Result<Self, DataError> {
        let ellipse = Domain::ellipse([0.0, 0.0], AXES)?;
        let rim = ellipse.boundary(NODES.1).coords;
        let inner = ellipse.interior(NODES.0, Sampling::Grid, 0).coords;
        let is_free: Vec<bool> = (0..(rim.len() + inner.len()) / 2).map(|node| 2 * node >= rim.len()).collect();
        let face = Face::new(2, [rim, inner].concat())?;
        let place = |node: usize| [face.points[2 * node], face.points[2 * node + 1]];
        let hats = |corners: &[usize; 3]| {
            let [p, q, r] = corners.map(place);
            let double = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            let hat = |a: [f64; 2], b: [f64; 2]| [(a[1] - b[1]) / double, (b[0] - a[0]) / double];
            (double, [hat(q, r), hat(r, p), hat(p, q)])
        };
        let hats = face.triangles.iter().map(hats).collect();
        let areas = face.areas(&face.at_rest());
        // A bulge to begin with.
        let bulge = |node: usize| {
            let [x, y] = place(node);
            [0.0, 0.0, 0.03 * (1.0 - (x / AXES[0]).powi(2) - (y / AXES[1]).powi(2)).max(0.0)]
        };
        let shape = (0..is_free.len()).flat_map(bulge).collect();
        Ok(Self { face, areas, hats, is_free, shape })
    }

    /// Moves the tool, and the membrane with it.
    pub(super) fn press(&mut self, tool: &Tool<'_>) -> Result<(), Fault> {
        let heights = self.face.points.chunks_exact(2).map(|point| tool(point[0], point[1])).collect();
        let mut method = Lbfgs::new(self.shape.clone(), 30);
        let mut energy = Energy { membrane: self, heights };
        for _ in 0..STEPS {
            let step = method.step(&mut energy)?;
            if step.gradient_norm < REST || step.verdict == Verdict::Exhausted {
                break;
            }
        }
        self.shape = Method::<f64, Energy<'_>>::theta(&method).to_vec();
        Ok(())
    }

    /// The tool's pressure at every node, in pascals.
    pub(super) fn pressures(&self, tool: &Tool<'_>) -> Vec<f64> {
        let nodes = self.face.points.chunks_exact(2).zip(self.shape.chunks_exact(3));
        nodes.map(|(point, moved)| PENALTY * (moved[2] - tool(point[0], point[1])).max(0.0)).collect()
    }

    /// The net force of pressures at the nodes, downwards, in newtons.
    pub(super) fn force(&self, pressures: &[f64]) -> f64 {
        pressures.iter().zip(&self.areas).map(|(pressure, area)| pressure * area).sum()
    }

    /// Places of the nodes at rest, flat.
    pub(super) fn places(&self) -> &[f64] {
        &self.face.points
    }

    /// A point of the surface: of a triangle that `choice` from 0 to 1 names, at these shares of two of its sides.
    pub(super) fn point(&self, choice: f64, [s, t]: [f64; 2]) -> [f64; 3] {
        let corners = self.face.triangles[(choice * self.face.triangles.len() as f64) as usize];
        let [s, t] = if s + t > 1.0 { [1.0 - s, 1.0 - t] } else { [s, t] };
        let moved = corners.map(|node| {
            let (rest, moved) = (&self.face.points[2 * node..], &self.shape[3 * node..]);
            [rest[0] + moved[0], rest[1] + moved[1], moved[2]]
        });
        std::array::from_fn(|axis| (1.0 - s - t) * moved[0][axis] + s * moved[1][axis] + t * moved[2][axis])
    }
}

/// The energy over a tool of these heights at the nodes, in joules.
struct Energy<'a> {
    membrane: &'a Membrane,
    heights: Vec<f64>,
}

impl Objective<f64> for Energy<'_> {
    fn len(&self) -> usize {
        self.membrane.shape.len()
    }

    fn value(&mut self, shape: &[f64]) -> Result<f64, Fault> {
        let mut gradient = vec![0.0; shape.len()];
        self.gradient(shape, &mut gradient)
    }

    fn gradient(&mut self, shape: &[f64], gradient: &mut [f64]) -> Result<f64, Fault> {
        let stiffness = YOUNG * THICKNESS / (1.0 - POISSON * POISSON);
        let body = self.membrane;
        gradient.fill(0.0);
        let mut energy = 0.0;
        for (corners, (double, hats)) in body.face.triangles.iter().zip(&body.hats) {
            // Derivatives of u, v and w by both coordinates.
            let slope = |field: usize, axis: usize| -> f64 {
                (0..3).map(|corner| hats[corner][axis] * shape[3 * corners[corner] + field]).sum()
            };
            let slopes: [[f64; 2]; 3] = std::array::from_fn(|field| [slope(field, 0), slope(field, 1)]);
            let [w_a, w_b] = slopes[2];
            let (aa, bb) = (slopes[0][0] + w_a * w_a / 2.0, slopes[1][1] + w_b * w_b / 2.0);
            let ab = (slopes[0][1] + slopes[1][0] + w_a * w_b) / 2.0;
            let n_aa = stiffness * (aa + POISSON * bb);
            let n_bb = stiffness * (bb + POISSON * aa);
            let n_ab = stiffness * (1.0 - POISSON) * ab;
            energy += double / 4.0 * (n_aa * aa + n_bb * bb + 2.0 * n_ab * ab);
            let pulls = [[n_aa, n_ab], [n_ab, n_bb], [n_aa * w_a + n_ab * w_b, n_ab * w_a + n_bb * w_b]];
            for (corner, hat) in corners.iter().zip(hats) {
                for (field, pull) in pulls.iter().enumerate() {
                    gradient[3 * corner + field] += double / 2.0 * (pull[0] * hat[0] + pull[1] * hat[1]);
                }
            }
        }
        for (node, area) in body.areas.iter().enumerate() {
            let w = shape[3 * node + 2];
            let depth = (w - self.heights[node]).max(0.0);
            energy += area * (PENALTY / 2.0 * depth * depth - PRESSURE * w);
            gradient[3 * node + 2] += area * (PENALTY * depth - PRESSURE);
            if !body.is_free[node] {
                gradient[3 * node..3 * node + 3].fill(0.0);
            }
        }
        Ok(energy)
    }
}
