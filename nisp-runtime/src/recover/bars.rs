//! Error bars of a network: what noise adds to the answer, and what smoothing takes from it.

use crate::noise::Noise;
use crate::solve::posterior::Posterior;

/// Standard deviations of quantities, and the part of them that comes from smoothing.
pub(super) struct Bars {
    pub(super) deviations: Vec<f64>,
    pub(super) by_prior: Vec<f64>,
}

/// How far the prior's part of error bars is off.
#[derive(Clone, Copy)]
pub(super) struct Distrust(f64);

impl Distrust {
    /// The prior's smoothness is chosen by the data, and the less they tell signal from noise, the more it is that of the
    /// states, which are smoother than the source that drives them. Line through what covers about 95 % of the sources of
    /// simulated circuits and pendulums, from noise of a thousandth of the signal to several times the signal
    /// (`equations/examples/calibrate.rs`).
    pub(super) fn under(noise: &Noise) -> Self {
        Self(0.5 + 2.75 * noise.share())
    }

    /// What the prior's part of deviations is multiplied by.
    pub(super) fn factor(self) -> f64 {
        self.0
    }

    /// The bars of quantities with this posterior.
    pub(super) fn bars(self, posterior: &Posterior) -> Bars {
        let by_prior: Vec<f64> = posterior.by_prior.iter().map(|part| self.0 * part).collect();
        let pairs = posterior.by_noise.iter().zip(&by_prior);
        Bars { deviations: pairs.map(|(noise, prior)| noise.hypot(*prior)).collect(), by_prior }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::ObservationNoise;

    #[test]
    fn noise_that_hides_the_signal_doubts_the_prior_most() {
        let bars = |levels: &[(f64, f64)]| {
            let observations =
                levels.iter().map(|&(deviation, spread)| ObservationNoise { group: 0, term: 0, deviation, spread });
            let posterior = Posterior { by_noise: vec![3.0], by_prior: vec![4.0] };
            Distrust::under(&Noise { observations: observations.collect() }).bars(&posterior)
        };
        let exact = bars(&[(0.0, 1.0)]);
        assert_eq!((exact.by_prior[0], exact.deviations[0]), (2.0, 13.0_f64.sqrt()));
        // Shares of four elevenths and of nothing: two elevenths, which is one.
        assert!((bars(&[((4.0_f64 / 11.0).sqrt(), 1.0), (0.0, 2.0)]).by_prior[0] - 4.0).abs() < 1e-12);
        // Values that do not vary, and none at all.
        assert_eq!(bars(&[(0.0, 0.0)]).by_prior[0], 2.0);
        assert_eq!(bars(&[]).by_prior[0], 13.0);
    }
}
