//! The cells between points that lie on a grid, some of which may be missing.

use std::collections::HashMap;

/// Cells by their corners, the first coordinate running fastest, as VTK's voxels have them.
pub(super) fn voxels(points: &[[f64; 3]]) -> Vec<[usize; 8]> {
    let lines: [Vec<f64>; 3] = std::array::from_fn(|axis| {
        let mut line: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        line.sort_by(f64::total_cmp);
        line.dedup();
        line
    });
    let place = |point: &[f64; 3]| -> [usize; 3] {
        std::array::from_fn(|axis| lines[axis].partition_point(|value| *value < point[axis]))
    };
    let numbers: HashMap<[usize; 3], usize> = points.iter().enumerate().map(|(at, point)| (place(point), at)).collect();
    let cell = |point: &[f64; 3]| -> Option<[usize; 8]> {
        let first = place(point);
        let corner = |k: usize| std::array::from_fn(|axis| first[axis] + (k >> axis & 1));
        let corners = (0..8).map(|k| numbers.get(&corner(k)).copied()).collect::<Option<Vec<usize>>>()?;
        corners.try_into().ok()
    };
    points.iter().filter_map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::voxels;

    #[test]
    fn cells_have_all_of_their_corners() {
        let all = (0..12).map(|i| [f64::from(i % 2), f64::from(i / 2 % 2) * 0.5, f64::from(i / 4)]);
        let mut points: Vec<[f64; 3]> = all.collect();
        assert_eq!(voxels(&points), [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]]);
        points.pop();
        assert_eq!(voxels(&points), [[0, 1, 2, 3, 4, 5, 6, 7]]);
    }
}
