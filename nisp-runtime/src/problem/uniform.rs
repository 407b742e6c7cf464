//! Rows of a group where everything that they read has one value everywhere: what changes from point to point is the equation itself.

use super::Bound;
use crate::residual::Points;
use crate::simd::Isa;

/// Padding of the points, as everywhere in the engine.
const LANES: usize = 16;

impl Bound {
    /// Rows of a group at points, given flat, with their columns, `[row][point]`.
    pub(crate) fn uniform_rows(
        &self,
        group: usize,
        (points, columns): (&[f64], &[Vec<f64>]),
        jets: &[f64],
        scalars: &[f64],
    ) -> Vec<Vec<f64>> {
        let scene = self.problem.scene();
        let (rows, inputs) = (scene.schema.groups[group].rows, scene.schema.coordinates.len());
        let count = points.len() / inputs;
        let stride = count.next_multiple_of(LANES);
        let padded = |of: &dyn Fn(usize) -> f64| (0..stride).map(|p| of(p.min(count - 1))).collect::<Vec<f64>>();
        let jets: Vec<f64> = jets.iter().flat_map(|&jet| std::iter::repeat_n(jet, stride)).collect();
        let coordinates: Vec<f64> = (0..inputs).flat_map(|axis| padded(&|p| points[p * inputs + axis])).collect();
        let columns: Vec<f64> = columns.iter().flat_map(|column| padded(&|p| column[p])).collect();
        let points =
            Points { count, stride, jets: &jets, coordinates: &coordinates, columns: &columns, scalars, seeds: &[] };
        let mut values = vec![0.0; rows * stride];
        scene.double()[group].programs.residual(Isa::detect(), points, &mut values);
        values.chunks_exact(stride).map(|row| row[..count].to_vec()).collect()
    }
}
