//! Tools that come down on the membrane, move over it, and are taken away.

/// A tool's way.
pub(super) struct Motion {
    pub(super) name: &'static str,
    /// At 30 a second.
    pub(super) frames: usize,
    /// Height of the tool's surface over a place, in metres, at a share of the way.
    pub(super) height: fn(f64, f64, f64) -> f64,
}

/// All motions.
pub(super) fn motions() -> [Motion; 2] {
    [
        Motion { name: "a ball slides", frames: 40, height: ball },
        Motion { name: "a bar turns", frames: 40, height: bar },
    ]
}

/// Height of the lowest point, in metres: down in the first quarter of the way, up in the last. The free membrane is 33 mm high.
fn lowest(share: f64) -> f64 {
    let down = (4.0 * share).min(4.0 * (1.0 - share)).clamp(0.0, 1.0);
    0.034 - 0.013 * down
}

/// A ball of 30 mm that is moved by 20 mm: some two thirds of a millimetre a frame.
fn ball(share: f64, x: f64, y: f64) -> f64 {
    const RADIUS: f64 = 0.015;
    let square = (x + 0.01 - 0.02 * share).powi(2) + (y - 0.004).powi(2);
    lowest(share) + RADIUS - (RADIUS * RADIUS - square).max(0.0).sqrt()
        + if square > RADIUS * RADIUS { 1.0 } else { 0.0 }
}

/// A bar of 30 by 6 mm, its edges rounded to 3 mm, that is turned by a quarter.
fn bar(share: f64, x: f64, y: f64) -> f64 {
    const HALF: [f64; 2] = [0.012, 1e-4];
    const ROUND: f64 = 0.003;
    let (sin, cos) = (share * std::f64::consts::FRAC_PI_2).sin_cos();
    let (along, across) = (cos * x + sin * y, cos * y - sin * x);
    let beyond = (along.abs() - HALF[0]).max(0.0).hypot((across.abs() - HALF[1]).max(0.0));
    if beyond > ROUND { 1.0 } else { lowest(share) + ROUND - (ROUND * ROUND - beyond * beyond).sqrt() }
}
