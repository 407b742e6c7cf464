//! Student's distribution: how much longer error bars are where few numbers say how large errors are.

/// Two deviations of so many degrees of freedom over two of the normal distribution: quantiles that are left out as often (Student
/// 1908). Exact for one and two, within two per cent for more (Abramowitz and Stegun 26.7.5).
pub(crate) fn longer(freedoms: f64) -> f64 {
    const NORMAL: f64 = 1.959_964;
    if freedoms < 2.0 {
        return 12.7062 / NORMAL;
    }
    if freedoms < 3.0 {
        return 4.302_65 / NORMAL;
    }
    let square = NORMAL * NORMAL;
    let first = (square + 1.0) / 4.0;
    let second = (5.0 * square * square + 16.0 * square + 3.0) / 96.0;
    let third = (3.0 * square.powi(3) + 19.0 * square * square + 17.0 * square - 15.0) / 384.0;
    1.0 + first / freedoms + second / freedoms.powi(2) + third / freedoms.powi(3)
}

#[cfg(test)]
mod tests {
    use super::longer;

    /// Tables of Student's distribution.
    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedoms, quantile) in
            [(1.0, 12.706), (2.0, 4.303), (3.0, 3.182), (5.0, 2.571), (8.0, 2.306), (30.0, 2.042)]
        {
            let found = longer(freedoms) * 1.96;
            assert!((found / quantile - 1.0).abs() < 0.02, "{freedoms}: {found} for {quantile}");
        }
    }
}
