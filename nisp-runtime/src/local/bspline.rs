//! Uniform B-splines on a line, one cell at a time (de Boor, *A Practical Guide to Splines*, chapter X).

/// Derivatives of order `order` of the `degree + 1` splines that do not vanish on a cell of unit length, at `t` within it,
/// the leftmost spline first. They are zero above the degree.
pub(super) fn on_cell(degree: usize, order: usize, t: f64, out: &mut [f64]) {
    out[..=degree].fill(0.0);
    if order > degree {
        return;
    }
    let low = degree - order;
    out[0] = 1.0;
    for k in 1..=low {
        for j in (0..=k).rev() {
            let left = if j > 0 { (t + (k - j) as f64) * out[j - 1] } else { 0.0 };
            let own = if j < k { (1.0 + j as f64 - t) * out[j] } else { 0.0 };
            out[j] = (left + own) / k as f64;
        }
    }
    // The derivative of a spline is the difference of two of a degree less.
    for k in low + 1..=degree {
        for j in (0..=k).rev() {
            let left = if j > 0 { out[j - 1] } else { 0.0 };
            let own = if j < k { out[j] } else { 0.0 };
            out[j] = left - own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_add_up_to_one_and_their_derivatives_to_nothing() {
        for degree in 0..6 {
            for order in 0..=degree {
                let mut values = [0.0; 6];
                on_cell(degree, order, 0.3, &mut values);
                let sum: f64 = values[..=degree].iter().sum();
                let expected = if order == 0 { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-14, "degree {degree}, order {order}: {sum}");
            }
        }
    }

    #[test]
    fn cubic_splines_have_their_closed_form() {
        let t: f64 = 0.4;
        let mut values = [0.0; 4];
        on_cell(3, 0, t, &mut values);
        let closed = [
            (1.0 - t).powi(3) / 6.0,
            (3.0 * t.powi(3) - 6.0 * t * t + 4.0) / 6.0,
            (-3.0 * t.powi(3) + 3.0 * t * t + 3.0 * t + 1.0) / 6.0,
            t.powi(3) / 6.0,
        ];
        assert!(values.iter().zip(closed).all(|(a, b)| (a - b).abs() < 1e-15), "{values:?}");
        on_cell(3, 2, t, &mut values);
        let closed = [1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t];
        assert!(values.iter().zip(closed).all(|(a, b)| (a - b).abs() < 1e-15), "{values:?}");
    }
}
