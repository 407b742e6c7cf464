//! Unknown sources, drawn at random.

use std::f64::consts::TAU;

use crate::random::Random;

/// A function over `0 .. span`: a few waves, a decay and a pulse, each of which may be missing.
pub(super) struct Drive {
    /// Angular frequency, amplitude and phase.
    waves: Vec<[f64; 3]>,
    /// Rate and amplitude.
    decay: [f64; 2],
    /// Place, width and height.
    pulse: [f64; 3],
}

impl Drive {
    /// Of values about as large as `size`, with some periods over the span.
    pub(super) fn draw(random: &mut Random, span: f64, size: f64) -> Self {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let parts = between(0.0, 3.0);
        let count = if parts < 2.0 { 1 + (parts * 1.5) as usize } else { 0 };
        let waves = (0..count).map(|_| [TAU * between(0.3, 4.0) / span, size * between(0.3, 1.0), between(0.0, TAU)]);
        let waves = waves.collect();
        let decay = [between(2.0, 8.0) / span, if parts > 1.0 { size * between(-1.5, 1.5) } else { 0.0 }];
        let pulse = [between(0.2, 0.8) * span, between(0.05, 0.15) * span, 0.0];
        let height = if between(0.0, 1.0) < 0.3 { size * between(0.7, 1.5) } else { 0.0 };
        Self { waves, decay, pulse: [pulse[0], pulse[1], height] }
    }

    pub(super) fn at(&self, t: f64) -> f64 {
        let [centre, width, height] = self.pulse;
        let waves: f64 = self.waves.iter().map(|[pace, size, phase]| size * (pace * t + phase).sin()).sum();
        waves + self.decay[1] * (-self.decay[0] * t).exp() + height * (-((t - centre) / width).powi(2)).exp()
    }

    pub(super) fn slope(&self, t: f64) -> f64 {
        let [centre, width, height] = self.pulse;
        let waves: f64 = self.waves.iter().map(|[pace, size, phase]| size * pace * (pace * t + phase).cos()).sum();
        let from = (t - centre) / width;
        let pulse = -2.0 * from / width * height * (-from * from).exp();
        waves - self.decay[0] * self.decay[1] * (-self.decay[0] * t).exp() + pulse
    }
}
