//! Ordinary differential equations by the classical method of Runge and Kutta.

/// Steps between two wanted times: smooth solutions are exact to some ten digits.
const STEPS: usize = 50;

/// States at rising times, the first of which is the start.
pub(crate) fn integrate<const N: usize>(
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
    start: [f64; N],
    times: &[f64],
) -> Vec<[f64; N]> {
    let along = |state: [f64; N], slope: [f64; N], by: f64| std::array::from_fn(|i| state[i] + by * slope[i]);
    let mut states = vec![start];
    for pair in times.windows(2) {
        let step = (pair[1] - pair[0]) / STEPS as f64;
        let mut state = states[states.len() - 1];
        for at in 0..STEPS {
            let time = pair[0] + step * at as f64;
            let k1 = slope(time, state);
            let k2 = slope(time + step / 2.0, along(state, k1, step / 2.0));
            let k3 = slope(time + step / 2.0, along(state, k2, step / 2.0));
            let k4 = slope(time + step, along(state, k3, step));
            state = std::array::from_fn(|i| state[i] + step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        states.push(state);
    }
    states
}

#[cfg(test)]
mod tests {
    use super::integrate;

    #[test]
    fn a_swing_follows_its_cosine() {
        let times: Vec<f64> = (0..20).map(|i| 0.3 * f64::from(i)).collect();
        let states = integrate(|_, [x, v]| [v, -x], [1.0, 0.0], &times);
        for (time, [x, v]) in times.iter().zip(states) {
            assert!((x - time.cos()).abs() < 1e-8 && (v + time.sin()).abs() < 1e-8, "{time}: {x} {v}");
        }
    }
}
